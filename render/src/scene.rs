//! The encoding: what a picture shows, as plain arrays that either painter draws as they stand.

use crate::ramp::{Ramp, Rgba};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use mt_core::{Mesh, mesh::area_vector};

/// One corner of a triangle, as it lies in a vertex buffer. Three in a row are a triangle, so that the
/// place in the row says which barycentric coordinate is the corner's own.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Corner {
    /// Position relative to [`Scene::origin`], in model units.
    pub position: [f32; 3],
    /// Unit normal, on the side from which the triangle turns counter-clockwise; zero where there is none.
    pub normal: [f32; 3],
    /// Colour of the material.
    pub colour: Rgba,
}

const _: () = assert!(size_of::<Corner>() == 28);

/// A line of constant width on the screen, with round ends; a dot where its ends coincide.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Segment {
    /// One end, relative to [`Scene::origin`], in model units.
    pub from: [f32; 3],
    /// The other end.
    pub to: [f32; 3],
    /// Colour.
    pub colour: Rgba,
    /// Width in pixels of a picture 768 pixels high.
    pub width_px: f32,
}

/// What a colour bar says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Legend {
    /// The ramp drawn.
    pub ramp: Ramp,
    /// Values at its lower and upper end.
    pub range: (f32, f32),
    /// A word above the bar; letters beyond those of "error" and "level" stay blank.
    pub caption: &'static str,
}

/// Of the edges of triangles, where they are drawn.
pub const WIRE: Rgba = [38, 36, 34, 255];
/// Of a cell of which nothing is told.
const UNKNOWN: Rgba = [150, 150, 150, 255];

/// Everything a painter needs but the camera. 84 bytes a triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The point of the world that coordinates are relative to, so that models far from 0 do not tremble.
    pub origin: Vec3,
    /// The triangles, three corners each.
    pub corners: Vec<Corner>,
    /// The lines, drawn over the triangles; where the mesh hides them a trace shows through.
    pub segments: Vec<Segment>,
    /// Lines that lie on the mesh: what is hidden of them is not drawn.
    pub marks: Vec<Segment>,
    /// Colour of the triangles' edges; `None` leaves them out.
    pub wire: Option<Rgba>,
    /// Colours behind everything, at the top and at the bottom of the picture.
    pub background: [Rgba; 2],
    /// A colour bar at the right side.
    pub legend: Option<Legend>,
}

/// What colours the triangles show: one value per cell of the mesh, and the values at the ramp's ends.
///
/// Cells beyond the end of the slice, and values that are not finite, are drawn grey.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Overlay<'a> {
    /// The material's own colour.
    #[default]
    None,
    /// Geometric error of each cell, in model units.
    Error {
        /// One value per cell.
        values: &'a [f32],
        /// Values at the lower and the upper end of the ramp.
        range: (f32, f32),
    },
    /// Level of refinement of each cell.
    Level {
        /// One value per cell.
        values: &'a [f32],
        /// Values at the lower and the upper end of the ramp.
        range: (f32, f32),
    },
    /// A colour of each cell: what it means is for the caption to say.
    Colours(&'a [Rgba]),
}

/// How a mesh is to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look<'a> {
    /// Colour of the material where no overlay covers it.
    pub material: Rgba,
    /// Whether the triangles' edges are drawn.
    pub wireframe: bool,
    /// Whether normals are averaged at vertices; flat facets show a triangulation better.
    pub smooth: bool,
    /// What colours mean.
    pub overlay: Overlay<'a>,
}

impl Default for Look<'_> {
    fn default() -> Self {
        Self { material: [222, 214, 202, 255], wireframe: false, smooth: false, overlay: Overlay::None }
    }
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            origin: Vec3::ZERO,
            corners: Vec::new(),
            segments: Vec::new(),
            marks: Vec::new(),
            wire: None,
            background: [[250, 251, 252, 255], [218, 222, 227, 255]],
            legend: None,
        }
    }
}

