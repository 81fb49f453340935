//! The engine as the machine drives it: as it is, or with a fault planted, and a sink that can be deaf.

use mt_core::check::Mirror;
use mt_core::model::{MultiTessellation, Step};
use mt_core::{Bound, Cell, CellId, NodeId, Sink};
use selective::{Criterion, Limits, Outcome, Pace, State, adapt};

/// A mirror of the mesh that can be made to miss the next thing it is told.
#[derive(Clone, Debug, Default)]
pub struct Ear<const N: usize> {
    /// What has been heard.
    pub mirror: Mirror<N>,
    deaf: bool,
}

impl<const N: usize> Ear<N> {
    fn hears(&mut self) -> bool {
        !std::mem::take(&mut self.deaf)
    }
}

impl<const N: usize> Sink<N> for Ear<N> {
    fn kill(&mut self, cell: CellId) {
        if self.hears() {
            self.mirror.kill(cell);
        }
    }
    fn make(&mut self, cell: CellId, corners: Cell<N>) {
        if self.hears() {
            self.mirror.make(cell, corners);
        }
    }
    fn relabel(&mut self, cell: CellId, corners: Cell<N>) {
        if self.hears() {
            self.mirror.relabel(cell, corners);
        }
    }
}

/// A view's state, with its ear.
pub type Seated<const N: usize, M> = State<N, M, Ear<N>>;

/// What may be wrong with an engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Rolling back stops a step too early.
    RollsBackOneTooFew,
    /// Rolling back goes a step too far.
    RollsBackOneTooMany,
    /// Adapting forgets to tell the sink one thing.
    ForgetsTheSink,
    /// A view that goes over to another model keeps its scratch memory, and all of its budget's search.
    KeepsScratch,
    /// What one view adapts, the other has too.
    SharesTheView,
    /// What a criterion asks for at a tie, which is nothing, is refined.
    AsksAtTies,
    /// A criterion with memory is asked as if nothing had been refined.
    ForgetsMemory,
    /// The budget is overshot by a cell or two.
    Overshoots,
    /// The last two steps of a call are logged the wrong way round.
    SwapsTheLog,
    /// Coarsening does not ask what is in its way.
    CoarsensUnasked,
}

impl Fault {
    /// All of them.
    pub const ALL: [Fault; 10] = [
        Fault::RollsBackOneTooFew,
        Fault::RollsBackOneTooMany,
        Fault::ForgetsTheSink,
        Fault::KeepsScratch,
        Fault::SharesTheView,
        Fault::AsksAtTies,
        Fault::ForgetsMemory,
        Fault::Overshoots,
        Fault::SwapsTheLog,
        Fault::CoarsensUnasked,
    ];
}

/// The engine, or one with a fault.
#[derive(Clone, Copy, Debug, Default)]
pub struct Engine(pub Option<Fault>);

/// A criterion that asks at ties.
struct AtTies<C>(C);

impl<C: Criterion<Bound>> Criterion<Bound> for AtTies<C> {
    const MEMORY: bool = C::MEMORY;
    const RUNS: bool = C::RUNS;
    fn excess(&self, bound: &Bound, refined: bool) -> f32 {
        let excess = self.0.excess(bound, refined);
        if excess == 0.0 { f32::MIN_POSITIVE } else { excess }
    }
    fn pace(&self, last: &Bound) -> Pace {
        self.0.pace(last)
    }
}

/// A criterion that is never told what is refined.
struct Forgetful<C>(C);

impl<C: Criterion<Bound>> Criterion<Bound> for Forgetful<C> {
    const MEMORY: bool = C::MEMORY;
    const RUNS: bool = C::RUNS;
    fn excess(&self, bound: &Bound, _: bool) -> f32 {
        self.0.excess(bound, false)
    }
    fn pace(&self, last: &Bound) -> Pace {
        self.0.pace(last)
    }
}

impl Engine {
    fn has(&self, fault: Fault) -> bool {
        self.0 == Some(fault)
    }

    /// [`adapt`].
    pub fn adapt<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
        &self,
        model: &M,
        criterion: &impl Criterion<Bound>,
        limits: &Limits,
        state: &mut Seated<N, M>,
    ) -> Outcome {
        let mark = state.steps.len();
        state.sink.deaf = self.has(Fault::ForgetsTheSink);
        let more = if self.has(Fault::Overshoots) { 2 } else { 0 };
        let limits = Limits { cells: limits.cells.map(|cells| cells + more), ..*limits };
        let outcome = match self.0 {
            Some(Fault::AsksAtTies) => adapt(model, &AtTies(criterion), &limits, state),
            Some(Fault::ForgetsMemory) => adapt(model, &Forgetful(criterion), &limits, state),
            _ => adapt(model, criterion, &limits, state),
        };
        state.sink.deaf = false;
        let last = state.steps.len();
        if self.has(Fault::SwapsTheLog) && last - mark > 1 {
            state.steps.swap(last - 1, last - 2);
        }
        outcome
    }

    /// What adapting one view does to the other: nothing.
    pub fn adapted<const N: usize, M: MultiTessellation<N>>(&self, state: &Seated<N, M>, other: &mut Seated<N, M>) {
        if self.has(Fault::SharesTheView) {
            other.view = state.view.clone();
        }
    }

    /// [`State::roll_back`].
    pub fn roll_back<const N: usize, M: MultiTessellation<N>>(&self, model: &M, state: &mut Seated<N, M>, mark: usize) {
        let mark = match self.0 {
            Some(Fault::RollsBackOneTooFew) => (mark + 1).min(state.steps.len()),
            Some(Fault::RollsBackOneTooMany) => mark.saturating_sub(1),
            _ => mark,
        };
        state.roll_back(model, mark);
    }

    /// [`State::try_coarsen`].
    pub fn coarsen<const N: usize, M: MultiTessellation<N>>(
        &self,
        model: &M,
        state: &mut Seated<N, M>,
        m: NodeId,
    ) -> bool {
        if self.has(Fault::CoarsensUnasked) {
            state.take(model, Step::coarsen(m));
            return true;
        }
        state.try_coarsen(model, m)
    }

    /// A state for another model, in place of one that was for this.
    pub fn restart<const N: usize, M: MultiTessellation<N>>(&self, model: &M, old: Seated<N, M>) -> Seated<N, M> {
        let mut fresh = State::new(model, Ear::default());
        if self.has(Fault::KeepsScratch) {
            let mut kept = old;
            std::mem::swap(&mut kept.view, &mut fresh.view);
            std::mem::swap(&mut kept.sink, &mut fresh.sink);
            kept.steps.clear();
            return kept;
        }
        fresh
    }
}
