//! The quadric error metric of `[GarlandHeckbert1997]`, weighted by area.
//!
//! A quadric is a weighted sum of squared distances to planes. Ours also carries the sum of its weights, so that
//! `sqrt(value / weight)` is a root mean square distance in model units. Deviation from the paper: planes are weighted
//! by area (as in Garland's thesis), boundary planes by squared length times a factor that the caller chooses.

use super::{Boundary, Merge, Metric, Offer, Place, RegionMetric, ends_of, fixed, put};
use glam::{DMat3, DVec3};
use mt_core::analysis::{Draft, Unfit};
use mt_core::mesh::area_vector;
use mt_core::{Slot, VertexId};
use rayon::prelude::*;
use std::ops::{Add, AddAssign};

/// Sum of weighted squared distances to planes: `p A p + 2 b p + c`. 88 bytes.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub struct Quadric {
    /// `xx, yy, zz` of `A`.
    diagonal: DVec3,
    /// `yz, xz, xy` of `A`.
    mixed: DVec3,
    linear: DVec3,
    constant: f64,
    weight: f64,
}

impl Quadric {
    /// `weight` times the squared distance to the plane through `point` with this unit normal.
    pub fn of_plane(point: DVec3, normal: DVec3, weight: f64) -> Self {
        let offset = -normal.dot(point);
        Self {
            diagonal: normal * normal * weight,
            mixed: DVec3::new(normal.y * normal.z, normal.x * normal.z, normal.x * normal.y) * weight,
            linear: normal * (offset * weight),
            constant: offset * offset * weight,
            weight,
        }
    }

    /// The area of a triangle times the squared distance to its plane; nothing for a triangle without area.
    pub fn of_triangle(corners: [DVec3; 3]) -> Self {
        let vector = area_vector(corners);
        let double_area = vector.length();
        match vector.try_normalize() {
            Some(normal) => Self::of_plane(corners[0], normal, double_area * 0.5),
            None => Self::default(),
        }
    }

    /// The plane along the edge `a b`, upright on the triangle with this area vector: it holds a boundary in place.
    pub fn of_boundary_edge(a: DVec3, b: DVec3, area_vector: DVec3, factor: f64) -> Self {
        match (b - a).cross(area_vector).try_normalize() {
            Some(normal) => Self { weight: 0.0, ..Self::of_plane(a, normal, (b - a).length_squared() * factor) },
            None => Self::default(),
        }
    }

    /// The squared distance to the line `a b`, times its squared length.
    pub fn of_line(a: DVec3, b: DVec3) -> Self {
        let along = b - a;
        let squares = along * along;
        let weight = along.length_squared();
        let moment = along.cross(a);
        Self {
            diagonal: DVec3::splat(weight) - squares,
            mixed: -DVec3::new(along.y * along.z, along.x * along.z, along.x * along.y),
            linear: along.cross(moment),
            constant: moment.length_squared(),
            weight,
        }
    }

    /// `weight` times `p (I - u uᵀ - v vᵀ) p + 2 linear p + constant`: the part that positions have in a distance to a
    /// plane that `u` and `v` are parts of.
    pub(super) fn besides(u: DVec3, v: DVec3, linear: DVec3, constant: f64, weight: f64) -> Self {
        let mixed = |a: DVec3| DVec3::new(a.y * a.z, a.x * a.z, a.x * a.y);
        Self {
            diagonal: (DVec3::ONE - u * u - v * v) * weight,
            mixed: (mixed(u) + mixed(v)) * -weight,
            linear: linear * weight,
            constant: constant * weight,
            weight,
        }
    }

    /// Takes `(direction p + offset)²` away.
    pub(super) fn take(&mut self, direction: DVec3, offset: f64) {
        let d = direction;
        self.diagonal -= d * d;
        self.mixed -= DVec3::new(d.y * d.z, d.x * d.z, d.x * d.y);
        self.linear -= d * offset;
        self.constant -= offset * offset;
    }

    /// The sum of the weights.
    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    /// `A`.
    pub(super) fn matrix(&self) -> DMat3 {
        let (d, m) = (self.diagonal, self.mixed);
        DMat3::from_cols(DVec3::new(d.x, m.z, m.y), DVec3::new(m.z, d.y, m.x), DVec3::new(m.y, m.x, d.z))
    }

    /// `b`.
    pub(super) fn linear(&self) -> DVec3 {
        self.linear
    }

    /// The sum of weighted squared distances from `p`, not below 0.
    #[inline]
    pub fn value(&self, p: DVec3) -> f64 {
        self.value_raw(p).max(0.0)
    }

    /// The value, below 0 by rounding, or because it is a part of another.
    #[inline]
    pub(super) fn value_raw(&self, p: DVec3) -> f64 {
        let mixed = self.mixed.x * p.y * p.z + self.mixed.y * p.x * p.z + self.mixed.z * p.x * p.y;
        self.diagonal.dot(p * p) + 2.0 * (mixed + self.linear.dot(p)) + self.constant
    }

