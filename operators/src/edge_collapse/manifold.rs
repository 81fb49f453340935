//! Is it a manifold? Judged by umbrellas at vertices, not by counting edges.

use mt_core::analysis::Unfit;
use mt_core::{Complex, Slot, VertexId};

/// An edge of a manifold: its ends ascending, and its one or two triangles.
pub(super) struct ManifoldEdge {
    pub(super) ends: [VertexId; 2],
    pub(super) slots: [Option<Slot>; 2],
}

/// All edges, or what is in the way: edges with more than two triangles, vertices with more than one umbrella.
/// O(triangles log triangles).
pub(super) fn check(complex: &Complex<3>) -> Result<Vec<ManifoldEdge>, Unfit> {
    let mut sides: Vec<([VertexId; 2], Slot)> = Vec::with_capacity(3 * complex.cell_count());
    for (slot, cell) in complex.cells() {
        for i in 0..3 {
            let (u, v) = (cell[i], cell[(i + 1) % 3]);
            sides.push(([u.min(v), u.max(v)], slot));
        }
    }
    sides.sort_unstable();
    let mut edges = Vec::with_capacity(sides.len() / 2 + 1);
    let mut bad_edges = Vec::new();
    for run in sides.chunk_by(|a, b| a.0 == b.0) {
        if run.len() > 2 {
            bad_edges.push(run[0].0);
        }
        edges.push(ManifoldEdge { ends: run[0].0, slots: [Some(run[0].1), run.get(1).map(|r| r.1)] });
    }
    let on_bad_edge = |v: VertexId| bad_edges.iter().any(|edge| edge.contains(&v));
    let mut bad_vertices = Vec::new();
    let mut walk = Vec::new();
    for v in (0..complex.vertex_count()).map(VertexId::new).filter(|&v| complex.has_star(v)) {
        if !one_umbrella(complex, v, &mut walk) && !on_bad_edge(v) {
            bad_vertices.push(v);
        }
    }
    if bad_edges.is_empty() && bad_vertices.is_empty() {
        return Ok(edges);
    }
    let edge_places = places(bad_edges.iter().map(|[u, v]| format!("{u}-{v}")), bad_edges.len());
    let vertex_places = places(bad_vertices.iter().map(VertexId::to_string), bad_vertices.len());
    Err(Unfit::NonManifold { edges: bad_edges.len(), edge_places, vertices: bad_vertices.len(), vertex_places })
}

fn places(names: impl Iterator<Item = String>, count: usize) -> String {
    let shown: Vec<_> = names.take(5).collect();
    match count {
        0 => String::new(),
        _ => format!(" ({}{})", shown.join(", "), if count > shown.len() { ", .." } else { "" }),
    }
}

/// Whether the triangles around `v` are linked across edges into one piece. O(degree²).
fn one_umbrella(complex: &Complex<3>, v: VertexId, walk: &mut Vec<(VertexId, VertexId)>) -> bool {
    walk.clear();
    walk.extend(complex.star(v).map(|(slot, i)| {
        let cell = complex.cell(slot);
        (cell[(i + 1) % 3], cell[(i + 2) % 3])
    }));
    // Sort the opposite edges into a chain that grows at its reached end.
    let mut reached = 1;
    let mut at = 0;
    while at < reached {
        let (a, b) = walk[at];
        for other in reached..walk.len() {
            let (c, d) = walk[other];
            if c == a || c == b || d == a || d == b {
                walk.swap(reached, other);
                reached += 1;
            }
        }
        at += 1;
    }
    reached == walk.len()
}
