//! A criterion on the nodes of a model: memory and runs of nodes are settled here, so that engines need not know them.

use crate::criterion::{Criterion, Pace};
use crate::state::{State, Urgent};
use mt_core::{Front, MultiTessellation, NodeId};

/// A criterion on the nodes of a model, for one call of an engine.
pub(crate) struct Judge<'a, const N: usize, M, C> {
    pub(crate) model: &'a M,
    pub(crate) criterion: &'a C,
    /// For criteria with memory: the front before the call. Without, the current one says what is refined, which makes
    /// no difference then.
    pub(crate) before: Option<&'a Front>,
}

impl<'a, const N: usize, M: MultiTessellation<N>, C: Criterion<M::Bound>> Judge<'a, N, M, C> {
    pub(crate) fn new(model: &'a M, criterion: &'a C, before: &'a Front) -> Self {
        Self { model, criterion, before: C::MEMORY.then_some(before) }
    }

    fn excess(&self, m: NodeId, front: &Front) -> f32 {
        self.criterion.excess(&self.model.bound(m), self.before.unwrap_or(front).is_refined(m))
    }

    /// Whether `m` is asked for.
    pub(crate) fn asks(&self, m: NodeId, front: &Front) -> bool {
        self.target(m, front).is_some()
    }

    /// Whether the criterion asks for `m`, whatever its run.
    fn asks_by_itself(&self, m: NodeId, front: &Front) -> bool {
        self.criterion.asks(&self.model.bound(m), self.before.unwrap_or(front).is_refined(m))
    }

    /// The first and the last node of the run of `m`, where it is judged as one.
    fn whole_run(&self, m: NodeId) -> Option<[NodeId; 2]> {
        if !C::RUNS {
            return None;
        }
        let (first, last) = self.model.run(m).into_inner();
        let is_whole = first < last && self.criterion.pace(&self.model.bound(last)) == Pace::Whole;
        is_whole.then_some([first, last])
    }

    /// If `m` is asked for: what to refine, as [`Self::goal`] says, where it does not matter how urgently.
    pub(crate) fn target(&self, m: NodeId, front: &Front) -> Option<NodeId> {
        match self.whole_run(m) {
            Some([first, last]) if self.asks_by_itself(last, front) => Some(first),
            _ => self.asks_by_itself(m, front).then_some(m),
        }
    }

    /// If `m` is asked for: how urgently, and what to refine. That is `m`, or where its run is judged as one the first
    /// node of the run, which needs all others.
    pub(crate) fn goal(&self, m: NodeId, front: &Front) -> Option<Urgent> {
        let excess = self.excess(m, front);
        if let Some([first, last]) = self.whole_run(m) {
            let whole = if m == last { excess } else { self.excess(last, front) };
            if whole > 0.0 {
                return Some(Urgent { excess: whole.max(excess), node: first });
            }
        }
        (excess > 0.0).then_some(Urgent { excess, node: m })
    }

    /// How many of the nodes refined since `mark` nobody asked for, where `asked` were judged and asked for.
    pub(crate) fn forced<S>(&self, state: &State<N, M, S>, mark: usize, asked: u32) -> u32 {
        let steps = &state.steps[mark..];
        if C::RUNS {
            // A run can be come upon from several of its nodes, so those that ask are counted afresh.
            let forced = steps.iter().filter(|step| step.refined && !self.asks(step.node, &state.view.front));
            return forced.count() as u32;
        }
        let refined = steps.iter().filter(|step| step.refined).count() as u32;
        refined.saturating_sub(asked)
    }

    /// How many runs of more than one node the steps since `mark` changed as one, and in how many nodes: what began
    /// with one end of a run and came to the other took in all between.
    pub(crate) fn whole_runs<S>(&self, state: &mut State<N, M, S>, mark: usize) -> (u32, u32) {
        if !C::RUNS {
            return (0, 0);
        }
        let begun = &mut state.scratch.marked;
        let (mut runs, mut nodes) = (0, 0);
        for step in &state.steps[mark..] {
            let (first, last) = self.model.run(step.node).into_inner();
            if first == last || self.criterion.pace(&self.model.bound(last)) == Pace::Single {
                continue;
            }
            let (begin, end) = if step.refined { (last, first) } else { (first, last) };
            if step.node == begin {
                begun.insert(begin.0);
            } else if step.node == end && begun.remove(begin.0) {
                runs += 1;
                nodes += last.0 - first.0 + 1;
            }
        }
        state.steps[mark..].iter().for_each(|step| _ = begun.remove(step.node.0));
        (runs, nodes)
    }
}
