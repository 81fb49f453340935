//! When a collapse keeps a manifold a manifold, and no triangle turns over.

use glam::{DVec3, Vec3};
use mt_core::analysis::Draft;
use mt_core::mesh::area_vector;
use mt_core::{Complex, Refusal, Slot, VertexId};

/// The link condition for an edge of a manifold: `Lk(u) ∩ Lk(v) = Lk(uv)`, in vertices and in edges, with a cone vertex
/// over the boundary (`[DeyEdelsbrunner1999]`). O(degree of u × degree of v).
pub(crate) fn link_condition(
    complex: &Complex<3>,
    [u, v]: [VertexId; 2],
    on_boundary: [bool; 2],
    coherent: bool,
    scratch: &mut Vec<VertexId>,
) -> Result<(), Refusal> {
    let Some((count, shared)) = shared_triangles(complex, [u, v], scratch) else { return Err(Refusal::Link) };
    if count == 2 && on_boundary == [true, true] {
        return Err(Refusal::Pinch);
    }
    // Around an inner vertex of a coherently oriented mesh each neighbour comes first in one triangle.
    let common = if coherent && on_boundary == [false, false] {
        common_followers(complex, v, scratch)
    } else {
        ring(complex, u, scratch);
        common_neighbours(complex, u, v, scratch)
    };
    if common != count {
        return Err(Refusal::Link);
    }
    let closes = match (count, shared) {
        // Both ends share an edge of their links: the last tetrahedron. Then both have three triangles.
        (2, [a, b]) => {
            complex.star(u).nth(3).is_none() && has_triangle(complex, u, a, b) && has_triangle(complex, v, a, b)
        }
        // The cone's edge: a triangle on its own.
        (1, [apex, _]) => complex.edge_degree(u, apex) == 1 && complex.edge_degree(v, apex) == 1,
        _ => true,
    };
    if closes { Err(Refusal::Link) } else { Ok(()) }
}

/// The vertices around `u`, each once, written over `out`. O(degree log degree): a hub may have thousands.
fn ring(complex: &Complex<3>, u: VertexId, out: &mut Vec<VertexId>) {
    out.clear();
    for (slot, i) in complex.star(u) {
        let cell = complex.cell(slot);
        out.extend([cell[(i + 1) % 3], cell[(i + 2) % 3]]);
    }
    out.sort_unstable();
    out.dedup();
}

/// How many of the vertices around `v` are in `ring_of_u`, `u` not counted. Uses up the ring.
fn common_neighbours(complex: &Complex<3>, u: VertexId, v: VertexId, ring_of_u: &mut Vec<VertexId>) -> usize {
    let mut count = 0;
    for (slot, i) in complex.star(v) {
        let cell = complex.cell(slot);
        for w in [cell[(i + 1) % 3], cell[(i + 2) % 3]] {
            if let Some(at) = ring_of_u.iter().position(|&x| x == w && w != u) {
                ring_of_u.swap_remove(at);
                count += 1;
            }
        }
    }
    count
}

/// How many triangles have both vertices, and the third corners of these; `None` where they are more than two. Who follows
/// `u` in a triangle is written over `followers`.
#[inline]
fn shared_triangles(
    complex: &Complex<3>,
    [u, v]: [VertexId; 2],
    followers: &mut Vec<VertexId>,
) -> Option<(usize, [VertexId; 2])> {
    let mut shared = [VertexId::NONE; 2];
    let mut count = 0;
    followers.clear();
    for (slot, i) in complex.star(u) {
        let [next, last] = sides(complex, slot, i);
        followers.push(next);
        if next == v || last == v {
            *shared.get_mut(count)? = if next == v { last } else { next };
            count += 1;
        }
    }
    Some((count, shared))
}

/// How many vertices that follow `v` in a triangle are among these.
#[inline]
fn common_followers(complex: &Complex<3>, v: VertexId, followers: &[VertexId]) -> usize {
    complex.star(v).filter(|&(slot, i)| followers.contains(&sides(complex, slot, i)[0])).count()
}

/// The corners of a triangle after corner `i`, in its turn.
#[inline]
pub(super) fn sides(complex: &Complex<3>, slot: Slot, i: usize) -> [VertexId; 2] {
    let cell = complex.cell(slot);
    match i {
        0 => [cell[1], cell[2]],
        1 => [cell[2], cell[0]],
        _ => [cell[0], cell[1]],
    }
}

fn has_triangle(complex: &Complex<3>, u: VertexId, a: VertexId, b: VertexId) -> bool {
    complex.star(u).any(|(slot, _)| complex.cell(slot).contains(&a) && complex.cell(slot).contains(&b))
}

/// Refuses when a triangle of either star that survives would turn by more than the cosine allows, or lose its area.
pub(crate) fn fold_over(draft: &Draft<3>, ends: [VertexId; 2], position: Vec3, cosine: f64) -> Result<(), Refusal> {
    for [end, other] in [ends, [ends[1], ends[0]]] {
        let [old, new] = [draft.positions[end.index()], position].map(|p| p.as_dvec3());
        if old == new {
            continue;
        }
        for (slot, i) in draft.complex.star(end) {
            let sides = sides(&draft.complex, slot, i);
            if !sides.contains(&other) {
                let [a, b] = sides.map(|v| draft.positions[v.index()].as_dvec3());
                turn([old, a, b], [new, a, b], cosine)?;
            }
        }
    }
    Ok(())
}

/// Refuses when a triangle turns by more than the cosine allows, or loses its area.
#[inline]
pub(crate) fn turn(before: [DVec3; 3], after: [DVec3; 3], cosine: f64) -> Result<(), Refusal> {
    let (old, new) = (area_vector(before), area_vector(after));
    if new == DVec3::ZERO {
        // A triangle that had no area cannot lose it.
        return if old == DVec3::ZERO { Ok(()) } else { Err(Refusal::Degenerate) };
    }
    let dot = old.dot(new);
    let most = old.length_squared() * new.length_squared() * cosine * cosine;
    let turned = if cosine >= 0.0 { dot < 0.0 || dot * dot < most } else { dot < 0.0 && dot * dot > most };
    if turned { Err(Refusal::FoldOver) } else { Ok(()) }
}
