//! How far two triangle meshes are from one another: samples of each against the exact nearest point of the other.
//!
//! After Metro `[CignoniRocchiniScopigno1998]`; the samples are stratified by area, and the vertices, where
//! simplified meshes stray furthest, are measured as well.

use glam::DVec3;
use mt_core::Mesh;
use mt_core::mesh::area_vector;
use mt_core::random::Random;
use rstar::{AABB, PointDistance, RTree, RTreeObject};

/// How a distance is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Samples on each of the two surfaces, on top of its vertices.
    pub count: usize,
    /// Which samples.
    pub seed: u64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { count: 100_000, seed: 1 }
    }
}

/// Distance from the points of one surface to another surface, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OneWay {
    /// Root of the mean square over the samples, which are even in area; vertices do not count.
    pub rms: f64,
    /// The largest over samples and vertices: a lower bound of the one-sided Hausdorff distance.
    pub maximum: f64,
}

/// Distance between two surfaces, in model units; divide by a diagonal to compare models.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distance {
    /// From the points of the first surface to the second.
    pub forward: OneWay,
    /// From the points of the second surface to the first.
    pub backward: OneWay,
}

impl Distance {
    /// The larger of the two root mean squares.
    pub fn rms(&self) -> f64 {
        self.forward.rms.max(self.backward.rms)
    }

    /// The larger of the two maxima: a lower bound of the Hausdorff distance.
    pub fn maximum(&self) -> f64 {
        self.forward.maximum.max(self.backward.maximum)
    }
}

/// Why a mesh has no distance to another.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DistanceError {
    /// Nothing to sample, nothing to be near.
    #[error("a mesh without triangles has no distance to another")]
    Empty,
    /// A coordinate is infinite or not a number.
    #[error("a mesh with a coordinate that is not finite has no distance to another")]
    NotFinite,
}

/// [`Surface::distance`] between two meshes; index a mesh once with [`Surface::new`] where it is compared often.
pub fn distance(first: &Mesh<3>, second: &Mesh<3>, sampling: Sampling) -> Result<Distance, DistanceError> {
    Ok(Surface::new(first)?.distance(&Surface::new(second)?, sampling))
}

/// The triangles of a mesh, ready to be sampled and to be asked for nearest points. About 250 bytes a triangle.
pub struct Surface {
    /// In the order of the mesh.
    triangles: Vec<Triangle>,
    /// Of each triangle: the area of it and of those before it.
    areas: Vec<f64>,
    vertices: Vec<DVec3>,
    tree: RTree<Triangle>,
}

impl Surface {
    /// Indexes a mesh. O(n log n), about a microsecond a triangle. Vertices without a triangle are left out.
    pub fn new(mesh: &Mesh<3>) -> Result<Self, DistanceError> {
        let mesh = mesh.compact();
        if mesh.cells.is_empty() {
            return Err(DistanceError::Empty);
        }
        if mesh.positions.iter().any(|p| !p.is_finite()) {
            return Err(DistanceError::NotFinite);
        }
        let vertices: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
        let triangles: Vec<Triangle> =
            mesh.cells.iter().map(|cell| Triangle(cell.map(|v| vertices[v.index()]))).collect();
        let areas = running_sum(triangles.iter().map(|triangle| area_vector(triangle.0).length() / 2.0));
        let tree = RTree::bulk_load(triangles.clone());
        Ok(Self { triangles, areas, vertices, tree })
    }

    /// The point of the surface nearest to `p`. O(log n) for points near the surface.
    pub fn nearest(&self, p: DVec3) -> DVec3 {
        self.tree.nearest_neighbor(p.to_array()).map_or(p, |triangle| triangle.nearest(p))
    }

    /// The distance to another surface, both ways. 3 to 5 microseconds a sample.
    pub fn distance(&self, other: &Self, sampling: Sampling) -> Distance {
        Distance { forward: self.distance_to(other, sampling), backward: other.distance_to(self, sampling) }
    }

