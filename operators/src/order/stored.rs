//! Static orders as rows: what each node needs besides its parent, and who needs it.

use super::derive;
use mt_core::hierarchy::{Dependency, HierarchyError, VertexMesh};
use mt_core::order::{Order, OrderError, Rows, SparseRows};
use mt_core::{Bits, Coarsen, NodeId, Replay, Rule, View};

/// A static order on the nodes of a replay. What the forest implies is left out, so that rows are short: for
/// `dual-piece` two to four nodes in a hundred have one where edges collapse, up to eight where fans merge (the studies'
/// table of dependencies).
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    needs: SparseRows,
    dependents: SparseRows,
}

impl Stored {
    /// The order of these needs (node, needed), less those that the forest or another need implies.
    ///
    /// Refuses needs of no higher rank. O(entries log entries + squares of rows), and a bounded search for each need.
    pub(super) fn reduced(replay: &Replay, mut entries: Vec<(NodeId, NodeId)>) -> Result<Self, OrderError> {
        entries.sort_unstable();
        entries.dedup();
        let mut kept = Vec::new();
        for row in entries.chunk_by(|a, b| a.0 == b.0) {
            let m = row[0].0;
            for &(_, need) in row {
                if need.0 >= replay.len() || m.0 >= replay.len() {
                    return Err(OrderError::OutOfRange { node: m, other: need, count: replay.len() });
                }
                if need <= m {
                    return Err(OrderError::Rank { node: m, need });
                }
                // Refining a node takes all that is above it, so a need above the node or above another need adds nothing.
                let implied = replay.is_ancestor(need, m)
                    || row.iter().any(|&(_, other)| other != need && replay.is_ancestor(need, other));
                if !implied {
                    kept.push((m, need));
                }
            }
        }
        let rows = SparseRows::new(replay.len(), kept);
        let mut search = Search::new(replay);
        let direct = |&(m, need): &(NodeId, NodeId)| {
            let others = rows.row(m).iter().copied().filter(|&other| other != need);
            !search.leads(replay, &rows, replay.parent(m).into_iter().chain(others), need, NODES_MAX)
        };
        let needs = SparseRows::new(replay.len(), rows.entries().filter(direct).collect());
        let dependents = needs.transposed();
        Ok(Self { needs, dependents })
    }

    /// The explicit order over cells: a node needs those that replaced a cell that it had made.
    ///
    /// Deviation from `[DeFlorianiTutorial2002]`: the parent in the forest is always needed, which for half-edge collapses
    /// and fans is more than the cells ask for.
    pub fn explicit(replay: &Replay) -> Self {
        Self::derived(replay, derive::explicit(replay))
    }

    /// The order of `[XiaVarshney1996]`: all neighbours of the merged vertex are there, or refined.
    pub fn one_ring(replay: &Replay) -> Self {
        Self::derived(replay, derive::one_ring(replay))
    }

    /// The order of `[Hoppe1996]`: the two vertices opposite the edge are there, or refined.
    pub fn cut_pair(replay: &Replay) -> Result<Self, HierarchyError> {
        derive::require_manifold(replay, "cut-pair")?;
        Ok(Self::derived(replay, derive::cut_pair(replay)))
    }

    /// The order of `[Hoppe1997]`: the four triangles beside the two that the merge takes are there.
    ///
    /// At a boundary there are fewer. A triangle may be missing where the scheme would need it to be sound, so the needs of
    /// [`Self::dual_piece`] are always included; on closed meshes they add nothing.
    pub fn four_face(replay: &Replay) -> Result<Self, HierarchyError> {
        derive::require_manifold(replay, "four-face")?;
        let mut entries = derive::four_face(replay);
        entries.extend(derive::dual_piece(replay));
        Ok(Self::derived(replay, entries))
    }

    /// The order of `[KimLee2001]`: the lowest common ancestor of the two fundamental cut vertices.
    pub fn dual_piece(replay: &Replay) -> Result<Self, HierarchyError> {
        derive::require_manifold(replay, "dual-piece")?;
        Ok(Self::derived(replay, derive::dual_piece(replay)))
    }

