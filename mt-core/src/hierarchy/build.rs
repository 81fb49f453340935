//! From a sequence of merges to a replay: the forest, its spans, what each node makes appear, and saturated bounds.

use super::lives::{Found, Home, Portion, listen};
use super::portions::Portions;
use super::replay::{Born, Merge, Node, Replay, Runs, Span};
use super::sequence::Sequence;
use super::umbrellas::{Input, keeps_umbrellas, look_at_input, sewn_by_looking};
use crate::bins::Bins;
use crate::bits::Bits;
use crate::bound::{Bound, Cone};
use crate::cell::{Cell, is_proper};
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::Mesh;
use glam::Vec3;
use rayon::prelude::*;

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

/// Leaves of a portion: what is asked of so many nearly stays in a cache of a megabyte, and few nodes are across cuts. With a
/// third of that it is no faster.
const PORTION: u32 = 4096;

impl Replay {
    /// The replay of a sequence of merges of `mesh`, with the edges by which vertices are neighbours besides
    /// triangles (none for collapses and fans).
    ///
    /// O(vertices + triangles + the stars that the merges change).
    pub fn new(mesh: &Mesh<3>, links: &[Cell<2>], sequence: &Sequence) -> Result<Self, InvalidSequence> {
        Self::in_portions(mesh, links, sequence, PORTION).map(|(replay, _)| replay)
    }

