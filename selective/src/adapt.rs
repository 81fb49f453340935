//! Incremental refinement: from the mesh of the last frame, contraction first, then expansion.

use crate::criterion::Criterion;
use crate::extract::{Strategy, expand, expand_by_priority, extract};
use crate::state::{Limits, Outcome, State};
use mt_core::bits::ones;
use mt_core::{Front, MultiTessellation, NodeId, Sink, Step};
use std::time::Instant;

/// Brings the mesh of the last frame to `criterion`. Ends in the front of [`extract`], for criteria without memory.
///
/// Without a budget: one sweep over the front by rank coarsens all that is no longer needed, then what lies under the
/// front is judged and refined. O(front + changes). Under a time limit the expansion goes by urgency; what is left out
/// is made up for by later calls. The limit is on steps: the front is always judged once.
///
/// Under a budget of cells the front that fits is found first, by priority from the base mesh and in a view of its own,
/// and then approached by the steps that are missing, so a still camera comes to rest at once. O(front log front +
/// changes), and memory for a second view. A time limit bounds the approach, not the search; and it waits until the mesh
/// is within the budget.
pub fn adapt<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    criterion: &impl Criterion<M::Bound>,
    limits: &Limits,
    state: &mut State<N, M, S>,
) -> Outcome {
    let deadline = limits.deadline();
    if limits.cells.is_some() {
        let (target, wanted) = extract(model, criterion, &Limits { time: None, ..*limits }, Strategy::Priority, ());
        let until = Until { deadline, cells_max: limits.cells };
        let reached = approach_until(model, &target.view.front, until, state);
        return Outcome { forced: wanted.forced, complete: reached.complete && wanted.complete, ..reached };
    }
    let start = state.steps.len();
    let contracted = contract(model, criterion, deadline, state);
    open_below_front(model, state);
    let expanded = match deadline {
        Some(_) => expand_by_priority(model, criterion, None, deadline, state),
        None => expand(model, criterion, state),
    };
    state.outcome_since(start, expanded.forced, contracted && expanded.complete)
}

/// How many steps to make between two looks at the clock.
const CLOCK_EVERY: u32 = 64;

fn is_late(deadline: Option<Instant>, turn: &mut u32) -> bool {
    *turn = turn.wrapping_add(1);
    turn.is_multiple_of(CLOCK_EVERY) && deadline.is_some_and(|deadline| Instant::now() >= deadline)
}

/// Coarsens what the criterion does not ask for and nothing refined needs; whether it got through.
///
/// Finest first: by the time a node's turn comes, those that need it have had theirs.
fn contract<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    criterion: &impl Criterion<M::Bound>,
    deadline: Option<Instant>,
    state: &mut State<N, M, S>,
) -> bool {
    let mut turn = 0;
    for w in 0..state.view.front.words().len() {
        for bit in ones(state.view.front.words()[w]) {
            let m = NodeId(w as u32 * 64 + bit);
            // Judging is cheap and always goes through, so that however little time there is, calls make progress.
            let content = !criterion.asks(&model.bound(m), true);
            if content && state.try_coarsen(model, m) && is_late(deadline, &mut turn) {
                return false;
            }
        }
    }
    true
}

/// Opens the nodes that are not refined and hang under a refined one, or under none.
fn open_below_front<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(model: &M, state: &mut State<N, M, S>) {
    let (front, open) = (&state.view.front, &mut state.scratch.open);
    open.clear();
    model.roots(open);
    for m in front.finest_first() {
        model.children(m, open);
    }
    open.retain(|&m| !front.is_refined(m));
}

/// Steps from the current front to a closed `target`: coarsens what is not in it, finest first, then refines what is
/// missing, coarsest first. Every front on the way is closed, and no larger than the larger of the two. O(nodes / 64 +
/// changes).
pub fn approach<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    target: &Front,
    state: &mut State<N, M, S>,
) -> Outcome {
    approach_until(model, target, Until::default(), state)
}

/// When an approach may be left off.
#[derive(Clone, Copy, Default)]
struct Until {
    deadline: Option<Instant>,
    /// Above this many cells it goes on, late or not.
    cells_max: Option<u32>,
}

fn approach_until<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    target: &Front,
    until: Until,
    state: &mut State<N, M, S>,
) -> Outcome {
    let start = state.steps.len();
    let mut nodes = std::mem::take(&mut state.scratch.open);
    let mut turn = 0;
    let mut complete = true;
    nodes.clear();
    nodes.extend(state.view.front.difference(target));
    let coarsened = nodes.len();
    nodes.extend(target.difference(&state.view.front));
    nodes[coarsened..].reverse();
    for (i, &m) in nodes.iter().enumerate() {
        let fits = until.cells_max.is_none_or(|most| model.cell_count(&state.view.mesh) <= most);
        if is_late(until.deadline, &mut turn) && fits {
            complete = false;
            break;
        }
        state.take(model, if i < coarsened { Step::coarsen(m) } else { Step::refine(m) });
    }
    nodes.clear();
    state.scratch.open = nodes;
    state.outcome_since(start, 0, complete)
}
