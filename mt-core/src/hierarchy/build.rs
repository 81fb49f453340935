//! From a sequence of merges to a replay: the forest, its spans, what each node makes appear, and saturated bounds.

use super::mesh::VertexMesh;
use super::patch::{PatchBound, Surroundings};
use super::replay::{Born, Merge, Node, Replay, Runs, Span};
use super::sequence::Sequence;
use crate::bits::Bits;
use crate::bound::{Bound, Cone};
use crate::cell::{Cell, is_proper};
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::Mesh;
use glam::Vec3;

/// A sequence that is not one of merges of this mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InvalidSequence {
    /// It is one of another mesh.
    #[error("the sequence is one of a mesh of {told} vertices, not of {found}")]
    OtherMesh {
        /// Vertices that the sequence speaks of.
        told: u32,
        /// Vertices of the mesh.
        found: usize,
    },
    /// Arrays that go together differ in length, or a merge has no child.
    #[error("the array of {0} does not fit the others")]
    Shape(&'static str),
    /// A merge takes a vertex that is not there.
    #[error("merge {merge} takes vertex {vertex}, which is merged already or not made yet")]
    Taken {
        /// The merge, by number.
        merge: u32,
        /// The vertex.
        vertex: VertexId,
    },
    /// A position, error, radius or size is out of range.
    #[error("{what} {index} is not a finite number in range")]
    NotFinite {
        /// Of what.
        what: &'static str,
        /// Which.
        index: usize,
    },
    /// A triangle or link of the input has a corner that is no vertex, or one twice.
    #[error("cell {0} of the input has a corner that is no vertex, or one corner twice")]
    Corners(usize),
    /// A merge is said to keep its centre and puts the merged vertex elsewhere.
    #[error("merge {0} is said to keep its centre where it is, but moves it")]
    Moved(u32),
    /// More than 32-bit ids can name.
    #[error("more vertices, triangles or links than 32-bit ids can name")]
    TooLarge,
}

/// Why there is no vertex hierarchy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HierarchyError {
    /// The sequence is none.
    #[error(transparent)]
    Sequence(#[from] InvalidSequence),
    /// A scheme does not take this sequence.
    #[error("{scheme} does not take this sequence: {why}")]
    Unfit {
        /// The scheme.
        scheme: &'static str,
        /// What is in the way, with the first nodes concerned where it is nodes.
        why: String,
    },
    /// An order lacks something that soundness needs.
    #[error(
        "the order is unsound: node {node} must wait for node {needed}, which its needs do not lead to (the two cut vertices of node {node} would be one)"
    )]
    Unsound {
        /// The node that is refined too early.
        node: NodeId,
        /// What it must wait for.
        needed: NodeId,
    },
    /// Rows that are no order.
    #[error(transparent)]
    Order(#[from] crate::order::OrderError),
}

impl Replay {
    /// The replay of a sequence of merges of `mesh`, with the edges by which vertices are neighbours besides
    /// triangles (none for collapses and fans).
    ///
    /// O(vertices + triangles + the stars that the merges change).
    pub fn new(mesh: &Mesh<3>, links: &[Cell<2>], sequence: &Sequence) -> Result<Self, InvalidSequence> {
        check(mesh, links, sequence)?;
        let merged_at = forest(sequence)?;
        let (merges, ranks) = spans(sequence, &merged_at);
        let mut positions = mesh.positions.clone();
        positions.extend_from_slice(&sequence.positions);
        let nodes = sequence.children.iter().zip(&sequence.errors);
        let mut replay = Replay {
            cells: mesh.cells.clone(),
            links: links.to_vec(),
            positions,
            leaf_count: sequence.input_vertex_count,
            ranks: ranks_or_none(ranks),
            merged_at,
            merges,
            nodes: nodes.map(|(&child, &error)| Node { child, error, radius: 0.0, cone: Cone::EMPTY }).collect(),
            runs: runs(sequence),
            kept: kept(sequence),
            born: Born::Pairs(Vec::new()),
            born_links: Born::Pairs(Vec::new()),
            base_cells: Vec::new(),
            base_links: Vec::new(),
            roots: Vec::new(),
            sewn: Vec::new(),
            is_manifold: true,
        };
        replay.coarsen_all();
        replay.saturate();
        replay.roots = (0..replay.len()).map(NodeId).filter(|&m| replay.parent(m).is_none()).collect();
        let bad = replay.nodes.iter().position(|node| !node.radius.is_finite());
        bad.map_or(Ok(replay), |index| Err(InvalidSequence::NotFinite { what: "the radius of node", index }))
    }

