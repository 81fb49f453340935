//! Criteria on bounds: is a modification's coarse side good enough?
//!
//! All of these are monotone in the bound: what contains another bound asks for at least as much. Sums are in `f64`, so
//! that rounding does not undo what saturation has proved.

use glam::{DVec4, Vec3, Vec4};
use mt_core::{Bound, Camera};

/// Judges a modification by its bound.
pub trait Criterion<B>: Sync {
    /// Whether the answer depends on `refined` (hysteresis). Such criteria are exempt from extract = adapt.
    const MEMORY: bool = false;
    /// How far the coarse side is from good enough, in the criterion's own unit; above 0 asks to refine. Larger is more
    /// urgent. Never not a number.
    fn excess(&self, bound: &B, refined: bool) -> f32;
    /// Whether it asks to refine.
    fn asks(&self, bound: &B, refined: bool) -> bool {
        self.excess(bound, refined) > 0.0
    }
}

impl<B, C: Criterion<B>> Criterion<B> for &C {
    const MEMORY: bool = C::MEMORY;
    fn excess(&self, bound: &B, refined: bool) -> f32 {
        (**self).excess(bound, refined)
    }
}

/// The same error everywhere.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct UniformError {
    /// Largest error allowed, in model units. Below 0 asks for everything.
    pub error_max: f32,
}

impl Criterion<Bound> for UniformError {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        bound.error - self.error_max
    }
}

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

/// Error projected to the screen, and nothing outside the view frustum.
///
/// The projection is conservative: the error at the nearest point of the bound's sphere, no nearer than the near plane.
#[derive(Clone, Debug)]
pub struct ScreenError {
    eye: Vec3,
    pixels_per_unit: f64,
    near: f64,
    planes: [DVec4; 6],
    error_max_px: f32,
}

impl ScreenError {
    /// The criterion of a camera. Requires: `camera.check()` is fine.
    pub fn new(camera: &Camera, error_max_px: f32) -> Self {
        Self {
            eye: camera.eye,
            pixels_per_unit: f64::from(camera.pixels_per_unit()),
            near: f64::from(camera.near),
            planes: camera.frustum().map(unit_plane),
            error_max_px,
        }
    }

    /// Whether the sphere of a bound reaches into the frustum.
    pub fn sees(&self, bound: &Bound) -> bool {
        let center = bound.center.as_dvec3().extend(1.0);
        self.planes.iter().all(|plane| plane.dot(center) >= -f64::from(bound.radius))
    }
}

impl Criterion<Bound> for ScreenError {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        if !self.sees(bound) {
            return f32::NEG_INFINITY;
        }
        let distance = bound.center.as_dvec3().distance(self.eye.as_dvec3()) - f64::from(bound.radius);
        let error_px = f64::from(bound.error) * self.pixels_per_unit / distance.max(self.near);
        (error_px - f64::from(self.error_max_px)) as f32
    }
}

/// A plane whose normal is at most a unit vector, so that a sphere within another never reaches further than it.
fn unit_plane(plane: Vec4) -> DVec4 {
    let plane = plane.as_dvec4();
    plane / (plane.truncate().length() * (1.0 + 1e-12))
}

/// A criterion chosen at run time.
#[derive(Clone, Debug)]
pub enum Wish {
    /// The same error everywhere.
    Uniform(UniformError),
    /// An error within a region.
    Region(InRegion),
    /// An error on a screen.
    Screen(Box<ScreenError>),
}

impl Criterion<Bound> for Wish {
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        match self {
            Wish::Uniform(criterion) => criterion.excess(bound, refined),
            Wish::Region(criterion) => criterion.excess(bound, refined),
            Wish::Screen(criterion) => criterion.excess(bound, refined),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mt_core::Cone;

    fn ball(center: Vec3, radius: f32, error: f32) -> Bound {
        Bound { center, radius, error, cone: Cone::ALL }
    }

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

    #[test]
    fn a_region_asks_only_where_it_is_touched() {
        let criterion = InRegion { region: Region { low: Vec3::ZERO, high: Vec3::ONE }, error_max: 0.1 };
        assert!(criterion.excess(&ball(Vec3::splat(1.5), 1.0, 0.2), false) > 0.0);
        assert_eq!(criterion.excess(&ball(Vec3::splat(3.0), 1.0, 0.2), false), f32::NEG_INFINITY);
    }
}
