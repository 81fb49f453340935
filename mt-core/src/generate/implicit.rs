//! Closed surfaces of a chosen genus, with detail: a plate of cubes with holes, rounded onto a chain of rings.
//!
//! The genus is that of the plate, which no later step can change: the vertices
//! move, the triangles stay. A function polygonised on a grid would have to be
//! trusted to have the genus one hoped for, and gives worse triangles.

use super::boxes::{Quads, cube_surface};
use super::noise::Fractal;
use crate::id::VertexId;
use crate::mesh::Mesh;
use glam::{DVec3, dvec2};

/// How often the vertices are spread over the surface; more does not show.
const RELAXATIONS: usize = 40;
const TUBE_RADIUS: f64 = 0.5;
/// How wide the seam is where two rings melt into one another.
const SEAM: f64 = 0.4;

/// A closed connected surface of `genus` (at most 3): a capsule, or as many rings in a row, with fractal detail.
///
/// With `k = resolution` (at least 2) it has `2 (18 genus + 14) k^2` triangles and `(18 genus + 14) k^2 + 2 - 2 genus`
/// vertices; genus 2 at resolution 14 has 19,600 triangles. It is `2 genus + 1` long and 3 wide, the tubes have radius
/// 0.5, and vertices are moved by up to `amplitude` along the normal; up to about 0.1 it does not cut itself.
/// About 15 microseconds a vertex.
pub fn genus_surface(genus: usize, resolution: usize, amplitude: f64, seed: u64) -> Mesh<3> {
    let shape = Rings { count: genus.min(3) };
    let mut surface = shape.plate(resolution.max(2));
    for _ in 0..4 {
        surface.positions.iter_mut().for_each(|p| *p = shape.project(*p));
    }
    for _ in 0..RELAXATIONS {
        relax(&mut surface, &shape);
    }
    let cells = surface.quads.iter().flat_map(|quad| split_short(*quad, &surface.positions)).collect();
    let noise = Fractal { frequency: 1.5, octaves: 6, persistence: 0.55, seed };
    let middle = DVec3::new(shape.count as f64 + 0.5, 1.5, 0.5);
    let move_out = |p: &DVec3| *p + shape.gradient(*p).normalize_or_zero() * (amplitude * noise.at(*p)) - middle;
    let positions = surface.positions.iter().map(|p| move_out(p).as_vec3()).collect();
    Mesh { positions, cells }
}

/// A row of rings that touch, each of radius 1 and two units from the next; without a ring, a capsule.
struct Rings {
    count: usize,
}

impl Rings {
    /// The plate of cubes that the rings are carved from: one hole a ring, nowhere thinner than a cube.
    fn plate(&self, resolution: usize) -> Quads {
        cube_surface([2 * self.count + 1, 3, 1], resolution, |[x, y, _]| !(y == 1 && x % 2 == 1))
    }

    /// Roughly the signed distance from the surface, negative inside.
    fn value(&self, p: DVec3) -> f64 {
        if self.count == 0 {
            let on_axis = DVec3::new(0.5, p.y.clamp(0.75, 2.25), 0.5);
            return p.distance(on_axis) - 0.75;
        }
        let ring = |i: usize| {
            let from_axis = dvec2(p.x - (2 * i) as f64 - 1.5, p.y - 1.5).length();
            dvec2(from_axis - 1.0, p.z - 0.5).length() - TUBE_RADIUS
        };
        (1..self.count).fold(ring(0), |nearest, i| smooth_minimum(nearest, ring(i)))
    }

    fn gradient(&self, p: DVec3) -> DVec3 {
        const STEP: f64 = 1e-4;
        let along = |axis: DVec3| (self.value(p + axis * STEP) - self.value(p - axis * STEP)) / (2.0 * STEP);
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    }

    /// One Newton step towards the surface.
    fn project(&self, p: DVec3) -> DVec3 {
        let gradient = self.gradient(p);
        let step = gradient * (self.value(p) / gradient.length_squared().max(1e-6));
        p - step.clamp_length_max(TUBE_RADIUS)
    }
}

fn smooth_minimum(a: f64, b: f64) -> f64 {
    let closeness = (SEAM - (a - b).abs()).max(0.0) / SEAM;
    a.min(b) - closeness * closeness * SEAM / 4.0
}

/// Moves every vertex along the surface towards the middle of its neighbours.
fn relax(surface: &mut Quads, shape: &Rings) {
    let mut sums = vec![(DVec3::ZERO, 0.0); surface.positions.len()];
    for quad in &surface.quads {
        // On a closed surface each edge runs once each way, so each neighbour is counted once.
        for i in 0..4 {
            let (sum, count) = &mut sums[quad[i].index()];
            *sum += surface.positions[quad[(i + 1) % 4].index()];
            *count += 1.0;
        }
    }
    for (p, (sum, count)) in surface.positions.iter_mut().zip(sums) {
        let normal = shape.gradient(*p).normalize_or_zero();
        *p = shape.project(*p + (sum / count - *p).reject_from_normalized(normal) * 0.7);
    }
}

/// The two triangles of a quadrilateral, cut along its shorter diagonal.
fn split_short([a, b, c, d]: [VertexId; 4], positions: &[DVec3]) -> [[VertexId; 3]; 2] {
    let length = |u: VertexId, v: VertexId| positions[u.index()].distance_squared(positions[v.index()]);
    if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}