impl<'a> Overlay<'a> {
    /// The range from the least to the greatest finite value; (0, 1) where there is none.
    pub fn range_of(values: &[f32]) -> (f32, f32) {
        let finite = values.iter().copied().filter(|value| value.is_finite());
        let range = finite.fold((f32::MAX, f32::MIN), |(low, high), value| (low.min(value), high.max(value)));
        if range.0 <= range.1 { range } else { (0.0, 1.0) }
    }

    fn parts(&self) -> Option<(&'a [f32], Legend)> {
        match *self {
            Overlay::None | Overlay::Colours(_) => None,
            Overlay::Error { values, range } => Some((values, Legend { ramp: Ramp::Plasma, range, caption: "error" })),
            Overlay::Level { values, range } => Some((values, Legend { ramp: Ramp::Viridis, range, caption: "level" })),
        }
    }
}

impl Legend {
    /// The colour of a value; grey where it or the range is not finite.
    pub fn colour(&self, value: f32) -> Rgba {
        let (low, high) = (f64::from(self.range.0), f64::from(self.range.1));
        let width = high - low;
        // A range of no width is a constant: its one value sits at the lower end.
        let place = if width == 0.0 { f64::from(value) - low } else { (f64::from(value) - low) / width };
        self.ramp.colour(if value.is_finite() { place as f32 } else { f32::NAN })
    }
}

/// The scene that shows `mesh`. O(cells); allocates 84 bytes a cell, and 12 a vertex while `smooth`.
///
/// A cell is left out where a corner names no vertex of the mesh or a position is not finite.
pub fn encode(mesh: &Mesh<3>, look: &Look) -> Scene {
    let (low, high) = mesh.bounding_box().unwrap_or_default();
    let middle = low * 0.5 + high * 0.5;
    let origin = if middle.is_finite() { middle } else { Vec3::ZERO };
    let overlay = look.overlay.parts();
    let normals = if look.smooth { vertex_normals(mesh) } else { Vec::new() };
    let mut scene = Scene {
        origin,
        corners: Vec::with_capacity(mesh.cells.len() * 3),
        wire: look.wireframe.then_some(WIRE),
        legend: overlay.map(|(_, legend)| legend),
        ..Scene::default()
    };
    for (cell, vertices) in mesh.cells.iter().enumerate() {
        let Some(positions) = positions(mesh, vertices.map(|vertex| vertex.index())) else { continue };
        let colour = match (look.overlay, overlay) {
            (Overlay::Colours(colours), _) => colours.get(cell).copied().unwrap_or(UNKNOWN),
            (_, Some((values, legend))) => legend.colour(values.get(cell).copied().unwrap_or(f32::NAN)),
            (_, None) => look.material,
        };
        let flat = unit_normal(positions);
        for (position, vertex) in positions.into_iter().zip(vertices) {
            let normal = normals.get(vertex.index()).copied().unwrap_or(flat).to_array();
            scene.corners.push(Corner { position: (position - origin).to_array(), normal, colour });
        }
    }
    scene
}

/// The corners' positions, where there are three and all are finite.
fn positions(mesh: &Mesh<3>, vertices: [usize; 3]) -> Option<[Vec3; 3]> {
    let found = vertices.map(|vertex| mesh.positions.get(vertex).copied().filter(|position| position.is_finite()));
    let [Some(a), Some(b), Some(c)] = found else { return None };
    Some([a, b, c])
}

/// In double precision, where the squares of all finite single coordinates are finite.
fn unit_normal(positions: [Vec3; 3]) -> Vec3 {
    area_vector(positions.map(Vec3::as_dvec3)).normalize_or_zero().as_vec3()
}

/// Normals averaged by area at each vertex; zero where no sound cell meets.
fn vertex_normals(mesh: &Mesh<3>) -> Vec<Vec3> {
    let mut sums = vec![glam::DVec3::ZERO; mesh.positions.len()];
    for cell in &mesh.cells {
        let vertices = cell.map(|vertex| vertex.index());
        let Some(positions) = positions(mesh, vertices) else { continue };
        let area = area_vector(positions.map(Vec3::as_dvec3));
        vertices.into_iter().for_each(|vertex| sums[vertex] += area);
    }
    sums.into_iter().map(|sum| sum.normalize_or_zero().as_vec3()).collect()
}
