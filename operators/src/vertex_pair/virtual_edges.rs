//! Virtual edges: which vertices that share no triangle may merge all the same.
//!
//! Patches of triangles with nearly one normal are grown; what lies on their boundaries carries the shape, so only these
//! vertices are joined, to those near them (`[ElSanaVarshney1999]`).

use super::gabriel;
use glam::DVec3;
use mt_core::mesh::area_vector;
use mt_core::{Mesh, VertexId};

/// How virtual edges are found.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct VirtualEdges {
    /// Two patches that share an edge become one while their normals differ by less than this, in radians.
    pub normal_threshold: f64,
    /// No virtual edge is longer than this share of the diagonal of the mesh. With 0 only vertices in the same place are
    /// joined; below 0, none.
    pub distance: f64,
}

impl Default for VirtualEdges {
    fn default() -> Self {
        Self { normal_threshold: 0.5, distance: 0.05 }
    }
}

/// The virtual edges of a mesh, each ascending, in ascending sequence; none of them is an edge of a triangle.
///
/// They are the edges of the Gabriel graph of the vertices on boundaries of patches, up to the length that `options`
/// sets. Of vertices in the same place the first stands for all in that graph, and is joined to each of the others.
/// Vertices without a triangle, or without a finite position, have none.
/// O(triangles × rounds of patch growing), and about O(boundary vertices × log) for the graph.
pub fn virtual_edges(mesh: &Mesh<3>, options: &VirtualEdges) -> Vec<[VertexId; 2]> {
    let length = options.distance * mesh.diagonal();
    if length.is_nan() || length < 0.0 {
        return Vec::new();
    }
    let sides = sides_of(mesh);
    let on_boundary = patch_boundaries(mesh, &sides, options.normal_threshold);
    let candidates = (0..mesh.positions.len())
        .filter(|&v| on_boundary[v] && mesh.positions[v].is_finite())
        .map(VertexId::new)
        .collect::<Vec<_>>();
    let mut edges = gabriel::edges(&mesh.positions, candidates, length);
    edges.sort_unstable();
    edges.dedup();
    edges.retain(|edge| sides.binary_search_by(|side| side.0.cmp(edge)).is_err());
    edges
}

/// An edge of a triangle, ascending, and which triangle.
type Side = ([VertexId; 2], u32);

fn sides_of(mesh: &Mesh<3>) -> Vec<Side> {
    let of_cell = |(slot, cell): (usize, &[VertexId; 3])| {
        [[cell[0], cell[1]], [cell[1], cell[2]], [cell[2], cell[0]]].map(|[u, v]| ([u.min(v), u.max(v)], slot as u32))
    };
    let mut sides: Vec<Side> = mesh.cells.iter().enumerate().flat_map(of_cell).collect();
    sides.sort_unstable();
    sides
}

/// Of each vertex: whether it is on the boundary of a patch, which is an edge with a single triangle or with triangles of
/// several patches.
fn patch_boundaries(mesh: &Mesh<3>, sides: &[Side], threshold: f64) -> Vec<bool> {
    let mut patches = Patches::new(mesh);
    let cosine = threshold.clamp(0.0, std::f64::consts::PI).cos();
    // Normals move as patches grow, so what was refused may be allowed later, until a whole round merges nothing.
    let mut merged = true;
    while merged {
        merged = false;
        for pair in sides.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            merged |= patches.merge(pair[0].1, pair[1].1, cosine);
        }
    }
    let mut on_boundary = vec![false; mesh.positions.len()];
    for run in sides.chunk_by(|a, b| a.0 == b.0) {
        let first = patches.find(run[0].1);
        if run.len() == 1 || run.iter().any(|side| patches.find(side.1) != first) {
            run[0].0.iter().for_each(|v| on_boundary[v.index()] = true);
        }
    }
    on_boundary
}

/// Triangles in disjoint patches, each with the sum of its area vectors.
struct Patches {
    parents: Vec<u32>,
    normals: Vec<DVec3>,
}

impl Patches {
    fn new(mesh: &Mesh<3>) -> Self {
        let normal = |cell: &[VertexId; 3]| area_vector(cell.map(|v| mesh.positions[v.index()].as_dvec3()));
        Self { parents: (0..mesh.cells.len() as u32).collect(), normals: mesh.cells.iter().map(normal).collect() }
    }

    fn find(&mut self, mut triangle: u32) -> u32 {
        while self.parents[triangle as usize] != triangle {
            let above = self.parents[self.parents[triangle as usize] as usize];
            self.parents[triangle as usize] = above;
            triangle = above;
        }
        triangle
    }

    /// Makes one patch of the two around these triangles if their normals allow it. A patch without area fits any other.
    fn merge(&mut self, a: u32, b: u32, cosine: f64) -> bool {
        let [a, b] = [self.find(a), self.find(b)];
        if a == b {
            return false;
        }
        let [n, m] = [a, b].map(|patch| self.normals[patch as usize].normalize_or_zero());
        let fits = n == DVec3::ZERO || m == DVec3::ZERO || n.dot(m) > cosine;
        if fits {
            let [low, high] = [a.min(b), a.max(b)];
            self.parents[high as usize] = low;
            let sum = self.normals[a as usize] + self.normals[b as usize];
            self.normals[low as usize] = sum;
        }
        fits
    }
}
