//! An error within a region, anything outside.

use crate::criterion::{Criterion, Relax};
use glam::Vec3;
use mt_core::Bound;

/// A box with sides along the axes.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Region {
    /// Least coordinates.
    pub low: Vec3,
    /// Greatest coordinates.
    pub high: Vec3,
}

impl Region {
    /// Distance from `p` to the box, 0 inside.
    pub fn distance(&self, p: Vec3) -> f64 {
        let p = p.as_dvec3();
        p.distance(p.clamp(self.low.as_dvec3(), self.high.as_dvec3()))
    }

    /// Whether `p` is in the box, its faces included.
    pub fn contains(&self, p: Vec3) -> bool {
        self.low.cmple(p).all() && p.cmple(self.high).all()
    }
}

/// An error within a region, anything outside.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct InRegion {
    /// Where.
    pub region: Region,
    /// Largest error allowed there, in model units.
    pub error_max: f32,
}

impl Criterion<Bound> for InRegion {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        let touches = self.region.distance(bound.center) <= f64::from(bound.radius);
        if touches { bound.error - self.error_max } else { f32::NEG_INFINITY }
    }
}

impl Relax for InRegion {
    fn relax(&mut self, by: f32) {
        self.error_max *= by;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::tests::ball;

    #[test]
    fn a_region_asks_only_where_it_is_touched() {
        let criterion = InRegion { region: Region { low: Vec3::ZERO, high: Vec3::ONE }, error_max: 0.1 };
        assert!(criterion.excess(&ball(Vec3::splat(1.5), 1.0, 0.2), false) > 0.0);
        assert_eq!(criterion.excess(&ball(Vec3::splat(3.0), 1.0, 0.2), false), f32::NEG_INFINITY);
    }
}
