//! The front of a view: which modifications are refined. A set of nodes, closed under what its members need.

use crate::bits::Bits;
use crate::id::NodeId;

/// The refined nodes of a view, one bit each.
///
/// The empty front is the base mesh, the full front the reference mesh.
#[derive(Debug, Default, PartialEq, Eq, Hash)]
pub struct Front(Bits);

impl Clone for Front {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }

    /// In the memory of `self`, where that is large enough.
    fn clone_from(&mut self, other: &Self) {
        self.0.clone_from(&other.0);
    }
}

impl Front {
    /// The front of the base mesh of a model of `node_count` modifications.
    pub fn base(node_count: u32) -> Self {
        Self(Bits::new(node_count))
    }

    /// The front of the reference mesh.
    pub fn reference(node_count: u32) -> Self {
        Self(Bits::full(node_count))
    }

    /// The front of exactly these nodes; closed only if they are.
    pub fn from_nodes(node_count: u32, nodes: impl IntoIterator<Item = NodeId>) -> Self {
        let mut front = Self::base(node_count);
        for m in nodes {
            front.set(m, true);
        }
        front
    }

    /// Whether `m` is refined.
    #[inline]
    pub fn is_refined(&self, m: NodeId) -> bool {
        self.0.contains(m.0)
    }

    /// Marks `m` as refined or not; whether that is a change. The mesh is not told: see [`crate::View`].
    #[inline]
    pub fn set(&mut self, m: NodeId, refined: bool) -> bool {
        if refined { self.0.insert(m.0) } else { self.0.remove(m.0) }
    }

    /// Number of refined nodes. O(1).
    pub fn len(&self) -> u32 {
        self.0.count()
    }

    /// Whether this is the front of the base mesh.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The refined nodes by rank, finest first (ascending ids): the direction in which coarsening is legal.
    pub fn finest_first(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.0.iter().map(NodeId)
    }

    /// Refined here and not in `other`, finest first.
    pub fn difference<'a>(&'a self, other: &'a Front) -> impl Iterator<Item = NodeId> + 'a {
        self.0.difference(&other.0).map(NodeId)
    }

    /// Whether all that is refined here is refined in `other`.
    pub fn is_subset(&self, other: &Front) -> bool {
        self.0.is_subset(&other.0)
    }

    /// The bits in words of 64 nodes, finest first, for sweeps that coarsen as they go.
    pub fn words(&self) -> &[u64] {
        self.0.words()
    }
}
