//! The forest of merges over an input mesh: what each node changes, and who is above whom.

use super::mesh::VertexMesh;
use crate::bits::Bits;
use crate::bound::{Bound, Cone};
use crate::cell::Cell;
use crate::front::Front;
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::Mesh;
use crate::model::View;
use glam::Vec3;
use std::ops::RangeInclusive;

/// Leaf ranks `first..end`: the input vertices under a vertex of the forest.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Span {
    /// The first rank.
    pub first: u32,
    /// One after the last.
    pub end: u32,
}

impl Span {
    /// Whether the leaf of this rank is under the vertex.
    #[inline]
    pub fn contains(self, rank: u32) -> bool {
        // One comparison: what is below `first` wraps around.
        rank.wrapping_sub(self.first) < self.end - self.first
    }

    /// Whether `other` is within this span.
    #[inline]
    pub fn covers(self, other: Span) -> bool {
        self.first <= other.first && other.end <= self.end
    }
}

/// A merge: the vertex that others join, and the span of the merged vertex.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Merge {
    /// The vertex that the children join.
    pub center: VertexId,
    /// The leaves under the merged vertex: those of the centre, then those of the children in their order.
    pub span: Span,
}

const _: () = assert!(size_of::<Merge>() == 12);

/// A node: one vertex joins a merge.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Node {
    /// The vertex that joins.
    pub child: VertexId,
    /// Error afterwards, not below that of any node under this one; in model units.
    pub error: f32,
    /// Radius of a sphere around the merged vertex that holds the patch and the spheres of all nodes under this one.
    pub radius: f32,
    /// Normals of the patch and of all patches under this node.
    pub cone: Cone,
}

const _: () = assert!(size_of::<Node>() == 16);

/// The runs of merges: which nodes belong to which merge.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Runs {
    /// Every merge has one node, of the same number.
    Single,
    /// The first node of each merge, and one more; and the merge of each node.
    Many { starts: Vec<u32>, merge_of: Vec<u32> },
}

/// The cells that each node makes appear.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Born {
    /// One or two each, as on manifolds; where there is one, the second is none.
    Pairs(Vec<[CellId; 2]>),
    /// Any number: where the cells of each node begin, with one more entry than nodes, and the cells.
    Rows(Vec<u32>, Vec<CellId>),
}

impl Born {
    /// The shorter of the two forms.
    pub(super) fn new(start: Vec<u32>, cells: Vec<CellId>) -> Self {
        let nodes = start.len() - 1;
        if cells.is_empty() {
            return Self::Pairs(Vec::new());
        }
        let is_links = start.windows(2).all(|row| (1..=2).contains(&(row[1] - row[0])));
        if !is_links || cells.len() < nodes {
            return Self::Rows(start, cells);
        }
        let row = |at: &[u32]| {
            [cells[at[0] as usize], if at[1] - at[0] == 2 { cells[at[0] as usize + 1] } else { CellId::NONE }]
        };
        Self::Pairs(start.windows(2).map(row).collect())
    }

    #[inline]
    fn row(&self, m: NodeId) -> &[CellId] {
        match self {
            Self::Pairs(pairs) => match pairs.get(m.index()) {
                Some([_, second]) if !second.is_none() => &pairs[m.index()],
                Some(one) => &one[..1],
                None => &[],
            },
            Self::Rows(start, cells) => &cells[start[m.index()] as usize..start[m.index() + 1] as usize],
        }
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Pairs(pairs) => 8 * pairs.len(),
            Self::Rows(start, cells) => 4 * (start.len() + cells.len()),
        }
    }
}

/// A sequence of merges that can be replayed both ways at any vertex. Immutable, and the same for every dependency.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    pub(super) cells: Vec<Cell<3>>,
    pub(super) links: Vec<Cell<2>>,
    /// Of the input's vertices, then of the merged ones.
    pub(super) positions: Vec<Vec3>,
    /// Number of input vertices.
    pub(super) leaf_count: u32,
    /// Leaf rank of each input vertex; empty where they are numbered by rank.
    pub(super) ranks: Vec<u32>,
    /// Of each vertex of the forest: the node at which it stops being one of its own.
    pub(super) merged_at: Vec<NodeId>,
    pub(super) merges: Vec<Merge>,
    pub(super) nodes: Vec<Node>,
    pub(super) runs: Runs,
    pub(super) kept: Bits,
    pub(super) born: Born,
    /// The links; empty where there are none.
    pub(super) born_links: Born,
    pub(super) base_cells: Vec<(CellId, Cell<3>)>,
    pub(super) base_links: Vec<(CellId, Cell<2>)>,
    pub(super) roots: Vec<NodeId>,
    pub(super) sewn: Vec<NodeId>,
    pub(super) is_manifold: bool,
}

impl Replay {
    /// Number of nodes.
    #[inline]
    pub fn len(&self) -> u32 {
        self.nodes.len() as u32
    }

