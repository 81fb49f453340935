//! What engines must reach, by definition: the least closed front of a wish, and under a budget the front found by
//! priority from the base mesh.

use crate::truth::{Needs, Set, Truth};
use mt_core::model::MultiTessellation;
use mt_core::{Bound, NodeId};
use selective::{Criterion, Pace};

/// Of a node that is asked for: how urgently, and which node is to be refined for it.
pub type Goal = Option<(f32, usize)>;

/// What a criterion asks for: a node if the criterion says so, or, where its run is judged as one, if it says so of the
/// last of the run, and then the first of the run is what to refine.
pub fn goals<const N: usize, C: Criterion<Bound>>(
    bounds: &[Bound],
    truth: &impl Truth<N>,
    criterion: &C,
    before: &[bool],
) -> Vec<Goal> {
    let excess = |m: usize| criterion.excess(&bounds[m], before[m]);
    let goal = |m: usize| {
        let (first, last) = truth.run(m);
        let whole = C::RUNS && first < last && criterion.pace(&bounds[last]) == Pace::Whole;
        if whole && excess(last) > 0.0 {
            return Some((excess(last).max(excess(m)), first));
        }
        (excess(m) > 0.0).then_some((excess(m), m))
    };
    (0..bounds.len()).map(goal).collect()
}

/// The nodes that are asked for.
pub fn asked(goals: &[Goal]) -> Set {
    goals.iter().map(Option::is_some).collect()
}

/// Under which node each is discovered; of roots, the number of nodes.
pub fn discovery<const N: usize, M: MultiTessellation<N>>(model: &M) -> Vec<usize> {
    let mut under = vec![model.len() as usize; model.len() as usize];
    for m in (0..model.len()).map(NodeId) {
        let mut children = Vec::new();
        model.children(m, &mut children);
        children.iter().for_each(|child| under[child.index()] = m.index());
    }
    under
}

/// How many chains that do not fit are passed over.
const MISFITS_MAX: usize = 16;

/// The front under a budget: the most urgent goal that has been discovered is refined with all it needs if that fits, of
/// equals the one of higher rank; and whether all fitted.
pub fn within_budget<const N: usize>(
    truth: &impl Truth<N>,
    order: &Needs,
    under: &[usize],
    goals: &[Goal],
    cells_max: usize,
) -> (Set, bool) {
    let found_under = |parent: usize| (0..goals.len()).filter(move |&m| under[m] == parent).filter_map(|m| goals[m]);
    let mut front = vec![false; goals.len()];
    let mut waiting: Vec<(f32, usize)> = found_under(goals.len()).collect();
    let mut misfits = 0;
    while misfits < MISFITS_MAX && !waiting.is_empty() {
        waiting.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (_, node) = waiting.pop().expect("there is one");
        if front[node] {
            continue;
        }
        let mut wish = front.clone();
        wish[node] = true;
        let larger = order.closure(&wish);
        if truth.mesh(&larger).len() > cells_max {
            misfits += 1;
            continue;
        }
        waiting.extend((0..goals.len()).filter(|&m| larger[m] && !front[m]).flat_map(found_under));
        front = larger;
    }
    (front, misfits == 0)
}
