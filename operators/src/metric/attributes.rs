//! Quadrics over positions and attributes together (`[GarlandHeckbert1998]`).
//!
//! A vertex with `K` attributes is a point of a space of `3 + K` dimensions, a triangle lies in a plane of two dimensions
//! there, and a quadric sums squared distances to such planes. For a position that is given, the attributes at which the
//! sum is least follow by a `K` by `K` system; what is left is a quadric over positions, which is minimised as any other.
//! So the only matrix of more than three rows that is ever solved is the block of the attributes, by Cholesky's method,
//! where a direction that the planes leave open stays at its old value and costs nothing.

use super::quadric::{Quadric, optimal};
use super::{Boundary, Merge, Metric, Offer, Place, RegionMetric, diagonal, ends_of, fixed, put};
use glam::{DVec3, Vec3};
use mt_core::VertexId;
use mt_core::analysis::{Draft, Unfit};
use mt_core::mesh::area_vector;
use std::sync::Arc;

/// A direction of which planes leave less than this share of the whole is open.
const OPEN: f64 = 1e-9;

/// Weighted squared distances to planes in the space of a position `p` and attributes `a`:
/// `position(p) + 2 p C a + a D a + 2 d a`. 256 bytes for three attributes.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct AttributeQuadric<const K: usize> {
    position: Quadric,
    /// The columns of `C`.
    cross: [DVec3; K],
    /// `D`.
    inner: [[f64; K]; K],
    /// `d`.
    linear: [f64; K],
}

impl<const K: usize> Default for AttributeQuadric<K> {
    fn default() -> Self {
        Self::of_position(Quadric::default())
    }
}

impl<const K: usize> AttributeQuadric<K> {
    /// A quadric that attributes do not matter to.
    pub fn of_position(position: Quadric) -> Self {
        Self { position, cross: [DVec3::ZERO; K], inner: [[0.0; K]; K], linear: [0.0; K] }
    }

    /// The area of a triangle times the squared distance to the plane through its corners with their attributes; nothing
    /// for a triangle without area.
    pub fn of_triangle(corners: [DVec3; 3], attributes: [[f64; K]; 3]) -> Self {
        let weight = area_vector(corners).length() * 0.5;
        let points: [_; 3] = std::array::from_fn(|i| Point { position: corners[i], attributes: attributes[i] });
        let Some(along) = points[1].minus(&points[0]).normalised().filter(|_| weight > 0.0) else {
            return Self::default();
        };
        let side = points[2].minus(&points[0]);
        let Some(across) = side.minus(&along.times(side.dot(&along))).normalised() else { return Self::default() };
        // What a point has besides the two directions: A = I - u uᵀ - v vᵀ, and the rest by the corner.
        let origin = &points[0];
        let foot = along.times(origin.dot(&along)).plus(&across.times(origin.dot(&across)));
        let offset = foot.minus(origin);
        let part = |i: usize, j: usize| {
            along.attributes[i] * along.attributes[j] + across.attributes[i] * across.attributes[j]
        };
        Self {
            position: Quadric::besides(along.position, across.position, offset.position, offset.dot(&offset), weight),
            cross: std::array::from_fn(|k| {
                (along.position * along.attributes[k] + across.position * across.attributes[k]) * -weight
            }),
            inner: std::array::from_fn(|i| {
                std::array::from_fn(|j| (f64::from(u8::from(i == j)) - part(i, j)) * weight)
            }),
            linear: offset.attributes.map(|x| x * weight),
        }
    }

    /// The sum of weighted squared distances, not below 0.
    pub fn value(&self, p: DVec3, a: &[f64; K]) -> f64 {
        let mut value = self.position.value_raw(p);
        for i in 0..K {
            let row: f64 = (0..K).map(|j| self.inner[i][j] * a[j]).sum();
            value += a[i] * (2.0 * (self.cross[i].dot(p) + self.linear[i]) + row);
        }
        value.max(0.0)
    }

