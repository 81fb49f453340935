//! The current mesh of a vertex hierarchy: triangles, links and who is active, changed star by star.

use super::replay::Replay;
use crate::bits::Bits;
use crate::cell::Cell;
use crate::complex::{Complex, Slot};
use crate::id::{CellId, NodeId, VertexId};
use crate::model::Sink;

/// Run-time state of a view of a vertex hierarchy. A slot is a cell of the input.
///
/// Per triangle of the input 32 bytes, per link 32, per vertex of the forest 4 and a bit, and 4 more where there are links.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexMesh {
    /// The triangles.
    pub faces: Complex<3>,
    /// Edges by which vertices are neighbours besides triangles, such as virtual ones.
    pub links: Complex<2>,
    /// The vertices of the forest that stand for their leaves now.
    pub active: Bits,
}

impl VertexMesh {
    pub(super) fn of_input(replay: &Replay) -> Self {
        let vertices = replay.vertex_count();
        let mut active = Bits::new(vertices);
        (0..replay.leaf_count()).for_each(|v| _ = active.insert(v));
        let linked = if replay.links.is_empty() { 0 } else { vertices as usize };
        Self {
            faces: Complex::new(vertices as usize, &replay.cells),
            links: Complex::new(linked, &replay.links),
            active,
        }
    }

    pub(super) fn of_base(replay: &Replay) -> Self {
        let vertices = replay.vertex_count();
        let mut active = Bits::new(vertices);
        (0..vertices).filter(|&v| replay.merged_at[v as usize].is_none()).for_each(|v| _ = active.insert(v));
        let linked = if replay.links.is_empty() { 0 } else { vertices as usize };
        let mut faces = Complex::vacant(vertices as usize, replay.cells.len());
        let mut links = Complex::vacant(linked, replay.links.len());
        replay.base_cells.iter().for_each(|(cell, corners)| faces.put(cell.0, *corners));
        replay.base_links.iter().for_each(|(link, ends)| links.put(link.0, *ends));
        Self { faces, links, active }
    }

    /// Whether `v` stands for its leaves.
    #[inline]
    pub fn is_active(&self, v: VertexId) -> bool {
        self.active.contains(v.0)
    }