    /// Whether nothing was merged.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Number of vertices of the input, which are the leaves.
    #[inline]
    pub fn leaf_count(&self) -> u32 {
        self.leaf_count
    }

    /// Number of merges.
    pub fn merge_count(&self) -> u32 {
        self.merges.len() as u32
    }

    /// Number of vertices of the forest, leaves included.
    pub fn vertex_count(&self) -> u32 {
        self.positions.len() as u32
    }

    /// Positions of the input's vertices and of the merged ones.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// The triangles of the input.
    pub fn cells(&self) -> &[Cell<3>] {
        &self.cells
    }

    /// The links of the input.
    pub fn links(&self) -> &[Cell<2>] {
        &self.links
    }

    /// The input, bit for bit.
    pub fn reference(&self) -> Mesh<3> {
        Mesh { positions: self.positions[..self.leaf_count as usize].to_vec(), cells: self.cells.clone() }
    }

    /// What joins at `m`, and how good the mesh is afterwards.
    #[inline]
    pub fn node(&self, m: NodeId) -> &Node {
        &self.nodes[m.index()]
    }

    /// The merge that `m` belongs to, by number.
    #[inline]
    pub fn merge_of(&self, m: NodeId) -> u32 {
        match &self.runs {
            Runs::Single => m.0,
            Runs::Many { merge_of, .. } => merge_of[m.index()],
        }
    }

    /// The merge of this number.
    #[inline]
    pub fn merge(&self, merge: u32) -> &Merge {
        &self.merges[merge as usize]
    }

    /// Whether a merge leaves its centre where it is, and the cells of the centre alone.
    pub fn keeps_center(&self, merge: u32) -> bool {
        merge < self.kept.capacity() && self.kept.contains(merge)
    }

    /// The nodes of a merge.
    #[inline]
    pub fn run_of(&self, merge: u32) -> RangeInclusive<NodeId> {
        match &self.runs {
            Runs::Single => NodeId(merge)..=NodeId(merge),
            Runs::Many { starts, .. } => NodeId(starts[merge as usize])..=NodeId(starts[merge as usize + 1] - 1),
        }
    }

    /// Whether each merge is one node.
    pub fn is_single(&self) -> bool {
        self.runs == Runs::Single
    }

    /// The vertex that `m` makes: there as soon as the first node of the merge is coarsened.
    #[inline]
    pub fn vertex(&self, m: NodeId) -> VertexId {
        VertexId(self.leaf_count() + self.merge_of(m))
    }

    /// The two vertices that `m` makes one: the one that stays, and the child. What stays is the centre of the merge, or the
    /// merged vertex itself while others of its run are coarse.
    #[inline]
    pub fn ends(&self, m: NodeId) -> [VertexId; 2] {
        let merge = self.merge_of(m);
        let is_first = m == *self.run_of(merge).start();
        let stays = if is_first { self.merges[merge as usize].center } else { VertexId(self.leaf_count() + merge) };
        [stays, self.nodes[m.index()].child]
    }

    /// Replays the whole analysis: coarsens node after node from the input, and shows each with the mesh just before it.
    /// O(stars of all merges).
    pub fn sweep(&self, mut visit: impl FnMut(NodeId, &View<VertexMesh>)) {
        let mut view = View { front: Front::reference(self.len()), mesh: self.reference_mesh() };
        for m in (0..self.len()).map(NodeId) {
            visit(m, &view);
            self.coarsen(m, &mut view.mesh, &mut ());
            view.front.set(m, false);
        }
    }

    /// The merge that makes a vertex; `None` for leaves.
    #[inline]
    pub fn merge_making(&self, v: VertexId) -> Option<u32> {
        v.0.checked_sub(self.leaf_count())
    }

    /// The node at which `v` stops being a vertex of its own; none for roots.
    #[inline]
    pub fn merged_at(&self, v: VertexId) -> NodeId {
        self.merged_at[v.index()]
    }

    /// Whether the input is a manifold and stays one at every merge.
    pub fn is_manifold(&self) -> bool {
        self.is_manifold && self.sewn.is_empty()
    }

    /// The nodes that sew sheets together or pinch them: those whose merged vertex is not the centre of one umbrella, whose ends
    /// have a neighbour in common that is no corner of a triangle that dies, or are both on the boundary while the edge between
    /// them is not.
    pub fn sewn(&self) -> &[NodeId] {
        &self.sewn
    }

    /// The nodes without a parent.
    pub fn roots(&self) -> &[NodeId] {
        &self.roots
    }

    /// The node that `m` needs because of the forest; `None` for roots.
    #[inline]
    pub fn parent(&self, m: NodeId) -> Option<NodeId> {
        let merge = self.merge_of(m);
        let last = *self.run_of(merge).end();
        let above = if m < last { NodeId(m.0 + 1) } else { self.merged_at(VertexId(self.leaf_count() + merge)) };
        (!above.is_none()).then_some(above)
    }

