//! The rasteriser: which samples of which pixels a triangle covers, exactly as graphics hardware says.
//!
//! Positions are snapped to 1/256 pixel and edges are integers, so that neighbours share no sample and
//! leave none out; four samples a pixel at the standard places, shaded once a pixel at its middle.

use crate::clip::Mixed;
use crate::ramp::Rgba;
use glam::{Vec2, Vec3};
use std::ops::Range;

/// Samples of a pixel.
pub(crate) const SAMPLES: usize = 4;
const SUBPIXELS: i64 = 256;
/// The standard places of four samples, from the pixel's middle, in 1/256 pixel.
const PLACES: [[i64; 2]; SAMPLES] = [[-32, -96], [96, -32], [-96, 32], [32, 96]];

/// A band of the picture while it is painted: depth and colour of each sample.
pub(crate) struct Sheet {
    /// Pixels in a row.
    pub(crate) width: usize,
    /// Rows of the picture that this band holds.
    pub(crate) rows: Range<usize>,
    depth: Vec<[f32; SAMPLES]>,
    colour: Vec<[Rgba; SAMPLES]>,
}

/// How a triangle's samples meet what is there.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Blend {
    /// Nearer samples replace depth and colour.
    Replace,
    /// Samples not behind are mixed in by their opacity; depth stays.
    Mix,
}

/// A value that is linear on the screen.
#[derive(Clone, Copy, Default)]
struct Plane {
    middle: f64,
    along: f64,
    down: f64,
}

/// A triangle on the screen, ready to be scanned.
pub(crate) struct Facet {
    edges: [Edge; 3],
    columns: Range<usize>,
    rows: Range<usize>,
    /// The first corner, in pixels, to which planes refer.
    anchor: [f64; 2],
    depth: Plane,
    /// 1 / w, and each corner's weight over w.
    inverse_w: Plane,
    weights: [Plane; 3],
    /// Whether the side is seen from which the corners turn counter-clockwise.
    pub(crate) front: bool,
}

/// Non-negative inside: value at the anchor pixel's middle, and change per pixel.
#[derive(Clone, Copy, Default)]
struct Edge {
    at_zero: i64,
    along: i64,
    down: i64,
    /// What each sample adds to the middle's value, and the most that any adds.
    samples: [i64; SAMPLES],
    most: i64,
}

impl Sheet {
    pub(crate) fn new(width: usize, rows: Range<usize>) -> Self {
        let count = width * rows.len();
        Self { width, rows, depth: vec![[0.0; SAMPLES]; count], colour: vec![[[0; 4]; SAMPLES]; count] }
    }

    /// Whether a place on the screen, with its depth, is not hidden: not farther, but for `slack`, than the farthest sample
    /// of its pixel and the eight around it.
    pub(crate) fn shows(&self, place: Vec3, slack: f32) -> bool {
        let (x, y) = (place.x.floor(), place.y.floor());
        let height = self.rows.len() as f32;
        if x < 0.0 || y < 0.0 || x >= self.width as f32 || y >= height {
            return false;
        }
        let around =
            |middle: f32, end: usize| (middle as usize).saturating_sub(1)..=((middle as usize) + 1).min(end - 1);
        let rows = around(y, self.rows.len());
        let farthest = rows
            .flat_map(|row| around(x, self.width).map(move |column| row * self.width + column))
            .flat_map(|at| self.depth[at])
            .fold(1.0, f32::min);
        place.z >= farthest - slack
    }

    /// The samples' averages, as rows of pixels.
    pub(crate) fn resolve(&self, rgba: &mut [u8]) {
        for (pixel, samples) in rgba.chunks_exact_mut(4).zip(&self.colour) {
            for (channel, value) in pixel.iter_mut().enumerate() {
                let sum: u32 = samples.iter().map(|sample| u32::from(sample[channel])).sum();
                *value = ((sum + 2) / 4) as u8;
            }
            pixel[3] = 255;
        }
    }

