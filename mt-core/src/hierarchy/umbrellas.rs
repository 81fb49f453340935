//! Whether the triangles around a vertex are one umbrella, and which merges leave one that is not.
//!
//! Mostly nobody needs to look: see [`keeps_umbrellas`].

use super::replay::Replay;
use crate::bins::rows;
use crate::cell::{is_short_cycle, sides};
use crate::complex::Complex;
use crate::id::{NodeId, VertexId};
use std::ops::Range;

/// What the triangles around a vertex are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fan {
    /// One fan all around: the link is one closed walk that passes no vertex twice.
    Closed,
    /// One fan that begins at one of these neighbours and ends at the other.
    Open([VertexId; 2]),
    /// Several, none, or something else.
    Other,
}

/// Looks at links, in buffers of its own.
#[derive(Default)]
pub(super) struct Links {
    /// Neighbours, each with an edge of the link that has it.
    link: Vec<(VertexId, u32)>,
    open: Vec<VertexId>,
    seen: Vec<bool>,
}

impl Links {
    /// What triangles around a vertex are, by the edges opposite it. O(edges), where they agree on their sides, close and are
    /// a few; else O(edges log edges).
    pub(super) fn fan(&mut self, edges: &[[VertexId; 2]]) -> Fan {
        if is_short_cycle(edges) {
            return Fan::Closed;
        }
        self.link.clear();
        self.link.extend(edges.iter().enumerate().flat_map(|(at, ends)| ends.map(|w| (w, at as u32))));
        self.link.sort_unstable();
        let Some(&[start, _]) = edges.first() else { return Fan::Other };
        let mut ends = [VertexId::NONE; 2];
        let mut open = 0;
        for run in self.link.chunk_by(|a, b| a.0 == b.0) {
            if run.len() > 2 || run.len() == 1 && open == 2 {
                return Fan::Other;
            }
            if run.len() == 1 {
                ends[open] = run[0].0;
                open += 1;
            }
        }
        // Paths and cycles only; two triangles with the same three corners are a cycle of two edges.
        let doubled = open == 0 && edges.len() == 2;
        if doubled || self.reached(edges, start) != edges.len() {
            return Fan::Other;
        }
        if open == 0 { Fan::Closed } else { Fan::Open(ends) }
    }

    /// How many edges of the link can be walked to from `start`.
    fn reached(&mut self, edges: &[[VertexId; 2]], start: VertexId) -> usize {
        self.seen.clear();
        self.seen.resize(edges.len(), false);
        self.open.clear();
        self.open.push(start);
        let mut count = 0;
        while let Some(w) = self.open.pop() {
            let from = self.link.partition_point(|entry| entry.0 < w);
            for &(_, at) in self.link[from..].iter().take_while(|entry| entry.0 == w) {
                if !std::mem::replace(&mut self.seen[at as usize], true) {
                    count += 1;
                    self.open.extend(edges[at as usize].into_iter().filter(|&x| x != w));
                }
            }
        }
        count
    }
}

/// What the input is around some of its vertices.
pub(super) struct Input {
    /// Whether each of them that has triangles has one umbrella of them.
    pub(super) is_manifold: bool,
    /// The edges with one triangle that end at one of them; each once, where all is manifold.
    pub(super) border: Vec<[VertexId; 2]>,
}

/// Looks at the leaves of these ranks, around which there are no other triangles than these. O(triangles).
pub(super) fn look_at_input(replay: &Replay, leaves: Range<u32>, cells: &[u32]) -> Input {
    let count = leaves.len();
    let corners = || {
        let all = cells.iter().map(|&cell| &replay.cells[cell as usize]);
        all.flat_map(|cell| (0..3).map(move |i| (cell[i], sides(cell, i))))
    };
    let place = |v: VertexId| Some((replay.rank(v).wrapping_sub(leaves.start)) as usize).filter(|&place| place < count);
    let own = || corners().filter_map(|(v, edge)| Some((place(v)?, v, edge)));
    let (starts, edges) = rows(count, [VertexId::NONE; 2], own().map(|(place, _, edge)| (place, edge)));
    let mut leaf = vec![VertexId::NONE; count];
    own().for_each(|(place, v, _)| leaf[place] = v);
    let mut input = Input { is_manifold: true, border: Vec::new() };
    let mut links = Links::default();
    for (row, &v) in starts.windows(2).zip(&leaf).filter(|(_, v)| !v.is_none()) {
        match links.fan(&edges[row[0] as usize..row[1] as usize]) {
            Fan::Closed => {}
            // Once from one of its ends, if both are looked at.
            Fan::Open(ends) => {
                input.border.extend(ends.into_iter().filter(|&w| v < w || place(w).is_none()).map(|w| [v, w]))
            }
            Fan::Other => input.is_manifold = false,
        }
    }
    input
}