    /// The distance from the points of this surface to another. A few microseconds a sample.
    pub fn distance_to(&self, other: &Self, sampling: Sampling) -> OneWay {
        let squared = |p: DVec3| other.nearest(p).distance_squared(p);
        let mut sum = 0.0;
        let mut largest: f64 = 0.0;
        for sample in self.samples(sampling) {
            let here = squared(sample);
            sum += here;
            largest = largest.max(here);
        }
        let largest = self.vertices.iter().map(|&p| squared(p)).fold(largest, f64::max);
        OneWay { rms: (sum / sampling.count.max(1) as f64).sqrt(), maximum: largest.sqrt() }
    }

    /// Points even in area: the area is cut in as many equal parts, along the order of the triangles, with one point in each.
    pub fn samples(&self, sampling: Sampling) -> impl Iterator<Item = DVec3> + '_ {
        let mut rng = Random::new(sampling.seed);
        let total = self.areas.last().copied().unwrap_or(0.0);
        let mut at = 0;
        (0..sampling.count).map(move |i| {
            let area = (i as f64 + rng.unit()) / sampling.count as f64 * total;
            while at + 1 < self.areas.len() && self.areas[at] <= area {
                at += 1;
            }
            self.triangles[at].point(rng.unit(), rng.unit())
        })
    }
}

/// Each value plus all before it; counts where all values are 0, so that a mesh without area is sampled all the same.
fn running_sum(values: impl Iterator<Item = f64> + Clone) -> Vec<f64> {
    let all_zero = values.clone().all(|value| value == 0.0);
    values
        .scan(0.0, |sum, value| {
            *sum += if all_zero { 1.0 } else { value };
            Some(*sum)
        })
        .collect()
}

#[derive(Clone, Debug)]
struct Triangle([DVec3; 3]);

impl Triangle {
    /// A point of the triangle; even in area where `u` and `v` are even in [0, 1).
    fn point(&self, u: f64, v: f64) -> DVec3 {
        let [a, b, c] = self.0;
        let root = u.sqrt();
        a * (1.0 - root) + b * (root * (1.0 - v)) + c * (root * v)
    }

    /// The nearest point of the triangle: above its inside the foot of the perpendicular, else the nearest on a side.
    fn nearest(&self, p: DVec3) -> DVec3 {
        let [a, b, c] = self.0;
        let normal = area_vector(self.0);
        let inside = |from: DVec3, to: DVec3| (to - from).cross(p - from).dot(normal) > 0.0;
        if inside(a, b) && inside(b, c) && inside(c, a) {
            return p - normal * ((p - a).dot(normal) / normal.length_squared());
        }
        // Also where the triangle has no area: then no side has an inside.
        let sides = [nearest_on_segment(a, b, p), nearest_on_segment(b, c, p), nearest_on_segment(c, a, p)];
        sides.into_iter().min_by(|q, r| q.distance_squared(p).total_cmp(&r.distance_squared(p))).unwrap_or(a)
    }
}

fn nearest_on_segment(a: DVec3, b: DVec3, p: DVec3) -> DVec3 {
    let along = b - a;
    let length_squared = along.length_squared();
    if length_squared == 0.0 {
        return a;
    }
    a + along * ((p - a).dot(along) / length_squared).clamp(0.0, 1.0)
}

impl RTreeObject for Triangle {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let [a, b, c] = self.0;
        AABB::from_corners(a.min(b).min(c).to_array(), a.max(b).max(c).to_array())
    }
}

impl PointDistance for Triangle {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        let p = DVec3::from_array(*point);
        self.nearest(p).distance_squared(p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec3, vec3};

    const SAMPLING: Sampling = Sampling { count: 2_000, seed: 7 };

