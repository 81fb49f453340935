//! Compressed rows: for each node a short list of nodes, all lists in one array.

use crate::id::NodeId;

/// One row of nodes per node: 4 bytes a node and 4 an entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rows {
    start: Vec<u32>,
    target: Vec<NodeId>,
}

impl Default for Rows {
    fn default() -> Self {
        Self { start: vec![0], target: Vec::new() }
    }
}

impl Rows {
    /// Rows from their arrays; `None` unless `start` begins at 0, never falls and ends at the number of targets.
    pub fn from_parts(start: Vec<u32>, target: Vec<NodeId>) -> Option<Self> {
        let spans = start.first() == Some(&0) && start.last().map(|&end| end as usize) == Some(target.len());
        (spans && start.is_sorted()).then_some(Self { start, target })
    }

    /// Rows with room for `rows` rows and `entries` entries.
    pub fn with_capacity(rows: usize, entries: usize) -> Self {
        let mut start = Vec::with_capacity(rows + 1);
        start.push(0);
        Self { start, target: Vec::with_capacity(entries) }
    }

    /// Appends a row.
    pub fn push(&mut self, row: impl IntoIterator<Item = NodeId>) {
        self.target.extend(row);
        self.start.push(self.target.len() as u32);
    }

    /// Number of rows.
    pub fn len(&self) -> u32 {
        self.start.len() as u32 - 1
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The row of `m`.
    #[inline]
    pub fn row(&self, m: NodeId) -> &[NodeId] {
        &self.target[self.start[m.index()] as usize..self.start[m.index() + 1] as usize]
    }

    /// Where each row starts, and where the last one ends.
    pub fn starts(&self) -> &[u32] {
        &self.start
    }

    /// All entries.
    pub fn targets(&self) -> &[NodeId] {
        &self.target
    }

    /// The rows in the other direction, each ascending. Requires: entries below the number of rows. O(rows + entries).
    pub fn transposed(&self) -> Self {
        let mut start = vec![0u32; self.start.len()];
        for t in &self.target {
            start[t.index() + 1] += 1;
        }
        for i in 1..start.len() {
            start[i] += start[i - 1];
        }
        let mut fill = start.clone();
        let mut target = vec![NodeId::NONE; self.target.len()];
        for m in (0..self.len()).map(NodeId) {
            for t in self.row(m) {
                target[fill[t.index()] as usize] = m;
                fill[t.index()] += 1;
            }
        }
        Self { start, target }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        4 * (self.start.len() + self.target.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_know_where_they_begin() {
        let mut rows = Rows::default();
        rows.push([3, 4].map(NodeId));
        rows.push([]);
        rows.push([NodeId(9)]);
        assert_eq!((rows.starts(), rows.targets().len(), rows.len()), ([0, 2, 2, 3].as_slice(), 3, 3));
        assert_eq!(Rows::from_parts(rows.starts().to_vec(), rows.targets().to_vec()).as_ref(), Some(&rows));
    }
}
