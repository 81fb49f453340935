//! Spheres and tori.

use super::noise::Fractal;
use super::patches::{Sheet, circle};
use super::tiny::icosahedron;
use crate::id::VertexId;
use crate::mesh::Mesh;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// The unit sphere: an icosahedron, each triangle split in four `level` times (at most 11).
///
/// `10 4^level + 2` vertices, `20 4^level` triangles, closed, genus 0. Vertices of coarser levels come first.
pub fn sphere(level: u32) -> Mesh<3> {
    let mut mesh = icosahedron();
    for _ in 0..level.min(11) {
        subdivide(&mut mesh);
    }
    mesh
}

/// [`sphere`] with its vertices moved along the radius by up to `amplitude` (below 1), by fractal noise.
pub fn bumpy_sphere(level: u32, amplitude: f32, seed: u64) -> Mesh<3> {
    let noise = Fractal { frequency: 1.5, octaves: 5, persistence: 0.5, seed };
    let mut mesh = sphere(level);
    for p in &mut mesh.positions {
        *p *= 1.0 + amplitude * noise.at(p.as_dvec3()) as f32;
    }
    mesh
}

/// A torus about the z axis, circle of radius 1 and tube of radius 0.4: `m` squares along the circle, `n` around the tube.
///
/// `m n` vertices, `2 m n` triangles (`m` and `n` at least 3), closed, genus 1.
pub fn torus(m: usize, n: usize) -> Mesh<3> {
    let (m, n) = (m.max(3), n.max(3));
    let sheet = Sheet { columns: m, rows: n, around: true, across: true };
    sheet.mesh(|i, j| {
        let tube = circle(j, n, 0.4);
        (circle(i, m, 1.0 + tube.x) + DVec3::Z * tube.y).as_vec3()
    })
}

/// Splits each triangle of a mesh on the unit sphere in four.
fn subdivide(mesh: &mut Mesh<3>) {
    let mut middles = FxHashMap::default();
    let mut cells = Vec::with_capacity(4 * mesh.cells.len());
    for &[a, b, c] in &mesh.cells {
        let mut middle = |u: VertexId, v: VertexId| {
            *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                let sum = mesh.positions[u.index()].as_dvec3() + mesh.positions[v.index()].as_dvec3();
                mesh.positions.push(sum.normalize().as_vec3());
                VertexId::new(mesh.positions.len() - 1)
            })
        };
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        cells.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    mesh.cells = cells;
}
