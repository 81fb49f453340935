//! The view frustum, and error projected to the screen.

use crate::criterion::{Criterion, Pace, Relax};
use glam::{DVec4, Vec3, Vec4};
use mt_core::{Bound, Camera};

/// The six planes of a view frustum.
#[derive(Copy, Clone, Debug)]
pub struct Frustum([DVec4; 6]);

impl Frustum {
    /// The frustum of a camera. Requires: `camera.check()` is fine.
    pub fn new(camera: &Camera) -> Self {
        Self(camera.frustum().map(unit_plane))
    }

    /// Whether the sphere of a bound may reach into the frustum: it is not wholly behind one of the planes.
    pub fn sees(&self, bound: &Bound) -> bool {
        let center = bound.center.as_dvec3().extend(1.0);
        self.0.iter().all(|plane| plane.dot(center) >= -f64::from(bound.radius))
    }
}

/// A plane whose normal is at most a unit vector, so that a sphere within another never reaches further than it.
fn unit_plane(plane: Vec4) -> DVec4 {
    let plane = plane.as_dvec4();
    plane / (plane.truncate().length() * (1.0 + 1e-12))
}

/// What another criterion asks for, within a view frustum.
#[derive(Clone, Debug)]
pub struct InView<C> {
    /// Where.
    pub frustum: Frustum,
    /// What to ask there.
    pub criterion: C,
}

impl<C: Criterion<Bound>> Criterion<Bound> for InView<C> {
    const MEMORY: bool = C::MEMORY;
    const RUNS: bool = C::RUNS;
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        if self.frustum.sees(bound) { self.criterion.excess(bound, refined) } else { f32::NEG_INFINITY }
    }
    fn asks(&self, bound: &Bound, refined: bool) -> bool {
        self.criterion.asks(bound, refined) && self.frustum.sees(bound)
    }
    fn pace(&self, last: &Bound) -> Pace {
        self.criterion.pace(last)
    }
}

impl<C: Relax> Relax for InView<C> {
    fn relax(&mut self, by: f32) {
        self.criterion.relax(by);
    }
}

/// Error projected to the screen, and nothing outside the view frustum.
///
/// The projection is conservative: the error at the nearest point of the bound's sphere, no nearer than the near plane.
#[derive(Clone, Debug)]
pub struct ScreenError {
    eye: Vec3,
    pixels_per_unit: f64,
    near: f64,
    frustum: Frustum,
    error_max_px: f32,
}

impl ScreenError {
    /// The criterion of a camera. Requires: `camera.check()` is fine.
    pub fn new(camera: &Camera, error_max_px: f32) -> Self {
        Self {
            eye: camera.eye,
            pixels_per_unit: f64::from(camera.pixels_per_unit()),
            near: f64::from(camera.near),
            frustum: Frustum::new(camera),
            error_max_px,
        }
    }

    /// The excess of what is seen.
    #[inline]
    fn excess_seen(&self, bound: &Bound) -> f32 {
        let distance = bound.center.as_dvec3().distance(self.eye.as_dvec3()) - f64::from(bound.radius);
        let error_px = f64::from(bound.error) * self.pixels_per_unit / distance.max(self.near);
        (error_px - f64::from(self.error_max_px)) as f32
    }

    /// Whether the sphere of a bound reaches into the frustum.
    pub fn sees(&self, bound: &Bound) -> bool {
        self.frustum.sees(bound)
    }
}

impl Criterion<Bound> for ScreenError {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        if self.sees(bound) { self.excess_seen(bound) } else { f32::NEG_INFINITY }
    }
    fn asks(&self, bound: &Bound, _: bool) -> bool {
        // Most nodes below a front are good enough wherever they are: told without a root, a quotient or six planes. Both
        // sides of `distance - radius > error in pixels / most pixels`, times the most pixels; squares, with room for rounding.
        let most = f64::from(self.error_max_px);
        let apart = bound.center.as_dvec3().distance_squared(self.eye.as_dvec3());
        let reach = f64::from(bound.error) * self.pixels_per_unit + f64::from(bound.radius) * most;
        if most > 0.0 && apart * most * most > reach * reach * (1.0 + 1e-9) {
            return false;
        }
        self.excess_seen(bound) > 0.0 && self.sees(bound)
    }
}

impl Relax for ScreenError {
    fn relax(&mut self, by: f32) {
        self.error_max_px *= by;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::tests::ball;
    use proptest::prelude::*;

    fn camera() -> Camera {
        Camera { near: 1.0, ..Camera::around(-Vec3::ONE, Vec3::ONE, Vec3::Z) }
    }

    #[test]
    fn screen_error_is_pixels_at_the_near_side_of_the_sphere() {
        let camera = camera();
        let criterion = ScreenError::new(&camera, 0.0);
        let ahead = camera.eye + camera.direction() * 3.0;
        let expected = camera.pixels_per_unit() * 0.01 / 2.0;
        let got = criterion.excess(&ball(ahead, 1.0, 0.01), false);
        assert!((got - expected).abs() < 1e-3 * expected, "{got} {expected}");
    }

    proptest! {
        #[test]
        fn it_asks_for_what_exceeds(center in prop::array::uniform3(-9f32..9.0), radius in 0f32..9.0, error in 0f32..0.1, px in 0f32..20.0) {
            for error_max_px in [px, 0.0, -1.0] {
                let criterion = ScreenError::new(&camera(), error_max_px);
                let bound = ball(Vec3::from(center), radius, error);
                prop_assert_eq!(criterion.asks(&bound, false), criterion.excess(&bound, false) > 0.0);
            }
        }
    }

    #[test]
    fn a_camera_inside_the_sphere_sees_a_finite_error() {
        let camera = camera();
        let criterion = ScreenError::new(&camera, 1.0);
        let excess = criterion.excess(&ball(camera.eye, 10.0, 0.5), false);
        assert_eq!(excess, (camera.pixels_per_unit() as f64 * 0.5 - 1.0) as f32);
    }

    #[test]
    fn behind_the_camera_nothing_is_asked_for() {
        let camera = camera();
        let behind = camera.eye - camera.direction() * 5.0;
        assert_eq!(ScreenError::new(&camera, 1.0).excess(&ball(behind, 1.0, 9.0), false), f32::NEG_INFINITY);
        // A sphere that reaches into the frustum counts.
        assert!(ScreenError::new(&camera, 1.0).excess(&ball(behind, 7.0, 9.0), false) > 0.0);
    }
}
