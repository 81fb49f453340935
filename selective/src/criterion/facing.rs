//! Back faces: nothing is asked where the whole surface faces away from the eye.

use crate::criterion::{Criterion, Pace, Relax};
use glam::Vec3;
use mt_core::Bound;

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
    /// Whether all of a bound faces away from the eye: the angle between the cone's axis and the direction from the eye to
    /// the sphere's centre, and the half-angles of both, make less than a right angle. By sines and cosines, since it is
    /// asked of every node that something is asked of.
    pub fn faces_away(&self, bound: &Bound) -> bool {
        let Some((axis, sine, cosine)) = bound.cone.slope() else { return true };
        let view = bound.center.as_dvec3() - self.eye.as_dvec3();
        let radius = f64::from(bound.radius);
        // Of the distance to the centre: what it is along the cone that touches the sphere.
        let along = (view.length_squared() - radius * radius).max(0.0).sqrt();
        // Sine and cosine of both half-angles together, times that distance.
        let (across, ahead) = (sine * along + cosine * radius, cosine * along - sine * radius);
        let away = axis.dot(view);
        // Rounding never makes out that something faces away.
        along > 0.0
            && ahead > 0.0
            && away > 0.0
            && away * away > across * across * axis.length_squared() * (1.0 + 1e-12)
    }
}

impl<C: Criterion<Bound>> Criterion<Bound> for Facing<C> {
    const MEMORY: bool = C::MEMORY;
    const RUNS: bool = C::RUNS;
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        if self.faces_away(bound) { f32::NEG_INFINITY } else { self.criterion.excess(bound, refined) }
    }
    fn asks(&self, bound: &Bound, refined: bool) -> bool {
        self.criterion.asks(bound, refined) && !self.faces_away(bound)
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
    use crate::criterion::angles::view_angles;
    use crate::criterion::tests::patch;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    proptest! {
        #[test]
        fn away_is_less_than_a_right_angle(center in prop::array::uniform3(-9f32..9.0), radius in 0f32..9.0,
                                           normal in prop::array::uniform3(-1f32..1.0), angle in 0f32..3.0) {
            let facing = Facing { eye: Vec3::new(1.0, 2.0, 3.0), criterion: UniformError { error_max: 0.1 } };
            let bound = patch(Vec3::from(center), radius, Vec3::from(normal).normalize_or(Vec3::Z), angle);
            let most = view_angles(&bound, facing.eye).expect("a cone with normals").most;
            prop_assume!((most - FRAC_PI_2).abs() > 1e-5);
            prop_assert_eq!(facing.faces_away(&bound), most < FRAC_PI_2);
        }
    }

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
