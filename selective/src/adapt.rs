//! Incremental refinement: from the mesh of the last frame, contraction first, then expansion.

use crate::criterion::Criterion;
use crate::extract::{expand, expand_by_priority, force_within};
use crate::judge::Judge;
use crate::state::{Limits, Outcome, State};
use mt_core::bits::ones;
use mt_core::{Front, MultiTessellation, NodeId, Rule, Sink, Step};
use std::time::Instant;

/// Brings the mesh of the last frame to `criterion`. Ends in the front of [`crate::extract`], for static orders and criteria
/// without memory; for those with, in the least closed front that holds all they ask for, given what was refined when the
/// call began.
///
/// Without a budget: one sweep over the front by rank coarsens all that is no longer needed, then what lies under the
/// front is judged and refined. O(front + changes). Under a time limit the expansion goes by urgency; what is left out
/// is made up for by later calls. The limit is on steps: the front is always judged once.
///
/// Under a budget of cells the front that fits is found first, by priority from the base mesh and in a view of its own,
/// and then approached by the steps that are missing, so a still camera comes to rest at once. O(front log front +
/// changes), and memory for a second view, which the state keeps. A time limit bounds the approach, not the search; and
/// it waits until the mesh is within the budget. A criterion with memory gives what is refined its head start in the
/// search too, but need not come to rest at once.
///
/// That is for static orders. Under a dynamic rule the way between two fronts need not be legal, so there legal steps go
/// as far towards that front as the rule and the budget let them. The mesh is within the budget whatever the time, but
/// depends on where it comes from, and a still camera need not come to rest.
///
/// Once a state has seen a camera's path, calls that ask for no more than before allocate nothing.
pub fn adapt<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    criterion: &impl Criterion<M::Bound>,
    limits: &Limits,
    state: &mut State<N, M, S>,
) -> Outcome {
    let deadline = limits.deadline();
    let start = state.steps.len();
    state.scratch.chains.clear();
    if let Some(cells_max) = limits.cells {
        return adapt_within(model, criterion, cells_max, deadline, state);
    }
    let before = remember(criterion, state);
    let judge = Judge::new(model, criterion, &before);
    let contracted = contract(&judge, deadline, state);
    open_below_front(&judge, state);
    let expanded = match deadline {
        Some(_) => expand_by_priority(&judge, None, deadline, state),
        None => expand(&judge, state),
    };
    let outcome = state.outcome_since(start, expanded.forced, contracted && expanded.complete);
    let outcome = outcome.with_runs(judge.whole_runs(state, start));
    state.scratch.before = before;
    outcome
}

/// The front as it is now, for a criterion with memory, in memory that was there; else anything.
fn remember<const N: usize, M: MultiTessellation<N>, S, C: Criterion<M::Bound>>(
    _: &C,
    state: &mut State<N, M, S>,
) -> Front {
    let mut before = std::mem::take(&mut state.scratch.before);
    if C::MEMORY {
        before.clone_from(&state.view.front);
    }
    before
}

/// Looks for the front that fits, by priority from the base mesh, in a state of its own.
fn search<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    criterion: &impl Criterion<M::Bound>,
    cells_max: u32,
    state: &mut State<N, M, S>,
) -> (Box<State<N, M, ()>>, Outcome) {
    let mut target = state.search.take().unwrap_or_else(|| Box::new(State::new(model, ())));
    // Back to the base mesh by the steps that led away from it.
    target.roll_back(model, 0);
    // Swapped, not copied: the chains of the search are those of the call.
    std::mem::swap(&mut target.scratch.chains, &mut state.scratch.chains);
    target.scratch.open.clear();
    model.roots(&mut target.scratch.open);
    let judge = Judge::new(model, criterion, &state.view.front);
    let wanted = expand_by_priority(&judge, Some(cells_max), None, &mut target);
    std::mem::swap(&mut target.scratch.chains, &mut state.scratch.chains);
    (target, wanted)
}

/// Looks for the front that fits, and approaches it.
fn adapt_within<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    criterion: &impl Criterion<M::Bound>,
    cells_max: u32,
    deadline: Option<Instant>,
    state: &mut State<N, M, S>,
) -> Outcome {
    let start = state.steps.len();
    let (target, wanted) = search(model, criterion, cells_max, state);
    let reached = match M::RULE {
        Rule::Static => {
            approach_until(model, &target.view.front, Until { deadline, cells_max: Some(cells_max) }, state).complete
        }
        Rule::Dynamic => approach_legally(model, &target.view.front, cells_max, deadline, state),
    };
    state.search = Some(target);
    let base = Front::default();
    let outcome = state.outcome_since(start, wanted.forced, reached && wanted.complete);
    outcome.with_runs(Judge::new(model, criterion, &base).whole_runs(state, start))
}

