//! The same error everywhere.

use crate::criterion::{Criterion, Relax};
use mt_core::Bound;

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

impl Relax for UniformError {
    fn relax(&mut self, by: f32) {
        self.error_max *= by;
    }
}
