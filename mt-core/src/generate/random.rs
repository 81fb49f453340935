//! Meshes from other meshes: several side by side, and one drawn by lot.

use super::*;
use crate::id::VertexId;
use crate::mesh::Mesh;
use crate::random::Random;
use glam::Vec3;

/// A mesh and what to call it in a report.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// The generator and its arguments.
    pub name: String,
    /// The mesh.
    pub mesh: Mesh<3>,
}

/// The disjoint union of `parts` in a row along x, a tenth of the largest diagonal apart.
///
/// Vertices and cells are those of the first part, then of the second, and so on.
pub fn components(parts: &[Mesh<3>]) -> Mesh<3> {
    let gap = 0.1 * parts.iter().map(Mesh::diagonal).fold(0.0, f64::max) as f32;
    let mut union = Mesh::default();
    let mut x = 0.0;
    for part in parts {
        let (low, high) = part.bounding_box().unwrap_or_default();
        let shift = Vec3::X * (x - low.x);
        let first = union.positions.len();
        union.positions.extend(part.positions.iter().map(|&p| p + shift));
        union.cells.extend(part.cells.iter().map(|cell| cell.map(|v| VertexId::new(v.index() + first))));
        x += high.x - low.x + gap;
    }
    union
}

/// A manifold and orientable mesh drawn by lot, of at most 1,300 triangles a component.
///
/// Any of: tiny, closed of genus 0 to 3, with one boundary loop or two, planar, with slivers, with sharp edges, of two
/// to four components. Under a hundred seeds show every kind.
pub fn random_mesh(seed: u64) -> Named {
    let mut rng = Random::new(seed);
    if rng.below(8) > 0 {
        return one_component(&mut rng);
    }
    let parts: Vec<Named> = (0..2 + rng.below(3)).map(|_| one_component(&mut rng)).collect();
    let names: Vec<&str> = parts.iter().map(|part| part.name.as_str()).collect();
    let meshes: Vec<Mesh<3>> = parts.iter().map(|part| part.mesh.clone()).collect();
    Named { name: names.join(" + "), mesh: components(&meshes) }
}

fn one_component(rng: &mut Random) -> Named {
    let inner = rng.bits() % 1000;
    let mut pick = |low: usize, high: usize| low + rng.below(high - low + 1);
    let (name, mesh) = match pick(0, 15) {
        0 => ("triangle".into(), triangle()),
        1 => ("tetrahedron".into(), tetrahedron()),
        2 => ("octahedron".into(), octahedron()),
        3 => ("icosahedron".into(), icosahedron()),
        4 => named2("grid", [pick(1, 14), pick(1, 14)], grid),
        5 => named2("bumpy_grid", [pick(2, 16), pick(2, 16)], |i, j| bumpy_grid(i, j, 1.5, inner)),
        6 => named2("annulus", [pick(3, 20), pick(1, 6)], annulus),
        7 => named1("strip", pick(1, 40), strip),
        8 => named2("cylinder", [pick(3, 20), pick(1, 10)], cylinder),
        9 => named1("sphere", pick(0, 2), |level| sphere(level as u32)),
        10 => named1("bumpy_sphere", pick(1, 3), |level| bumpy_sphere(level as u32, 0.3, inner)),
        11 => named2("torus", [pick(3, 20), pick(3, 14)], torus),
        12 => named2("genus_surface", [pick(0, 3), pick(2, 3)], |g, k| genus_surface(g, k, 0.08, inner)),
        13 => named1("terrain", pick(1, 24), |n| terrain(n, 0.7, inner)),
        14 => (format!("slivers({inner})"), slivers(inner)),
        _ => named1("sharp_box", pick(1, 8), sharp_box),
    };
    Named { name, mesh }
}

fn named1(name: &str, n: usize, make: impl Fn(usize) -> Mesh<3>) -> (String, Mesh<3>) {
    (format!("{name}({n})"), make(n))
}

fn named2(name: &str, [m, n]: [usize; 2], make: impl Fn(usize, usize) -> Mesh<3>) -> (String, Mesh<3>) {
    (format!("{name}({m}, {n})"), make(m, n))
}