    /// The root mean square distance to the planes, in model units.
    pub fn distance(&self, p: DVec3, a: &[f64; K]) -> f64 {
        self.position.root(self.value(p, a))
    }

    /// The attributes at which the value is least for a position, near `old` where the planes leave them open.
    pub fn attributes_at(&self, p: DVec3, old: &[f64; K]) -> [f64; K] {
        // Solved for the step from the old ones, so that an open direction keeps them.
        let slope = std::array::from_fn(|i| {
            let row: f64 = (0..K).map(|j| self.inner[i][j] * old[j]).sum();
            -(self.cross[i].dot(p) + self.linear[i] + row)
        });
        let step = Factors::new(&self.inner).solve(slope);
        std::array::from_fn(|i| old[i] + step[i])
    }

    /// What is left of it when the attributes follow the position.
    pub fn of_positions(&self) -> Quadric {
        let factors = Factors::new(&self.inner);
        // With the rows of C and d as right sides, L y = right side gives C D⁻¹ Cᵀ and its like as sums of squares.
        let [x, y, z, w] = [
            factors.forward(self.cross.map(|c| c.x)),
            factors.forward(self.cross.map(|c| c.y)),
            factors.forward(self.cross.map(|c| c.z)),
            factors.forward(self.linear),
        ];
        let mut left = self.position;
        for k in 0..K {
            left.take(DVec3::new(x[k], y[k], z[k]), w[k]);
        }
        left
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            position: self.position + other.position,
            cross: std::array::from_fn(|k| self.cross[k] + other.cross[k]),
            inner: std::array::from_fn(|i| std::array::from_fn(|j| self.inner[i][j] + other.inner[i][j])),
            linear: std::array::from_fn(|k| self.linear[k] + other.linear[k]),
        }
    }
}

/// A point of the space, or a direction.
struct Point<const K: usize> {
    position: DVec3,
    attributes: [f64; K],
}

impl<const K: usize> Point<K> {
    fn dot(&self, other: &Self) -> f64 {
        self.position.dot(other.position) + (0..K).map(|k| self.attributes[k] * other.attributes[k]).sum::<f64>()
    }

    fn times(&self, factor: f64) -> Self {
        Self { position: self.position * factor, attributes: self.attributes.map(|a| a * factor) }
    }

    fn plus(&self, other: &Self) -> Self {
        let attributes = std::array::from_fn(|k| self.attributes[k] + other.attributes[k]);
        Self { position: self.position + other.position, attributes }
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.times(-1.0))
    }

    fn normalised(&self) -> Option<Self> {
        let length = self.dot(self).sqrt();
        (length > 0.0 && length.is_finite()).then(|| self.times(1.0 / length))
    }
}

/// Cholesky's factors of a matrix that is not negative: `L Lᵀ`. A direction that is open has a pivot of 0.
struct Factors<const K: usize>([[f64; K]; K]);

impl<const K: usize> Factors<K> {
    fn new(matrix: &[[f64; K]; K]) -> Self {
        let least = OPEN * (0..K).map(|k| matrix[k][k]).sum::<f64>();
        let mut lower = [[0.0; K]; K];
        for j in 0..K {
            let pivot = matrix[j][j] - (0..j).map(|k| lower[j][k] * lower[j][k]).sum::<f64>();
            if pivot > least {
                lower[j][j] = pivot.sqrt();
                for i in j + 1..K {
                    let rest: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
                    lower[i][j] = (matrix[i][j] - rest) / lower[j][j];
                }
            }
        }
        Self(lower)
    }

    /// `y` of `L y = right`.
    fn forward(&self, right: [f64; K]) -> [f64; K] {
        let mut y = [0.0; K];
        for i in 0..K {
            let rest: f64 = (0..i).map(|k| self.0[i][k] * y[k]).sum();
            y[i] = if self.0[i][i] > 0.0 { (right[i] - rest) / self.0[i][i] } else { 0.0 };
        }
        y
    }

