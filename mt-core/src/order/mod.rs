//! The partial order on modifications: compressed rows of needs and of dependents.
//!
//! Feasibility, closure, minimality and petgraph live here and never look at a cell.

mod petgraph_view;
mod rows;
mod sparse;

pub use petgraph_view::Arc;
pub use rows::Rows;
pub use sparse::SparseRows;

use crate::front::Front;
use crate::id::NodeId;

/// A partial order as rows in both directions: 8 bytes an arc and 8 a node.
///
/// Ids are a rank: `needs(m)` are all above `m`, `dependents(m)` all below. So nothing can cycle.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Order {
    needs: Rows,
    dependents: Rows,
}

/// Rows that are not an order.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum OrderError {
    /// A row names a node that the model does not have.
    #[error("node {node} names node {other}, but there are only {count}")]
    OutOfRange {
        /// The row.
        node: NodeId,
        /// What it names.
        other: NodeId,
        /// How many nodes there are.
        count: u32,
    },
    /// A node needs one of no higher rank, so the relation may cycle.
    #[error("node {node} needs node {need}, whose id is not larger")]
    Rank {
        /// The row.
        node: NodeId,
        /// What it needs.
        need: NodeId,
    },
    /// Entries of a row do not ascend.
    #[error("the row of node {node} does not ascend")]
    Unsorted {
        /// The row.
        node: NodeId,
    },
}

impl Order {
    /// The order in which `needs` says what each node needs. O(nodes + arcs).
    pub fn from_needs(needs: Rows) -> Result<Self, OrderError> {
        check_rows(&needs, |m, need| need > m)?;
        let dependents = needs.transposed();
        Ok(Self { needs, dependents })
    }

    /// The order in which `dependents` says who needs each node. O(nodes + arcs).
    pub fn from_dependents(dependents: Rows) -> Result<Self, OrderError> {
        check_rows(&dependents, |m, dependent| dependent < m)?;
        let needs = dependents.transposed();
        Ok(Self { needs, dependents })
    }

    /// Number of nodes.
    pub fn len(&self) -> u32 {
        self.needs.len()
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of arcs.
    pub fn arc_count(&self) -> usize {
        self.needs.targets().len()
    }

    /// What `m` needs directly, ascending.
    #[inline]
    pub fn needs(&self, m: NodeId) -> &[NodeId] {
        self.needs.row(m)
    }

    /// Who needs `m` directly, ascending.
    #[inline]
    pub fn dependents(&self, m: NodeId) -> &[NodeId] {
        self.dependents.row(m)
    }

    /// The nodes that need nothing.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> + '_ {
        (0..self.len()).map(NodeId).filter(|&m| self.needs(m).is_empty())
    }

    /// Whether `front` holds all that its members need. O(arcs of the front).
    pub fn is_closed(&self, front: &Front) -> bool {
        self.unmet(front).is_none()
    }

    /// A refined node and something that it needs and that is not refined; `None` where `front` is closed.
    pub fn unmet(&self, front: &Front) -> Option<(NodeId, NodeId)> {
        let missing = |m: NodeId| self.needs(m).iter().copied().find(|&need| !front.is_refined(need));
        front.finest_first().find_map(|m| missing(m).map(|need| (m, need)))
    }

    /// Adds to `front` all that its members need: its least closure. One sweep by rank, O(nodes / 64 + arcs).
    pub fn close(&self, front: &mut Front) {
        for w in 0..front.words().len() {
            // What a node needs has a larger id, so it is met later in the sweep, in this word or a later one.
            let mut done = 0u64;
            while let Some(bit) = crate::bits::ones(front.words()[w] & !done).next() {
                done |= 1 << bit;
                for &need in self.needs(NodeId(w as u32 * 64 + bit)) {
                    front.set(need, true);
                }
            }
        }
    }

    /// The length of the longest chain of needs. O(nodes + arcs).
    pub fn depth(&self) -> u32 {
        let mut depth = vec![0u32; self.len() as usize];
        for m in (0..self.len()).rev().map(NodeId) {
            depth[m.index()] = 1 + self.needs(m).iter().map(|need| depth[need.index()]).max().unwrap_or(0);
        }
        depth.into_iter().max().unwrap_or(0)
    }

    /// The rows of needs.
    pub fn needs_rows(&self) -> &Rows {
        &self.needs
    }

    /// Bytes held, with both directions.
    pub fn bytes(&self) -> usize {
        self.needs.bytes() + self.dependents.bytes()
    }
}