/// Towards a front by legal steps alone, for rules under which two fronts need have no legal way between them: what it
/// lacks is coarsened as far as the rule lets it, what it has is forced as far as the budget lets it. Whether it got there.
fn approach_legally<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    target: &Front,
    cells_max: u32,
    deadline: Option<Instant>,
    state: &mut State<N, M, S>,
) -> bool {
    let mut nodes = std::mem::take(&mut state.scratch.wanted);
    nodes.clear();
    nodes.extend(state.view.front.difference(target));
    nodes.iter().for_each(|&m| _ = state.try_coarsen(model, m));
    shrink(model, cells_max, state);
    nodes.clear();
    nodes.extend(target.difference(&state.view.front));
    let mut turn = 0;
    for &m in nodes.iter().rev() {
        if is_late(deadline, &mut turn) {
            break;
        }
        if !state.view.front.is_refined(m) {
            force_within(model, m, Some(cells_max), state);
        }
    }
    state.scratch.wanted = nodes;
    state.view.front == *target
}

/// Coarsens what lets itself be coarsened, finest first, until the mesh has no more cells than allowed. One sweep after
/// the other: what stood in the way may be gone by the next. Late or not, since the budget is not for time to break.
///
/// A rule may come to a mesh of which it lets nothing be coarsened. Then all is coarsened in the order of the analysis
/// without asking, down to the base mesh: the meshes on the way are nobody's, but the one at the end is legal.
fn shrink<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(model: &M, cells_max: u32, state: &mut State<N, M, S>) {
    let fits = |state: &State<N, M, S>| model.cell_count(&state.view.mesh) <= cells_max;
    let mut moved = true;
    while moved {
        moved = false;
        for w in 0..state.view.front.words().len() {
            for bit in ones(state.view.front.words()[w]) {
                if fits(state) {
                    return;
                }
                moved |= state.try_coarsen(model, NodeId(w as u32 * 64 + bit));
            }
        }
    }
    if !fits(state) {
        for w in 0..state.view.front.words().len() {
            ones(state.view.front.words()[w])
                .for_each(|bit| state.take(model, Step::coarsen(NodeId(w as u32 * 64 + bit))));
        }
    }
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
    judge: &Judge<N, M, impl Criterion<M::Bound>>,
    deadline: Option<Instant>,
    state: &mut State<N, M, S>,
) -> bool {
    let mut turn = 0;
    for w in 0..state.view.front.words().len() {
        for bit in ones(state.view.front.words()[w]) {
            let m = NodeId(w as u32 * 64 + bit);
            // Judging is cheap and always goes through, so that however little time there is, calls make progress.
            let content = !judge.asks(m, &state.view.front);
            if content && state.try_coarsen(judge.model, m) && is_late(deadline, &mut turn) {
                return false;
            }
        }
    }
    true
}

/// Opens the nodes that are not refined and hang under a refined one, or under none; and the first nodes of runs that
/// are refined in part, which may hang elsewhere but are asked for by their last.
fn open_below_front<const N: usize, M: MultiTessellation<N>, S: Sink<N>, C: Criterion<M::Bound>>(
    judge: &Judge<N, M, C>,
    state: &mut State<N, M, S>,
) {
    let (front, open) = (&state.view.front, &mut state.scratch.open);
    open.clear();
    judge.model.roots(open);
    for m in front.finest_first() {
        judge.model.children(m, open);
        if C::RUNS {
            let (first, last) = judge.model.run(m).into_inner();
            open.extend((m == last).then_some(first));
        }
    }
    open.retain(|&m| !front.is_refined(m));
}

/// Steps from the current front to a closed `target`: coarsens what is not in it, finest first, then refines what is
/// missing, coarsest first. Every front on the way is closed, and no larger than the larger of the two. O(nodes / 64 +
/// changes).
///
/// Requires a static order: under a dynamic rule steps on the way need not be legal, nor `target` reachable.
pub fn approach<const N: usize, M: MultiTessellation<N>, S: Sink<N>>(
    model: &M,
    target: &Front,
    state: &mut State<N, M, S>,
) -> Outcome {
    state.scratch.chains.clear();
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
