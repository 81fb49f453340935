//! The slow oracle of vertex hierarchies: the input, relabelled by active ancestors. It walks the forest vertex by vertex;
//! of the replay it reads who is merged where, and neither spans nor what appears at a node.

use super::{Breach, Law, ensure};
use crate::bound::Cone;
use crate::cell::{Cell, Facet, facets, is_proper};
use crate::front::Front;
use crate::hierarchy::{Replay, VertexMesh};
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::area_vector;
use crate::model::View;
use glam::Vec3;
use rustc_hash::{FxHashMap, FxHashSet};

/// The active vertex above each input vertex. O(vertices).
pub fn active_ancestors(replay: &Replay, front: &Front) -> Vec<VertexId> {
    // A vertex of the forest passes its leaves on when the node that merges it is coarse; later ones are further up.
    let mut above: Vec<VertexId> = (0..replay.vertex_count()).map(VertexId).collect();
    for v in (0..replay.vertex_count()).rev().map(VertexId) {
        let node = replay.merged_at(v);
        if !node.is_none() && !front.is_refined(node) {
            above[v.index()] = above[replay.vertex(node).index()];
        }
    }
    above.truncate(replay.leaf_count() as usize);
    above
}

/// Whether a front is a cut of the forest: every node's parent is refined before it. O(nodes of the front).
pub fn is_cut(replay: &Replay, front: &Front) -> Result<(), (NodeId, NodeId)> {
    let unmet = |m: NodeId| replay.parent(m).filter(|&parent| !front.is_refined(parent)).map(|parent| (m, parent));
    front.finest_first().find_map(unmet).map_or(Ok(()), Err)
}

/// The mesh of a front: each input triangle with its corners' active ancestors, if they are three. A multiset: two
/// triangles of the input may become alike. O(vertices + triangles).
pub fn quotient(replay: &Replay, front: &Front) -> Vec<(CellId, Cell<3>)> {
    let above = active_ancestors(replay, front);
    let relabelled = replay.cells().iter().enumerate();
    let cells = relabelled.map(|(i, cell)| (CellId::new(i), cell.map(|leaf| above[leaf.index()])));
    cells.filter(|(_, cell)| is_proper(cell)).collect()
}

/// The boundary that the mesh of a front must have: the image of the input's boundary, edges counted modulo two.
pub fn boundary_chain(replay: &Replay, front: &Front) -> FxHashSet<Facet<3>> {
    let above = active_ancestors(replay, front);
    let mut input: FxHashMap<Facet<3>, u32> = FxHashMap::default();
    for (facet, _) in replay.cells().iter().flat_map(facets) {
        *input.entry(facet).or_default() += 1;
    }
    let mut chain = FxHashSet::default();
    for facet in input.into_iter().filter(|(_, count)| count % 2 == 1).map(|(facet, _)| facet) {
        let ends = facet.vertices();
        let [a, b] = [0, 1].map(|i| above[ends[i].index()]);
        if a != b {
            // A facet as a cell of its own would have it: built from a triangle so that the form is canonical.
            let image = crate::cell::facet(&[VertexId::NONE, a, b], 0).0;
            if !chain.remove(&image) {
                chain.insert(image);
            }
        }
    }
    chain
}

/// The partition law of `[KimLee2001]`, section 3: the dual pieces of the active vertices cover the input, are disjoint,
/// and any two that touch share one portion of boundary. For manifold input. O(vertices + triangles).
pub fn dual_pieces(replay: &Replay, front: &Front) -> Result<(), Breach> {
    let above = active_ancestors(replay, front);
    let mut active: Vec<VertexId> = above.clone();
    active.sort_unstable();
    active.dedup();
    // A fan that is merged in part stands for the part.
    let piece = |v: VertexId| replay.latest(v, front).map_or_else(|| replay.span(v), |m| replay.span_at(m));
    let mut spans: Vec<_> = active.iter().map(|&v| piece(v)).collect();
    spans.sort_unstable_by_key(|span| span.first);
    let mut reached = 0;
    for span in &spans {
        let meets = span.first == reached;
        ensure!(meets, Law::Partition, None, "leaves {reached} to {} are in no piece, or in two", span.first);
        reached = span.end;
    }
    ensure!(reached == replay.leaf_count(), Law::Partition, None, "leaves from {reached} on are in no piece");
    one_portion(replay, &above)
}

