//! Bounds of modifications: a sphere, an error and a cone of normals, saturated and rounded outwards.
//!
//! A bound is saturated when it contains the bounds of all that is discovered under it, so a criterion that is
//! monotone in the bound never asks for a node without asking for the one above. Rounding is always outwards: what
//! contains in real numbers contains in the stored ones.

use crate::mesh::area_vector;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};
use std::sync::LazyLock;

/// Bound of a modification. 24 bytes.
#[derive(Copy, Clone, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Bound {
    /// Centre of a sphere around the patch and all that is discovered under it.
    pub center: Vec3,
    /// Its radius, in model units.
    pub radius: f32,
    /// Error of the coarse side, not below that of anything discovered under it; in model units.
    pub error: f32,
    /// Normals of both sides and of all that is discovered under it.
    pub cone: Cone,
}

const _: () = assert!(size_of::<Bound>() == 24);

impl Bound {
    /// The bound of a patch by itself. O(vertices of the patch).
    pub fn of_patch(points: &[Vec3], error: f32, cone: Cone) -> Self {
        let (center, radius) = sphere_around(points);
        Self { center, radius, error, cone }
    }

    /// Grows `self` until it contains `other`.
    pub fn include(&mut self, other: &Bound) {
        (self.center, self.radius) = sphere_union((self.center, self.radius), (other.center, other.radius));
        self.error = self.error.max(other.error);
        self.cone = self.cone.union(other.cone);
    }

    /// The radius that the sphere would have after [`Self::include`].
    pub fn radius_with(&self, other: &Bound) -> f32 {
        sphere_union((self.center, self.radius), (other.center, other.radius)).1
    }

    /// Whether `self` contains `other`, in every part.
    pub fn contains(&self, other: &Bound) -> bool {
        let apart = self.center.as_dvec3().distance(other.center.as_dvec3());
        is_within(apart, f64::from(other.radius), f64::from(self.radius))
            && self.error >= other.error
            && self.cone.contains(other.cone)
    }

    /// Distance from `p` to the sphere, rounded towards 0; 0 inside.
    pub fn distance(&self, p: Vec3) -> f32 {
        let apart = self.center.distance(p);
        ((apart - self.radius) - (apart + self.radius) * 4.0 * f32::EPSILON).max(0.0)
    }
}

/// Rounds a non-negative length up to `f32`, with room for the rounding of the `f64` sums it came from.
fn up(length: f64) -> f32 {
    ((length * (1.0 + 1e-14)) as f32).next_up()
}

/// Whether a sphere lies within another whose centre is `apart` from its own; no when rounding could decide it.
fn is_within(apart: f64, radius: f64, outer: f64) -> bool {
    if apart == 0.0 { radius <= outer } else { (apart + radius) * (1.0 + 1e-15) <= outer }
}

fn sphere_around(points: &[Vec3]) -> (Vec3, f32) {
    let Some(&first) = points.first() else { return (Vec3::ZERO, 0.0) };
    let (low, high) = points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
    let center = low + (high - low) * 0.5;
    let radius = points.iter().map(|p| p.as_dvec3().distance_squared(center.as_dvec3())).fold(0.0, f64::max).sqrt();
    (center, up(radius))
}

fn sphere_union(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let (center_a, center_b) = (a.0.as_dvec3(), b.0.as_dvec3());
    let (radius_a, radius_b) = (f64::from(a.1), f64::from(b.1));
    let apart = center_a.distance(center_b);
    if is_within(apart, radius_b, radius_a) {
        return a;
    }
    if is_within(apart, radius_a, radius_b) {
        return b;
    }
    let center = center_a.lerp(center_b, 0.5 + (radius_b - radius_a) / (2.0 * apart)).as_vec3();
    let reach = |c: DVec3, r: f64| c.distance(center.as_dvec3()) + r;
    (center, up(reach(center_a, radius_a).max(reach(center_b, radius_b))))
}

