//! Vector drawings: the edges of a mesh as far as they can be seen, for papers; as SVG and as PDF.
//!
//! Hidden lines are removed by a picture of depths of twice the size: along each edge it is asked, half a pixel at a time,
//! whether something lies before it, and what can be seen in one piece is one line. So a drawing is as large as what it
//! shows, and a line that ends behind another ends within half a pixel of it.

use crate::clip::{Polygon, clip};
use crate::easel::RenderError;
use crate::globals::Globals;
use crate::ink::clip_segment;
use crate::ramp::Rgba;
use crate::raster::{Blend, Facet, Sheet};
use crate::scene::{Scene, Segment, WIRE};
use glam::{Vec3, Vec4};
use mt_core::Camera;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Depths are taken in a picture so many times as large.
const FINER: usize = 2;
/// A depth so much farther than what is there still counts as there; edges lie on what hides what is behind them.
const SLACK: f32 = 4e-6;
/// Height of the line of text, and its letters, in units of the drawing.
const CAPTION: f32 = 22.0;
const LETTERS: f32 = 12.0;
/// Lines of a mesh.
const EDGE_WIDTH: f32 = 0.6;

/// Lines on a page, from the upper left corner, in pixels of the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Width of the page.
    pub width: f32,
    /// Height of the page, without the line of text.
    pub height: f32,
    /// What can be seen, in no order.
    pub lines: Vec<Line>,
    /// A line of text below; may be empty.
    pub caption: String,
}

/// A straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// One end.
    pub from: [f32; 2],
    /// The other.
    pub to: [f32; 2],
    /// Its colour.
    pub colour: Rgba,
    /// Its width.
    pub width: f32,
}

impl Drawing {
    /// The edges of a scene's triangles and its lines, as far as `camera` sees them. O(triangles + pixels + lengths);
    /// 128 bytes a pixel of the camera while it works.
    ///
    /// Refuses a camera that [`Camera::check`] refuses.
    pub fn new(scene: &Scene, camera: &Camera, caption: &str) -> Result<Self, RenderError> {
        camera.check()?;
        let size = [camera.width_px as usize, camera.height_px as usize];
        let eye = Eye { globals: Globals::new(scene, camera), size: size.map(|side| side * FINER) };
        let depths = eye.depths(scene);
        let mut lines = Vec::new();
        let colour = scene.wire.unwrap_or(WIRE);
        for (from, to) in edges(scene) {
            eye.seen(&depths, from, to, &mut |from, to| lines.push(Line { from, to, colour, width: EDGE_WIDTH }));
        }
        for &Segment { from, to, colour, width_px } in scene.segments.iter().chain(&scene.marks) {
            let width = width_px * camera.height_px as f32 / 768.0;
            eye.seen(&depths, from, to, &mut |from, to| lines.push(Line { from, to, colour, width }));
        }
        Ok(Self { width: size[0] as f32, height: size[1] as f32, lines, caption: caption.to_owned() })
    }

    fn page_height(&self) -> f32 {
        self.height + if self.caption.is_empty() { 0.0 } else { CAPTION }
    }

    /// The lines by colour and width, so that each kind is told once.
    fn kinds(&self) -> BTreeMap<(Rgba, u32), Vec<&Line>> {
        let mut kinds: BTreeMap<_, Vec<&Line>> = BTreeMap::new();
        for line in &self.lines {
            kinds.entry((line.colour, line.width.to_bits())).or_default().push(line);
        }
        kinds
    }

