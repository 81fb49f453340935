//! Ink: flat triangles in screen space, which backgrounds, lines and legends become before either painter
//! sees them. Graphics interfaces have no line width, so lines are outlined here, for both alike.

use crate::font;
use crate::globals::{Globals, scale};
use crate::ramp::{KNOTS, Rgba};
use crate::scene::{Legend, Scene, Segment};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};
use mt_core::Camera;

/// One corner of a flat triangle.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct InkCorner {
    /// Normalised device coordinates: x right and y up, -1 to 1; depth 1 (near) to 0 (far).
    pub(crate) position: [f32; 3],
    /// Blended over what is there by its opacity.
    pub(crate) colour: Rgba,
}

/// The ink of a picture: what lies under the mesh, and what lies over it.
pub(crate) struct Ink {
    pub(crate) under: Vec<InkCorner>,
    pub(crate) over: Vec<InkCorner>,
}

/// Steps in the half circle at each end of a line.
const CAP_STEPS: usize = 6;
/// Opacity of a line where the mesh hides it.
const TRACE: u8 = 84;
const TEXT: Rgba = [52, 56, 62, 255];

impl Ink {
    pub(crate) fn new(scene: &Scene, camera: &Camera, globals: &Globals) -> Self {
        let size = Vec2::new(camera.width_px as f32, camera.height_px as f32);
        let below = camera.near / (camera.far - camera.near);
        let mut under = Pen { size, below, corners: Vec::new() };
        let [top, bottom] = scene.background;
        under.quad(Vec2::ZERO, size, 0.0, top, bottom);
        let mut over = Pen { size, below, corners: Vec::new() };
        let mut stroke = |segments: &[Segment], how| {
            segments.iter().for_each(|segment| over.stroke(segment, globals, scale(camera), how));
        };
        stroke(&scene.segments, How::Trace);
        stroke(&scene.marks, How::Lifted);
        stroke(&scene.segments, How::Placed);
        if let Some(legend) = &scene.legend {
            over.legend(legend);
        }
        Self { under: under.corners, over: over.corners }
    }
}

/// How a line meets the mesh.
#[derive(Clone, Copy, PartialEq, Eq)]
enum How {
    /// Faint, and in front of everything.
    Trace,
    /// Where it is.
    Placed,
    /// A little nearer than it is, so that the mesh that it lies on does not hide it.
    Lifted,
}

/// The share of its distance from the eye that a line is brought nearer by.
const LIFT: f32 = 0.003;

impl How {
    /// A depth is a / z - b at a distance z, where b is near / (far - near): so `below`, which is b, says what another distance
    /// comes to.
    fn depth(self, depth: f32, below: f32) -> f32 {
        match self {
            How::Trace => 1.0,
            How::Placed => depth,
            How::Lifted => depth + (depth + below) * (LIFT / (1.0 - LIFT)),
        }
    }
}

/// Draws in pixels from the upper left corner; collects triangles.
struct Pen {
    size: Vec2,
    /// Near / (far - near) of the camera.
    below: f32,
    corners: Vec<InkCorner>,
}

