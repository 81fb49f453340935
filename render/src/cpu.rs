//! The CPU painter: bands of rows, each painted by one thread from a list of what may touch it. The same
//! bytes whatever the number of threads.

use crate::clip::{Polygon, clip};
use crate::globals::Globals;
use crate::ink::{Ink, InkCorner};
use crate::picture::Picture;
use crate::ramp::Rgba;
use crate::raster::{Blend, Facet, Sheet};
use crate::scene::{Corner, Scene};
use glam::{Vec3, Vec4};
use mt_core::Camera;
use std::sync::Mutex;

/// Rows of a band: small enough for a cache, large enough that few triangles are in two.
const BAND: usize = 32;

/// What all bands read.
struct Job<'a> {
    triangles: &'a [[Corner; 3]],
    ink: Ink,
    globals: Globals,
    size: [usize; 2],
}

/// Paints with every core. O(triangles + pixels covered); 4 bytes a triangle and 32 a pixel of the bands
/// at work, besides the picture.
pub(crate) fn paint(scene: &Scene, camera: &Camera) -> Picture {
    let globals = Globals::new(scene, camera);
    let size = [camera.width_px as usize, camera.height_px as usize];
    let (triangles, _) = scene.corners.as_chunks::<3>();
    let job = Job { triangles, ink: Ink::new(scene, camera, &globals), globals, size };
    let lists = job.sort();
    let mut rgba = vec![0; 4 * size[0] * size[1]];
    let bands = rgba.chunks_mut(4 * size[0] * BAND).zip(&lists).enumerate();
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(lists.len());
    let queue = Mutex::new(bands);
    // Only a panic of another thread poisons the queue, and the scope hands that on.
    let next = || queue.lock().ok().and_then(|mut queue| queue.next());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((band, (rows, list))) = next() {
                    job.paint_band(band, list, rows);
                }
            });
        }
    });
    Picture { width: camera.width_px, height: camera.height_px, rgba }
}

impl Job<'_> {
    /// For each band the triangles that may touch it, in their order.
    fn sort(&self) -> Vec<Vec<u32>> {
        let mut lists = vec![Vec::new(); self.size[1].div_ceil(BAND)];
        for (index, triangle) in self.triangles.iter().enumerate() {
            if let Some((top, bottom)) = self.reach(&self.project(triangle)) {
                for list in &mut lists[top / BAND..=bottom / BAND] {
                    list.push(index as u32);
                }
            }
        }
        lists
    }

    fn project(&self, triangle: &[Corner; 3]) -> Polygon {
        let matrix = self.globals.matrix();
        clip(triangle.map(|corner| matrix * Vec3::from_array(corner.position).extend(1.0)))
    }

    /// First and last row of the picture that a polygon may touch.
    fn reach(&self, polygon: &Polygon) -> Option<(usize, usize)> {
        let height = self.size[1] as f32;
        let rows = polygon.points().iter().map(|point| (0.5 - 0.5 * point.clip.y / point.clip.w) * height);
        let (top, bottom) = rows.fold((f32::MAX, f32::MIN), |(top, bottom), row| (top.min(row), bottom.max(row)));
        // A row more on either side makes up for the snapping of positions.
        let visible = top <= bottom && bottom >= -1.0 && top <= height + 1.0;
        let row = |place: f32| place.clamp(0.0, height - 1.0) as usize;
        visible.then(|| (row(top - 1.0), row(bottom + 1.0)))
    }

    fn paint_band(&self, band: usize, list: &[u32], rgba: &mut [u8]) {
        let first = band * BAND;
        let mut sheet = Sheet::new(self.size[0], first..(first + BAND).min(self.size[1]));
        self.draw_ink(&mut sheet, &self.ink.under);
        for &index in list {
            self.draw_triangle(&mut sheet, &self.triangles[index as usize]);
        }
        self.draw_ink(&mut sheet, &self.ink.over);
        sheet.resolve(rgba);
    }

    fn draw_ink(&self, sheet: &mut Sheet, corners: &[InkCorner]) {
        let (triangles, _) = corners.as_chunks::<3>();
        for triangle in triangles {
            let colours = triangle.map(|corner| corner.colour);
            let mix = |weights: Vec3| std::array::from_fn(|i| to_byte(blend(weights, colours, i)));
            let polygon = clip(triangle.map(|corner| Vec3::from_array(corner.position).extend(1.0)));
            for facet in self.facets(&polygon, sheet) {
                sheet.fill(&facet, Blend::Mix, |weights, _| mix(weights));
            }
        }
    }

    fn draw_triangle(&self, sheet: &mut Sheet, triangle: &[Corner; 3]) {
        let [a, b, c] = triangle.map(|corner| Vec3::from_array(corner.normal));
        let flat = a == b && b == c;
        for facet in self.facets(&self.project(triangle), sheet) {
            let side = if facet.front { 1.0 } else { -1.0 };
            let light = self.globals.light(a.normalize_or_zero() * side);
            sheet.fill(&facet, Blend::Replace, |weights, slopes| {
                let bent = || (a * weights.x + b * weights.y + c * weights.z).normalize_or_zero() * side;
                let light = if flat { light } else { self.globals.light(bent()) };
                self.shade(triangle, light, weights, slopes)
            });
        }
    }

    /// `mesh_fragment` of the shader.
    fn shade(&self, triangle: &[Corner; 3], light: f32, weights: Vec3, slopes: &dyn Fn() -> Vec3) -> Rgba {
        let colours = triangle.map(|corner| corner.colour);
        let material = Vec3::from_array(std::array::from_fn(|i| blend(weights, colours, i) / 255.0));
        let mut shaded = (material * light).min(Vec3::ONE);
        let wire = Vec4::from_array(self.globals.wire);
        if wire.w > 0.0 {
            let lifted = wire.truncate() + Globals::wire_lift(shaded);
            shaded = shaded.lerp(lifted, self.globals.wire_cover(weights, slopes()));
        }
        let [red, green, blue] = (shaded * 255.0).to_array().map(to_byte);
        [red, green, blue, 255]
    }

    /// The facets of a polygon, as a fan, that may touch the sheet.
    fn facets<'a>(&'a self, polygon: &'a Polygon, sheet: &Sheet) -> impl Iterator<Item = Facet> + use<'a> {
        let rows = sheet.rows.clone();
        let points = polygon.points();
        (2..points.len())
            .filter_map(|i| Facet::new([points[0], points[i - 1], points[i]], self.size))
            .filter(move |facet| facet.rows().start < rows.end && rows.start < facet.rows().end)
    }
}

/// One channel of three colours mixed, 0 to 255.
fn blend(weights: Vec3, colours: [Rgba; 3], channel: usize) -> f32 {
    let [a, b, c] = colours.map(|colour| f32::from(colour[channel]));
    Vec4::new(a, b, c, 0.0).dot(weights.extend(0.0))
}

fn to_byte(value: f32) -> u8 {
    (value + 0.5).clamp(0.0, 255.0) as u8
}
