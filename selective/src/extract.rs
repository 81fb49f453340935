//! Top-down extraction: depth first, or by priority, which can be interrupted and kept within a budget.

use crate::criterion::Criterion;
use crate::judge::Judge;
use crate::state::{Limits, Outcome, State, Urgent};
use mt_core::{Front, MultiTessellation, NodeId, Sink};
use std::time::Instant;

/// In what sequence to refine.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// Depth first from the base mesh; a budget needs priorities and turns it into [`Strategy::Priority`].
    #[default]
    TopDown,
    /// Most urgent first from the base mesh: every intermediate mesh is the best so far.
    Priority,
}

/// A mesh for `criterion` from the base mesh, with what was done. Any limit makes it go by priority. Without limits the
/// least closed front that holds all that the criterion asks for. O(steps + nodes judged), with a logarithm for
/// priorities, and memory for a [`State`].
pub fn extract<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    criterion: &impl Criterion<M::Bound>,
    limits: &Limits,
    strategy: Strategy,
    sink: S,
) -> (State<N, M, S>, Outcome) {
    let mut state = State::new(model, sink);
    let before = state.view.front.clone();
    let judge = Judge::new(model, criterion, &before);
    model.roots(&mut state.scratch.open);
    let outcome = if strategy == Strategy::Priority || limits.cells.is_some() || limits.time.is_some() {
        expand_by_priority(&judge, limits.cells, limits.deadline(), &mut state)
    } else {
        expand(&judge, &mut state)
    };
    let outcome = outcome.with_runs(judge.whole_runs(&mut state, 0));
    (state, outcome)
}

/// Judges the open nodes and refines what the criterion asks for, depth first, down to where it is content.
pub(crate) fn expand<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    judge: &Judge<N, M, impl Criterion<M::Bound>>,
    state: &mut State<N, M, S>,
) -> Outcome {
    let start = state.steps.len();
    let mut asked = 0;
    while let Some(m) = state.scratch.open.pop() {
        let Some(node) = judge.target(m, &state.view.front) else { continue };
        let mark = state.steps.len();
        if !state.view.front.is_refined(node) {
            state.force_counted(judge.model, node);
            open_children_since(judge.model, state, mark);
        }
        asked += 1;
    }
    state.outcome_since(start, judge.forced(state, start, asked), true)
}

/// What hangs under newly refined nodes has to be judged, whether they were asked for or forced.
fn open_children_since<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    state: &mut State<N, M, S>,
    mark: usize,
) {
    for step in &state.steps[mark..] {
        model.children(step.node, &mut state.scratch.open);
    }
}

/// How many chains that do not fit are passed over before the budget counts as used up.
const MISFITS_MAX: u32 = 16;

/// The same, most urgent first, within a budget of cells and until a deadline.
///
/// The front that it ends in depends on model, criterion and budget alone (unless time runs out), which is what makes a
/// still camera come to rest.
pub(crate) fn expand_by_priority<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    judge: &Judge<N, M, impl Criterion<M::Bound>>,
    cells_max: Option<u32>,
    deadline: Option<Instant>,
    state: &mut State<N, M, S>,
) -> Outcome {
    let start = state.steps.len();
    let (mut asked, mut misfits, mut turn) = (0, 0, 0u32);
    let mut in_time = true;
    state.scratch.queue.clear();
    enqueue_open(judge, state);
    while let Some(Urgent { node, .. }) = state.scratch.queue.pop() {
        turn = turn.wrapping_add(1);
        if turn.is_multiple_of(32) && deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            in_time = false;
            break;
        }
        if state.view.front.is_refined(node) {
            asked += 1;
            continue;
        }
        let mark = state.steps.len();
        if !force_within(judge.model, node, cells_max, state) {
            misfits += 1;
            if misfits >= MISFITS_MAX {
                break;
            }
            continue;
        }
        asked += 1;
        open_children_since(judge.model, state, mark);
        enqueue_open(judge, state);
    }
    state.outcome_since(start, judge.forced(state, start, asked), in_time && misfits == 0)
}

fn enqueue_open<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    judge: &Judge<N, M, impl Criterion<M::Bound>>,
    state: &mut State<N, M, S>,
) {
    while let Some(m) = state.scratch.open.pop() {
        state.scratch.queue.extend(judge.goal(m, &state.view.front));
    }
}

/// Forces `m` unless that takes more cells than allowed; whether it did. Where gains are static the chain is counted
/// first; else it is applied and rolled back.
pub(crate) fn force_within<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    m: NodeId,
    cells_max: Option<u32>,
    state: &mut State<N, M, S>,
) -> bool {
    let Some(cells_max) = cells_max else {
        state.force_counted(model, m);
        return true;
    };
    if model.gain(m).is_some() {
        let cells = i64::from(model.cell_count(&state.view.mesh));
        let fits = chain_gain(model, m, state).is_none_or(|gain| cells + gain <= i64::from(cells_max));
        if !fits {
            return false;
        }
    }
    let mark = state.steps.len();
    state.force_counted(model, m);
    let fits = model.cell_count(&state.view.mesh) <= cells_max;
    if !fits {
        state.roll_back(model, mark);
        state.scratch.chains.pop();
    }
    fits
}

/// Cells won by forcing `m`, where every node of its chain says so.
fn chain_gain<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    m: NodeId,
    state: &mut State<N, M, S>,
) -> Option<i64> {
    let (chain, marked) = (&mut state.scratch.chain, &mut state.scratch.marked);
    chain.push(m);
    let mut at = 0;
    let mut gain = 0i64;
    let mut known = true;
    while at < chain.len() {
        let node = chain[at];
        match model.gain(node) {
            Some(cells) => gain += i64::from(cells),
            None => known = false,
        }
        let nodes = &mut state.scratch.nodes;
        nodes.clear();
        model.prerequisites(node, &state.view, nodes);
        chain.extend(nodes.iter().copied().filter(|need| marked.insert(need.0)));
        at += 1;
    }
    chain.drain(..).for_each(|node| _ = marked.remove(node.0));
    known.then_some(gain)
}

/// The slow oracle of selective refinement: ask every node for itself and close. O(nodes + arcs).
///
/// For monotone criteria on saturated bounds this is the front that `extract` must reach, and `adapt` too unless the
/// criterion has a memory.
pub fn wish_closure<const N: usize, M: MultiTessellation<N>>(model: &M, criterion: &impl Criterion<M::Bound>) -> Front {
    wish_closure_after(model, criterion, &Front::base(model.len()))
}

/// The same for a criterion with memory, where `before` is the front of the last frame: what `adapt` must reach.
pub fn wish_closure_after<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    criterion: &impl Criterion<M::Bound>,
    before: &Front,
) -> Front {
    let judge = Judge::new(model, criterion, before);
    let mut front = Front::base(model.len());
    let mut needs = Vec::new();
    for m in (0..model.len()).map(NodeId) {
        if judge.asks(m, before) {
            front.set(m, true);
        }
        // What a node needs has a larger id, so its turn comes later.
        if front.is_refined(m) {
            needs.clear();
            model.needs(m, &mut needs);
            needs.iter().for_each(|&need| _ = front.set(need, true));
        }
    }
    front
}
