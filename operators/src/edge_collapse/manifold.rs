//! Is it a manifold? Judged by umbrellas at vertices, not by counting edges.

use mt_core::analysis::Unfit;
use mt_core::cell::is_short_cycle;
use mt_core::{Bits, Complex, Slot, VertexId};
use rayon::prelude::*;
use std::ops::Range;

/// The edges of a manifold.
#[derive(Default)]
pub(crate) struct Edges {
    /// The ends of each, ascending, by some vertices after the other; nothing if nobody wants them.
    ends: Vec<Vec<[VertexId; 2]>>,
    /// Those that have only one triangle, and that.
    pub(crate) border: Vec<([VertexId; 2], Slot)>,
    /// Whether the triangles of every inner edge pass it in opposite directions.
    pub(crate) coherent: bool,
}

impl Edges {
    /// The ends of each edge, ascending; in the order of the lower ones.
    pub(crate) fn ends(&self) -> impl Iterator<Item = [VertexId; 2]> + '_ {
        self.ends.iter().flatten().copied()
    }
}

/// So many vertices are looked at by one thread at a time.
const VERTICES: usize = 8192;

/// What a look at some vertices found.
#[derive(Default)]
struct Found {
    ends: Vec<[VertexId; 2]>,
    border: Vec<([VertexId; 2], Slot)>,
    incoherent: bool,
    bad_edges: Vec<[VertexId; 2]>,
    bad_vertices: Vec<VertexId>,
}

/// The edges, or what is in the way: edges with more than two triangles, vertices with more than one umbrella. The ends of
/// all edges are told if wanted. O(triangles × degree). By the threads of the rayon pool that this is called in; with the
/// same answer for any number of them.
pub(crate) fn check(complex: &Complex<3>, wants_ends: bool) -> Result<Edges, Unfit> {
    let runs = (0..complex.vertex_count()).into_par_iter().step_by(VERTICES);
    let one = |from: usize| look(complex, from..complex.vertex_count().min(from + VERTICES), wants_ends);
    let parts: Vec<Found> = runs.map(one).collect();
    let mut bad_edges: Vec<[VertexId; 2]> = Vec::new();
    let mut bad_vertices: Vec<VertexId> = Vec::new();
    let mut edges = Edges { coherent: true, ..Edges::default() };
    for found in parts {
        edges.ends.push(found.ends);
        edges.border.extend(found.border);
        edges.coherent &= !found.incoherent;
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
fn look(complex: &Complex<3>, vertices: Range<usize>, wants_ends: bool) -> Found {
    let mut found = Found::default();
    let (mut sides, mut walk) = (Vec::new(), Vec::new());
    for v in vertices.map(VertexId::new).filter(|&v| complex.has_star(v)) {
        complex.link_edges(v, &mut walk);
        if is_short_cycle(&walk) {
            if wants_ends {
                // Each neighbour begins one edge of the link, and the edge to it has the triangle before and that after.
                let from = found.ends.len();
                found.ends.extend(walk.iter().filter(|side| side[0] > v).map(|&[w, _]| [v, w]));
                found.ends[from..].sort_unstable();
            }
            continue;
        }
        sides_above(complex, v, &mut sides);
        for run in sides.chunk_by(|a, b| a.0 == b.0) {
            let ends = [v, run[0].0];
            if run.len() > 2 {
                found.bad_edges.push(ends);
            }
            found.incoherent |= run.len() > 1 && run[0].1 == run[1].1;
            found.border.extend((run.len() == 1).then_some((ends, run[0].2)));
            found.ends.extend(wants_ends.then_some(ends));
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