/// A cone of unit normals in 4 bytes: an axis on a grid of 127 steps, and a half-angle in steps of π/254, rounded up.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Cone {
    axis: [i8; 3],
    /// 0 to 254: half-angle in steps of π/254; 255: no normal at all.
    angle: u8,
}

impl Default for Cone {
    fn default() -> Self {
        Self::EMPTY
    }
}

/// A sum of unit vectors, the same in whatever order they come: each is put on a grid so fine and so coarse that sums of up to
/// eight million are exact.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NormalSum(DVec3);

impl NormalSum {
    /// Adding this and taking it away again leaves 30 bits behind the point of a number below 1.
    const GRID: f64 = 1.5 * (1u64 << (52 - 30)) as f64;

    /// The sum of one; of what has no normal, one that has no axis, nor has what it is added to.
    #[inline]
    pub(crate) fn of(normal: Vec3) -> Self {
        let on_grid = (normal.as_dvec3() + Self::GRID) - Self::GRID;
        Self(if normal == Vec3::ZERO { DVec3::NAN } else { on_grid })
    }

    #[inline]
    pub(crate) fn add(&mut self, other: Self) {
        self.0 += other.0;
    }

    /// Its direction, if it has one.
    pub(crate) fn axis(self) -> Option<Vec3> {
        self.0.as_vec3().try_normalize()
    }
}

const STEPS: f32 = 254.0;
/// More than an axis can be off by after it is put on the grid, in radians: half a step of 1/127 in two directions, and
/// rounding.
const AXIS_ERROR: f32 = 0.0067;

impl Cone {
    /// No normal.
    pub const EMPTY: Cone = Cone { axis: [0; 3], angle: 255 };
    /// Every normal.
    pub const ALL: Cone = Cone { axis: [0, 0, 127], angle: 254 };

    /// The axis, a unit vector; and the half-angle in radians, 0 to π. `None` without normals.
    pub fn get(self) -> Option<(Vec3, f32)> {
        let axis = Vec3::from(self.axis.map(f32::from)).normalize_or(Vec3::Z);
        (self != Self::EMPTY).then(|| (axis, f32::from(self.angle) * std::f32::consts::PI / STEPS))
    }

    /// An axis that is no unit vector, and sine and cosine of the half-angle. `None` without normals. For whoever asks so
    /// often that the trigonometry of [`Self::get`] shows.
    #[inline]
    pub fn slope(self) -> Option<(DVec3, f64, f64)> {
        static SLOPES: LazyLock<[[f64; 2]; 255]> = LazyLock::new(|| {
            std::array::from_fn(|steps| {
                let (sine, cosine) = (steps as f64 * std::f64::consts::PI / f64::from(STEPS)).sin_cos();
                [sine, cosine]
            })
        });
        let [sine, cosine] = *SLOPES.get(usize::from(self.angle))?;
        Some((DVec3::from(self.axis.map(f64::from)), sine, cosine))
    }

    /// Whether it is one that is made here, and not bytes from anywhere: only without normals is there no axis.
    pub fn is_valid(self) -> bool {
        (self.angle == 255) == (self.axis == [0; 3])
    }

    /// A cone about `axis` that holds everything within `angle` radians of it, rounded outwards.
    pub fn new(axis: Vec3, angle: f32) -> Self {
        let Some(axis) = axis.try_normalize() else { return Self::ALL };
        let grid = (axis * (127.0 / axis.abs().max_element())).round().to_array().map(|x| x as i8);
        let steps = ((angle + AXIS_ERROR) * (STEPS / std::f32::consts::PI)).ceil();
        if steps < STEPS { Cone { axis: grid, angle: steps as u8 } } else { Self::ALL }
    }

    /// The cone of the normals of these vectors (twice the area of a triangle along its normal); zero ones count as
    /// all, since a triangle without area has no normal to speak of. Makes unit vectors of them.
    pub fn of_vectors(vectors: &mut [Vec3]) -> Self {
        vectors.iter_mut().for_each(|v| *v = v.normalize_or_zero());
        Self::of_normals(vectors)
    }

