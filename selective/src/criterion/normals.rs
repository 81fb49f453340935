//! Change of normals: a guard against what errors do not see.

use crate::criterion::{Criterion, Relax};
use mt_core::Bound;
use std::f32::consts::PI;

/// Asks while the half-angle of the cone of normals exceeds an angle: where a coarse side would shade differently, or
/// flip. Combine it with an error by [`crate::Wish::Any`].
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct NormalChange {
    /// Largest half-angle allowed, in radians. π and above asks for nothing.
    pub angle_max: f32,
}

impl Criterion<Bound> for NormalChange {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        // The cone says π where it cannot tell.
        bound.cone.get().map_or(f32::NEG_INFINITY, |(_, half)| half.min(PI) - self.angle_max)
    }
}

impl Relax for NormalChange {
    fn relax(&mut self, by: f32) {
        self.angle_max *= by;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::tests::patch;
    use glam::Vec3;
    use mt_core::Cone;

    #[test]
    fn wide_cones_ask() {
        let asks = |angle| NormalChange { angle_max: 0.5 }.asks(&patch(Vec3::ZERO, 1.0, Vec3::X, angle), false);
        assert!(asks(0.6) && !asks(0.4));
        let all = Bound { cone: Cone::ALL, ..Bound::default() };
        assert!(!NormalChange { angle_max: PI }.asks(&all, false) && NormalChange { angle_max: 3.1 }.asks(&all, false));
    }
}
