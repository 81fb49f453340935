//! Sparse rows: short lists of nodes for some of the nodes, in little more than the lists themselves.

use crate::bits::Bits;
use crate::id::NodeId;

/// Rows of which many are empty: a bit and half a byte a node, 4 bytes for a row that is not empty, 4 an entry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseRows {
    filled: Bits,
    /// Filled rows before each word of 64 nodes.
    before: Vec<u32>,
    start: Vec<u32>,
    target: Vec<NodeId>,
}

impl SparseRows {
    /// Rows for `count` nodes of entries (node, target); sorts them and drops what comes twice. Requires: nodes below
    /// `count`. O(entries log entries).
    pub fn new(count: u32, mut entries: Vec<(NodeId, NodeId)>) -> Self {
        entries.sort_unstable();
        entries.dedup();
        let mut filled = Bits::new(count);
        let mut start = Vec::new();
        for (i, (m, _)) in entries.iter().enumerate() {
            if filled.insert(m.0) {
                start.push(i as u32);
            }
        }
        start.push(entries.len() as u32);
        start.shrink_to_fit();
        let before = filled
            .words()
            .iter()
            .scan(0, |sum, word| {
                let before = *sum;
                *sum += word.count_ones();
                Some(before)
            })
            .collect();
        Self { filled, before, start, target: entries.into_iter().map(|(_, target)| target).collect() }
    }

    /// The row of `m`, ascending. O(1).
    #[inline]
    pub fn row(&self, m: NodeId) -> &[NodeId] {
        if m.0 >= self.filled.capacity() || !self.filled.contains(m.0) {
            return &[];
        }
        let word = m.index() / 64;
        let below = self.filled.words()[word] & ((1u64 << (m.0 % 64)) - 1);
        let row = (self.before[word] + below.count_ones()) as usize;
        &self.target[self.start[row] as usize..self.start[row + 1] as usize]
    }

    /// Number of entries.
    pub fn entry_count(&self) -> usize {
        self.target.len()
    }

    /// All entries as (node, target), ascending.
    pub fn entries(&self) -> impl Iterator<Item = (NodeId, NodeId)> + '_ {
        self.filled.iter().map(NodeId).flat_map(|m| self.row(m).iter().map(move |&target| (m, target)))
    }

    /// The rows in the other direction.
    pub fn transposed(&self) -> Self {
        Self::new(self.filled.capacity(), self.entries().map(|(m, target)| (target, m)).collect())
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        8 * self.filled.words().len() + 4 * (self.before.len() + self.start.len() + self.target.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn rows_are_what_was_put_in(entries in prop::collection::vec((0u32..300, 0u32..300), 0..200)) {
            let entries: Vec<_> = entries.into_iter().map(|(a, b)| (NodeId(a), NodeId(b))).collect();
            let rows = SparseRows::new(300, entries.clone());
            for m in (0..300).map(NodeId) {
                let told: BTreeSet<_> = entries.iter().filter(|e| e.0 == m).map(|e| e.1).collect();
                prop_assert!(told.iter().eq(rows.row(m)), "{:?} {:?}", told, rows.row(m));
            }
            prop_assert!(rows.entries().count() == rows.entry_count());
            prop_assert!(rows.transposed().transposed() == rows);
        }
    }

    #[test]
    fn bytes_are_those_of_rows_that_are_filled() {
        let rows = SparseRows::new(130, [(3, 1), (3, 2), (128, 9)].map(|(m, t)| (NodeId(m), NodeId(t))).to_vec());
        // Three words of bits and the rows before each, where two rows begin and the second ends, three entries.
        let counts = (rows.filled.words().len(), rows.before.len(), rows.start.len(), rows.target.len());
        assert_eq!((counts.0, counts.2, counts.3), (3, 3, 3));
        assert_eq!(rows.bytes(), 8 * counts.0 + 4 * (counts.1 + counts.2 + counts.3));
    }
}