    /// The cone of these unit vectors; zero ones count as all.
    pub fn of_normals(normals: &[Vec3]) -> Self {
        if normals.is_empty() {
            return Self::EMPTY;
        }
        let mut sum = NormalSum::default();
        normals.iter().for_each(|normal| sum.add(NormalSum::of(*normal)));
        let Some(axis) = sum.axis() else { return Self::ALL };
        let least = normals.iter().fold(1.0, |least: f32, normal| least.min(normal.dot(axis)));
        Self::about(axis, least)
    }

    /// The cone about an axis that holds all unit vectors whose part along it is not less than this.
    pub(crate) fn about(axis: Vec3, least: f32) -> Self {
        Self::new(axis, least.clamp(-1.0, 1.0).acos())
    }

    /// The least cone, up to rounding outwards, that holds both.
    pub fn union(self, other: Cone) -> Cone {
        if other == Self::EMPTY || self.contains(other) {
            return self;
        }
        if self == Self::EMPTY || other.contains(self) {
            return other;
        }
        let (Some((axis_a, angle_a)), Some((axis_b, angle_b))) = (self.get(), other.get()) else { return Self::ALL };
        let apart = axis_a.angle_between(axis_b);
        let half = (apart + angle_a + angle_b) * 0.5;
        let side = (axis_b - axis_a * axis_a.dot(axis_b)).normalize_or_zero();
        if half >= std::f32::consts::PI || side == Vec3::ZERO {
            return Self::ALL;
        }
        let turn = half - angle_a;
        Self::new(axis_a * turn.cos() + side * turn.sin(), half)
    }

    /// Whether every normal of `other` is one of `self`.
    pub fn contains(self, other: Cone) -> bool {
        /// By how many steps one half-angle is the larger: the cosine of the angle that there may be between the axes. A
        /// little less than the difference, as axes are rounded.
        static APART: LazyLock<[f64; 255]> = LazyLock::new(|| {
            std::array::from_fn(|steps| (steps as f64 * std::f64::consts::PI / f64::from(STEPS) - 1e-4).cos())
        });
        if other.angle == 255 || self.angle == 254 {
            return true;
        }
        if self.angle == 255 || self.angle < other.angle {
            return false;
        }
        if self.axis == other.axis || self.angle == other.angle {
            return self.axis == other.axis;
        }
        let dot = |a: [i8; 3], b: [i8; 3]| (0..3).map(|i| i32::from(a[i]) * i32::from(b[i])).sum::<i32>();
        let (along, least) = (f64::from(dot(self.axis, other.axis)), APART[usize::from(self.angle - other.angle)]);
        let squares = f64::from(dot(self.axis, self.axis)) * f64::from(dot(other.axis, other.axis));
        // `along >= least * sqrt(squares)`, without the root.
        let is_short = along * along <= least * least * squares;
        if least >= 0.0 { along >= 0.0 && !is_short } else { along >= 0.0 || is_short }
    }
}