    /// A planar patch of `n` x `n` unit squares at height `z`.
    fn plane(n: u32, z: impl Fn(u32, u32) -> f32) -> Mesh<3> {
        let side = n + 1;
        let place = |i: u32| vec3((i % side) as f32, (i / side) as f32, z(i % side, i / side));
        let square = |i: u32| {
            let a = i % n + i / n * side;
            [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]]
        };
        Mesh::from_indices((0..side * side).map(place).collect(), &(0..n * n).flat_map(square).collect::<Vec<_>>())
    }

    fn bumpy(n: u32, phase: f32) -> Mesh<3> {
        plane(n, |i, j| (i as f32 * 1.7 + phase).sin() + (j as f32 * 2.3 - phase).cos())
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    #[test]
    fn nothing_between_a_mesh_and_itself() {
        let found = distance(&bumpy(12, 0.3), &bumpy(12, 0.3), SAMPLING).expect("meshes");
        assert!(found.maximum() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_plane_moved_along_its_normal() {
        let found = distance(&plane(5, |_, _| 0.0), &plane(8, |_, _| 0.25), SAMPLING).expect("meshes");
        assert!(close(found.forward.rms, 0.25) && close(found.forward.maximum, 0.25));
        // The larger plane reaches beyond the smaller: its far corner is (3, 3, 0.25) away.
        assert!(close(found.backward.maximum, (9.0f64 + 9.0 + 0.0625).sqrt()));
        assert!(found.rms() == found.backward.rms && found.maximum() == found.backward.maximum);
    }

    #[test]
    fn the_vertex_that_sticks_out_is_found_without_samples() {
        let spike = plane(4, |i, j| if (i, j) == (2, 2) { 3.0 } else { 0.0 });
        let found = distance(&spike, &plane(4, |_, _| 0.0), Sampling { count: 0, seed: 0 }).expect("meshes");
        assert_eq!((found.forward.maximum, found.forward.rms), (3.0, 0.0));
    }

    #[test]
    fn the_index_agrees_with_brute_force() {
        let (first, second) = (bumpy(9, 0.0), bumpy(7, 1.1));
        let (first, second) = (Surface::new(&first).expect("mesh"), Surface::new(&second).expect("mesh"));
        for p in first.samples(SAMPLING) {
            let brute = second.triangles.iter().map(|t| t.nearest(p).distance(p)).fold(f64::MAX, f64::min);
            assert!(close(second.nearest(p).distance(p), brute));
        }
    }

    #[test]
    fn nearest_is_no_further_than_any_point_of_the_triangle() {
        let mut rng = Random::new(3);
        let mut point = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
        for _ in 0..300 {
            let (triangle, p) = (Triangle([point(), point(), point()]), point() * 3.0 - 1.0);
            let nearest = triangle.nearest(p).distance(p);
            let fine = 60;
            let all = (0..=fine).flat_map(|i| (0..=fine - i).map(move |j| (i as f64, j as f64)));
            let brute = all.map(|(i, j)| {
                let [a, b, c] = triangle.0;
                (a + (b - a) * (i / f64::from(fine)) + (c - a) * (j / f64::from(fine))).distance(p)
            });
            let brute = brute.fold(f64::MAX, f64::min);
            assert!(nearest <= brute + 1e-12 && brute < nearest + 0.05);
        }
    }

    #[test]
    fn samples_are_even_in_area() {
        let lopsided = Mesh::from_indices(
            vec![Vec3::ZERO, vec3(3.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(-1.0, 0.0, 0.0)],
            &[[0, 1, 2], [0, 2, 3]],
        );
        let surface = Surface::new(&lopsided).expect("mesh");
        let right = surface.samples(SAMPLING).filter(|p| p.x > 0.0).count();
        assert!((1_499..=1_501).contains(&right), "three quarters of the area got {right} of 2000 samples");
        let mean = surface.samples(SAMPLING).filter(|p| p.x > 0.0).sum::<DVec3>() / right as f64;
        assert!(mean.distance(DVec3::new(1.0, 1.0 / 3.0, 0.0)) < 0.05, "{mean}");
        assert!(surface.samples(SAMPLING).eq(surface.samples(SAMPLING)));
    }

    #[test]
    fn meshes_without_area_or_triangles() {
        let needle = Mesh::from_indices(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0], &[[0, 1, 2], [0, 0, 0]]);
        let found = distance(&needle, &plane(2, |_, _| 1.0), SAMPLING).expect("meshes");
        assert!(close(found.forward.maximum, 1.0));
        let empty = Mesh::<3>::default();
        assert_eq!(distance(&empty, &needle, SAMPLING), Err(DistanceError::Empty));
        let infinite = Mesh::from_indices(vec![Vec3::ZERO, Vec3::X, Vec3::INFINITY], &[[0, 1, 2]]);
        assert_eq!(distance(&needle, &infinite, SAMPLING), Err(DistanceError::NotFinite));
    }
}