impl Pen {
    fn corner(&mut self, at: Vec2, depth: f32, colour: Rgba) {
        let ndc = at / self.size * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0);
        self.corners.push(InkCorner { position: [ndc.x, ndc.y, depth], colour });
    }

    /// A rectangle whose colour runs from `top` to `bottom`.
    fn quad(&mut self, low: Vec2, high: Vec2, depth: f32, top: Rgba, bottom: Rgba) {
        let (right_top, left_bottom) = (Vec2::new(high.x, low.y), Vec2::new(low.x, high.y));
        for triangle in [
            [(low, top), (left_bottom, bottom), (right_top, top)],
            [(right_top, top), (left_bottom, bottom), (high, bottom)],
        ] {
            triangle.into_iter().for_each(|(at, colour)| self.corner(at, depth, colour));
        }
    }

    /// The outline of a line with round ends as a fan.
    fn stroke(&mut self, segment: &Segment, globals: &Globals, scale: f32, how: How) {
        let project = |end: [f32; 3]| globals.matrix() * Vec3::from_array(end).extend(1.0);
        let Some(ends) = clip_segment(project(segment.from), project(segment.to)) else { return };
        let place = |end: Vec4| {
            let ndc = end.truncate() / end.w;
            ((ndc.truncate() * Vec2::new(0.5, -0.5) + 0.5) * self.size, ndc.z)
        };
        let [(from, from_depth), (to, to_depth)] = ends.map(place);
        if !(from.is_finite() && to.is_finite()) {
            return;
        }
        let along = (to - from).try_normalize().unwrap_or(Vec2::X);
        let radius = segment.width_px * scale * 0.5;
        let mut colour = segment.colour;
        if how == How::Trace {
            colour[3] = TRACE;
        }
        let below = self.below;
        let rim = |i: usize| {
            // The first half circle goes round `to`, the second round `from`.
            let around_to = i <= CAP_STEPS;
            let step = if around_to { i } else { i - 1 } as f32 / CAP_STEPS as f32;
            let turned = Vec2::from_angle((step - 0.5) * std::f32::consts::PI).rotate(along) * radius;
            let (center, depth) = if around_to { (to, to_depth) } else { (from, from_depth) };
            (center + turned, how.depth(depth, below).min(1.0))
        };
        for i in 1..2 * CAP_STEPS + 1 {
            for (at, depth) in [rim(0), rim(i), rim(i + 1)] {
                self.corner(at, depth, colour);
            }
        }
    }

    /// The colour bar at the upper right, with its ticks; left out where the picture is too small for it.
    fn legend(&mut self, legend: &Legend) {
        let unit = (self.size.y / 768.0).round().max(1.0);
        if self.size.x < 200.0 * unit || self.size.y < 160.0 * unit {
            return;
        }
        let high = Vec2::new(self.size.x - 24.0 * unit, 48.0 * unit + (self.size.y * 0.36).floor());
        let low = Vec2::new(high.x - 16.0 * unit, 48.0 * unit);
        let frame = Vec2::splat(unit);
        self.quad(low - frame, high + frame, 1.0, TEXT, TEXT);
        let step = (high.y - low.y) / (KNOTS - 1) as f32;
        for knot in 0..KNOTS - 1 {
            let (upper, lower) = (KNOTS - 1 - knot, KNOTS - 2 - knot);
            let top = Vec2::new(low.x, low.y + step * knot as f32);
            let bottom = Vec2::new(high.x, top.y + step);
            self.quad(top, bottom, 1.0, legend.ramp.knot(upper), legend.ramp.knot(lower));
        }
        let caption = Vec2::new(high.x + frame.x, low.y - 20.0 * unit);
        self.text(legend.caption, caption, unit * 2.0);
        for (share, label) in ticks(legend.range) {
            let y = (high.y - share * (high.y - low.y)).round();
            self.quad(Vec2::new(low.x - 6.0 * unit, y), Vec2::new(low.x, y + unit), 1.0, TEXT, TEXT);
            self.text(&label, Vec2::new(low.x - 10.0 * unit, y), unit * 2.0);
        }
    }

    /// Text that ends at `right_middle`, one dot of the font `dot` pixels wide.
    fn text(&mut self, text: &str, right_middle: Vec2, dot: f32) {
        let length = text.chars().count() as f32 * 6.0 - 1.0;
        let start = right_middle - Vec2::new(length * dot, (3.5 * dot).floor());
        for (place, letter) in text.chars().enumerate() {
            for (row, bits) in font::glyph(letter).into_iter().enumerate() {
                for column in (0..5).filter(|column| bits >> (4 - column) & 1 == 1) {
                    let low = start + Vec2::new((place * 6 + column) as f32, row as f32) * dot;
                    self.quad(low, low + dot, 1.0, TEXT, TEXT);
                }
            }
        }
    }
}

/// The part of a segment between near and far plane.
pub(crate) fn clip_segment(mut from: Vec4, mut to: Vec4) -> Option<[Vec4; 2]> {
    for inside in [|v: Vec4| v.z, |v: Vec4| v.w - v.z] {
        let (a, b) = (inside(from), inside(to));
        if a.is_nan() || b.is_nan() || (a < 0.0 && b < 0.0) {
            return None;
        }
        if (a < 0.0) != (b < 0.0) {
            let cut = from.lerp(to, a / (a - b));
            *if a < 0.0 { &mut from } else { &mut to } = cut;
        }
    }
    (from.w > 0.0 && to.w > 0.0).then_some([from, to])
}

/// Round values within the range, as shares of it, and their names: three to eight of them.
fn ticks((low, high): (f32, f32)) -> Vec<(f32, String)> {
    let (low, high) = (f64::from(low), f64::from(high));
    let width = high - low;
    if !(width.is_finite() && width > 0.0) {
        return vec![(0.0, name(low, 3, low.abs()))];
    }
    let power = (width / 3.0).log10().floor();
    let base = 10f64.powf(power);
    let step =
        base * [5.0, 2.0, 1.0].into_iter().find(|factor| base * factor * 3.0 <= width * 1.000_001).unwrap_or(1.0);
    let first = (low / step - 1e-6).ceil();
    let decimals = (-power).max(0.0) as usize;
    let count = (((high - first * step) / step + 1e-6).floor().max(0.0) as usize).min(9);
    let tick = |i: usize| {
        let value = (first + i as f64) * step;
        (((value - low) / width) as f32, name(value, decimals, low.abs().max(high.abs())))
    };
    (0..=count).map(tick).collect()
}

/// A value with its decimals, or with an exponent where the values are very large or very small.
fn name(value: f64, decimals: usize, greatest: f64) -> String {
    if value == 0.0 {
        "0".into()
    } else if greatest >= 1e6 || (greatest < 1e-3 && greatest > 0.0) {
        format!("{value:.1e}")
    } else {
        format!("{value:.decimals$}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        let names = |range| ticks(range).into_iter().map(|(_, name)| name).collect::<Vec<_>>();
        assert_eq!(names((0.0, 10.0)), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(names((0.0, 0.0137)), ["0", "0.002", "0.004", "0.006", "0.008", "0.010", "0.012"]);
        assert_eq!(names((3.0, 3.0)), ["3.000"]);
        assert_eq!(names((0.0, 4e-5)), ["0", "1.0e-5", "2.0e-5", "3.0e-5", "4.0e-5"]);
        for range in [(-1e38, 1e38), (1e7, 1.000_001e7), (f32::NAN, 1.0), (-3.0, 4.0)] {
            assert!((1..=10).contains(&ticks(range).len()), "{range:?}");
        }
    }
}
