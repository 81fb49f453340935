//! Feature points of a mesh, and folds of an extracted one: what the angles between neighbouring triangles say.

use glam::{DVec3, Vec3};
use mt_core::mesh::area_vector;
use mt_core::{Cell, Mesh, VertexId};

/// Normals that differ by more than 40 degrees across an edge make its ends feature points.
const SHARP_COSINE: f64 = 0.766;
/// Normals that differ by more than 120 degrees make a fold.
const FOLD_COSINE: f64 = -0.5;

/// The positions of the vertices at sharp edges and at boundaries; where nothing is sharp, every hundredth vertex.
pub fn sharp_vertices(mesh: &Mesh<3>) -> Vec<Vec3> {
    let mut sharp = vec![false; mesh.positions.len()];
    each_edge(&mesh.cells, &mesh.positions, |[a, b], cosine| {
        if cosine.is_none_or(|cosine| cosine < SHARP_COSINE) {
            (sharp[a.index()], sharp[b.index()]) = (true, true);
        }
    });
    let found: Vec<Vec3> = mesh.positions.iter().zip(&sharp).filter(|(_, sharp)| **sharp).map(|(p, _)| *p).collect();
    if found.is_empty() { mesh.positions.iter().copied().step_by(100).collect() } else { found }
}

/// How many inner edges fold: their two triangles look nearly at each other. O(cells log cells).
pub(crate) fn folds(cells: &[Cell<3>], positions: &[Vec3]) -> u32 {
    let mut count = 0;
    each_edge(cells, positions, |_, cosine| count += u32::from(cosine.is_some_and(|cosine| cosine < FOLD_COSINE)));
    count
}

/// Each edge once, and the cosine between the normals of its triangles where there are two.
fn each_edge(cells: &[Cell<3>], positions: &[Vec3], mut visit: impl FnMut([VertexId; 2], Option<f64>)) {
    let normal = |cell: &Cell<3>| area_vector(cell.map(|v| positions[v.index()].as_dvec3())).normalize_or_zero();
    let mut sides: Vec<([VertexId; 2], u32)> = Vec::with_capacity(3 * cells.len());
    for (i, cell) in cells.iter().enumerate() {
        sides.extend((0..3).map(|k| {
            let (a, b) = (cell[k], cell[(k + 1) % 3]);
            ([a.min(b), a.max(b)], i as u32)
        }));
    }
    sides.sort_unstable();
    for run in sides.chunk_by(|a, b| a.0 == b.0) {
        let normals: Vec<DVec3> = run.iter().map(|(_, i)| normal(&cells[*i as usize])).collect();
        let cosine = if let [a, b] = normals[..] { Some(a.dot(b)) } else { None };
        visit(run[0].0, cosine);
    }
}