    /// `x` of `L Lᵀ x = right`.
    fn solve(&self, right: [f64; K]) -> [f64; K] {
        let y = self.forward(right);
        let mut x = [0.0; K];
        for i in (0..K).rev() {
            let rest: f64 = (i + 1..K).map(|k| self.0[k][i] * x[k]).sum();
            x[i] = if self.0[i][i] > 0.0 { (y[i] - rest) / self.0[i][i] } else { 0.0 };
        }
        x
    }
}

/// The metric of `[GarlandHeckbert1998]`, for `K` attributes of each vertex.
///
/// Deviation from the paper: it scales the mesh to a unit cube and leaves the attributes as they are; here a difference of
/// 1 in an attribute counts as `weight` times the diagonal of the mesh. So prices and errors are lengths of the model, in
/// the space of both: the error is the root mean square distance to the planes there, and where attributes change without
/// the surface doing so it is not 0. Boundaries are held in place by their positions alone.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadricAttributes<const K: usize = 3> {
    /// Attributes of each vertex of the input, by its id. Without them they are the vertex normals, weighted by area, as
    /// many of their coordinates as there are attributes and 0 for the rest.
    pub attributes: Option<Arc<[[f32; K]]>>,
    /// The share of the mesh's diagonal that a difference of 1 in an attribute is worth.
    pub weight: f64,
}

impl QuadricAttributes<3> {
    /// Vertex normals as attributes. A turn of 90 degrees counts as about a hundredth of the diagonal.
    pub const NORMALS: Self = Self { attributes: None, weight: 0.01 };
}

/// Quadrics and attributes of the vertices, seen from the middle of the mesh, attributes as lengths.
#[derive(Clone, Debug, Default)]
pub struct AttributeState<const K: usize> {
    middle: DVec3,
    vertices: Vec<(AttributeQuadric<K>, [f64; K])>,
}

/// What the quadrics say of two vertices: with attributes, and with those that follow the position.
#[derive(Copy, Clone, Debug)]
pub struct AttributePair<const K: usize> {
    middle: DVec3,
    sum: AttributeQuadric<K>,
    attributes: [[f64; K]; 2],
}

impl<const K: usize> Metric for QuadricAttributes<K> {
    type State = AttributeState<K>;
    type Pair = AttributePair<K>;

