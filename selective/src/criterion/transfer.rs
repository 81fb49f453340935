//! Level-of-detail transfer functions: a tolerance that the user draws over distance, or over size on the screen.

use crate::criterion::angles::distances;
use crate::criterion::{Criterion, Relax};
use glam::Vec3;
use mt_core::Bound;

/// Over what a transfer function is drawn. Taken at the nearest point of the bound's sphere.
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum Measure {
    /// Distance from the eye, in model units. The tolerance may not fall with it.
    Distance,
    /// Radius of the bound's sphere on the screen, in pixels. The tolerance may not rise with it.
    SizePx {
        /// Pixels that a length of 1 at distance 1 covers.
        pixels_per_unit: f32,
        /// Distance of the near plane, above 0: nothing counts as nearer.
        near: f32,
    },
}

/// Why a list of knots is no transfer function.
#[derive(Copy, Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TransferError {
    /// There is none.
    #[error("a transfer function needs a knot")]
    Empty,
    /// A value is infinite or not a number.
    #[error("knot {0} has a value that is not finite")]
    NotFinite(usize),
    /// Knots do not ascend.
    #[error("knot {0} does not lie after the one before it")]
    NotAscending(usize),
    /// The tolerance goes the wrong way: what is nearer or larger would be coarser.
    #[error("at knot {0} what is nearer or larger on the screen would be coarser")]
    NotMonotone(usize),
    /// A measure on the screen without pixels or near plane.
    #[error("size on the screen needs pixels and a near plane, both above 0")]
    Lens,
}

/// A tolerance in model units, piecewise linear over a measure, as the second half of `[DeFlorianiTutorial2002]` lists
/// it among the factors of simplification; constant before the first knot and after the last.
///
/// Monotone because the function has to be, which [`Transfer::new`] checks.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer {
    eye: Vec3,
    measure: Measure,
    /// Measure and tolerance.
    knots: Vec<(f32, f32)>,
}

impl Transfer {
    /// The function through `knots`, each a value of the measure and a tolerance.
    pub fn new(eye: Vec3, measure: Measure, knots: Vec<(f32, f32)>) -> Result<Self, TransferError> {
        if let Measure::SizePx { pixels_per_unit, near } = measure
            && !(pixels_per_unit > 0.0 && near > 0.0 && pixels_per_unit.is_finite())
        {
            return Err(TransferError::Lens);
        }
        if knots.is_empty() {
            return Err(TransferError::Empty);
        }
        if let Some(at) = knots.iter().position(|(at, tolerance)| !(at.is_finite() && tolerance.is_finite())) {
            return Err(TransferError::NotFinite(at));
        }
        for (i, pair) in knots.windows(2).enumerate() {
            let ((before, first), (after, second)) = (pair[0], pair[1]);
            if after <= before {
                return Err(TransferError::NotAscending(i + 1));
            }
            if if measure == Measure::Distance { second < first } else { second > first } {
                return Err(TransferError::NotMonotone(i + 1));
            }
        }
        Ok(Self { eye, measure, knots })
    }

    /// The tolerance at a value of the measure, in model units.
    pub fn tolerance(&self, at: f64) -> f64 {
        let after = self.knots.partition_point(|knot| f64::from(knot.0) <= at);
        let wide = |i: usize| (f64::from(self.knots[i].0), f64::from(self.knots[i].1));
        if after == 0 || after == self.knots.len() {
            return wide(after.saturating_sub(1)).1;
        }
        let ((before, first), (end, second)) = (wide(after - 1), wide(after));
        // Rounding may not lead out of the piece, or pieces would not be monotone in turn.
        (first + (second - first) * ((at - before) / (end - before))).clamp(first.min(second), first.max(second))
    }

    fn value(&self, bound: &Bound) -> f64 {
        let distance = distances(bound, self.eye).least;
        match self.measure {
            Measure::Distance => distance,
            Measure::SizePx { pixels_per_unit, near } => {
                f64::from(bound.radius) * f64::from(pixels_per_unit) / distance.max(f64::from(near))
            }
        }
    }
}

impl Criterion<Bound> for Transfer {
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        (f64::from(bound.error) - self.tolerance(self.value(bound))) as f32
    }
}

impl Relax for Transfer {
    fn relax(&mut self, by: f32) {
        self.knots.iter_mut().for_each(|knot| knot.1 *= by);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::tests::ball;

    #[test]
    fn tolerance_is_linear_between_knots_and_constant_beyond() {
        let transfer = Transfer::new(Vec3::ZERO, Measure::Distance, vec![(1.0, 0.0), (3.0, 1.0), (4.0, 5.0)]).unwrap();
        let at = [0.0, 1.0, 2.0, 3.0, 3.5, 4.0, 9.0].map(|x| transfer.tolerance(x));
        assert_eq!(at, [0.0, 0.0, 0.5, 1.0, 3.0, 5.0, 5.0]);
        // The nearest point of the sphere counts.
        assert!(transfer.asks(&ball(Vec3::X * 4.0, 2.0, 0.6), false));
        assert!(!transfer.asks(&ball(Vec3::X * 4.0, 2.0, 0.4), false));
    }

    #[test]
    fn functions_that_are_not_monotone_are_refused() {
        let new = |measure, knots: &[(f32, f32)]| Transfer::new(Vec3::ZERO, measure, knots.to_vec()).map(|_| ());
        let size = Measure::SizePx { pixels_per_unit: 100.0, near: 0.1 };
        assert_eq!(new(Measure::Distance, &[]), Err(TransferError::Empty));
        assert_eq!(new(Measure::Distance, &[(0.0, 1.0), (1.0, f32::NAN)]), Err(TransferError::NotFinite(1)));
        assert_eq!(new(Measure::Distance, &[(0.0, 1.0), (0.0, 2.0)]), Err(TransferError::NotAscending(1)));
        assert_eq!(new(Measure::Distance, &[(0.0, 1.0), (1.0, 0.5)]), Err(TransferError::NotMonotone(1)));
        assert_eq!(new(size, &[(0.0, 1.0), (1.0, 2.0)]), Err(TransferError::NotMonotone(1)));
        assert_eq!(new(size, &[(0.0, 1.0), (1.0, 0.5)]), Ok(()));
        let blind = Measure::SizePx { pixels_per_unit: 100.0, near: 0.0 };
        assert_eq!(new(blind, &[(0.0, 1.0)]), Err(TransferError::Lens));
    }
}
