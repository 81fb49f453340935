//! Speed of motion: the faster the camera, the larger the tolerance.

use crate::criterion::{Criterion, Pace};
use mt_core::Bound;

/// A criterion with a tolerance that can be made larger.
pub trait Relax {
    /// Multiplies the tolerance. Requires: `by` is finite and at least 1.
    fn relax(&mut self, by: f32);
}

/// A criterion whose tolerance grows in proportion to the motion of the camera since the last frame, after
/// `[LivnySokolovskyElSana2006]`: by 1 + factor · speed / diagonal.
///
/// Speed is a parameter, so it is without memory: a criterion is made anew for each frame anyway.
#[derive(Clone, Debug)]
pub struct Moving<C> {
    relaxed: C,
}

impl<C: Relax> Moving<C> {
    /// `criterion` is that of a still camera, `speed` how far the camera went since the last frame, `diagonal` that of
    /// the model, both in model units; `factor` says how much the tolerance grows at a speed of one diagonal a frame.
    pub fn new(mut criterion: C, factor: f32, speed: f32, diagonal: f32) -> Self {
        let by = 1.0 + factor * speed / diagonal;
        // Without a diagonal there is nothing to compare a speed with.
        if by.is_finite() && by > 1.0 {
            criterion.relax(by);
        }
        Self { relaxed: criterion }
    }
}

impl<C> Moving<C> {
    /// The criterion that it comes to at this speed.
    pub fn relaxed(&self) -> &C {
        &self.relaxed
    }
}

impl<C: Criterion<Bound>> Criterion<Bound> for Moving<C> {
    const MEMORY: bool = C::MEMORY;
    const RUNS: bool = C::RUNS;
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        self.relaxed.excess(bound, refined)
    }
    fn asks(&self, bound: &Bound, refined: bool) -> bool {
        self.relaxed.asks(bound, refined)
    }
    fn pace(&self, last: &Bound) -> Pace {
        self.relaxed.pace(last)
    }
}

impl<C: Relax> Relax for Moving<C> {
    fn relax(&mut self, by: f32) {
        self.relaxed.relax(by);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::UniformError;

    #[test]
    fn tolerance_grows_with_speed() {
        let error_max =
            |speed, diagonal| Moving::new(UniformError { error_max: 1.0 }, 10.0, speed, diagonal).relaxed().error_max;
        assert_eq!((error_max(0.0, 5.0), error_max(1.0, 5.0), error_max(5.0, 5.0)), (1.0, 3.0, 11.0));
        assert_eq!((error_max(1.0, 0.0), error_max(0.0, 0.0)), (1.0, 1.0));
    }
}