    fn name(&self) -> &'static str {
        "quadric-attributes"
    }

    fn prepare(&self, draft: &Draft<3>, boundary: &Boundary<'_>) -> Result<AttributeState<K>, Unfit> {
        let count = draft.positions.len();
        if let Some(given) = self.attributes.as_ref().map(|all| all.len()).filter(|&given| given != count) {
            return Err(Unfit::Other(format!("attributes are given for {given} vertices, and there are {count}")));
        }
        let unit = diagonal(&draft.positions) * self.weight;
        let attributes: Vec<[f64; K]> = match &self.attributes {
            Some(given) => given.iter().map(|a| a.map(|x| f64::from(x) * unit)).collect(),
            None => {
                normals(draft).iter().map(|n| std::array::from_fn(|k| n.get(k).map_or(0.0, |x| x * unit))).collect()
            }
        };
        let sum = draft.positions.iter().fold(DVec3::ZERO, |sum, p| sum + p.as_dvec3());
        let middle = sum / count.max(1) as f64;
        let mut vertices: Vec<_> = attributes.into_iter().map(|a| (AttributeQuadric::default(), a)).collect();
        let corners = |cell: [VertexId; 3]| cell.map(|v| draft.positions[v.index()].as_dvec3() - middle);
        for (_, &cell) in draft.complex.cells() {
            let quadric = AttributeQuadric::of_triangle(corners(cell), cell.map(|v| vertices[v.index()].1));
            cell.iter().for_each(|v| vertices[v.index()].0 = vertices[v.index()].0.plus(&quadric));
        }
        for edge in boundary.edges {
            let [a, b] = edge.ends.map(|v| draft.positions[v.index()].as_dvec3() - middle);
            let quadric = Quadric::of_boundary_edge(a, b, area_vector(corners(edge.cell)), boundary.weight);
            edge.ends.iter().for_each(|v| vertices[v.index()].0.position += quadric);
        }
        Ok(AttributeState { middle, vertices })
    }

    fn pair(&self, _: &Draft<3>, state: &AttributeState<K>, ends: [VertexId; 2]) -> AttributePair<K> {
        let [a, b] = ends.map(|v| &state.vertices[v.index()]);
        AttributePair { middle: state.middle, sum: a.0.plus(&b.0), attributes: [a.1, b.1] }
    }

    fn offer(&self, draft: &Draft<3>, ends: [VertexId; 2], pair: &AttributePair<K>, place: Place) -> Offer {
        let ends = ends_of(draft, ends);
        let position = fixed(ends, place).unwrap_or_else(|| {
            let seen = ends.map(|p| p.as_dvec3() - pair.middle);
            (optimal(seen, &pair.sum.of_positions()) + pair.middle).as_vec3()
        });
        let p = position.as_dvec3() - pair.middle;
        let attributes = match place {
            Place::First => pair.attributes[0],
            Place::Second => pair.attributes[1],
            Place::Best | Place::Middle => pair.attributes_at(ends, position),
        };
        let price = pair.sum.value(p, &attributes);
        Offer { position, price, error: pair.sum.position.root(price) }
    }

    fn merged(&self, draft: &Draft<3>, state: &mut AttributeState<K>, merge: &Merge) {
        let pair = self.pair(draft, state, merge.ends);
        let attributes = if merge.into == merge.ends[0] {
            pair.attributes[0]
        } else {
            pair.attributes_at(ends_of(draft, merge.ends), draft.positions[merge.into.index()])
        };
        put(&mut state.vertices, merge.into, (pair.sum, attributes));
    }
}

impl<const K: usize> RegionMetric for QuadricAttributes<K> {
    /// Quadric and attributes.
    type Memory = (AttributeQuadric<K>, [f64; K]);

    fn recall(&self, state: &AttributeState<K>, v: VertexId) -> Self::Memory {
        state.vertices[v.index()]
    }

    fn resume(&self, of: &AttributeState<K>, memories: impl Iterator<Item = Self::Memory>) -> AttributeState<K> {
        AttributeState { middle: of.middle, vertices: memories.collect() }
    }
}

impl<const K: usize> AttributePair<K> {
    /// The best attributes of a new vertex; where the planes leave them open, those between the two ends.
    fn attributes_at(&self, ends: [Vec3; 2], position: Vec3) -> [f64; K] {
        let [a, b, p] = [ends[0], ends[1], position].map(|p| p.as_dvec3());
        let share = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        // Ends in one place have no direction between them.
        let share = if share.is_nan() { 0.5 } else { share };
        let old = std::array::from_fn(|k| self.attributes[0][k] * (1.0 - share) + self.attributes[1][k] * share);
        self.sum.attributes_at(p - self.middle, &old)
    }
}

