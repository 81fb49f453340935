//! Faces as a reader finds them, before anything is repaired.

use super::error::{Place, Problem, Refusal};
use super::report::Left;
use super::sets::Buckets;
use glam::Vec3;

/// Positions and triangles with indices as written, and enough memory of the faces to name them.
#[derive(Debug, Default)]
pub(super) struct Soup {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Faces that were fanned into more than one triangle.
    pub(super) polygons: usize,
    /// Things in the file that are no surface.
    pub(super) left: Left,
    /// Remarks for the report.
    pub(super) notes: Vec<String>,
    /// Number of faces as written.
    pub(super) faces: usize,
    /// Triangles before each face; empty while every face is one triangle.
    starts: Vec<u32>,
}

impl Soup {
    /// Adds a face as a fan around its first corner; with fewer than three corners it is left out and counted.
    pub(super) fn push_face(&mut self, corners: &[u32]) {
        if corners.len() != 3 && self.starts.is_empty() {
            self.starts = (0..self.faces as u32).collect();
        }
        if corners.len() != 3 || !self.starts.is_empty() {
            self.starts.push(self.triangles.len() as u32);
        }
        self.faces += 1;
        if corners.len() < 3 {
            self.left.short_faces += 1;
            return;
        }
        self.polygons += usize::from(corners.len() > 3);
        let fan = (1..corners.len() - 1).map(|k| [corners[0], corners[k], corners[k + 1]]);
        self.triangles.extend(fan);
    }

    /// The face, from 0, that a triangle belongs to.
    pub(super) fn face_of(&self, triangle: usize) -> usize {
        if self.starts.is_empty() {
            return triangle;
        }
        self.starts.partition_point(|&start| start as usize <= triangle) - 1
    }

    /// Splits quadrilaterals along their other diagonal where fans made the same triangle twice.
    ///
    /// Two quadrilaterals that share two sides do that at the vertex between them, and dropping one
    /// of the triangles would tear a sound surface. Requires: indices checked. One pass, only with polygons.
    pub(super) fn turn_doubled_quads(&mut self) {
        if self.polygons == 0 {
            return;
        }
        let mut turned = 0;
        for triangle in same_triangles(self.positions.len(), self.triangles.iter().copied()).into_iter().flatten() {
            let face = self.face_of(triangle as usize);
            let start = self.starts[face] as usize;
            let end = self.starts.get(face + 1).map_or(self.triangles.len(), |end| *end as usize);
            // A quadrilateral that both its halves name is turned once.
            if let [[a, b, c], [_, also_c, d]] = self.triangles[start..end]
                && c == also_c
            {
                self.triangles[start..end].copy_from_slice(&[[b, c, d], [b, d, a]]);
                turned += 1;
            }
        }
        if turned > 0 {
            self.notes.push(format!(
                "{turned} quadrilaterals split along their other diagonal, where a fan would double a triangle"
            ));
        }
    }

    /// The first vertex whose position is not finite and that some triangle uses. Requires: indices checked.
    pub(super) fn first_not_finite(&self) -> Option<usize> {
        if self.positions.iter().all(|p| p.is_finite()) {
            return None;
        }
        let corners = self.triangles.iter().flatten().map(|&v| v as usize);
        corners.filter(|&v| !self.positions[v].is_finite()).min()
    }

    /// Refuses the first used vertex whose position is not finite; unused ones are dropped later.
    pub(super) fn check_positions(&self) -> Result<(), Refusal> {
        let Some(vertex) = self.first_not_finite() else { return Ok(()) };
        let [x, y, z] = self.positions[vertex].to_array();
        Err(Refusal::new(Place::Vertex(vertex), Problem::NotFinite(x, y, z)))
    }

    /// Refuses the first index that has no vertex, and counts that do not fit 32-bit ids.
    pub(super) fn check_indices(&self) -> Result<(), Refusal> {
        let count = self.positions.len();
        if count >= u32::MAX as usize || self.triangles.len() >= u32::MAX as usize / 3 {
            let problem = Problem::TooLarge("ids have 32 bits".into());
            return Err(Refusal::new(Place::File, problem));
        }
        let bad = |corner: &u32| *corner as usize >= count;
        match self.triangles.iter().position(|t| t.iter().any(bad)) {
            None => Ok(()),
            Some(triangle) => {
                let index = self.triangles[triangle].into_iter().find(|c| bad(c)).unwrap_or_default();
                let problem = Problem::IndexOutOfRange { index: index.into(), count };
                Err(Refusal::new(Place::Face(self.face_of(triangle)), problem))
            }
        }
    }
}

/// Groups of triangles with the same three corners in whatever order, each in the order of the triangles.
pub(super) fn same_triangles(vertices: usize, triangles: impl Iterator<Item = [u32; 3]> + Clone) -> Vec<Vec<u32>> {
    let keys = triangles.enumerate().map(|(t, mut corners)| {
        corners.sort_unstable();
        (corners[0], (corners[1], corners[2], t as u32))
    });
    let mut groups = Vec::new();
    for (_, bucket) in Buckets::new(vertices, keys).iter() {
        let runs = bucket.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter(|run| run.len() > 1);
        groups.extend(runs.map(|run| run.iter().map(|&(_, _, t)| t).collect()));
    }
    groups
}

/// An index as a file gives it, refused when no `u32` can hold it; whether its vertex is there is seen at the end.
pub(super) fn index_of(value: i64, face: usize, count: usize) -> Result<u32, Refusal> {
    u32::try_from(value).map_err(|_| Refusal::new(Place::Face(face), Problem::IndexOutOfRange { index: value, count }))
}