    /// Takes every merge in turn: what dies at a node is what it makes appear; what is around it bounds it.
    fn coarsen_all(&mut self) {
        let mut mesh = VertexMesh::of_input(self);
        let mut patch = PatchBound::new(self);
        let mut around = Surroundings::default();
        let used = |v: &VertexId| mesh.faces.has_star(*v);
        let used: Vec<VertexId> = (0..self.leaf_count()).map(VertexId).filter(used).collect();
        self.is_manifold = used.iter().all(|&v| around.is_umbrella(&mesh, v));
        // A closed manifold so far: each link is one closed walk that passes no vertex twice.
        let mut is_closed = self.is_manifold && used.iter().all(|&v| around.is_cycle(&mesh, v));
        drop(used);
        let (mut starts, mut link_starts) = (vec![0], vec![0]);
        let (mut born, mut born_links) = (Vec::with_capacity(self.cells.len()), Vec::with_capacity(self.links.len()));
        for m in (0..self.len()).map(NodeId) {
            let radius = patch.fine(self, &mesh, m);
            let shared = around.shared(&mesh, self.ends(m));
            mesh.join(
                self,
                m,
                |_, _| {},
                |slot, is_link| if is_link { born_links.push(CellId(slot)) } else { born.push(CellId(slot)) },
            );
            for (start, cells) in [(&mut starts, &mut born), (&mut link_starts, &mut born_links)] {
                cells[start[m.index()] as usize..].sort_unstable();
                start.push(cells.len() as u32);
            }
            // A third neighbour in common is a loop that closes: a waist, or a hole with three edges.
            let died = born.len() - starts[m.index()] as usize;
            let closes = shared != died;
            // Two links that are cycles and have two vertices in common, besides each other's, are joined into a cycle; no
            // need to look, unless it is a cycle of two.
            let is_cycle = is_closed && !closes && died == 2 && mesh.faces.star(self.vertex(m)).nth(2).is_some();
            if !is_cycle {
                is_closed = false;
                if closes || !around.is_umbrella(&mesh, self.vertex(m)) {
                    self.sewn.push(m);
                }
            }
            let cone = patch.coarse(self, &mesh, m);
            let node = &mut self.nodes[m.index()];
            (node.radius, node.cone) = (radius, cone);
        }
        (self.born, self.born_links) = (Born::new(starts, born), Born::new(link_starts, born_links));
        self.base_cells = mesh.faces.cells().map(|(slot, corners)| (CellId(slot), *corners)).collect();
        self.base_links = mesh.links.cells().map(|(slot, ends)| (CellId(slot), *ends)).collect();
    }

    /// Grows each node's bound until it holds those under it; these have smaller ids, so one sweep does.
    fn saturate(&mut self) {
        for m in (0..self.len()).map(NodeId) {
            let Some(parent) = self.parent(m) else { continue };
            let (own, above) = (self.bound(m), self.bound(parent));
            let node = &mut self.nodes[parent.index()];
            node.error = node.error.max(own.error);
            node.cone = node.cone.union(own.cone);
            node.radius = radius_around(above.center, above.radius, &own);
        }
    }
}

/// The least radius, rounded up, of a sphere about `center` that holds `inner`, not below `radius`.
fn radius_around(center: Vec3, radius: f32, inner: &Bound) -> f32 {
    let apart = center.as_dvec3().distance(inner.center.as_dvec3());
    let reach = (apart + f64::from(inner.radius)) * (1.0 + 1e-14);
    let grown = if apart == 0.0 { inner.radius } else { (reach as f32).next_up() };
    radius.max(grown)
}

fn check(mesh: &Mesh<3>, links: &[Cell<2>], sequence: &Sequence) -> Result<(), InvalidSequence> {
    use InvalidSequence::{Corners, NotFinite, OtherMesh, Shape, TooLarge};
    if sequence.input_vertex_count as usize != mesh.vertex_count() {
        return Err(OtherMesh { told: sequence.input_vertex_count, found: mesh.vertex_count() });
    }
    let (merges, nodes) = (sequence.centers.len(), sequence.children.len());
    if mesh.vertex_count() + merges >= u32::MAX as usize
        || mesh.cell_count() >= u32::MAX as usize / 3
        || links.len() >= u32::MAX as usize / 2
    {
        return Err(TooLarge);
    }
    let starts = &sequence.starts;
    let ascends = starts.windows(2).all(|pair| pair[0] < pair[1]);
    if starts.len() != merges + 1 || starts[0] != 0 || starts[merges] as usize != nodes || !ascends {
        return Err(Shape("runs"));
    }
    if sequence.positions.len() != merges {
        return Err(Shape("positions"));
    }
    if sequence.errors.len() != nodes {
        return Err(Shape("errors"));
    }
    let not_finite = |p: &Vec3| !p.is_finite();
    if let Some(index) = mesh.positions.iter().chain(&sequence.positions).position(not_finite) {
        return Err(NotFinite { what: "the position of vertex", index });
    }
    if let Some(index) = sequence.errors.iter().position(|error| !(error.is_finite() && *error >= 0.0)) {
        return Err(NotFinite { what: "the error of node", index });
    }
    let place = |v: VertexId| {
        let made = v.index().checked_sub(mesh.vertex_count());
        made.map_or_else(|| mesh.positions.get(v.index()), |merge| sequence.positions.get(merge)).copied()
    };
    for merge in sequence.kept.iter().take_while(|&merge| (merge as usize) < merges) {
        let at = sequence.positions[merge as usize];
        // What the centre is, if it is anything, is checked with the forest.
        if place(sequence.centers[merge as usize]).is_some_and(|center| center != at) {
            return Err(InvalidSequence::Moved(merge));
        }
    }
    let fits = |v: &VertexId| v.index() < mesh.vertex_count();
    if let Some(index) = mesh.cells.iter().position(|cell| !(cell.iter().all(fits) && is_proper(cell))) {
        return Err(Corners(index));
    }
    if let Some(index) = links.iter().position(|link| !(link.iter().all(fits) && is_proper(link))) {
        return Err(Corners(mesh.cell_count() + index));
    }
    Ok(())
}