    /// Scans a facet; `shade` gives a pixel's colour from the corners' weights and their slopes per pixel.
    pub(crate) fn fill(&mut self, facet: &Facet, blend: Blend, shade: impl Fn(Vec3, &dyn Fn() -> Vec3) -> Rgba) {
        let rows = facet.rows.start.max(self.rows.start)..facet.rows.end.min(self.rows.end);
        for y in rows {
            let starts = facet.edges.map(|edge| edge.at_zero + edge.down * y as i64);
            let first = (y - self.rows.start) * self.width;
            for x in facet.span(&starts) {
                let values: [i64; 3] = std::array::from_fn(|i| starts[i] + facet.edges[i].along * x as i64);
                let covered = facet.covered(values);
                if covered == 0 {
                    continue;
                }
                let passed = self.test(facet, blend, first + x, [x, y], covered);
                if passed != 0 {
                    let colour = facet.shaded([x, y], &shade);
                    write(&mut self.colour[first + x], passed, blend, colour);
                }
            }
        }
    }

    /// Which of the covered samples are visible; nearer depths are kept.
    fn test(&mut self, facet: &Facet, blend: Blend, at: usize, [x, y]: [usize; 2], covered: u8) -> u8 {
        let middle = facet.value(&facet.depth, [x, y]);
        let mut passed = 0;
        for sample in (0..SAMPLES).filter(|sample| covered >> sample & 1 == 1) {
            let [along, down] = PLACES[sample].map(|place| place as f64 / SUBPIXELS as f64);
            let depth = (middle + facet.depth.along * along + facet.depth.down * down) as f32;
            let kept = &mut self.depth[at][sample];
            match blend {
                Blend::Replace if depth > *kept => {
                    *kept = depth;
                    passed |= 1 << sample;
                }
                Blend::Mix if depth >= *kept => passed |= 1 << sample,
                _ => {}
            }
        }
        passed
    }
}

fn write(samples: &mut [Rgba; SAMPLES], passed: u8, blend: Blend, colour: Rgba) {
    for sample in (0..SAMPLES).filter(|sample| passed >> sample & 1 == 1) {
        let kept = &mut samples[sample];
        match (blend, colour[3]) {
            (Blend::Replace, _) | (Blend::Mix, 255) => *kept = colour,
            (Blend::Mix, opacity) => {
                let opacity = u32::from(opacity);
                let mix = |new: u8, old: u8| (u32::from(new) * opacity + u32::from(old) * (255 - opacity) + 127) / 255;
                *kept = std::array::from_fn(|i| mix(colour[i], kept[i]) as u8);
            }
        }
    }
}

impl Facet {
    /// The facet of three clipped points in a picture of `size` pixels; `None` where it covers nothing.
    pub(crate) fn new(points: [Mixed; 3], size: [usize; 2]) -> Option<Self> {
        let half = Vec2::new(size[0] as f32, size[1] as f32) * 0.5;
        let snapped = points.map(|point| {
            let ndc = point.clip.truncate().truncate() / point.clip.w;
            let pixel = Vec2::new(1.0 + ndc.x, 1.0 - ndc.y) * half;
            [pixel.x, pixel.y].map(|c| (f64::from(c) * SUBPIXELS as f64).round() as i64)
        });
        let (order, area, front) = match doubled_area(snapped) {
            0 => return None,
            area if area > 0 => ([0, 1, 2], area, false),
            area => ([0, 2, 1], -area, true),
        };
        let (points, snapped) = (order.map(|i| points[i]), order.map(|i| snapped[i]));
        let range = |axis: usize| {
            let low = snapped.iter().map(|p| p[axis]).min().unwrap_or(0).div_euclid(SUBPIXELS);
            let high = snapped.iter().map(|p| p[axis]).max().unwrap_or(0).div_euclid(SUBPIXELS) + 1;
            low.clamp(0, size[axis] as i64) as usize..high.clamp(0, size[axis] as i64) as usize
        };
        let (columns, rows) = (range(0), range(1));
        if columns.is_empty() || rows.is_empty() {
            return None;
        }
        let plane = |value: &dyn Fn(&Mixed) -> f64| Plane::new(snapped, area, [0, 1, 2].map(|i| value(&points[i])));
        let inverse = |point: &Mixed| 1.0 / f64::from(point.clip.w);
        Some(Self {
            edges: [0, 1, 2].map(|i| Edge::new(snapped[i], snapped[(i + 1) % 3])),
            columns,
            rows,
            anchor: snapped[0].map(|c| c as f64 / SUBPIXELS as f64),
            depth: plane(&|point| f64::from(point.clip.z) * inverse(point)),
            inverse_w: plane(&inverse),
            weights: [0, 1, 2].map(|i| plane(&|point| f64::from(point.weights[i]) * inverse(point))),
            front,
        })
    }

