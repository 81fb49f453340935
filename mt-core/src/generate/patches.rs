//! Sheets of quadrilaterals, each split in two: planar patches, bumps, rings, tubes and the strip with one side.

use super::noise::Fractal;
use crate::id::VertexId;
use crate::mesh::Mesh;
use crate::random::Random;
use glam::{DVec3, Vec3, vec3};
use std::f64::consts::{PI, TAU};

/// A planar patch of `columns` x `rows` unit squares (each at least 1) in the plane z = 0.
///
/// `(columns + 1) (rows + 1)` vertices, `2 columns rows` triangles, one boundary loop.
pub fn grid(columns: usize, rows: usize) -> Mesh<3> {
    let sheet = Sheet::open(columns.max(1), rows.max(1));
    sheet.mesh(|i, j| vec3(i as f32, j as f32, 0.0))
}

/// [`grid`] with heights of up to `amplitude` (in sides of a square) by fractal noise, bumps about eight squares wide.
pub fn bumpy_grid(columns: usize, rows: usize, amplitude: f32, seed: u64) -> Mesh<3> {
    let noise = Fractal { frequency: 0.125, octaves: 3, persistence: 0.5, seed };
    let mut mesh = grid(columns, rows);
    for p in &mut mesh.positions {
        p.z = amplitude * noise.at(p.as_dvec3()) as f32;
    }
    mesh
}

/// A planar ring between the radii 1 and 2: `n` (at least 3) squares around, `rings` (at least 1) across.
///
/// `n (rings + 1)` vertices, `2 n rings` triangles, two boundary loops.
pub fn annulus(n: usize, rings: usize) -> Mesh<3> {
    let (n, rings) = (n.max(3), rings.max(1));
    let sheet = Sheet { columns: n, rows: rings, around: true, across: false };
    // From the outer circle inwards, so that the normals point up.
    sheet.mesh(|i, j| circle(i, n, 2.0 - j as f64 / rings as f64).as_vec3())
}

/// A row of `n` triangles (at least 1) in the plane z = 0: `n + 2` vertices, all of them on the one boundary loop.
pub fn strip(n: usize) -> Mesh<3> {
    let n = n.max(1) as u32;
    let positions = (0..n + 2).map(|i| vec3(i as f32 * 0.5, (i % 2) as f32, 0.0)).collect();
    let cells: Vec<_> = (0..n).map(|i| if i % 2 == 0 { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] }).collect();
    Mesh::from_indices(positions, &cells)
}

/// An open tube of radius 1 and height 2 along z: `n` (at least 3) squares around, `rings` (at least 1) up.
///
/// `n (rings + 1)` vertices, `2 n rings` triangles, two boundary loops.
pub fn cylinder(n: usize, rings: usize) -> Mesh<3> {
    let (n, rings) = (n.max(3), rings.max(1));
    let sheet = Sheet { columns: n, rows: rings, around: true, across: false };
    sheet.mesh(|i, j| (circle(i, n, 1.0) + DVec3::Z * (2.0 * j as f64 / rings as f64 - 1.0)).as_vec3())
}

/// A patch of 8 x 8 squares squeezed and sheared until most of its triangles are needles or caps.
///
/// 81 vertices, 128 triangles of positive area, one boundary loop; columns are between 0.002 and 1 wide.
pub fn slivers(seed: u64) -> Mesh<3> {
    let mut rng = Random::new(seed);
    let mut x = 0.0;
    let columns: Vec<f64> = (0..9)
        .map(|_| {
            let here = x;
            x += 0.002 * 500.0f64.powf(rng.unit().powi(2));
            here
        })
        .collect();
    let shear = rng.between(-2.0, 2.0);
    let noise = Fractal { frequency: 0.5, octaves: 2, persistence: 0.5, seed: rng.bits() };
    Sheet::open(8, 8).mesh(|i, j| {
        let p = DVec3::new(columns[i] + shear * j as f64, j as f64, 0.0);
        (p + DVec3::Z * (0.05 * noise.at(p))).as_vec3()
    })
}

/// A strip with half a twist: `n` (at least 5) pieces around, two squares wide.
///
/// `3 n` vertices, `4 n` triangles, one boundary loop, Euler characteristic 0. It has no coherent orientation: the
/// triangles turn the same way but for those that meet where the strip is closed.
pub fn moebius(n: usize) -> Mesh<3> {
    let n = n.max(5);
    let mut positions = Vec::with_capacity(3 * n);
    for i in 0..n {
        let twist = PI * i as f64 / n as f64;
        let outwards = circle(i, n, 1.0);
        let across = outwards * twist.cos() + DVec3::Z * twist.sin();
        positions.extend([-1.0, 0.0, 1.0].map(|side| (outwards * 2.0 + across * side * 0.5).as_vec3()));
    }
    let name = |i: usize, j: usize| VertexId::new(if i == n { 2 - j } else { 3 * i + j });
    let square = |i, j| split([name(i, j), name(i + 1, j), name(i + 1, j + 1), name(i, j + 1)]);
    let cells = (0..n).flat_map(|i| (0..2).flat_map(move |j| square(i, j))).collect();
    Mesh { positions, cells }
}

/// The `i`-th of `n` points on a circle in the plane z = 0.
pub(super) fn circle(i: usize, n: usize, radius: f64) -> DVec3 {
    let (sine, cosine) = (TAU * i as f64 / n as f64).sin_cos();
    DVec3::new(cosine, sine, 0.0) * radius
}

/// The two triangles of a quadrilateral, cut from its first corner to its third.
pub(super) fn split([a, b, c, d]: [VertexId; 4]) -> [[VertexId; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// A rectangle of squares whose opposite sides may be glued together.
pub(super) struct Sheet {
    /// Squares along a row.
    pub(super) columns: usize,
    /// Squares along a column.
    pub(super) rows: usize,
    /// Whether the last column is glued to the first.
    pub(super) around: bool,
    /// Whether the last row is glued to the first.
    pub(super) across: bool,
}

impl Sheet {
    /// A sheet with four free sides.
    pub(super) fn open(columns: usize, rows: usize) -> Self {
        Self { columns, rows, around: false, across: false }
    }

    /// The mesh whose vertex in column `i` of row `j` is `place(i, j)`.
    pub(super) fn mesh(&self, place: impl Fn(usize, usize) -> Vec3) -> Mesh<3> {
        let width = self.columns + usize::from(!self.around);
        let height = self.rows + usize::from(!self.across);
        let mut positions = Vec::with_capacity(width * height);
        for j in 0..height {
            positions.extend((0..width).map(|i| place(i, j)));
        }
        Mesh { positions, cells: self.cells() }
    }

    /// The triangles, two a square, row by row.
    pub(super) fn cells(&self) -> Vec<[VertexId; 3]> {
        let width = self.columns + usize::from(!self.around);
        let height = self.rows + usize::from(!self.across);
        let mut cells = Vec::with_capacity(2 * self.columns * self.rows);
        for j in 0..self.rows {
            let (low, high) = (j * width, if j + 1 == height { 0 } else { (j + 1) * width });
            for i in 0..self.columns {
                let next = if i + 1 == width { 0 } else { i + 1 };
                let corners = [low + i, low + next, high + next, high + i];
                cells.extend(split(corners.map(VertexId::new)));
            }
        }
        cells
    }
}