    /// A user's own order, given as what each node needs; the parents need not be among them.
    ///
    /// Refused with a witness unless it contains [`Self::dual_piece`]. O(entries + nodes reached from the few that need more
    /// than their parent).
    pub fn of_user(replay: &Replay, needs: impl IntoIterator<Item = (NodeId, NodeId)>) -> Result<Self, HierarchyError> {
        derive::require_manifold(replay, "an order of your own")?;
        let order = Self::reduced(replay, needs.into_iter().collect())?;
        let sound = Self::dual_piece(replay)?;
        order.contains(replay, &sound).map_err(|(node, needed)| HierarchyError::Unsound { node, needed })?;
        Ok(order)
    }

    fn derived(replay: &Replay, entries: Vec<(NodeId, NodeId)>) -> Self {
        Self::reduced(replay, entries).expect("what is there at a merge is merged later")
    }

    /// What each node needs besides its parent.
    pub fn needs_rows(&self) -> &SparseRows {
        &self.needs
    }

    /// Whether every front that is closed here is closed in `other`; else a node, and what `other` wants for it.
    pub fn contains(&self, replay: &Replay, other: &Stored) -> Result<(), (NodeId, NodeId)> {
        let mut search = Search::new(replay);
        for (m, wanted) in other.needs.entries() {
            if !search.leads(replay, &self.needs, [m], wanted, usize::MAX) {
                return Err((m, wanted));
            }
        }
        Ok(())
    }

    /// The whole order, parents included, as rows in both directions. O(nodes + entries).
    pub fn order(&self, replay: &Replay) -> Order {
        let mut rows = Rows::default();
        let mut row = Vec::new();
        for m in (0..replay.len()).map(NodeId) {
            row.clear();
            row.extend(replay.parent(m));
            row.extend_from_slice(self.needs.row(m));
            row.sort_unstable();
            rows.push(row.iter().copied());
        }
        Order::from_needs(rows).expect("a stored order is one")
    }
}

/// How many nodes to look at before a need counts as one of its own: a row too many costs a few bytes, no more.
const NODES_MAX: usize = 64;

/// Searches along needs and parents, in buffers of its own.
struct Search {
    seen: Bits,
    met: Vec<NodeId>,
    open: Vec<NodeId>,
}

impl Search {
    fn new(replay: &Replay) -> Self {
        Self { seen: Bits::new(replay.len()), met: Vec::new(), open: Vec::new() }
    }

    /// Whether refining `from` refines `wanted`, as far as this many nodes tell.
    fn leads(
        &mut self,
        replay: &Replay,
        needs: &SparseRows,
        from: impl IntoIterator<Item = NodeId>,
        wanted: NodeId,
        nodes_max: usize,
    ) -> bool {
        self.open.extend(from);
        let mut found = false;
        while let Some(node) = self.open.pop().filter(|_| self.met.len() < nodes_max) {
            found = replay.is_ancestor(wanted, node);
            if found {
                break;
            }
            // Needs have larger ids: what lies above the wanted node cannot lead back to it.
            let above = replay.parent(node).into_iter().chain(needs.row(node).iter().copied());
            for need in above.filter(|&need| need <= wanted) {
                if self.seen.insert(need.0) {
                    self.met.push(need);
                    self.open.push(need);
                }
            }
        }
        self.open.clear();
        self.met.drain(..).for_each(|node| _ = self.seen.remove(node.0));
        found
    }
}

impl Dependency for Stored {
    const RULE: Rule = Rule::Static;

    #[inline]
    fn needs(&self, _: &Replay, m: NodeId, out: &mut Vec<NodeId>) {
        out.extend_from_slice(self.needs.row(m));
    }

    #[inline]
    fn prerequisites(&self, _: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) {
        out.extend(self.needs.row(m).iter().copied().filter(|&need| !view.front.is_refined(need)));
    }

    #[inline]
    fn obstacles(&self, _: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) -> Coarsen {
        let before = out.len();
        out.extend(self.dependents.row(m).iter().copied().filter(|&dependent| view.front.is_refined(dependent)));
        if out.len() == before { Coarsen::Now } else { Coarsen::After }
    }

    fn bytes(&self) -> usize {
        self.needs.bytes() + self.dependents.bytes()
    }
}