    /// Rows that the facet may touch.
    pub(crate) fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// The columns of a row where no edge rules out all samples of a pixel.
    fn span(&self, starts: &[i64; 3]) -> Range<usize> {
        let (mut low, mut high) = (self.columns.start as i64, self.columns.end as i64);
        for (edge, start) in self.edges.iter().zip(starts) {
            let best = start + edge.most;
            match edge.along {
                0 if best < 0 => return 0..0,
                0 => {}
                along if along > 0 => low = low.max((-best).div_euclid(along)),
                along => high = high.min(best.div_euclid(-along) + 1),
            }
        }
        low as usize..high.max(low) as usize
    }

    fn covered(&self, values: [i64; 3]) -> u8 {
        let inside = |sample: &usize| (0..3).all(|i| values[i] + self.edges[i].samples[*sample] >= 0);
        (0..SAMPLES).filter(inside).fold(0, |mask, sample| mask | 1 << sample)
    }

    fn value(&self, plane: &Plane, [x, y]: [usize; 2]) -> f64 {
        let (along, down) = (x as f64 + 0.5 - self.anchor[0], y as f64 + 0.5 - self.anchor[1]);
        plane.middle + plane.along * along + plane.down * down
    }

    fn shaded(&self, pixel: [usize; 2], shade: impl Fn(Vec3, &dyn Fn() -> Vec3) -> Rgba) -> Rgba {
        // The middle of a pixel may lie outside the triangle, and then even behind the eye.
        let inverse_w = self.value(&self.inverse_w, pixel).max(f64::MIN_POSITIVE);
        let weights = self.weights.map(|plane| self.value(&plane, pixel) / inverse_w);
        let slope = |i: usize| {
            let along = self.weights[i].along - weights[i] * self.inverse_w.along;
            let down = self.weights[i].down - weights[i] * self.inverse_w.down;
            (along * along + down * down).sqrt() / inverse_w
        };
        let bounded = |value: f64| if value.is_finite() { value.clamp(-1e9, 1e9) as f32 } else { 0.0 };
        let slopes = || Vec3::from_array([0, 1, 2].map(|i| bounded(slope(i))));
        shade(Vec3::from_array(weights.map(bounded)), &slopes)
    }
}

impl Plane {
    /// Through three values at three corners; relative to the first corner, slopes per pixel.
    fn new(corners: [[i64; 2]; 3], area: i64, values: [f64; 3]) -> Self {
        let [a, b, c] = corners;
        let (first, second) = (values[1] - values[0], values[2] - values[0]);
        let scale = SUBPIXELS as f64 / area as f64;
        Self {
            middle: values[0],
            along: (first * (c[1] - a[1]) as f64 - second * (b[1] - a[1]) as f64) * scale,
            down: (second * (b[0] - a[0]) as f64 - first * (c[0] - a[0]) as f64) * scale,
        }
    }
}

impl Edge {
    fn new(from: [i64; 2], to: [i64; 2]) -> Self {
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        // A sample on an edge belongs to the triangle below or right of it, so that it is drawn once.
        let top_or_left = dy < 0 || (dy == 0 && dx > 0);
        let middle = SUBPIXELS / 2;
        let at_zero = dx * (middle - from[1]) - dy * (middle - from[0]) - i64::from(!top_or_left);
        let samples = PLACES.map(|[x, y]| dx * y - dy * x);
        let most = samples.into_iter().fold(i64::MIN, i64::max);
        Self { at_zero, along: -dy * SUBPIXELS, down: dx * SUBPIXELS, samples, most }
    }
}

/// Positive where the corners turn clockwise on the screen, whose y points down.
fn doubled_area([a, b, c]: [[i64; 2]; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