    /// The root mean square distance from `p` to the planes, in model units: an estimate of the distance to the surface.
    /// Boundary planes raise it near boundaries; without any area it is 0.
    #[inline]
    pub fn distance(&self, p: DVec3) -> f64 {
        self.root(self.value(p))
    }

    /// The distance that a value stands for.
    #[inline]
    pub(super) fn root(&self, value: f64) -> f64 {
        if self.weight > 0.0 { (value / self.weight).sqrt() } else { 0.0 }
    }

    /// The point of least value, where the planes pin one down well enough.
    #[inline]
    pub fn minimum(&self) -> Option<DVec3> {
        let (d, m) = (self.diagonal, self.mixed);
        let adjugate_diagonal = DVec3::new(d.y * d.z - m.x * m.x, d.x * d.z - m.y * m.y, d.x * d.y - m.z * m.z);
        let adjugate_mixed = DVec3::new(m.y * m.z - d.x * m.x, m.x * m.z - d.y * m.y, m.x * m.y - d.z * m.z);
        let determinant = d.x * adjugate_diagonal.x + m.z * adjugate_mixed.z + m.y * adjugate_mixed.y;
        let scale = d.element_sum();
        // Relative to the trace, so that the unit of the model does not matter.
        if determinant <= 1e-7 * scale * scale * scale {
            return None;
        }
        let l = self.linear;
        let product = adjugate_diagonal * l
            + DVec3::new(
                adjugate_mixed.z * l.y + adjugate_mixed.y * l.z,
                adjugate_mixed.z * l.x + adjugate_mixed.x * l.z,
                adjugate_mixed.y * l.x + adjugate_mixed.x * l.y,
            );
        Some(-product / determinant)
    }

    /// The point of least value on the segment `a b`.
    #[inline]
    pub fn minimum_on(&self, a: DVec3, b: DVec3) -> DVec3 {
        // Along the segment the value is a parabola, given by its ends and its middle.
        let (at_a, at_b, middle) = (self.value(a), self.value(b), self.value(a.lerp(b, 0.5)));
        let bend = 2.0 * (at_a + at_b) - 4.0 * middle;
        if bend > 1e-12 * (at_a + at_b) {
            let slope = 4.0 * middle - 3.0 * at_a - at_b;
            return a.lerp(b, (-slope / (2.0 * bend)).clamp(0.0, 1.0));
        }
        if at_a < at_b {
            a
        } else if at_b < at_a {
            b
        } else {
            a.lerp(b, 0.5)
        }
    }
}

/// The metric of `[GarlandHeckbert1997]`: each vertex has the sum of the quadrics of its triangles, two that become one
/// add theirs up, and the best place is where the sum is least. The error is the root mean square distance to the planes
/// of the sum; it may fall from one collapse to the next.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Quadrics;

impl Metric for Quadrics {
    type State = Vec<Quadric>;
    type Pair = Quadric;

    fn name(&self) -> &'static str {
        "quadric"
    }

    fn prepare(&self, draft: &Draft<3>, boundary: &Boundary<'_>) -> Result<Vec<Quadric>, Unfit> {
        let corners = |cell: [VertexId; 3]| cell.map(|v| draft.positions[v.index()].as_dvec3());
        let mut quadrics = of_triangles(draft);
        for edge in boundary.edges {
            let [a, b] = edge.ends.map(|v| draft.positions[v.index()].as_dvec3());
            let quadric = Quadric::of_boundary_edge(a, b, area_vector(corners(edge.cell)), boundary.weight);
            for v in edge.ends {
                quadrics[v.index()] += quadric;
            }
        }
        Ok(quadrics)
    }

    #[inline]
    fn pair(&self, _: &Draft<3>, quadrics: &Vec<Quadric>, ends: [VertexId; 2]) -> Quadric {
        quadrics[ends[0].index()] + quadrics[ends[1].index()]
    }

    #[inline(always)]
    fn offer(&self, draft: &Draft<3>, ends: [VertexId; 2], quadric: &Quadric, place: Place) -> Offer {
        let ends = ends_of(draft, ends);
        let position = fixed(ends, place).unwrap_or_else(|| optimal(ends.map(|p| p.as_dvec3()), quadric).as_vec3());
        let at = position.as_dvec3();
        let value = quadric.value(at);
        Offer { position, price: value, error: quadric.root(value) }
    }

    fn merged(&self, _: &Draft<3>, quadrics: &mut Vec<Quadric>, merge: &Merge) {
        let [a, b] = merge.ends;
        let sum = quadrics[a.index()] + quadrics[b.index()];
        put(quadrics, merge.into, sum);
    }
}

