//! petgraph's visit traits on [`Order`], so that its algorithms run on it without a copy.
//!
//! Arcs run from a node to its dependents, as the pictures of Multi-Tessellations draw them, so `toposort` gives a
//! sequence in which refining is legal. `toposort` and `kosaraju_scc` are iterative; `is_cyclic_directed` and
//! `tarjan_scc` recurse and overflow the stack on deep orders.

use super::Order;
use crate::bits::Bits;
use crate::id::NodeId;
use petgraph::Direction;
use petgraph::visit::*;

/// An arc of the order: `dependent` needs `need`.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Arc {
    /// What is needed.
    pub need: NodeId,
    /// Who needs it.
    pub dependent: NodeId,
}

impl GraphBase for Order {
    type NodeId = NodeId;
    type EdgeId = Arc;
}

impl Data for Order {
    type NodeWeight = NodeId;
    type EdgeWeight = ();
}

impl GraphProp for Order {
    type EdgeType = petgraph::Directed;
}

impl NodeCount for Order {
    fn node_count(&self) -> usize {
        self.len() as usize
    }
}

impl EdgeCount for Order {
    fn edge_count(&self) -> usize {
        self.arc_count()
    }
}

impl NodeIndexable for Order {
    fn node_bound(&self) -> usize {
        self.len() as usize
    }
    fn to_index(&self, m: NodeId) -> usize {
        m.index()
    }
    fn from_index(&self, i: usize) -> NodeId {
        NodeId::new(i)
    }
}

impl NodeCompactIndexable for Order {}

impl Visitable for Order {
    type Map = Visited;
    fn visit_map(&self) -> Visited {
        Visited(Bits::new(self.len()))
    }
    fn reset_map(&self, map: &mut Visited) {
        *map = self.visit_map();
    }
}

/// The nodes that a petgraph algorithm has seen.
#[derive(Clone, Debug, Default)]
pub struct Visited(Bits);

impl VisitMap<NodeId> for Visited {
    fn visit(&mut self, m: NodeId) -> bool {
        self.0.insert(m.0)
    }
    fn is_visited(&self, m: &NodeId) -> bool {
        self.0.contains(m.0)
    }
    fn unvisit(&mut self, m: NodeId) -> bool {
        self.0.remove(m.0)
    }
}

impl IntoNodeIdentifiers for &Order {
    type NodeIdentifiers = std::iter::Map<std::ops::Range<u32>, fn(u32) -> NodeId>;
    fn node_identifiers(self) -> Self::NodeIdentifiers {
        (0..self.len()).map(NodeId)
    }
}

impl IntoNodeReferences for &Order {
    type NodeRef = NodeReference;
    type NodeReferences = std::iter::Map<std::ops::Range<u32>, fn(u32) -> NodeReference>;
    fn node_references(self) -> Self::NodeReferences {
        (0..self.len()).map(|m| NodeReference(NodeId(m)))
    }
}

/// A node as petgraph sees it: its id is its weight.
#[derive(Copy, Clone, Debug)]
pub struct NodeReference(NodeId);

impl NodeRef for NodeReference {
    type NodeId = NodeId;
    type Weight = NodeId;
    fn id(&self) -> NodeId {
        self.0
    }
    fn weight(&self) -> &NodeId {
        &self.0
    }
}

impl<'a> IntoNeighbors for &'a Order {
    type Neighbors = std::iter::Copied<std::slice::Iter<'a, NodeId>>;
    fn neighbors(self, m: NodeId) -> Self::Neighbors {
        self.dependents(m).iter().copied()
    }
}

impl<'a> IntoNeighborsDirected for &'a Order {
    type NeighborsDirected = std::iter::Copied<std::slice::Iter<'a, NodeId>>;
    fn neighbors_directed(self, m: NodeId, direction: Direction) -> Self::NeighborsDirected {
        match direction {
            Direction::Outgoing => self.dependents(m).iter().copied(),
            Direction::Incoming => self.needs(m).iter().copied(),
        }
    }
}

/// An arc as petgraph sees it.
#[derive(Copy, Clone, Debug)]
pub struct ArcReference(Arc);

impl EdgeRef for ArcReference {
    type NodeId = NodeId;
    type EdgeId = Arc;
    type Weight = ();
    fn source(&self) -> NodeId {
        self.0.need
    }
    fn target(&self) -> NodeId {
        self.0.dependent
    }
    fn weight(&self) -> &() {
        &()
    }
    fn id(&self) -> Arc {
        self.0
    }
}

/// The arcs that leave one node after another.
#[derive(Clone, Debug)]
pub struct Arcs<'a> {
    order: &'a Order,
    node: u32,
    end: u32,
    at: usize,
}

impl Iterator for Arcs<'_> {
    type Item = ArcReference;
    fn next(&mut self) -> Option<ArcReference> {
        while self.node < self.end {
            let need = NodeId(self.node);
            if let Some(&dependent) = self.order.dependents(need).get(self.at) {
                self.at += 1;
                return Some(ArcReference(Arc { need, dependent }));
            }
            self.node += 1;
            self.at = 0;
        }
        None
    }
}

impl<'a> IntoEdgeReferences for &'a Order {
    type EdgeRef = ArcReference;
    type EdgeReferences = Arcs<'a>;
    fn edge_references(self) -> Arcs<'a> {
        Arcs { order: self, node: 0, end: self.len(), at: 0 }
    }
}

impl<'a> IntoEdges for &'a Order {
    type Edges = Arcs<'a>;
    fn edges(self, m: NodeId) -> Arcs<'a> {
        Arcs { order: self, node: m.0, end: m.0 + 1, at: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn petgraph_sees_the_nodes_and_arcs_there_are() {
        // 2 is needed by 1 and by 0, 1 by 0.
        let mut rows = crate::order::Rows::default();
        [&[1u32, 2][..], &[2], &[]].iter().for_each(|row| rows.push(row.iter().map(|&need| NodeId(need))));
        let order = Order::from_needs(rows).unwrap();
        assert_eq!((order.node_count(), order.edge_count(), order.node_bound()), (3, 3, 3));
        let arcs = |m: u32| (&order).edges(NodeId(m)).map(|arc| (arc.source().0, arc.target().0)).collect::<Vec<_>>();
        assert_eq!((arcs(2), arcs(1), arcs(0)), (vec![(2, 0), (2, 1)], vec![(1, 0)], vec![]));
        assert_eq!((&order).edge_references().count(), 3);
    }
}