/// Of each vertex: where it is merged. Each merge may take what is there and not taken.
fn forest(sequence: &Sequence) -> Result<Vec<NodeId>, InvalidSequence> {
    let leaves = sequence.input_vertex_count;
    let mut merged_at = vec![NodeId::NONE; (leaves + sequence.merge_count()) as usize];
    for merge in 0..sequence.merge_count() {
        let (first, end) = (sequence.starts[merge as usize], sequence.starts[merge as usize + 1]);
        let children = (first..end).map(|m| (sequence.children[m as usize], m));
        for (vertex, m) in std::iter::once((sequence.centers[merge as usize], first)).chain(children) {
            if vertex.0 >= leaves + merge || !merged_at[vertex.index()].is_none() {
                return Err(InvalidSequence::Taken { merge, vertex });
            }
            merged_at[vertex.index()] = NodeId(m);
        }
    }
    Ok(merged_at)
}

/// The spans of the merged vertices, and the ranks of the leaves: roots one after the other, and under each vertex its
/// centre before its children.
fn spans(sequence: &Sequence, merged_at: &[NodeId]) -> (Vec<Merge>, Vec<u32>) {
    let leaves = sequence.input_vertex_count as usize;
    let merges = sequence.centers.len();
    let mut size = vec![1u32; leaves + merges];
    let parts = |merge: usize| {
        let children = sequence.starts[merge] as usize..sequence.starts[merge + 1] as usize;
        std::iter::once(sequence.centers[merge]).chain(sequence.children[children].iter().copied())
    };
    for merge in 0..merges {
        size[leaves + merge] = parts(merge).map(|v| size[v.index()]).sum();
    }
    let mut first = vec![0u32; leaves + merges];
    let mut next = 0;
    for v in (0..leaves + merges).filter(|&v| merged_at[v].is_none()) {
        first[v] = next;
        next += size[v];
    }
    for merge in (0..merges).rev() {
        let mut at = first[leaves + merge];
        for v in parts(merge) {
            first[v.index()] = at;
            at += size[v.index()];
        }
    }
    let span = |v: usize| Span { first: first[v], end: first[v] + size[v] };
    let made = (0..merges).map(|f| Merge { center: sequence.centers[f], span: span(leaves + f) }).collect();
    first.truncate(leaves);
    (made, first)
}

/// Ranks, or none where each leaf is numbered by its own.
pub(super) fn ranks_or_none(ranks: Vec<u32>) -> Vec<u32> {
    let numbered_so = ranks.iter().enumerate().all(|(v, &rank)| v as u32 == rank);
    if numbered_so { Vec::new() } else { ranks }
}

/// The merges that keep their centre, in no more memory than there are merges: a sequence that was heard has room to grow,
/// one that was read has none, and their replays are one.
fn kept(sequence: &Sequence) -> Bits {
    let merges = sequence.merge_count();
    let kept = || sequence.kept.iter().take_while(|&merge| merge < merges);
    let mut exact = Bits::new(if kept().next().is_some() { merges } else { 0 });
    kept().for_each(|merge| _ = exact.insert(merge));
    exact
}

fn runs(sequence: &Sequence) -> Runs {
    if sequence.centers.len() == sequence.children.len() {
        return Runs::Single;
    }
    let sizes = sequence.starts.windows(2).map(|pair| (pair[1] - pair[0]) as usize);
    let merge_of = sizes.enumerate().flat_map(|(merge, size)| std::iter::repeat_n(merge as u32, size)).collect();
    Runs::Many { starts: sequence.starts.clone(), merge_of }
}
