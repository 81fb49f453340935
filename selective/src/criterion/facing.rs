//! Back faces: nothing is asked where the whole surface faces away from the eye.

use crate::criterion::angles::view_angles;
use crate::criterion::{Criterion, Pace, Relax};
use glam::Vec3;
use mt_core::Bound;
use std::f64::consts::FRAC_PI_2;

/// What another criterion asks for, but nothing where every normal of the cone faces away from the eye at every point of
/// the sphere. For closed surfaces, or where back faces are not drawn.
///
/// A bound without normals has nothing that faces the eye; one with all normals always has.
#[derive(Clone, Debug)]
pub struct Facing<C> {
    /// Where the eye is.
    pub eye: Vec3,
    /// What to ask of what may face it.
    pub criterion: C,
}

impl<C> Facing<C> {
    /// Whether all of a bound faces away from the eye.
    pub fn faces_away(&self, bound: &Bound) -> bool {
        view_angles(bound, self.eye).is_none_or(|angles| angles.most < FRAC_PI_2)
    }
}

impl<C: Criterion<Bound>> Criterion<Bound> for Facing<C> {
    const MEMORY: bool = C::MEMORY;
    const RUNS: bool = C::RUNS;
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        if self.faces_away(bound) { f32::NEG_INFINITY } else { self.criterion.excess(bound, refined) }
    }
    fn pace(&self, last: &Bound) -> Pace {
        self.criterion.pace(last)
    }
}

impl<C: Relax> Relax for Facing<C> {
    fn relax(&mut self, by: f32) {
        self.criterion.relax(by);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::UniformError;
    use crate::criterion::tests::patch;

    #[test]
    fn only_what_wholly_faces_away_is_left_out() {
        let facing = Facing { eye: Vec3::Z * 10.0, criterion: UniformError { error_max: 0.1 } };
        let asks = |normal, radius, angle| facing.asks(&patch(Vec3::ZERO, radius, normal, angle), false);
        assert!(!asks(-Vec3::Z, 1.0, 0.2) && asks(Vec3::Z, 1.0, 0.2));
        // A cone that opens beyond the horizon; a sphere so large that its rim is seen from the other side.
        assert!(asks(-Vec3::Z, 1.0, 1.5) && asks(-Vec3::Z, 9.0, 1.0));
        // The eye within the sphere sees something of it from every side.
        assert!(asks(-Vec3::Z, 11.0, 0.0));
    }
}
