//! A forest cut into portions of which each can be told by itself what happens to its triangles, several at once: runs of leaf
//! ranks, the nodes within each, and the triangles around each.
//!
//! Leaves are numbered along the forest, so a run of ranks is near in space, and nearly all nodes lie within one run. Those
//! that lie across a cut are a portion of their own, which comes when the others are done. Where the cuts are is a function of
//! the forest, so threads change nothing.

use super::replay::{Replay, Span};
use crate::id::NodeId;
use std::ops::Range;

/// Runs of leaf ranks.
pub(super) struct Portions {
    /// Where each begins, and where the last ends.
    starts: Vec<u32>,
    /// Leaves of a portion, to within half of that.
    size: u32,
}

impl Portions {
    /// About so many leaves each, cut where the forest is joined last. O(nodes).
    pub(super) fn new(replay: &Replay, size: u32) -> Self {
        let leaves = replay.leaf_count();
        let count = leaves.div_ceil(size.max(2)).max(1);
        let size = leaves.div_ceil(count).max(1);
        let window = size / 4;
        let mut starts: Vec<u32> = (0..=count).map(|k| k.saturating_mul(size).min(leaves)).collect();
        let mut wanted = count - 1;
        let mut is_cut = vec![false; count as usize];
        // The later a merge, the fewer are above it, and all of these lie across a cut where its child begins.
        for m in (0..replay.len()).rev().map(NodeId) {
            if wanted == 0 {
                break;
            }
            let at = replay.span(replay.node(m).child).first;
            let near = u64::from(at) + u64::from(window);
            let (k, off) = ((near / u64::from(size)) as u32, (near % u64::from(size)) as u32);
            if (1..count).contains(&k) && off <= 2 * window && at < leaves && !is_cut[k as usize] {
                is_cut[k as usize] = true;
                starts[k as usize] = at;
                wanted -= 1;
            }
        }
        Self { starts, size }
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The ranks of a portion.
    pub(super) fn leaves(&self, portion: usize) -> Range<u32> {
        self.starts[portion]..self.starts[portion + 1]
    }

    /// The portion that the leaf of this rank is in. O(1): no cut is further than a quarter from where it would be if all
    /// were of one size.
    #[inline]
    pub(super) fn of(&self, rank: u32) -> usize {
        let k = ((rank / self.size) as usize).min(self.len() - 1);
        if rank < self.starts[k] {
            k - 1
        } else if rank >= self.starts[k + 1] {
            k + 1
        } else {
            k
        }
    }

    /// The portion that all of a span is in; `len()` where it lies across a cut.
    #[inline]
    pub(super) fn of_span(&self, span: Span) -> usize {
        let portion = self.of(span.first);
        if span.end <= self.starts[portion + 1] { portion } else { self.len() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate;
    use crate::hierarchy::Sequence;
    use crate::id::VertexId;

    #[test]
    fn cuts_ascend_and_ranks_are_found() {
        let mesh = generate::terrain(12, 0.5, 3);
        let mut sequence = Sequence::new(&mesh);
        let mut there: Vec<VertexId> = (0..mesh.vertex_count()).map(VertexId::new).collect();
        while let [.., a, b] = there[..] {
            there.truncate(there.len() - 2);
            there.insert(there.len() / 2, sequence.push(a, [b], [0.0], glam::Vec3::ZERO, false));
        }
        let replay = Replay::new(&mesh, &[], &sequence).unwrap();
        for size in [1, 2, 7, 50, 1000, u32::MAX] {
            let portions = Portions::new(&replay, size);
            assert!(portions.starts.is_sorted() && portions.starts[0] == 0);
            assert_eq!(portions.starts.last(), Some(&replay.leaf_count()));
            for rank in 0..replay.leaf_count() {
                assert!(portions.leaves(portions.of(rank)).contains(&rank), "{rank} of portions of {size}");
            }
        }
    }
}
