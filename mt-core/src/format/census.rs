//! The census of a triangle mesh: components, boundary, non-manifold places, orientation, genus.
//!
//! Counting sort by the smaller end of each edge and two union-finds; O(n log n) at worst, in
//! practice linear. Peak memory about 60 bytes a triangle.

use super::report::{Finding, Spot};
use super::sets::{Buckets, Sets};
use crate::id::VertexId;
use crate::mesh::Mesh;
use serde::Serialize;

/// What the triangles of a mesh look like together. Vertices that no triangle uses are not counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Census {
    /// Vertices that a triangle uses.
    pub vertices: usize,
    /// Distinct pairs of vertices joined by a side of a triangle.
    pub edges: usize,
    /// Triangles.
    pub triangles: usize,
    /// Groups of triangles joined by vertices.
    pub components: usize,
    /// Edges of one triangle.
    pub boundary_edges: usize,
    /// Connected groups of boundary edges; loops in the strict sense where all vertices are manifold.
    pub boundary_loops: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: Finding,
    /// Vertices whose triangles fall into more than one group joined across edges (umbrellas).
    pub non_manifold_vertices: Finding,
    /// Edges whose two triangles run through them in the same direction.
    pub inconsistent_edges: Finding,
    /// Whether flipping some triangles can make every edge of two triangles consistent.
    pub orientable: bool,
    /// Vertices - edges + triangles.
    pub euler_characteristic: i64,
    /// Handles, summed over the components with each boundary loop closed by a disc; only for manifold, orientable meshes.
    pub genus: Option<u64>,
}

impl Census {
    /// Whether no edge has more than two triangles and every vertex has one umbrella.
    pub fn is_manifold(&self) -> bool {
        self.non_manifold_edges.count == 0 && self.non_manifold_vertices.count == 0
    }

    /// Whether there is no boundary.
    pub fn is_closed(&self) -> bool {
        self.boundary_edges == 0
    }
}

/// Sides of triangles grouped into edges. A side is `3 t + k`: triangle `t`, from its corner `k` to the next.
pub(super) struct Edges<'a> {
    cells: &'a [[VertexId; 3]],
    buckets: Buckets<u64>,
}

/// One edge: its ends, the smaller first, and its sides in the order of their triangles.
pub(super) struct Edge<'a> {
    pub(super) ends: [u32; 2],
    run: &'a [u64],
}

impl Edge<'_> {
    pub(super) fn sides(&self) -> impl ExactSizeIterator<Item = u32> {
        self.run.iter().map(|&item| item as u32)
    }
}

impl<'a> Edges<'a> {
    /// Sides with both ends equal are left out; they belong to triangles that are no triangles.
    pub(super) fn new(mesh: &'a Mesh<3>) -> Self {
        let sides = mesh.cells.iter().enumerate().flat_map(|(t, cell)| {
            (0..3).filter_map(move |k| {
                let (a, b) = (cell[k].0, cell[(k + 1) % 3].0);
                let item = (u64::from(a.max(b)) << 32) | (3 * t + k) as u64;
                (a != b).then_some((a.min(b), item))
            })
        });
        Self { cells: &mesh.cells, buckets: Buckets::new(mesh.positions.len(), sides) }
    }

    /// Every edge, by its smaller then its larger end.
    pub(super) fn iter(&self) -> impl Iterator<Item = Edge<'_>> {
        self.buckets.iter().flat_map(|(low, bucket)| {
            bucket.chunk_by(|a, b| a >> 32 == b >> 32).map(move |run| Edge { ends: [low, (run[0] >> 32) as u32], run })
        })
    }

    /// The corners of `side`'s triangle at the edge's smaller and larger end.
    pub(super) fn corners(&self, edge: &Edge<'_>, side: u32) -> [u32; 2] {
        let next = if side % 3 == 2 { side - 2 } else { side + 1 };
        if self.forward(edge, side) { [side, next] } else { [next, side] }
    }

    /// Whether the side runs from the smaller end to the larger.
    fn forward(&self, edge: &Edge<'_>, side: u32) -> bool {
        self.cells[side as usize / 3][side as usize % 3].0 == edge.ends[0]
    }

    fn inconsistent(&self, edge: &Edge<'_>) -> bool {
        let mut sides = edge.sides();
        match (sides.next(), sides.next(), sides.next()) {
            (Some(a), Some(b), None) => self.forward(edge, a) == self.forward(edge, b),
            _ => false,
        }
    }
}