/// Whether no merge sews or pinches: see [`Replay::sewn`]. A yes is a proof; a no says that somebody has to look.
///
/// Put a cone over the boundary, one tip for all of it, so that the surface is closed; let the input be a manifold; and let every
/// node take just two triangles of the closed surface away, with different third corners, and leave three or more around its
/// vertex. That was asked while the triangles were followed, `border` of which are left of the cone.
///
/// Count the edges, as images of those of the input, alike ones once. There are three for two triangles at first. A node takes
/// two triangles away, and of edges the one between its ends and one for every neighbour that they have in common: two are there,
/// so it is three or more. What is lost beyond three never comes back. So if there are three edges for two triangles in the
/// end, no two ends ever had a third neighbour in common. Then two links that are cycles and meet in two vertices are joined
/// into one cycle, which has as many vertices as there are triangles left, three or more.
///
/// In the end there are as many if every edge of the base mesh has one triangle or two, those with one meet two by two, and the
/// cone has one triangle over each of these and no others. Modulo two, edges with one triangle are what has become of the
/// boundary, so each has a triangle of the cone: if the numbers agree, one. O(base mesh, sorted).
pub(super) fn keeps_umbrellas(replay: &Replay, border: usize) -> bool {
    let edges_of = |cell: [VertexId; 3]| (0..3).map(move |i| sides(&cell, i)).map(|[a, b]| [a.min(b), a.max(b)]);
    let mut edges: Vec<[VertexId; 2]> = replay.base_cells.iter().flat_map(|(_, cell)| edges_of(*cell)).collect();
    edges.sort_unstable();
    let mut open = Vec::new();
    for run in edges.chunk_by(|a, b| a == b) {
        match run {
            [edge] => open.extend_from_slice(edge),
            [_, _] => {}
            _ => return false,
        }
    }
    open.sort_unstable();
    open.len() == 2 * border && open.chunk_by(|a, b| a == b).all(|run| run.len() == 2)
}

/// The nodes that sew or pinch, by looking at all of them. O(stars of all merges; those that are no short walks sorted).
pub(super) fn sewn_by_looking(replay: &Replay) -> Vec<NodeId> {
    let mut mesh = Complex::new(replay.vertex_count() as usize, replay.cells());
    let (mut links, mut edges) = (Links::default(), Vec::new());
    // Of each vertex: the last node near whose first end it was, and the last near both of whose ends.
    let mut near = vec![[NodeId::NONE; 2]; replay.vertex_count() as usize];
    let mut ring = Vec::new();
    let mut sews = |m: NodeId| {
        let ([stays, child], into) = (replay.ends(m), replay.vertex(m));
        let born = replay.born(m).len();
        // The tip of the cone is a neighbour of both as well.
        let pinches = born == 2 && [stays, child].iter().all(|&end| is_on_border(&mesh, end, &mut ring));
        mesh.star(stays).for_each(|(slot, i)| sides(mesh.cell(slot), i).iter().for_each(|w| near[w.index()][0] = m));
        let mut shared = 0;
        for (slot, i) in mesh.star(child) {
            for w in sides(mesh.cell(slot), i) {
                let [first, both] = &mut near[w.index()];
                shared += usize::from(*first == m && *both != m);
                *both = if *first == m { m } else { *both };
            }
        }
        [stays, child]
            .into_iter()
            .filter(|&end| end != into)
            .for_each(|end| mesh.join_star(end, into, |_, _, _, _| {}));
        mesh.link_edges(into, &mut edges);
        pinches || shared != born || links.fan(&edges) == Fan::Other
    };
    (0..replay.len()).map(NodeId).filter(|m| sews(*m)).collect()
}

/// Whether an edge at `v` has one triangle.
fn is_on_border(mesh: &Complex<3>, v: VertexId, ring: &mut Vec<VertexId>) -> bool {
    ring.clear();
    mesh.star(v).for_each(|(slot, i)| ring.extend(sides(mesh.cell(slot), i)));
    ring.sort_unstable();
    ring.chunk_by(|a, b| a == b).any(|run| run.len() == 1)
}