    /// The drawing as an SVG file, on white.
    pub fn svg(&self) -> String {
        let (width, height) = (self.width, self.page_height());
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
        );
        for (([red, green, blue, _], bits), lines) in self.kinds() {
            let stroke = f32::from_bits(bits);
            _ = write!(
                svg,
                "<path fill=\"none\" stroke=\"#{red:02x}{green:02x}{blue:02x}\" stroke-width=\"{stroke}\" stroke-linecap=\"round\" d=\""
            );
            for line in lines {
                let [x, y, u, v] = [line.from[0], line.from[1], line.to[0], line.to[1]].map(short);
                _ = write!(svg, "M{x} {y}L{u} {v}");
            }
            svg.push_str("\"/>\n");
        }
        if !self.caption.is_empty() {
            let (x, y) = (width * 0.5, self.height + CAPTION * 0.65);
            _ = writeln!(
                svg,
                "<text x=\"{x}\" y=\"{y}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"{LETTERS}\" text-anchor=\"middle\">{}</text>",
                escape(&self.caption)
            );
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// The drawing as a PDF file of one page, a point a unit. Letters beyond ASCII become question marks in the line of text.
    pub fn pdf(&self) -> Vec<u8> {
        let height = self.page_height();
        let mut content = String::from("1 J\n");
        for (([red, green, blue, _], bits), lines) in self.kinds() {
            let [red, green, blue] = [red, green, blue].map(|channel| (f32::from(channel) / 0.255).round() / 1000.0);
            _ = writeln!(content, "{red} {green} {blue} RG {} w", f32::from_bits(bits));
            for line in lines {
                let [x, y, u, v] = [line.from[0], height - line.from[1], line.to[0], height - line.to[1]].map(short);
                _ = writeln!(content, "{x} {y} m {u} {v} l");
            }
            content.push_str("S\n");
        }
        if !self.caption.is_empty() {
            let text: String =
                self.caption.chars().map(|c| if c.is_ascii() && !c.is_ascii_control() { c } else { '?' }).collect();
            let text = text.replace('\\', "\\\\").replace('(', "\\(").replace(')', "\\)");
            // Helvetica is about half as wide as high, on the average.
            let x = (self.width - 0.5 * LETTERS * self.caption.chars().count() as f32).max(0.0) * 0.5;
            _ = writeln!(content, "BT /F1 {LETTERS} Tf {x} {} Td ({text}) Tj ET", CAPTION * 0.35);
        }
        file(&content, self.width, height)
    }
}

/// A PDF file of one page, by the parts that one needs: catalogue, pages, page, content, font.
fn file(content: &str, width: f32, height: f32) -> Vec<u8> {
    let parts = [
        "<< /Type /Catalog /Pages 2 0 R >>".to_owned(),
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_owned(),
        format!(
            "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {width} {height}] /Contents 4 0 R /Resources << /Font << /F1 5 0 R >> >> >>"
        ),
        format!("<< /Length {} >>\nstream\n{content}endstream", content.len()),
        "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>".to_owned(),
    ];
    let mut bytes = String::from("%PDF-1.4\n");
    let mut places = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        places.push(bytes.len());
        _ = write!(bytes, "{} 0 obj\n{part}\nendobj\n", i + 1);
    }
    let table = bytes.len();
    _ = write!(bytes, "xref\n0 {}\n0000000000 65535 f \n", parts.len() + 1);
    places.iter().for_each(|place| _ = writeln!(bytes, "{place:010} 00000 n "));
    _ = write!(bytes, "trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{table}\n%%EOF\n", parts.len() + 1);
    bytes.into_bytes()
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Two digits behind the point, and none that say nothing.
fn short(value: f32) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The edges of a scene's triangles, each once.
fn edges(scene: &Scene) -> Vec<([f32; 3], [f32; 3])> {
    let (triangles, _) = scene.corners.as_chunks::<3>();
    let bits = |p: [f32; 3]| p.map(f32::to_bits);
    let mut edges: Vec<[[u32; 3]; 2]> = Vec::with_capacity(3 * triangles.len());
    for triangle in triangles {
        for i in 0..3 {
            let (a, b) = (bits(triangle[i].position), bits(triangle[(i + 1) % 3].position));
            edges.push(if a < b { [a, b] } else { [b, a] });
        }
    }
    edges.sort_unstable();
    edges.dedup();
    edges.into_iter().map(|[a, b]| (a.map(f32::from_bits), b.map(f32::from_bits))).collect()
}

/// Where the scene is seen from, in a picture of depths.
struct Eye {
    globals: Globals,
    size: [usize; 2],
}

impl Eye {
    fn depths(&self, scene: &Scene) -> Sheet {
        let mut sheet = Sheet::new(self.size[0], 0..self.size[1]);
        let (triangles, _) = scene.corners.as_chunks::<3>();
        for triangle in triangles {
            let polygon: Polygon = clip(triangle.map(|corner| self.project(corner.position)));
            let points = polygon.points();
            for i in 2..points.len() {
                if let Some(facet) = Facet::new([points[0], points[i - 1], points[i]], self.size) {
                    sheet.fill(&facet, Blend::Replace, |_, _| [0; 4]);
                }
            }
        }
        sheet
    }

    fn project(&self, position: [f32; 3]) -> Vec4 {
        self.globals.matrix() * Vec3::from_array(position).extend(1.0)
    }

