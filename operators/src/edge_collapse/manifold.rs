//! Is it a manifold? Judged by umbrellas at vertices, not by counting edges.

use mt_core::analysis::Unfit;
use mt_core::cell::is_short_cycle;
use mt_core::{Bits, Complex, Slot, VertexId};
use rayon::prelude::*;
use std::ops::Range;

/// An edge of a manifold.
pub(crate) struct ManifoldEdge {
    /// Its ends, ascending.
    pub(crate) ends: [VertexId; 2],
    /// Its triangle, where it has only one.
    border: Option<Slot>,
    /// Whether its triangles pass it in opposite directions; also true on the boundary.
    pub(crate) coherent: bool,
}

impl ManifoldEdge {
    /// An edge with a triangle on either side, which agree on them.
    fn inner(ends: [VertexId; 2]) -> Self {
        Self { ends, border: None, coherent: true }
    }

    /// The edge and its triangle, where it has only one.
    pub(crate) fn on_border(&self) -> Option<(&Self, Slot)> {
        Some((self, self.border?))
    }
}

/// So many vertices are looked at by one thread at a time.
const VERTICES: usize = 8192;

/// What a look at some vertices found.
#[derive(Default)]
struct Found {
    edges: Vec<ManifoldEdge>,
    bad_edges: Vec<[VertexId; 2]>,
    bad_vertices: Vec<VertexId>,
}

/// All edges by their lower ends, or what is in the way: edges with more than two triangles, vertices with more than one
/// umbrella. O(triangles × degree). By the threads of the rayon pool that this is called in; with the same answer for any
/// number of them.
pub(crate) fn check(complex: &Complex<3>) -> Result<Vec<ManifoldEdge>, Unfit> {
    let runs = (0..complex.vertex_count()).into_par_iter().step_by(VERTICES);
    let parts: Vec<Found> = runs.map(|from| look(complex, from..complex.vertex_count().min(from + VERTICES))).collect();
    let mut bad_edges: Vec<[VertexId; 2]> = Vec::new();
    let mut bad_vertices: Vec<VertexId> = Vec::new();
    let mut edges = Vec::with_capacity(parts.iter().map(|found| found.edges.len()).sum());
    for found in parts {
        edges.extend(found.edges);
        bad_edges.extend(found.bad_edges);
        bad_vertices.extend(found.bad_vertices);
    }
    let mut on_bad_edge = Bits::new(complex.vertex_count() as u32);
    bad_edges.iter().flatten().for_each(|v| _ = on_bad_edge.insert(v.0));
    bad_vertices.retain(|v| !on_bad_edge.contains(v.0));
    if bad_edges.is_empty() && bad_vertices.is_empty() {
        return Ok(edges);
    }
    let edge_places = places(bad_edges.iter().map(|[u, v]| format!("{u}-{v}")), bad_edges.len());
    let vertex_places = places(bad_vertices.iter().map(VertexId::to_string), bad_vertices.len());
    Err(Unfit::NonManifold { edges: bad_edges.len(), edge_places, vertices: bad_vertices.len(), vertex_places })
}

/// Looks at these vertices, and at the edges of which they are the lower ends.
fn look(complex: &Complex<3>, vertices: Range<usize>) -> Found {
    let mut found = Found::default();
    let (mut sides, mut walk) = (Vec::new(), Vec::new());
    for v in vertices.map(VertexId::new).filter(|&v| complex.has_star(v)) {
        complex.link_edges(v, &mut walk);
        if is_short_cycle(&walk) {
            // Each neighbour begins one edge of the link, and the edge to it has the triangle before and that after.
            let from = found.edges.len();
            found.edges.extend(walk.iter().filter(|side| side[0] > v).map(|&[w, _]| ManifoldEdge::inner([v, w])));
            found.edges[from..].sort_unstable_by_key(|edge| edge.ends);
            continue;
        }
        sides_above(complex, v, &mut sides);
        for run in sides.chunk_by(|a, b| a.0 == b.0) {
            let ends = [v, run[0].0];
            if run.len() > 2 {
                found.bad_edges.push(ends);
            }
            let coherent = run.len() == 1 || run[0].1 != run[1].1;
            found.edges.push(ManifoldEdge { ends, border: (run.len() == 1).then_some(run[0].2), coherent });
        }
        if !one_umbrella(&mut walk) {
            found.bad_vertices.push(v);
        }
    }
    found
}

/// The edges from `v` to vertices with larger ids, once for each triangle: the other end, whether `v` comes first, and
/// the triangle's slot; sorted, and written over `out`.
fn sides_above(complex: &Complex<3>, v: VertexId, out: &mut Vec<(VertexId, bool, Slot)>) {
    out.clear();
    for (slot, i) in complex.star(v) {
        let cell = complex.cell(slot);
        let both = [(cell[(i + 1) % 3], true, slot), (cell[(i + 2) % 3], false, slot)];
        out.extend(both.into_iter().filter(|side| side.0 > v));
    }
    out.sort_unstable();
}

fn places(names: impl Iterator<Item = String>, count: usize) -> String {
    let shown: Vec<_> = names.take(5).collect();
    match count {
        0 => String::new(),
        _ => format!(" ({}{})", shown.join(", "), if count > shown.len() { ", .." } else { "" }),
    }
}

/// Whether the triangles of this link are linked across edges into one piece. Sorts the link. O(degree²).
fn one_umbrella(walk: &mut [[VertexId; 2]]) -> bool {
    // Sort the opposite edges into a chain that grows at its reached end.
    let mut reached = 1;
    let mut at = 0;
    while at < reached {
        let [a, b] = walk[at];
        let mut other = reached;
        while other < walk.len() {
            let [c, d] = walk[other];
            if c == a || c == b || d == a || d == b {
                walk.swap(reached, other);
                reached += 1;
            }
            other += 1;
        }
        at += 1;
    }
    reached == walk.len()
}