/// Of each vertex, the unit normal of its triangles weighted by area; 0 where there is none.
fn normals(draft: &Draft<3>) -> Vec<[f64; 3]> {
    let mut normals = vec![DVec3::ZERO; draft.positions.len()];
    for (_, cell) in draft.complex.cells() {
        let vector = area_vector(cell.map(|v| draft.positions[v.index()].as_dvec3()));
        cell.iter().for_each(|v| normals[v.index()] += vector);
    }
    normals.into_iter().map(|n| n.normalize_or_zero().to_array()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Corner = [f64; 6];

    fn corner() -> impl Strategy<Value = Corner> {
        prop::array::uniform6(-1f64..1.0)
    }

    fn split(c: Corner) -> (DVec3, [f64; 3]) {
        (DVec3::new(c[0], c[1], c[2]), [c[3], c[4], c[5]])
    }

    fn quadric(corners: [Corner; 3]) -> AttributeQuadric<3> {
        AttributeQuadric::of_triangle(corners.map(|c| split(c).0), corners.map(|c| split(c).1))
    }

    /// The squared distance of `x` to the plane of a triangle in six dimensions, by the normal equations.
    fn brute_force(corners: [Corner; 3], x: Corner) -> Option<f64> {
        let minus = |a: Corner, b: Corner| -> Corner { std::array::from_fn(|i| a[i] - b[i]) };
        let dot = |a: Corner, b: Corner| -> f64 { (0..6).map(|i| a[i] * b[i]).sum() };
        let (u, v, w) = (minus(corners[1], corners[0]), minus(corners[2], corners[0]), minus(x, corners[0]));
        let determinant = dot(u, u) * dot(v, v) - dot(u, v).powi(2);
        let s = (dot(w, u) * dot(v, v) - dot(w, v) * dot(u, v)) / determinant;
        let t = (dot(w, v) * dot(u, u) - dot(w, u) * dot(u, v)) / determinant;
        let rest: Corner = std::array::from_fn(|i| w[i] - s * u[i] - t * v[i]);
        (determinant > 1e-3).then(|| dot(rest, rest))
    }

    fn area(corners: [Corner; 3]) -> f64 {
        area_vector(corners.map(|c| split(c).0)).length() * 0.5
    }

    proptest! {
        #[test]
        fn value_is_the_squared_distance(triangles in prop::collection::vec(prop::array::uniform3(corner()), 1..8), x in corner()) {
            let wanted: Option<Vec<f64>> = triangles.iter().map(|&t| Some(brute_force(t, x)? * area(t))).collect();
            prop_assume!(wanted.is_some());
            let sum = triangles.iter().fold(AttributeQuadric::default(), |sum, &t| sum.plus(&quadric(t)));
            let (p, a) = split(x);
            let wanted: f64 = wanted.unwrap_or_default().iter().sum();
            prop_assert!((sum.value(p, &a) - wanted).abs() < 1e-9 * (1.0 + wanted));
            let weight: f64 = triangles.iter().map(|&t| area(t)).sum();
            prop_assert!((sum.distance(p, &a) - (wanted / weight).sqrt()).abs() < 1e-6);
        }

        #[test]
        fn attributes_that_follow_are_the_best(triangles in prop::collection::vec(prop::array::uniform3(corner()), 2..8), x in corner()) {
            let sum = triangles.iter().fold(AttributeQuadric::default(), |sum, &t| sum.plus(&quadric(t)));
            let (p, a) = split(x);
            let best = sum.value(p, &sum.attributes_at(p, &a));
            prop_assert!(best <= sum.value(p, &a) + 1e-9);
            prop_assert!((sum.of_positions().value(p) - best).abs() < 1e-6 * (1.0 + best));
        }

        #[test]
        fn equal_attributes_leave_the_plain_quadric(corners in prop::array::uniform3(corner()), p in corner()) {
            prop_assume!(area(corners) > 1e-3);
            let [corners, [p, ..]] = [corners.map(|c| split(c).0), [split(p).0; 3]];
            let flat = AttributeQuadric::<2>::of_triangle(corners, [[0.25, -1.0]; 3]);
            let plain = Quadric::of_triangle(corners).value(p);
            prop_assert!((flat.value(p, &[0.25, -1.0]) - plain).abs() < 1e-9);
            prop_assert!((flat.of_positions().value(p) - plain).abs() < 1e-9);
        }
    }

    #[test]
    fn attributes_for_other_vertices_are_refused() {
        let draft = Draft::new(&mt_core::generate::tetrahedron());
        let metric = QuadricAttributes { attributes: Some(Arc::from([[0.0f32; 2]; 3])), weight: 1.0 };
        let refused = metric.prepare(&draft, &Boundary { edges: &[], weight: 1.0 }).unwrap_err();
        assert_eq!(refused.to_string(), "attributes are given for 3 vertices, and there are 4");
    }
}