/// Counts what there is to know about the triangles of a mesh as a surface.
///
/// Requires: every corner is a vertex of the mesh, and three times the triangles fits `u32`
/// (both hold for what [`super::read`] returns).
pub fn census(mesh: &Mesh<3>) -> Census {
    let edges = Edges::new(mesh);
    let mut found = Census { triangles: mesh.cells.len(), orientable: true, ..Census::default() };
    let mut boundary = Sets::new(mesh.positions.len());
    let mut umbrellas = Sets::new(3 * mesh.cells.len());
    // A boundary graph with v vertices and e edges has v - (joins) connected groups.
    let mut on_boundary = vec![false; mesh.positions.len()];
    let mut boundary_joins = 0;
    for edge in edges.iter() {
        found.edges += 1;
        let count = edge.sides().len();
        if count == 1 {
            found.boundary_edges += 1;
            boundary_joins += usize::from(boundary.join(edge.ends[0], edge.ends[1]));
            edge.ends.iter().for_each(|&end| on_boundary[end as usize] = true);
        } else {
            join_umbrellas(&edges, &edge, &mut umbrellas);
        }
        if count > 2 {
            found.non_manifold_edges.add(|| edge_spot(mesh, edge.ends));
        } else if edges.inconsistent(&edge) {
            found.inconsistent_edges.add(|| edge_spot(mesh, edge.ends));
        }
    }
    found.boundary_loops = on_boundary.iter().filter(|on| **on).count() - boundary_joins;
    count_vertices(mesh, &mut umbrellas, &mut found);
    found.orientable = found.inconsistent_edges.count == 0 || orientable(&edges);
    found.euler_characteristic = found.vertices as i64 - found.edges as i64 + found.triangles as i64;
    found.genus = genus(&found);
    found
}

fn join_umbrellas(edges: &Edges<'_>, edge: &Edge<'_>, umbrellas: &mut Sets) {
    let mut corners = edge.sides().map(|side| edges.corners(edge, side));
    let Some(first) = corners.next() else { return };
    for other in corners {
        umbrellas.join(first[0], other[0]);
        umbrellas.join(first[1], other[1]);
    }
}

/// Used vertices, components, and the vertices of several umbrellas.
fn count_vertices(mesh: &Mesh<3>, umbrellas: &mut Sets, found: &mut Census) {
    let mut umbrella_count = vec![0u32; mesh.positions.len()];
    let mut components = Sets::new(mesh.positions.len());
    let mut joins = 0;
    for (t, cell) in mesh.cells.iter().enumerate() {
        for k in 0..3 {
            let corner = (3 * t + k) as u32;
            umbrella_count[cell[k].index()] += u32::from(umbrellas.find(corner) == corner);
        }
        joins += usize::from(components.join(cell[0].0, cell[1].0));
        joins += usize::from(components.join(cell[0].0, cell[2].0));
    }
    for (vertex, &count) in umbrella_count.iter().enumerate() {
        found.vertices += usize::from(count > 0);
        if count > 1 {
            let position = mesh.positions[vertex].to_array();
            found.non_manifold_vertices.add(|| Spot { vertices: vec![VertexId::new(vertex)], position });
        }
    }
    found.components = found.vertices - joins;
}

/// Whether the triangles can be given sides (kept or flipped) that agree across every edge of two.
///
/// Two copies of each triangle, kept and flipped; a consistent edge joins like with like, an
/// inconsistent one joins kept with flipped. Orientable means that no triangle meets its own flip.
fn orientable(edges: &Edges<'_>) -> bool {
    let count = edges.cells.len() as u32;
    let mut copies = Sets::new(2 * count as usize);
    for edge in edges.iter() {
        let mut sides = edge.sides();
        if let (Some(a), Some(b), None) = (sides.next(), sides.next(), sides.next()) {
            let (a, b) = (a / 3, b / 3);
            let flip = if edges.inconsistent(&edge) { count } else { 0 };
            copies.join(a, b + flip);
            copies.join(a + count, b + count - flip);
        }
    }
    (0..count).all(|t| copies.find(t) != copies.find(t + count))
}

fn genus(found: &Census) -> Option<u64> {
    let handles = 2 * found.components as i64 - found.boundary_loops as i64 - found.euler_characteristic;
    (found.is_manifold() && found.orientable).then(|| u64::try_from(handles / 2).ok())?
}

fn edge_spot(mesh: &Mesh<3>, ends: [u32; 2]) -> Spot {
    let middle = ends.map(|end| mesh.positions[end as usize]);
    let position = ((middle[0] + middle[1]) / 2.0).to_array();
    Spot { vertices: ends.map(VertexId).to_vec(), position }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate;

    #[test]
    fn surfaces_are_counted_as_topology_has_it() {
        let of = |mesh: &Mesh<3>| {
            let found = census(mesh);
            (found.genus, found.boundary_loops, found.components, found.euler_characteristic)
        };
        assert_eq!(of(&generate::icosahedron()), (Some(0), 0, 1, 2));
        assert_eq!(of(&generate::torus(6, 5)), (Some(1), 0, 1, 0));
        assert_eq!(of(&generate::genus_surface(2, 12, 0.0, 1)), (Some(2), 0, 1, -2));
        assert_eq!(of(&generate::cylinder(7, 2)), (Some(0), 2, 1, 0));
        assert_eq!(of(&generate::components(&[generate::torus(6, 5), generate::grid(2, 2)])), (Some(1), 1, 2, 1));
        let band = census(&generate::moebius(9));
        assert!(!band.orientable && band.genus.is_none() && band.is_manifold() && !band.is_closed());
        assert_eq!((band.boundary_loops, band.euler_characteristic), (1, 0));
        // Triangles that do not agree on a side are told, and can be turned so that they do.
        let mut turned = generate::torus(6, 5);
        turned.cells[7].swap(0, 1);
        let found = census(&turned);
        assert_eq!((found.inconsistent_edges.count, found.orientable, found.genus), (3, true, Some(1)));
        assert_eq!(census(&generate::torus(6, 5)).inconsistent_edges.count, 0);
        assert_eq!(census(&generate::fan3()).non_manifold_edges.count, 1);
    }
}