    /// Tells what can be seen of a line, piece by piece, in pixels of the camera.
    fn seen(&self, depths: &Sheet, from: [f32; 3], to: [f32; 3], tell: &mut dyn FnMut([f32; 2], [f32; 2])) {
        let Some(ends) = clip_segment(self.project(from), self.project(to)) else { return };
        let [from, to] = ends.map(|end| {
            let ndc = end.truncate() / end.w;
            Vec3::new((0.5 + 0.5 * ndc.x) * self.size[0] as f32, (0.5 - 0.5 * ndc.y) * self.size[1] as f32, ndc.z)
        });
        if !(from.is_finite() && to.is_finite()) {
            return;
        }
        let length = from.truncate().distance(to.truncate());
        let count = (length.ceil() as usize).clamp(1, 4 * (self.size[0] + self.size[1]));
        let at = |i: usize| from.lerp(to, i as f32 / count as f32);
        let mut begun: Option<Vec3> = None;
        for i in 0..=count {
            let p = at(i);
            if depths.shows(p, SLACK) {
                begun.get_or_insert(p);
            } else if let Some(first) = begun.take() {
                self.tell(first, at(i - 1), tell);
            }
        }
        if let Some(first) = begun {
            self.tell(first, to, tell);
        }
    }

    fn tell(&self, from: Vec3, to: Vec3, tell: &mut dyn FnMut([f32; 2], [f32; 2])) {
        let place = |p: Vec3| [p.x / FINER as f32, p.y / FINER as f32];
        if from.truncate().distance(to.truncate()) >= 0.5 * FINER as f32 {
            tell(place(from), place(to));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Look, encode};
    use mt_core::Mesh;

    /// Two squares over each other, the upper one half as large, seen from above.
    fn squares() -> (Scene, Camera) {
        let square = |side: f32, z: f32| {
            [[-side, -side], [side, -side], [side, side], [-side, side]].map(|[x, y]| Vec3::new(x, y, z))
        };
        let positions = [square(1.0, 0.0), square(0.5, 0.5)].concat();
        let mesh = Mesh::from_indices(positions, &[[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
        let camera = Camera {
            eye: Vec3::Z * 4.0,
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_y_degrees: 40.0,
            near: 1.0,
            far: 10.0,
            width_px: 400,
            height_px: 400,
        };
        (encode(&mesh, &Look::default()), camera)
    }

    fn length(lines: &[Line]) -> f32 {
        lines.iter().map(|line| (line.from[0] - line.to[0]).hypot(line.from[1] - line.to[1])).sum()
    }

    #[test]
    fn what_is_behind_is_left_out() {
        let (scene, camera) = squares();
        let drawing = Drawing::new(&scene, &camera, "two squares").unwrap();
        // Both outlines are seen whole; of the lower diagonal only what the upper square does not cover.
        let unit = 400.0 / (2.0 * (20f32).to_radians().tan() * 4.0);
        let nearer = 400.0 / (2.0 * (20f32).to_radians().tan() * 3.5);
        let outlines = 8.0 * unit + 4.0 * nearer;
        let diagonals = 2.0 * 2f32.sqrt() * unit;
        assert!(
            (length(&drawing.lines) - outlines - diagonals).abs() < 12.0,
            "{} for {}",
            length(&drawing.lines),
            outlines + diagonals
        );
        let alone = Drawing::new(&Scene { corners: scene.corners[..6].to_vec(), ..scene }, &camera, "").unwrap();
        assert!((length(&alone.lines) - 8.0 * unit - diagonals).abs() < 6.0);
    }

    #[test]
    fn files_are_what_they_say() {
        let (scene, camera) = squares();
        let drawing = Drawing::new(&scene, &camera, "a < b & (c)").unwrap();
        let svg = drawing.svg();
        assert!(svg.starts_with("<svg") && svg.contains("a &lt; b &amp; (c)") && svg.ends_with("</svg>\n"));
        let pdf = String::from_utf8(drawing.pdf()).unwrap();
        assert!(pdf.starts_with("%PDF-1.4") && pdf.ends_with("%%EOF\n") && pdf.contains("(a < b & \\(c\\)) Tj"));
        // Every entry of the table is where an object begins.
        let table = pdf.split("xref\n0 6\n").nth(1).unwrap();
        for (i, line) in table.lines().skip(1).take(5).enumerate() {
            let place: usize = line[..10].parse().unwrap();
            assert!(pdf[place..].starts_with(&format!("{} 0 obj", i + 1)));
        }
    }

    #[test]
    fn nothing_to_see_is_an_empty_page() {
        let (_, camera) = squares();
        let drawing = Drawing::new(&Scene::default(), &camera, "").unwrap();
        assert!(drawing.lines.is_empty() && drawing.svg().contains("viewBox=\"0 0 400 400\""));
        let blind = Camera { eye: Vec3::NAN, ..camera };
        assert!(Drawing::new(&Scene::default(), &blind, "").is_err());
    }
}