/// Triangles whose quadrics are made at a time: enough for several threads, and few enough to stay in a cache.
const TOGETHER: usize = 1 << 14;

/// The sums of the quadrics of the triangles around each vertex, in the order of the triangles. While some are added up, the
/// next are made.
fn of_triangles(draft: &Draft<3>) -> Vec<Quadric> {
    let make =
        |&(_, cell): &(Slot, &[VertexId; 3])| Quadric::of_triangle(cell.map(|v| draft.positions[v.index()].as_dvec3()));
    let mut sums = vec![Quadric::default(); draft.positions.len()];
    let mut add = |cells: &[(Slot, &[VertexId; 3])], quadrics: &[Quadric]| {
        for ((_, cell), quadric) in cells.iter().zip(quadrics) {
            cell.iter().for_each(|v| sums[v.index()] += *quadric);
        }
    };
    let mut cells = draft.complex.cells();
    let mut take = || cells.by_ref().take(TOGETHER).collect::<Vec<_>>();
    let mut these = take();
    let mut quadrics: Vec<Quadric> = these.iter().map(make).collect();
    while !these.is_empty() {
        let next = take();
        let made = if next.is_empty() {
            add(&these, &quadrics);
            Vec::new()
        } else {
            let work = || next.par_iter().with_min_len(TOGETHER / 8).map(make).collect();
            rayon::join(work, || add(&these, &quadrics)).0
        };
        (these, quadrics) = (next, made);
    }
    sums
}

impl RegionMetric for Quadrics {
    type Memory = Quadric;

    fn recall(&self, quadrics: &Vec<Quadric>, v: VertexId) -> Quadric {
        quadrics[v.index()]
    }

    fn resume(&self, _: &Vec<Quadric>, memories: impl Iterator<Item = Quadric>) -> Vec<Quadric> {
        memories.collect()
    }
}

/// The quadric's minimum if it is near the ends, else the best point between them.
#[inline]
pub(super) fn optimal([a, b]: [DVec3; 2], quadric: &Quadric) -> DVec3 {
    // Planes that are nearly parallel pin their meeting point down badly; it may be far away.
    let near = |p: &DVec3| p.distance_squared((a + b) * 0.5) <= 4.0 * a.distance_squared(b);
    quadric.minimum().filter(near).unwrap_or_else(|| quadric.minimum_on(a, b))
}

impl Add for Quadric {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            diagonal: self.diagonal + other.diagonal,
            mixed: self.mixed + other.mixed,
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
            weight: self.weight + other.weight,
        }
    }
}

impl AddAssign for Quadric {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1f64..1.0).prop_map(DVec3::from)
    }

    #[test]
    fn sums_are_those_of_adding_up_in_a_row() {
        let mesh = mt_core::generate::torus(160, 120);
        assert!(mesh.cell_count() > 2 * TOGETHER);
        let mut slow = vec![Quadric::default(); mesh.vertex_count()];
        for cell in &mesh.cells {
            let quadric = Quadric::of_triangle(cell.map(|v| mesh.positions[v.index()].as_dvec3()));
            cell.iter().for_each(|v| slow[v.index()] += quadric);
        }
        assert!(of_triangles(&Draft::new(&mesh)) == slow);
    }

    proptest! {
        #[test]
        fn value_is_the_squared_distance(a in point(), b in point(), c in point(), p in point()) {
            let vector = mt_core::mesh::area_vector([a, b, c]);
            prop_assume!(vector.length() > 1e-3);
            let height = (p - a).dot(vector.normalize());
            let quadric = Quadric::of_triangle([a, b, c]);
            prop_assert!((quadric.value(p) - height * height * vector.length() * 0.5).abs() < 1e-9);
            prop_assert!((quadric.distance(p) - height.abs()).abs() < 1e-6);
        }

        #[test]
        fn a_line_is_as_far_as_its_nearest_point(a in point(), b in point(), p in point()) {
            let far = (p - a).cross(b - a).length_squared();
            prop_assert!((Quadric::of_line(a, b).value(p) - far).abs() < 1e-9);
        }

        #[test]
        fn no_other_point_is_better_than_the_minimum(points in prop::collection::vec(point(), 12), p in point()) {
            let quadric = points.chunks(3).map(|c| Quadric::of_triangle([c[0], c[1], c[2]])).fold(Quadric::default(), Add::add);
            if let Some(best) = quadric.minimum() {
                prop_assert!(quadric.value(best) <= quadric.value(p) + 1e-9);
            }
            let (a, b) = (points[0], points[1]);
            let best = quadric.minimum_on(a, b);
            for t in 0..=10 {
                prop_assert!(quadric.value(best) <= quadric.value(a.lerp(b, f64::from(t) / 10.0)) + 1e-9);
            }
        }
    }
}
