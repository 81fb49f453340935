//! Visual error by distance, view and light: equation 3 of `[LivnySokolovskyElSana2006]`, in two readings.
//!
//! With `D` the directions of view and light at a vertex `v` with normal `n`, and `C` the viewpoint, it says
//!
//! ```text
//! error(v) = dist(v, C) · |n·D_view| · |n·D_light|    if |n·D_view| > epsilon
//!            dist(v, C) · |n·D_light|                 otherwise: the silhouette
//! ```
//!
//! and calls that both the visual error and, two sentences on, a tolerance that is small close by and large far away.
//! No stored error is in it. We found no reading in which all that the paper says of it is true, so both are here:
//!
//! - [`Reading::Tolerance`]: a node may be coarse while its error is at most `scale` times the equation. With distance
//!   it goes as the paper says. But the silhouette branch makes the tolerance larger, so outlines get coarser, though
//!   the paper wants to emphasise them; and the smallest tolerance is where light grazes the surface.
//! - [`Reading::Error`]: the stored error times the equation may be at most `scale`. Outlines and surfaces that face the
//!   light get finer, as emphasis asks. But so does what is far away, which is backwards.
//!
//! The default is the first: distance is what the paper's text is about. For finer outlines put a [`crate::Silhouette`]
//! around it.
//!
//! The paper evaluates at a vertex. Here the least (tolerance) or largest (error) value over the whole sphere and the
//! whole cone counts, each factor by itself, so both readings are conservative and monotone without exception, but
//! stricter than at the vertex: a cone that holds a direction perpendicular to the light has a tolerance of 0, and a
//! wide cone holds one. That is what `error_min` is for. Both directions count by magnitude, as in the paper: a surface
//! that faces away from light or eye counts as one that faces it. Put a [`crate::Facing`] around it for the eye.

use crate::criterion::angles::{Range, angles, distances, view_angles};
use crate::criterion::{Criterion, Relax};
use glam::Vec3;
use mt_core::Bound;

/// What the equation is taken for.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// How large an error may be.
    #[default]
    Tolerance,
    /// By what an error is weighed.
    Error,
}

/// Error by distance, view and light.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct VisualError {
    /// Where the eye is.
    pub eye: Vec3,
    /// Direction to the light or from it, which is the same here; a unit vector.
    pub light: Vec3,
    /// Magnitude of the cosine between normal and view up to which a place counts as silhouette.
    pub epsilon: f32,
    /// Tolerance: what the equation is multiplied by. Error: the largest product of error and equation. Above 0.
    pub scale: f32,
    /// Below this stored error nothing is asked, in model units; 0 as in the paper.
    pub error_min: f32,
    /// What the equation is taken for.
    pub reading: Reading,
}

impl VisualError {
    /// The least and the largest value of the equation over a bound, factor by factor; `None` without normals.
    fn range(&self, bound: &Bound) -> Option<Range> {
        let distance = distances(bound, self.eye);
        let view = self.view_factor(view_angles(bound, self.eye)?.cosines());
        let light = angles(bound.cone, self.light)?.cosines();
        Some(Range { least: distance.least * view.least * light.least, most: distance.most * view.most * light.most })
    }

    /// The factor of the view for cosines in a range: the cosine itself, but 1 up to epsilon.
    fn view_factor(&self, cosines: Range) -> Range {
        let epsilon = f64::from(self.epsilon);
        let is_silhouette = cosines.least <= epsilon;
        let least = if cosines.most <= epsilon { 1.0 } else { cosines.least.max(epsilon) };
        Range { least, most: if is_silhouette { 1.0 } else { cosines.most } }
    }
}

impl Criterion<Bound> for VisualError {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        let Some(range) = self.range(bound).filter(|_| bound.error > self.error_min) else { return f32::NEG_INFINITY };
        let (error, scale) = (f64::from(bound.error), f64::from(self.scale));
        match self.reading {
            Reading::Tolerance => (error - scale * range.least) as f32,
            Reading::Error => (error * range.most - scale) as f32,
        }
    }
}

impl Relax for VisualError {
    fn relax(&mut self, by: f32) {
        self.scale *= by;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::tests::patch;

    fn visual(reading: Reading) -> VisualError {
        VisualError { eye: Vec3::ZERO, light: Vec3::Z, epsilon: 0.2, scale: 1.0, error_min: 0.0, reading }
    }

    /// A patch at a distance with an error of 1, small and almost flat.
    fn at(distance: f32, normal: Vec3) -> Bound {
        patch(Vec3::Z * distance, 0.01, normal, 0.0)
    }

    #[test]
    fn distance_relaxes_a_tolerance_and_aggravates_an_error() {
        let excess = |reading, distance| visual(reading).excess(&at(distance, -Vec3::Z), false);
        assert!(excess(Reading::Tolerance, 0.5) > 0.0 && excess(Reading::Tolerance, 2.0) < 0.0);
        assert!(excess(Reading::Error, 0.5) < 0.0 && excess(Reading::Error, 2.0) > 0.0);
    }

    #[test]
    fn the_silhouette_branch_leaves_out_the_view() {
        // Light from the side, so that a silhouette is lit.
        let lit = |reading| VisualError { light: Vec3::X, ..visual(reading) };
        let oblique = Vec3::new(0.8, 0.0, -0.6);
        let excess = |reading, normal| lit(reading).excess(&at(10.0, normal), false);
        assert!((excess(Reading::Error, Vec3::X) - 9.0).abs() < 0.1);
        assert!((excess(Reading::Error, oblique) - (10.0 * 0.48 - 1.0)).abs() < 0.2);
        assert!((excess(Reading::Tolerance, Vec3::X) + 9.0).abs() < 0.1);
        assert!((excess(Reading::Tolerance, oblique) - (1.0 - 10.0 * 0.48)).abs() < 0.2);
    }

    #[test]
    fn the_factor_of_the_view_is_extreme_over_both_branches() {
        let criterion = visual(Reading::Tolerance);
        let epsilon = f64::from(criterion.epsilon);
        let factor = |least, most| {
            let factor = criterion.view_factor(Range { least, most });
            (factor.least, factor.most)
        };
        assert_eq!(factor(0.0, 0.1), (1.0, 1.0));
        assert_eq!(factor(0.3, 0.5), (0.3, 0.5));
        assert_eq!(factor(0.1, 0.5), (epsilon, 1.0));
    }

    #[test]
    fn what_the_light_grazes_has_no_tolerance() {
        let grazed = VisualError { light: Vec3::X, ..visual(Reading::Tolerance) };
        assert_eq!(grazed.excess(&at(10.0, -Vec3::Z), false), 1.0);
        assert!(!VisualError { error_min: 1.0, ..grazed }.asks(&at(10.0, -Vec3::Z), false));
    }
}
