//! A mesh as formats, builders and renderers pass it on: positions and cells, nothing else.

use crate::id::VertexId;
use glam::{DVec3, Vec3};

/// Vertices in space and cells of `N` corners each (3: triangles, 4: tetrahedra).
///
/// Plain data; [`crate::Complex`] adds incidence. 12 bytes a vertex, `4 N` bytes a cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh<const N: usize> {
    /// Position of each vertex, in model units.
    pub positions: Vec<Vec3>,
    /// Corners of each cell; the order of the corners is the cell's orientation.
    pub cells: Vec<[VertexId; N]>,
}

impl<const N: usize> Mesh<N> {
    /// A mesh from raw indices, for tests and generators.
    pub fn from_indices(positions: Vec<Vec3>, cells: &[[u32; N]]) -> Self {
        Self { positions, cells: cells.iter().map(|c| c.map(VertexId)).collect() }
    }

    /// Number of vertices, used by a cell or not.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// The smallest box around all vertices; `None` without vertices.
    pub fn bounding_box(&self) -> Option<(Vec3, Vec3)> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p))))
    }

    /// Length of the bounding box's diagonal, the unit in which errors are compared; 0 without vertices.
    pub fn diagonal(&self) -> f64 {
        self.bounding_box().map_or(0.0, |(low, high)| (high.as_dvec3() - low.as_dvec3()).length())
    }

    /// Drops the vertices that no cell uses, keeping the order of the rest.
    pub fn compact(&self) -> Self {
        let mut used = vec![false; self.positions.len()];
        for corner in self.cells.iter().flatten() {
            used[corner.index()] = true;
        }
        let mut renamed = vec![VertexId::NONE; self.positions.len()];
        let mut positions = Vec::new();
        for (vertex, _) in used.iter().enumerate().filter(|(_, used)| **used) {
            renamed[vertex] = VertexId::new(positions.len());
            positions.push(self.positions[vertex]);
        }
        let cells = self.cells.iter().map(|cell| cell.map(|v| renamed[v.index()])).collect();
        Self { positions, cells }
    }
}

/// Twice the area of a triangle as a vector along its normal (counter-clockwise seen from outside).
pub fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Six times the signed volume of a tetrahedron; positive when `d` lies on the side from which `a b c` turns
/// counter-clockwise.
pub fn volume_six([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).cross(c - a).dot(d - a)
}
