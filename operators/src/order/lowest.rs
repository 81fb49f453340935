//! Lowest common ancestors of leaves: the largest of the nodes that join neighbouring leaves between them.

use mt_core::{NodeId, Replay};

/// Leaves whose joins are looked through one by one; a power of two.
const BLOCK: usize = 16;

/// Answers in O(1) after O(leaves): node ids rise along the forest, and between two leaves lies the first leaf of exactly
/// the children that were joined on the way, so the lowest common ancestor is the largest of their nodes.
pub(super) struct Lowest {
    /// Of each leaf: the node that joins it with the one before; none where nothing does, which is larger than all nodes.
    joins: Vec<NodeId>,
    /// Level `k` holds the maximum over `2^k` neighbouring blocks. With blocks a level takes a sixteenth of the memory
    /// of the joins, and all are made while these are read once; most questions are about leaves of one block or two.
    levels: Vec<Vec<NodeId>>,
}

impl Lowest {
    pub(super) fn new(replay: &Replay) -> Self {
        let mut joins = vec![NodeId::NONE; replay.leaf_count() as usize];
        for m in (0..replay.len()).map(NodeId) {
            joins[replay.span(replay.node(m).child).first as usize] = m;
        }
        Self::of_joins(joins)
    }

    fn of_joins(joins: Vec<NodeId>) -> Self {
        let mut levels: Vec<Vec<NodeId>> = vec![joins.chunks(BLOCK).map(most).collect()];
        let mut width = 1;
        while 2 * width <= levels[0].len() {
            let last = &levels[levels.len() - 1];
            let next = (0..last.len() - width).map(|i| last[i].max(last[i + width])).collect();
            levels.push(next);
            width *= 2;
        }
        Self { joins, levels }
    }

    /// The lowest node above two leaves, given by rank; none where they are one, or in two trees.
    pub(super) fn of(&self, a: u32, b: u32) -> Option<NodeId> {
        let (low, high) = (a.min(b) as usize + 1, a.max(b) as usize + 1);
        if low >= high {
            return None;
        }
        let (first, last) = (low.div_ceil(BLOCK), high / BLOCK);
        let node = if first < last {
            let level = (last - first).ilog2() as usize;
            let row = &self.levels[level];
            let between = row[first].max(row[last - (1 << level)]);
            between.max(most(&self.joins[low..first * BLOCK])).max(most(&self.joins[last * BLOCK..high]))
        } else {
            most(&self.joins[low..high])
        };
        Some(node).filter(|node| !node.is_none())
    }
}

/// The largest; 0 of none.
fn most(nodes: &[NodeId]) -> NodeId {
    NodeId(nodes.iter().fold(0, |most, node| most.max(node.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_join_between_two_leaves_is_found() {
        let count = 7 * BLOCK as u32 + 5;
        let joins: Vec<NodeId> = (0..count)
            .map(|i| if i % 61 == 0 { NodeId::NONE } else { NodeId(i.wrapping_mul(2_654_435_761) >> 8) })
            .collect();
        let lowest = Lowest::of_joins(joins.clone());
        for a in 0..count {
            for b in 0..count {
                let between = &joins[a.min(b) as usize + 1..=a.max(b) as usize];
                let slow = between.iter().copied().max().filter(|node| !node.is_none());
                assert_eq!(lowest.of(a, b), slow, "{a} {b}");
            }
        }
    }
}