/// The cone of normals of these cells: of triangles in space; every normal for cells of other dimensions.
pub fn cone_of_cells<const N: usize>(cells: &[[Vec3; N]], scratch: &mut Vec<Vec3>) -> Cone {
    if N != 3 {
        return Cone::ALL;
    }
    scratch.clear();
    scratch.extend(cells.iter().map(|c| area_vector([c[0].as_dvec3(), c[1].as_dvec3(), c[2].as_dvec3()]).as_vec3()));
    Cone::of_vectors(scratch)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Whatever the bytes, there is an answer, and for those that are cones the one that arcs give.
    #[test]
    fn every_pair_of_angles_is_compared() {
        let axes: [[i8; 3]; 5] = [[127, 0, 0], [127, 1, -3], [-128, 127, 5], [0, 0, 0], [-127, 0, 0]];
        for (i, j) in (0..axes.len()).flat_map(|i| (0..axes.len()).map(move |j| (i, j))) {
            for (a, b) in (0..=255u8).flat_map(|a| (0..=255u8).map(move |b| (a, b))) {
                let (one, other) = (Cone { axis: axes[i], angle: a }, Cone { axis: axes[j], angle: b });
                let told = one.contains(other);
                let (true, true) = (one.is_valid(), other.is_valid()) else { continue };
                let (Some((axis, angle)), Some((axis_b, angle_b))) = (one.get(), other.get()) else { continue };
                if a == 254 || axes[i] == axes[j] {
                    continue;
                }
                let room = f64::from(angle) - f64::from(angle_b) - f64::from(axis.angle_between(axis_b));
                // Where rounding decides either will do.
                assert!(room.abs() <= 2e-3 || told == (room > 0.0), "{one:?} {other:?}");
            }
        }
    }

    fn point() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1000f32..1000.0).prop_map(Vec3::from)
    }

    fn direction() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1f32..1.0).prop_filter_map("no direction", |v| Vec3::from(v).try_normalize())
    }

    proptest! {
        #[test]
        fn spheres_hold_their_points(points in prop::collection::vec(point(), 1..20)) {
            let bound = Bound::of_patch(&points, 0.0, Cone::EMPTY);
            for p in &points {
                prop_assert!(p.as_dvec3().distance(bound.center.as_dvec3()) <= f64::from(bound.radius));
                prop_assert_eq!(bound.distance(*p), 0.0);
            }
        }

        #[test]
        fn unions_contain_both(a in point(), b in point(), ra in 0f32..100.0, rb in 0f32..100.0,
                               x in direction(), y in direction(), s in 0f32..3.2, t in 0f32..3.2) {
            let one = Bound { center: a, radius: ra, error: 1.0, cone: Cone::new(x, s) };
            let two = Bound { center: b, radius: rb, error: 2.0, cone: Cone::new(y, t) };
            let mut both = one;
            both.include(&two);
            prop_assert!(both.contains(&one) && both.contains(&two));
        }

        #[test]
        fn cones_hold_their_normals(normals in prop::collection::vec(direction(), 1..12)) {
            let cone = Cone::of_vectors(&mut normals.clone());
            let (axis, angle) = cone.get().unwrap();
            for n in normals { prop_assert!(axis.angle_between(n) <= angle, "{:?} {:?}", cone, n); }
        }

        #[test]
        fn a_slope_is_the_cone_it_is_of(axis in direction(), angle in 0f32..3.2) {
            let cone = Cone::new(axis, angle);
            let (unit, half) = cone.get().unwrap();
            let (along, sine, cosine) = cone.slope().unwrap();
            prop_assert!((along.normalize().as_vec3() - unit).length() < 1e-6);
            prop_assert!((sine - f64::from(half).sin()).abs() < 1e-6 && (cosine - f64::from(half).cos()).abs() < 1e-6);
            prop_assert_eq!(Cone::EMPTY.slope(), None);
        }

        #[test]
        fn cones_round_outwards(axis in direction(), angle in 0f32..3.0) {
            let (grid, wider) = Cone::new(axis, angle).get().unwrap();
            prop_assert!(grid.angle_between(axis) + angle <= wider);
        }
    }

    #[test]
    fn a_distance_is_to_the_sphere_and_rounded_towards_nothing() {
        let bound = Bound { center: Vec3::new(1.0, 0.0, 0.0), radius: 2.0, error: 0.0, cone: Cone::EMPTY };
        let far = bound.distance(Vec3::new(1.0, 10.0, 0.0));
        assert!(far <= 8.0 && far > 7.999, "{far}");
        assert_eq!(bound.distance(Vec3::new(1.0, 2.0, 0.0)), 0.0);
        assert_eq!(bound.distance(Vec3::X), 0.0);
    }
}
