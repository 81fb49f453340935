//! The algorithms as the slides have them, on any model: contraction and expansion, by a test of whole modifications.
//!
//! Written for reading, to be measured against the engine; every call looks at the whole front.

use mt_core::{Coarsen, MultiTessellation, NodeId};
use selective::State;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A number that sorts.
#[derive(Copy, Clone, Debug, PartialEq)]
struct Key(f32);

impl Eq for Key {}
impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Key {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// Above 0 where the coarse side of a node does not satisfy the criterion.
pub(super) type Excess<'a> = &'a dyn Fn(NodeId) -> f32;

/// Removes leaves of the set while the mesh is larger than the budget, or the finest of them may go.
pub(super) fn contraction<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    excess: Excess<'_>,
    budget: u32,
    state: &mut State<N, M, ()>,
) {
    let mut scratch = Vec::new();
    let mut is_leaf = |m: NodeId, state: &State<N, M, ()>| {
        scratch.clear();
        model.obstacles(m, &state.view, &mut scratch) == Coarsen::Now
    };
    let leaves: Vec<NodeId> = state.front().finest_first().filter(|&m| is_leaf(m, state)).collect();
    let mut queue: BinaryHeap<Reverse<(Key, NodeId)>> =
        leaves.into_iter().map(|m| Reverse((Key(excess(m)), m))).collect();
    let mut parents = Vec::new();
    while let Some(&Reverse((least, m))) = queue.peek() {
        if state.cell_count(model) <= budget && least.0 > 0.0 {
            break;
        }
        queue.pop();
        if !state.try_coarsen(model, m) {
            continue;
        }
        parents.clear();
        model.needs(m, &mut parents);
        for &parent in &parents {
            if is_leaf(parent, state) {
                queue.push(Reverse((Key(excess(parent)), parent)));
            }
        }
    }
}

/// Adds nodes below the front that do not satisfy the criterion, with all that they need, while the mesh is smaller than
/// the budget. Gives the number of nodes that were added for one that then was not.
pub(super) fn expansion<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    excess: Excess<'_>,
    budget: u32,
    state: &mut State<N, M, ()>,
) -> u32 {
    let mut needs = Vec::new();
    let mut below = |m: NodeId, state: &State<N, M, ()>| {
        needs.clear();
        model.needs(m, &mut needs);
        needs.is_empty() || needs.iter().any(|&need| state.front().is_refined(need))
    };
    let mut queue: BinaryHeap<(Key, NodeId)> = (0..model.len())
        .map(NodeId)
        .filter(|&m| !state.front().is_refined(m) && excess(m) > 0.0 && below(m, state))
        .map(|m| (Key(excess(m)), m))
        .collect();
    let mut in_vain = 0;
    while let Some((_, m)) = queue.pop() {
        if state.cell_count(model) >= budget {
            break;
        }
        if state.front().is_refined(m) {
            continue;
        }
        let mark = state.steps.len();
        add(model, m, budget, state);
        let added: Vec<NodeId> = state.steps[mark..].iter().map(|step| step.node).collect();
        in_vain += if state.front().is_refined(m) { 0 } else { added.len() as u32 };
        let mut children = Vec::new();
        added.iter().for_each(|&m| model.children(m, &mut children));
        queue.extend(
            children
                .into_iter()
                .filter(|&m| !state.front().is_refined(m) && excess(m) > 0.0)
                .map(|m| (Key(excess(m)), m)),
        );
    }
    in_vain
}

/// The recursive procedure, with its stack: each node after its parents, while the mesh is smaller than the budget.
fn add<const N: usize, M: MultiTessellation<N>>(model: &M, m: NodeId, budget: u32, state: &mut State<N, M, ()>) {
    let mut stack = vec![m];
    while let Some(&top) = stack.last() {
        let before = stack.len();
        if !state.front().is_refined(top) {
            model.prerequisites(top, &state.view, &mut stack);
        }
        if stack.len() > before {
            continue;
        }
        stack.pop();
        if state.front().is_refined(top) {
            continue;
        }
        if state.cell_count(model) >= budget {
            // No parent was added, so no node above it can be: the recursion returns without rolling back.
            return;
        }
        state.take(model, mt_core::Step::refine(top));
    }
}