/// Between two pieces that touch, the edges across are linked by triangles with two corners in one of them.
fn one_portion(replay: &Replay, above: &[VertexId]) -> Result<(), Breach> {
    let mut across: FxHashMap<[VertexId; 2], u32> = FxHashMap::default();
    let mut parent: Vec<u32> = Vec::new();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    for cell in replay.cells() {
        let mut met = Vec::with_capacity(2);
        for i in 0..3 {
            let (a, b) = (cell[i], cell[(i + 1) % 3]);
            if above[a.index()] != above[b.index()] {
                let next = parent.len() as u32;
                let id = *across.entry([a.min(b), a.max(b)]).or_insert(next);
                if id == next {
                    parent.push(next);
                }
                met.push(id);
            }
        }
        // Two edges across between the same two pieces; three would be a triangle of the current mesh.
        if let [one, two] = met[..] {
            let (one, two) = (root(&mut parent, one), root(&mut parent, two));
            parent[one as usize] = two;
        }
    }
    let mut portion: FxHashMap<[VertexId; 2], u32> = FxHashMap::default();
    let mut edges: Vec<_> = across.into_iter().collect();
    edges.sort_unstable();
    for (edge, id) in edges {
        let [v, w] = edge.map(|leaf| above[leaf.index()]);
        let mine = root(&mut parent, id);
        let first = *portion.entry([v.min(w), v.max(w)]).or_insert(mine);
        ensure!(
            first == mine,
            Law::Partition,
            None,
            "the pieces of vertices {v} and {w} share two portions of boundary"
        );
    }
    Ok(())
}

/// Saturation of a hierarchy's own bounds: the sphere and the cone of each node hold the triangles around it before and
/// after it is coarsened. Together with [`super::forest_saturation`] that is the whole law. O(stars of all merges).
pub fn patch_bounds(replay: &Replay) -> Result<(), Breach> {
    let mut broken = Ok(());
    let corners = |view: &View<VertexMesh>, v: VertexId| -> Vec<[Vec3; 3]> {
        let star = view.mesh.faces.star(v);
        star.map(|(slot, _)| view.mesh.faces.cell(slot).map(|w| replay.positions()[w.index()])).collect()
    };
    let mut last: Option<NodeId> = None;
    replay.sweep(|m, view| {
        if broken.is_ok() {
            let mut before = replay.ends(m).into_iter().flat_map(|end| corners(view, end));
            broken = before.try_for_each(|cell| holds(replay, m, cell));
        }
        // What this mesh has around the vertex made last is what that node leaves.
        if let Some(made) = last.filter(|_| broken.is_ok()) {
            broken = corners(view, replay.vertex(made)).into_iter().try_for_each(|cell| holds(replay, made, cell));
        }
        last = Some(m);
    });
    broken
}

fn holds(replay: &Replay, m: NodeId, cell: [Vec3; 3]) -> Result<(), Breach> {
    let bound = replay.bound(m);
    for p in cell {
        let apart = p.as_dvec3().distance(bound.center.as_dvec3());
        ensure!(apart <= f64::from(bound.radius), Law::Saturation, m, "{p} of node {m}'s patch is outside its sphere");
    }
    let normal = area_vector(cell.map(|p| p.as_dvec3())).as_vec3();
    let (Some(normal), Some((axis, angle))) = (normal.try_normalize(), bound.cone.get()) else { return Ok(()) };
    let held = bound.cone == Cone::ALL || axis.angle_between(normal) <= angle;
    ensure!(held, Law::Saturation, m, "a normal of node {m}'s patch is outside its cone");
    Ok(())
}
