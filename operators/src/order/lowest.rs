//! Lowest common ancestors of leaves: the largest of the nodes that join neighbouring leaves between them.

use mt_core::{NodeId, Replay};

/// Answers in O(1) after O(leaves × log leaves): node ids rise along the forest, and between two leaves lies the first
/// leaf of exactly the children that were joined on the way, so the lowest common ancestor is the largest of their nodes.
pub(super) struct Lowest {
    /// Level `k` holds the maximum over `2^k` neighbours.
    levels: Vec<Vec<NodeId>>,
}

impl Lowest {
    pub(super) fn new(replay: &Replay) -> Self {
        // Two trees are joined by nothing; `NodeId::NONE` is larger than all nodes.
        let mut joins = vec![NodeId::NONE; replay.leaf_count() as usize];
        for m in (0..replay.len()).map(NodeId) {
            joins[replay.span(replay.node(m).child).first as usize] = m;
        }
        let mut levels = vec![joins];
        let mut width = 1;
        while 2 * width <= levels[0].len() {
            let last = &levels[levels.len() - 1];
            let next = (0..last.len() - width).map(|i| last[i].max(last[i + width])).collect();
            levels.push(next);
            width *= 2;
        }
        Self { levels }
    }

    /// The lowest node above two leaves, given by rank; none where they are one, or in two trees.
    pub(super) fn of(&self, a: u32, b: u32) -> Option<NodeId> {
        let (low, high) = (a.min(b) as usize + 1, a.max(b) as usize + 1);
        if low >= high {
            return None;
        }
        let level = (high - low).ilog2() as usize;
        let row = &self.levels[level];
        Some(row[low].max(row[high - (1 << level)])).filter(|node| !node.is_none())
    }
}
