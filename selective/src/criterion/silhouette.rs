//! Silhouettes: a stricter criterion where the surface may turn away from the eye.

use crate::criterion::angles::view_angles;
use crate::criterion::{Criterion, Pace, Relax, ScreenError};
use glam::Vec3;
use mt_core::{Bound, Camera};

/// One criterion everywhere, and another besides at outlines: where some normal of the cone is perpendicular to the
/// direction from the eye to some point of the sphere. Runs go the way of the one that is everywhere.
#[derive(Clone, Debug)]
pub struct Silhouette<C, D = C> {
    /// Where the eye is.
    pub eye: Vec3,
    /// What to ask at outlines; the stricter one.
    pub outline: C,
    /// What to ask everywhere.
    pub elsewhere: D,
}

impl Silhouette<ScreenError> {
    /// A camera's error on the screen, smaller at outlines.
    pub fn new(camera: &Camera, error_max_px: f32, outline_max_px: f32) -> Self {
        let of = |error_px| ScreenError::new(camera, error_px);
        Self { eye: camera.eye, outline: of(outline_max_px), elsewhere: of(error_max_px) }
    }
}

impl<C, D> Silhouette<C, D> {
    /// Whether an outline may run through a bound.
    pub fn is_outline(&self, bound: &Bound) -> bool {
        view_angles(bound, self.eye).is_some_and(|angles| angles.holds_right_angle())
    }
}

impl<C: Criterion<Bound>, D: Criterion<Bound>> Criterion<Bound> for Silhouette<C, D> {
    const MEMORY: bool = C::MEMORY || D::MEMORY;
    const RUNS: bool = D::RUNS;
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        let everywhere = self.elsewhere.excess(bound, refined);
        if self.is_outline(bound) { everywhere.max(self.outline.excess(bound, refined)) } else { everywhere }
    }
    fn asks(&self, bound: &Bound, refined: bool) -> bool {
        self.elsewhere.asks(bound, refined) || self.outline.asks(bound, refined) && self.is_outline(bound)
    }
    fn pace(&self, last: &Bound) -> Pace {
        self.elsewhere.pace(last)
    }
}

impl<C: Relax, D: Relax> Relax for Silhouette<C, D> {
    fn relax(&mut self, by: f32) {
        self.outline.relax(by);
        self.elsewhere.relax(by);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::UniformError;
    use crate::criterion::tests::patch;

    #[test]
    fn outlines_are_finer() {
        let criterion = Silhouette {
            eye: Vec3::Z * 10.0,
            outline: UniformError { error_max: 0.1 },
            elsewhere: UniformError { error_max: 2.0 },
        };
        let asks = |normal| criterion.asks(&patch(Vec3::ZERO, 0.5, normal, 0.1), false);
        assert!(asks(Vec3::X) && asks(-Vec3::Y) && !asks(Vec3::Z) && !asks(-Vec3::Z));
    }
}
