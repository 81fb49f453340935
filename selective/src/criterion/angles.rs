//! Extreme distances and angles over a bound: every point of the sphere, every normal of the cone.
//!
//! Ranges only ever grow with the bound, which is what makes criteria on them monotone.

use glam::{DVec3, Vec3};
use mt_core::{Bound, Cone};
use std::f64::consts::{FRAC_PI_2, PI};

/// Everything between two values.
#[derive(Copy, Clone, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) least: f64,
    pub(super) most: f64,
}

impl Range {
    /// The magnitudes of the cosines of these angles, 0 to π.
    pub(super) fn cosines(self) -> Range {
        let (first, last) = (self.least.cos().abs(), self.most.cos().abs());
        Range { least: if self.holds_right_angle() { 0.0 } else { first.min(last) }, most: first.max(last) }
    }

    /// Whether a right angle is among these.
    pub(super) fn holds_right_angle(self) -> bool {
        self.least <= FRAC_PI_2 && FRAC_PI_2 <= self.most
    }
}

/// Distances from `eye` to points of the sphere.
pub(super) fn distances(bound: &Bound, eye: Vec3) -> Range {
    let (apart, radius) = (bound.center.as_dvec3().distance(eye.as_dvec3()), f64::from(bound.radius));
    Range { least: (apart - radius).max(0.0), most: apart + radius }
}

/// Angles between a normal of the cone and a direction from `eye` to a point of the sphere; above a right angle the
/// surface faces the eye. `None` without normals.
pub(super) fn view_angles(bound: &Bound, eye: Vec3) -> Option<Range> {
    let view = bound.center.as_dvec3() - eye.as_dvec3();
    let (apart, radius) = (view.length(), f64::from(bound.radius));
    let spread = if apart <= radius { PI } else { (radius / apart).asin() };
    angles_about(bound.cone, view, spread)
}

/// Angles between a normal of the cone and a direction. `None` without normals.
pub(super) fn angles(cone: Cone, direction: Vec3) -> Option<Range> {
    angles_about(cone, direction.as_dvec3(), 0.0)
}

/// Angles between a normal of the cone and anything within `spread` of a direction.
fn angles_about(cone: Cone, direction: DVec3, spread: f64) -> Option<Range> {
    let (axis, half) = cone.get()?;
    let axis = axis.as_dvec3();
    let between = axis.cross(direction).length().atan2(axis.dot(direction));
    let reach = f64::from(half) + spread;
    Some(Range { least: (between - reach).max(0.0), most: (between + reach).min(PI) })
}