    /// The vertices that share a triangle or a link with `v`, some more than once.
    #[inline]
    pub fn ring(&self, v: VertexId) -> impl Iterator<Item = VertexId> + '_ {
        let faces = self.faces.star(v).flat_map(move |(slot, i)| {
            let cell = self.faces.cell(slot);
            [cell[(i + 1) % 3], cell[(i + 2) % 3]]
        });
        let linked = v.index() < self.links.vertex_count();
        let links = linked.then(|| self.links.star(v).map(|(slot, i)| self.links.cell(slot)[1 - i]));
        faces.chain(links.into_iter().flatten())
    }

    /// The active vertex above an input vertex. O(depth).
    pub fn above(&self, replay: &Replay, leaf: VertexId) -> VertexId {
        let mut v = leaf;
        while !self.is_active(v) {
            v = replay.vertex(replay.merged_at(v));
        }
        v
    }

    /// The active vertex above an input vertex that is expected around one of these: O(rings) by spans, else O(depth).
    #[inline]
    pub fn above_near(&self, replay: &Replay, leaf: VertexId, near: &[VertexId]) -> VertexId {
        // The span of a fan that is merged in part takes in children that are vertices of their own; fan forests are low.
        if !replay.is_single() {
            return self.above(replay, leaf);
        }
        let rank = replay.rank(leaf);
        near.iter().find_map(|&v| self.neighbour_above(replay, rank, v)).unwrap_or_else(|| self.above(replay, leaf))
    }

    /// The neighbour of `v` across a triangle under which the leaf of this rank is. Around an inner vertex each neighbour
    /// follows it in one triangle, so the other corners are asked only where that finds none.
    #[inline]
    fn neighbour_above(&self, replay: &Replay, rank: u32, v: VertexId) -> Option<VertexId> {
        for corner in [1, 2] {
            for (slot, i) in self.faces.star(v) {
                let w = self.faces.cell(slot)[(i + corner) % 3];
                if replay.span(w).contains(rank) {
                    return Some(w);
                }
            }
        }
        None
    }

    #[inline]
    fn part(&mut self, replay: &Replay, m: NodeId, sink: &mut impl Sink<3>) {
        let parts = Parts::new(replay, m);
        let Parts { vertex, center, child, .. } = parts;
        self.faces.part_star(
            vertex,
            |slot, i| parts.side(replay, replay.cells[slot as usize][i]).unwrap_or(center),
            |slot, corners| sink.relabel(CellId(slot), *corners),
        );
        for &cell in replay.born(m) {
            let corners = replay.cells[cell.index()].map(|leaf| {
                parts.side(replay, leaf).unwrap_or_else(|| self.above_near(replay, leaf, &[child, center]))
            });
            self.faces.put(cell.0, corners);
            sink.make(cell, corners);
        }
        if !replay.links.is_empty() {
            self.part_links(replay, m, &parts);
        }
        if center != vertex {
            self.active.remove(vertex.0);
            self.active.insert(center.0);
        }
        self.active.insert(child.0);
    }

    fn part_links(&mut self, replay: &Replay, m: NodeId, parts: &Parts) {
        let side = |slot: Slot, i| parts.side(replay, replay.links[slot as usize][i]).unwrap_or(parts.center);
        self.links.part_star(parts.vertex, side, |_, _| {});
        for &link in replay.born_links(m) {
            let ends: Cell<2> = replay.links[link.index()].map(|leaf| parts.side(replay, leaf).expect("an end of it"));
            self.links.put(link.0, ends);
        }
    }

    #[inline]
    fn unite(&mut self, replay: &Replay, m: NodeId, sink: &mut impl Sink<3>) {
        for &cell in replay.born(m) {
            self.faces.remove(cell.0);
            sink.kill(cell);
        }
        for &link in replay.born_links(m) {
            self.links.remove(link.0);
        }
        let Parts { vertex, center, child, .. } = Parts::new(replay, m);
        for from in [center, child] {
            if from == vertex {
                continue;
            }
            self.faces.join_star(from, vertex, |slot, _, corners, lives| {
                if lives {
                    sink.relabel(CellId(slot), *corners);
                }
            });
            if !replay.links.is_empty() {
                self.links.join_star(from, vertex, |_, _, _, _| {});
            }
            self.active.remove(from.0);
        }
        self.active.insert(vertex.0);
    }
}

impl Replay {
    /// Takes the child of `m` out of its vertex. Requires: the vertex is active, and `m` the latest coarse node of its run.
    ///
    /// O(star), where the vertex across a triangle that appears is one of the ring; else, and for fans, O(depth) besides.
    /// Without allocation or hashing.
    #[inline]
    pub fn refine(&self, m: NodeId, mesh: &mut VertexMesh, sink: &mut impl Sink<3>) {
        mesh.part(self, m, sink);
    }

    /// Puts the child of `m` into its vertex. Requires: child and centre are active, where the centre of a run that is
    /// coarse in part is the merged vertex. O(stars), without allocation or hashing.
    #[inline]
    pub fn coarsen(&self, m: NodeId, mesh: &mut VertexMesh, sink: &mut impl Sink<3>) {
        mesh.unite(self, m, sink);
    }
}

/// What a node does to names: the vertex falls into the centre, which may be itself, and the child.
struct Parts {
    vertex: VertexId,
    /// What stays when the child goes: the vertex itself while others of the run are merged, else the centre.
    center: VertexId,
    child: VertexId,
    of_center: super::Span,
    of_child: super::Span,
}

impl Parts {
    #[inline]
    fn new(replay: &Replay, m: NodeId) -> Self {
        let [center, child] = replay.ends(m);
        let of_child = replay.span(child);
        let merge = replay.merge(replay.merge_of(m));
        let vertex = replay.vertex(m);
        let of_center = super::Span { first: merge.span.first, end: of_child.first };
        Self { vertex, center, child, of_center, of_child }
    }

    /// On which side an input vertex is, if it is under the vertex at all.
    #[inline]
    fn side(&self, replay: &Replay, leaf: VertexId) -> Option<VertexId> {
        let rank = replay.rank(leaf);
        if self.of_child.contains(rank) {
            Some(self.child)
        } else {
            self.of_center.contains(rank).then_some(self.center)
        }
    }
}
