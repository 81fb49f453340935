//! What a reader found in a file and what it did about it.

use super::Format;
use super::census::Census;
use super::split::SplitCounts;
use crate::id::VertexId;
use serde::Serialize;
use std::fmt;

/// How many spots a [`Finding`] remembers.
const SPOTS_KEPT: usize = 5;

/// Something found a number of times, with its first few spots.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Finding {
    /// How often.
    pub count: usize,
    /// The first few, at most five.
    pub first: Vec<Spot>,
}

/// A spot in the loaded mesh, or, for what was dropped, in the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spot {
    /// The vertices concerned.
    pub vertices: Vec<VertexId>,
    /// Where that is, in model units.
    pub position: [f32; 3],
}

impl Finding {
    /// Counts one more, and remembers its spot if it is among the first.
    pub(super) fn add(&mut self, spot: impl FnOnce() -> Spot) {
        self.count += 1;
        if self.first.len() < SPOTS_KEPT {
            self.first.push(spot());
        }
    }
}

/// Things in a file that are no surface and were left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Left {
    /// Faces with fewer than three corners.
    pub short_faces: usize,
    /// Points, lines and free-form pieces.
    pub other_elements: usize,
}

/// The faces that a repair dropped: how many, and the first few by their number in the file, from 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Dropped {
    /// How many triangles.
    pub count: usize,
    /// The first few faces, at most five.
    pub first_faces: Vec<usize>,
}

impl Dropped {
    pub(super) fn add(&mut self, face: impl FnOnce() -> usize) {
        self.count += 1;
        if self.first_faces.len() < SPOTS_KEPT {
            self.first_faces.push(face());
        }
    }
}

/// What was in a file, what was repaired, and what the surface is like. Displays as a few readable lines.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadReport {
    /// The format read.
    pub format: Format,
    /// Vertices as written (glTF: summed over the instances of the scene).
    pub vertices_written: usize,
    /// Faces as written.
    pub faces_written: usize,
    /// Faces of more than three corners, fanned around their first.
    pub polygons_triangulated: usize,
    /// Things left out because they are no surface.
    pub left_out: Left,
    /// Vertices merged into an earlier one at exactly the same position.
    pub welded_vertices: usize,
    /// Triangles dropped because two corners are the same vertex (after welding).
    pub degenerate_triangles: Dropped,
    /// Triangles dropped because an earlier one has the same three vertices, in whatever order.
    pub duplicate_triangles: Dropped,
    /// Vertices dropped because no triangle uses them.
    pub unused_vertices: usize,
    /// Of those, vertices whose position is not finite.
    pub unused_not_finite: usize,
    /// What was split, if [`super::NonManifold::Split`] was asked for.
    pub split: Option<SplitCounts>,
    /// The loaded mesh as a surface, after all repairs.
    pub census: Census,
    /// Whatever else was ignored or unusual, in words.
    pub notes: Vec<String>,
}

impl LoadReport {
    /// Whether the mesh is just what the file says: nothing repaired, left out or remarked on.
    pub fn is_untouched(&self) -> bool {
        self.remarks().is_empty()
    }

    /// What was left out or repaired, a line each.
    fn remarks(&self) -> Vec<String> {
        let dropped = |what: &str, dropped: &Dropped| {
            let faces = dropped.first_faces.iter().map(ToString::to_string).collect::<Vec<_>>();
            let more = if dropped.count > faces.len() { ", ..." } else { "" };
            (dropped.count, format!("{what} (faces {}{more})", faces.join(", ")))
        };
        let split = self.split.unwrap_or_default();
        let lines = [
            (self.polygons_triangulated, "polygons triangulated as fans".into()),
            (self.left_out.short_faces, "faces of fewer than three corners left out".into()),
            (self.left_out.other_elements, "points, lines or free-form pieces left out".into()),
            (self.welded_vertices, "vertices merged with one at the same position".into()),
            dropped("triangles dropped for repeating a vertex", &self.degenerate_triangles),
            dropped("triangles dropped as duplicates", &self.duplicate_triangles),
            (self.unused_vertices, format!("unused vertices dropped ({} not finite)", self.unused_not_finite)),
            (split.copies, format!("copies split off {} vertices and {} edges", split.vertices, split.edges)),
        ];
        let counted = lines.into_iter().filter(|line| line.0 > 0).map(|(n, what)| format!("{n} {what}"));
        counted.chain(self.notes.iter().cloned()).collect()
    }
}

impl fmt::Display for LoadReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} vertices, {} faces as written", self.format, self.vertices_written, self.faces_written)?;
        for remark in self.remarks() {
            writeln!(f, "  {remark}")?;
        }
        self.census.fmt(f)
    }
}

impl fmt::Display for Census {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { vertices, triangles, components, boundary_edges, boundary_loops, .. } = self;
        write!(f, "{vertices} vertices, {triangles} triangles, {components} components")?;
        if *boundary_edges > 0 {
            write!(f, ", {boundary_edges} boundary edges in {boundary_loops} loops")?;
        }
        match self.genus {
            Some(genus) => writeln!(f, ", genus {genus}")?,
            None => writeln!(f)?,
        }
        if !self.orientable {
            writeln!(f, "  not orientable")?;
        }
        finding(f, "edges of more than two triangles", &self.non_manifold_edges)?;
        finding(f, "vertices of more than one umbrella", &self.non_manifold_vertices)?;
        finding(f, "edges whose two triangles disagree in orientation", &self.inconsistent_edges)
    }
}

fn finding(f: &mut fmt::Formatter<'_>, what: &str, finding: &Finding) -> fmt::Result {
    let Some(first) = finding.first.first() else { return Ok(()) };
    let vertices = first.vertices.iter().map(ToString::to_string).collect::<Vec<_>>().join("-");
    let [x, y, z] = first.position;
    writeln!(f, "  {} {what}, the first at vertex {vertices} ({x} {y} {z})", finding.count)
}
