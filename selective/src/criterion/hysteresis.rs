//! Hysteresis: what is refined stays so until it is clearly not needed.

use crate::criterion::{Criterion, Pace, Relax};

/// Refines as another criterion asks, and keeps what is refined until the excess is down to minus a margin, so that a
/// camera that trembles at a threshold does not make the mesh flicker.
///
/// Its front depends on that of the last frame; it is the least closed one that holds what is asked for, given which
/// nodes were refined. What the other criterion excludes (an excess of minus infinity) is not kept.
#[derive(Clone, Debug)]
pub struct Hysteresis<C> {
    /// What to ask.
    pub criterion: C,
    /// How far below the threshold to hold on, in the unit of the criterion's excess; not below 0.
    pub margin: f32,
}

impl<B, C: Criterion<B>> Criterion<B> for Hysteresis<C> {
    const MEMORY: bool = true;
    const RUNS: bool = C::RUNS;
    fn excess(&self, bound: &B, refined: bool) -> f32 {
        self.criterion.excess(bound, refined) + if refined { self.margin } else { 0.0 }
    }
    fn asks(&self, bound: &B, refined: bool) -> bool {
        if refined { self.excess(bound, refined) > 0.0 } else { self.criterion.asks(bound, refined) }
    }
    fn pace(&self, last: &B) -> Pace {
        self.criterion.pace(last)
    }
}

impl<C: Relax> Relax for Hysteresis<C> {
    fn relax(&mut self, by: f32) {
        self.criterion.relax(by);
    }
}
