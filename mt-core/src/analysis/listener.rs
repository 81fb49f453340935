//! Who hears of an analysis: a listener is told of every plan before and after it is applied.

use super::Draft;
use crate::complex::Slot;
use crate::explicit::{HistoryError, Recorder};
use crate::plan::Plan;

/// Hears of each modification of an analysis. The [`Recorder`] is one; two of them side by side are one.
pub trait Listener<const N: usize> {
    /// `plan` is good and about to be applied to `draft`.
    fn applying(&mut self, draft: &Draft<N>, plan: &Plan<N>) -> Result<(), HistoryError>;
    /// `plan` was applied; `slots[i]` holds `plan.makes[i]`.
    fn applied(&mut self, draft: &mut Draft<N>, plan: &Plan<N>, slots: &[Slot]) -> Result<(), HistoryError>;
}

/// Names of cells in the model are kept in the draft's complex.
impl<const N: usize> Listener<N> for Recorder<N> {
    fn applying(&mut self, draft: &Draft<N>, plan: &Plan<N>) -> Result<(), HistoryError> {
        plan.kills.iter().try_for_each(|&slot| self.kill(draft.complex.name(slot)))?;
        plan.vertices.iter().try_for_each(|&position| self.vertex(position).map(|_| ()))
    }

    fn applied(&mut self, draft: &mut Draft<N>, plan: &Plan<N>, slots: &[Slot]) -> Result<(), HistoryError> {
        for (&slot, &corners) in slots.iter().zip(&plan.makes) {
            draft.complex.set_name(slot, self.make(corners)?);
        }
        self.end(plan.error).map(|_| ())
    }
}

impl<const N: usize, A: Listener<N>, B: Listener<N>> Listener<N> for (A, B) {
    fn applying(&mut self, draft: &Draft<N>, plan: &Plan<N>) -> Result<(), HistoryError> {
        self.0.applying(draft, plan)?;
        self.1.applying(draft, plan)
    }

    fn applied(&mut self, draft: &mut Draft<N>, plan: &Plan<N>, slots: &[Slot]) -> Result<(), HistoryError> {
        self.0.applied(draft, plan, slots)?;
        self.1.applied(draft, plan, slots)
    }
}
