//! A forest cut into portions that can be replayed by themselves, several at once: runs of leaf ranks, the merges within
//! each, and the triangles around each.
//!
//! Leaves are numbered along the forest, so a run of ranks is near in space, and nearly all merges lie within one run. Those
//! that lie across a cut are a portion of their own, which is replayed when the others are done. Where the cuts are is a
//! function of the forest, so threads change nothing.

use super::replay::{Replay, Span};
use crate::id::NodeId;
use rayon::prelude::*;
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
        let mut starts: Vec<u32> = (0..=count).map(|k| (k * size).min(leaves)).collect();
        let mut wanted = count - 1;
        let mut is_cut = vec![false; count as usize];
        // The later a merge, the fewer are above it, and all of these lie across a cut where its child begins.
        for m in (0..replay.len()).rev().map(NodeId) {
            if wanted == 0 {
                break;
            }
            let at = replay.span(replay.node(m).child).first;
            let (k, off) = ((at + window) / size, (at + window) % size);
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

impl Portions {
    /// Whether a span lies across a cut.
    pub(super) fn is_across(&self, span: Span) -> bool {
        self.of_span(span) == self.len()
    }
}

/// Numbers sorted into bins, ascending in each.
pub(super) struct Bins {
    /// Of each chunk of the numbers: where each bin begins, and the numbers bin by bin.
    chunks: Vec<(Vec<u32>, Vec<u32>)>,
}

/// Numbers that one thread sorts at a time.
const CHUNK: u32 = 1 << 16;

impl Bins {
    /// The numbers below `count`, each in the bins that `of` tells, in each of these once. O(numbers + bins × chunks).
    pub(super) fn new<const K: usize>(count: u32, bins: usize, of: impl Fn(u32) -> [usize; K] + Sync) -> Self {
        let chunk = |first: u32| {
            let told: Vec<[usize; K]> = (first..(first + CHUNK).min(count)).map(&of).collect();
            let once = |told: &[usize; K]| {
                let told = *told;
                (0..K).filter(move |&k| !told[..k].contains(&told[k])).map(move |k| told[k])
            };
            let mut starts = vec![0u32; bins + 1];
            told.iter().flat_map(once).for_each(|bin| starts[bin + 1] += 1);
            (0..bins).for_each(|bin| starts[bin + 1] += starts[bin]);
            let mut next = starts.clone();
            let mut items = vec![0; starts[bins] as usize];
            for (number, told) in (first..).zip(&told) {
                for bin in once(told) {
                    items[next[bin] as usize] = number;
                    next[bin] += 1;
                }
            }
            (starts, items)
        };
        let chunks = (0..count.div_ceil(CHUNK)).into_par_iter().map(|i| chunk(i * CHUNK)).collect();
        Self { chunks }
    }

    /// The numbers in a bin.
    pub(super) fn of(&self, bin: usize) -> Vec<u32> {
        let row = |(starts, items): &(Vec<u32>, Vec<u32>)| -> Vec<u32> {
            items[starts[bin] as usize..starts[bin + 1] as usize].to_vec()
        };
        self.chunks.iter().flat_map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_number_is_in_its_bins_once(told in prop::collection::vec(prop::array::uniform2(0usize..5), 0..50), more in 0u32..2) {
            // Over the end of a chunk as well.
            let first = more * (CHUNK - 20);
            let of = |number: u32| number.checked_sub(first).map_or([0, 0], |at| told[at as usize]);
            let count = first + told.len() as u32;
            let bins = Bins::new(count, 5, of);
            for bin in 0..5 {
                let slow: Vec<u32> = (0..count).filter(|&number| of(number).contains(&bin)).collect();
                prop_assert_eq!(bins.of(bin), slow);
            }
        }
    }
}