    /// The nodes whose parent is `m`, at most two.
    #[inline]
    pub fn children(&self, m: NodeId) -> impl Iterator<Item = NodeId> + use<> {
        let merge = self.merge_of(m);
        let first = *self.run_of(merge).start();
        let last_of = |v| self.merge_making(v).map(|merge| *self.run_of(merge).end());
        let of_center = if m == first { last_of(self.merges[merge as usize].center) } else { Some(NodeId(m.0 - 1)) };
        [of_center, last_of(self.nodes[m.index()].child)].into_iter().flatten()
    }

    /// The leaves under a vertex.
    #[inline]
    pub fn span(&self, v: VertexId) -> Span {
        match self.merge_making(v) {
            Some(merge) => self.merges[merge as usize].span,
            None => {
                let rank = self.rank(v);
                Span { first: rank, end: rank + 1 }
            }
        }
    }

    /// The leaves under the vertex of `m` when `m` is coarse and the rest of its run is not.
    #[inline]
    pub fn span_at(&self, m: NodeId) -> Span {
        let first = self.merges[self.merge_of(m) as usize].span.first;
        Span { first, end: self.span(self.nodes[m.index()].child).end }
    }

    /// The rank of an input vertex among the leaves.
    #[inline]
    pub fn rank(&self, leaf: VertexId) -> u32 {
        if self.ranks.is_empty() { leaf.0 } else { self.ranks[leaf.index()] }
    }

    /// Whether `above` is `m` or needs to be refined before it because of the forest. O(1).
    #[inline]
    pub fn is_ancestor(&self, above: NodeId, m: NodeId) -> bool {
        self.span_at(above).covers(self.span_at(m))
    }

    /// The triangles that appear when `m` is refined.
    #[inline]
    pub fn born(&self, m: NodeId) -> &[CellId] {
        self.born.row(m)
    }

    /// The links that appear when `m` is refined.
    #[inline]
    pub fn born_links(&self, m: NodeId) -> &[CellId] {
        self.born_links.row(m)
    }

    /// The node whose vertex `v` is at this front: the last one of its run that is coarse. `None` for leaves.
    /// O(log run).
    #[inline]
    pub fn latest(&self, v: VertexId, front: &Front) -> Option<NodeId> {
        let run = self.run_of(self.merge_making(v)?);
        // Within a run each node needs the next, so what is refined comes last.
        let (mut low, mut high) = (run.start().0, run.end().0 + 1);
        while low < high {
            let middle = low + (high - low) / 2;
            if front.is_refined(NodeId(middle)) { high = middle } else { low = middle + 1 }
        }
        (low > run.start().0).then(|| NodeId(low - 1))
    }

    /// The node at which `v` changes next when coarsening: the next one of its run, or the one at which it is merged.
    #[inline]
    pub fn next(&self, v: VertexId, front: &Front) -> NodeId {
        match self.latest(v, front) {
            Some(m) if m < *self.run_of(self.merge_of(m)).end() => NodeId(m.0 + 1),
            _ => self.merged_at(v),
        }
    }

    /// The bound of `m`: a sphere around its vertex.
    #[inline]
    pub fn bound(&self, m: NodeId) -> Bound {
        let Node { error, radius, cone, .. } = self.nodes[m.index()];
        Bound { center: self.positions[self.vertex(m).index()], radius, error, cone }
    }

    /// The input as a mesh of a view.
    pub fn reference_mesh(&self) -> VertexMesh {
        VertexMesh::of_input(self)
    }

    /// Bytes of each array beyond the input mesh, by name.
    pub fn bytes_table(&self) -> Vec<(&'static str, usize)> {
        let runs = match &self.runs {
            Runs::Single => 0,
            Runs::Many { starts, merge_of } => 4 * (starts.len() + merge_of.len()),
        };
        let cones = size_of::<Cone>() * self.nodes.len();
        vec![
            ("positions of merged vertices", 12 * self.merges.len()),
            ("centres and spans", size_of::<Merge>() * self.merges.len()),
            ("children, errors, radii", size_of::<Node>() * self.nodes.len() - cones),
            ("normal cones", cones),
            ("parents", 4 * self.merged_at.len()),
            ("leaf ranks", 4 * self.ranks.len()),
            ("runs", runs),
            ("triangles of each node", self.born.bytes()),
            ("links", 8 * self.links.len() + self.born_links.bytes()),
            ("kept centres", 8 * self.kept.words().len()),
            (
                "base mesh",
                16 * self.base_cells.len() + 12 * self.base_links.len() + 4 * (self.roots.len() + self.sewn.len()),
            ),
        ]
    }

    /// Bytes of the hierarchy, without the input mesh and without any dependency.
    pub fn bytes(&self) -> usize {
        self.bytes_table().iter().map(|(_, bytes)| bytes).sum()
    }
}