    /// The same, whatever the number of leaves of a portion; and whether it was proved that nothing is sewn, so that nobody
    /// had to look.
    pub(super) fn in_portions(
        mesh: &Mesh<3>,
        links: &[Cell<2>],
        sequence: &Sequence,
        size: u32,
    ) -> Result<(Self, bool), InvalidSequence> {
        check(mesh, links, sequence)?;
        let merged_at = forest(sequence)?;
        let (merges, ranks) = spans(sequence, &merged_at);
        let nodes = sequence.children.par_iter().zip(&sequence.errors);
        let node = |(&child, &error): (&VertexId, &f32)| Node { child, error, radius: 0.0, cone: Cone::EMPTY };
        let (positions, cells) =
            rayon::join(|| [&mesh.positions[..], &sequence.positions].concat(), || mesh.cells.clone());
        let mut replay = Replay {
            cells,
            links: links.to_vec(),
            positions,
            leaf_count: sequence.input_vertex_count,
            ranks: ranks_or_none(ranks),
            merged_at,
            merges,
            nodes: nodes.map(node).collect(),
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
        let is_proved = replay.find_all(size);
        if !is_proved {
            replay.sewn = sewn_by_looking(&replay);
        }
        replay.find_links();
        replay.roots = (0..replay.len()).map(NodeId).filter(|&m| replay.parent(m).is_none()).collect();
        let bad = replay.nodes.iter().position(|node| !node.radius.is_finite());
        bad.map_or(Ok((replay, is_proved)), |index| {
            Err(InvalidSequence::NotFinite { what: "the radius of node", index })
        })
    }

    /// What each node makes appear and what bounds it, in portions of about so many leaves; and whether that proves that no
    /// node sews or pinches.
    fn find_all(&mut self, size: u32) -> bool {
        let portions = Portions::new(self, size);
        let all = portions.len();
        let homes = self.homes(&portions);
        let nodes = Bins::new(self.len(), all + 1, |m| [homes[m as usize].portion as usize]);
        let nodes: Vec<Vec<u32>> = (0..=all).into_par_iter().map(|portion| nodes.of(portion)).collect();
        let (input, found) = self.find_in(&portions, &homes, &nodes);
        drop(homes);
        self.take_in(&nodes, &found);
        // What is across the cuts holds what is not.
        nodes[all].iter().for_each(|&m| self.saturate(NodeId(m)));
        self.is_manifold = input.is_manifold;
        let border = input.border.len() - found.iter().map(|found| found.border_gone).sum::<usize>();
        let is_plain = input.is_manifold && found.iter().all(|found| found.is_plain);
        drop((input, found));
        is_plain && keeps_umbrellas(self, border)
    }

    /// The portion of each node, and its place there.
    fn homes(&self, portions: &Portions) -> Vec<Home> {
        let portion = |m| portions.of_span(self.merge(self.merge_of(NodeId(m))).span) as u32;
        let mut homes: Vec<Home> =
            (0..self.len()).into_par_iter().map(|m| Home { portion: portion(m), place: 0 }).collect();
        let mut counts = vec![0; portions.len() + 1];
        for home in &mut homes {
            let count = &mut counts[home.portion as usize];
            home.place = *count;
            *count += 1;
        }
        homes
    }

    /// Each portion by itself, by the threads of the rayon pool that this is called in; then what lies across the cuts, by the
    /// triangles that go so far. The same for any number of threads.
    fn find_in(&self, portions: &Portions, homes: &[Home], nodes: &[Vec<u32>]) -> (Input, Vec<Found>) {
        let across = portions.len();
        let of_corner = |v: VertexId| portions.of(self.rank(v));
        let cells = Bins::new(self.cells.len() as u32, across, |cell| self.cells[cell as usize].map(of_corner));
        let listen_to = |number: usize, cells: &[u32], border: &[[VertexId; 2]]| {
            let nodes = &nodes[number];
            listen(&Portion { replay: self, homes, across: across as u32, number: number as u32, nodes, cells, border })
        };
        let find_one = |number: usize| {
            let cells = cells.of(number);
            let input = look_at_input(self, portions.leaves(number), &cells);
            let found = listen_to(number, &cells, &input.border);
            (input, found)
        };
        let (inputs, mut found): (Vec<Input>, Vec<Found>) = (0..across).into_par_iter().map(find_one).unzip();
        drop(cells);
        let mut border: Vec<[VertexId; 2]> = inputs.iter().flat_map(|input| &input.border).copied().collect();
        border.iter_mut().for_each(|edge| edge.sort_unstable());
        border.sort_unstable();
        border.dedup();
        let mut crossing: Vec<u32> = found.iter_mut().flat_map(|found| std::mem::take(&mut found.crossed)).collect();
        crossing.sort_unstable();
        crossing.dedup();
        let border_across = if nodes[across].is_empty() { [].as_slice() } else { &border };
        found.push(listen_to(across, &crossing, border_across));
        (Input { is_manifold: inputs.iter().all(|input| input.is_manifold), border }, found)
    }

    /// Puts together what was found: of these nodes, portion by portion.
    fn take_in(&mut self, nodes: &[Vec<u32>], found: &[Found]) {
        let mut starts = vec![0; self.nodes.len() + 1];
        for (nodes, found) in nodes.iter().zip(found) {
            for ((&m, node), row) in nodes.iter().zip(&found.nodes).zip(found.starts.windows(2)) {
                self.nodes[m as usize] = *node;
                starts[m as usize + 1] = row[1] - row[0];
            }
        }
        (0..self.nodes.len()).for_each(|m| starts[m + 1] += starts[m]);
        let mut born = vec![CellId::NONE; starts[self.nodes.len()] as usize];
        for (nodes, found) in nodes.iter().zip(found) {
            for (&m, row) in nodes.iter().zip(found.starts.windows(2)) {
                let row = &found.born[row[0] as usize..row[1] as usize];
                born[starts[m as usize] as usize..][..row.len()].copy_from_slice(row);
            }
        }
        let mut is_base = vec![true; self.cells.len()];
        born.iter().for_each(|cell| is_base[cell.index()] = false);
        self.born = Born::new(starts, born);
        let base = (0..self.cells.len()).filter(|&cell| is_base[cell]).map(CellId::new);
        self.base_cells = base.map(|cell| (cell, self.cells[cell.index()].map(|v| self.root(v)))).collect();
    }

    /// At which nodes links appear, and what is left of them.
    fn find_links(&mut self) {
        let deaths: Vec<NodeId> = self.links.iter().map(|link| self.joined_at(*link)).collect();
        let mut by_node: Vec<u32> = (0..self.links.len() as u32).filter(|&i| !deaths[i as usize].is_none()).collect();
        by_node.sort_by_key(|&link| deaths[link as usize]);
        let mut starts = vec![0; self.nodes.len() + 1];
        by_node.iter().for_each(|&link| starts[deaths[link as usize].index() + 1] += 1);
        (0..self.nodes.len()).for_each(|m| starts[m + 1] += starts[m]);
        self.born_links = Born::new(starts, by_node.into_iter().map(CellId).collect());
        let base = (0..self.links.len()).filter(|&link| deaths[link].is_none());
        self.base_links = base.map(|link| (CellId::new(link), self.links[link].map(|v| self.root(v)))).collect();
    }

    /// The vertex without a node above it that `v` is under. O(depth).
    fn root(&self, mut v: VertexId) -> VertexId {
        while !self.merged_at(v).is_none() {
            v = self.vertex(self.merged_at(v));
        }
        v
    }

    /// The node that makes two vertices one; none where nothing does. O(depth).
    fn joined_at(&self, [mut a, mut b]: [VertexId; 2]) -> NodeId {
        loop {
            // What is merged first cannot be under the other.
            let earlier = if self.merged_at(a) <= self.merged_at(b) { &mut a } else { &mut b };
            let node = self.merged_at[earlier.index()];
            if node.is_none() {
                return NodeId::NONE;
            }
            *earlier = VertexId(self.leaf_count + self.merge_of(node));
            if a == b {
                return node;
            }
        }
    }

    /// Grows a node's bound until it holds those under it, which have smaller ids.
    fn saturate(&mut self, m: NodeId) {
        let mut node = self.nodes[m.index()];
        grow(&mut node, self, m, |child| self.bound(child));
        self.nodes[m.index()] = node;
    }
}

/// Grows the bound of node `m` until it holds those of the nodes under it, in their order.
pub(super) fn grow(node: &mut Node, replay: &Replay, m: NodeId, bound_of: impl Fn(NodeId) -> Bound) {
    let center = replay.positions[replay.vertex(m).index()];
    let mut under = [None; 2];
    under.iter_mut().zip(replay.children(m)).for_each(|(place, child)| *place = Some(child));
    under.sort_unstable();
    under.into_iter().flatten().for_each(|child| include(node, center, &bound_of(child)));
}

/// Grows the bound of a node about `center` until it holds that of one under it.
pub(super) fn include(node: &mut Node, center: Vec3, under: &Bound) {
    node.error = node.error.max(under.error);
    node.cone = node.cone.union(under.cone);
    node.radius = radius_around(center, node.radius, under);
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