fn check_rows(rows: &Rows, ranked: impl Fn(NodeId, NodeId) -> bool) -> Result<(), OrderError> {
    for m in (0..rows.len()).map(NodeId) {
        let row = rows.row(m);
        if let Some(&other) = row.iter().find(|other| other.0 >= rows.len()) {
            return Err(OrderError::OutOfRange { node: m, other, count: rows.len() });
        }
        if let Some(&need) = row.iter().find(|&&other| !ranked(m, other)) {
            return Err(OrderError::Rank { node: m, need });
        }
        if !row.is_sorted_by(|a, b| a < b) {
            return Err(OrderError::Unsorted { node: m });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use petgraph::algo::{kosaraju_scc, toposort};
    use petgraph::dot::{Config, Dot};
    use proptest::prelude::*;

    fn order(needs: &[&[u32]]) -> Order {
        let mut rows = Rows::default();
        for row in needs {
            rows.push(row.iter().map(|&n| NodeId(n)));
        }
        Order::from_needs(rows).unwrap()
    }

    /// 3 is the root; 2 and 1 need it; 0 needs 1 and 2.
    fn diamond() -> Order {
        order(&[&[1, 2], &[3], &[3], &[]])
    }

    #[test]
    fn petgraph_runs_on_the_order_without_a_copy() {
        let order = diamond();
        let sorted = toposort(&order, None).unwrap();
        assert_eq!((sorted[0], sorted[3]), (NodeId(3), NodeId(0)));
        assert_eq!(kosaraju_scc(&order).len(), 4);
        let dot = format!("{:?}", Dot::with_config(&order, &[Config::EdgeNoLabel]));
        assert_eq!(dot.matches("->").count(), order.arc_count());
        assert!(petgraph::algo::has_path_connecting(&order, NodeId(3), NodeId(0), None));
    }

    #[test]
    fn a_chain_of_a_million_sorts_without_recursion() {
        let count = 1_000_000;
        let mut rows = Rows::default();
        for m in 0..count {
            rows.push((m + 1 < count).then_some(NodeId(m + 1)));
        }
        let order = Order::from_needs(rows).unwrap();
        assert_eq!(toposort(&order, None).unwrap()[0], NodeId(count - 1));
        assert_eq!(kosaraju_scc(&order).len(), count as usize);
        assert_eq!(order.depth(), count);
    }

    #[test]
    fn cycles_and_strangers_are_refused() {
        let mut rows = Rows::default();
        rows.push([NodeId(1)]);
        rows.push([NodeId(0)]);
        assert_eq!(Order::from_needs(rows), Err(OrderError::Rank { node: NodeId(1), need: NodeId(0) }));
        let mut rows = Rows::default();
        rows.push([NodeId(9)]);
        assert!(matches!(Order::from_needs(rows), Err(OrderError::OutOfRange { .. })));
    }

    fn random_needs() -> impl Strategy<Value = Vec<Vec<u32>>> {
        (1u32..150).prop_flat_map(|n| {
            (0..n)
                .map(|m| {
                    proptest::collection::btree_set((m + 1).min(n - 1)..n, 0..4)
                        .prop_map(move |s| s.into_iter().filter(|&x| x > m).collect())
                })
                .collect::<Vec<_>>()
        })
    }

    proptest! {
        #[test]
        fn closing_equals_repeated_union(needs in random_needs(), wish in proptest::collection::vec(0u32..150, 0..8)) {
            let rows: Vec<&[u32]> = needs.iter().map(Vec::as_slice).collect();
            let order = order(&rows);
            let mut front = Front::from_nodes(order.len(), wish.iter().map(|w| NodeId(w % order.len())));
            let mut oracle: std::collections::BTreeSet<u32> = front.finest_first().map(|m| m.0).collect();
            loop {
                let more: Vec<u32> = oracle.iter().flat_map(|&m| needs[m as usize].iter().copied()).collect();
                let before = oracle.len();
                oracle.extend(more);
                if oracle.len() == before { break; }
            }
            order.close(&mut front);
            prop_assert!(order.is_closed(&front));
            prop_assert_eq!(front.finest_first().map(|m| m.0).collect::<Vec<_>>(), oracle.into_iter().collect::<Vec<_>>());
        }

        #[test]
        fn rows_and_their_transpose_tell_the_same(needs in random_needs()) {
            let rows: Vec<&[u32]> = needs.iter().map(Vec::as_slice).collect();
            let order = order(&rows);
            let again = Order::from_dependents(order.dependents.clone()).unwrap();
            prop_assert_eq!(&again, &order);
            for m in (0..order.len()).map(NodeId) {
                for need in order.needs(m) { prop_assert!(order.dependents(*need).contains(&m)); }
            }
        }
    }

    #[test]
    fn an_order_is_empty_that_has_no_node() {
        assert!(order(&[]).is_empty());
        assert!(!diamond().is_empty());
        assert_eq!((order(&[]).depth(), diamond().depth(), order(&[&[], &[]]).depth()), (0, 3, 1));
    }
}
