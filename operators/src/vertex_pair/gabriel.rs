//! The Gabriel graph of points in space: two are joined when no third lies in the ball whose diameter they are.
//!
//! It is a part of the Delaunay triangulation and has the Euclidean minimum spanning tree in it, so it joins what is
//! nearest across every gap. Unlike the triangulation it is defined for any points, coplanar and cospherical ones too.

use glam::{DVec3, Vec3};
use mt_core::VertexId;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree, SelectionFunction};

type Point = GeomWithData<[f64; 3], VertexId>;

/// The edges of the Gabriel graph of these vertices that are not longer than `length`, in no particular sequence but
/// always the same. Of vertices in one place the first stands for all, and is joined to each of the others.
///
/// Requires: finite positions.
pub(super) fn edges(positions: &[Vec3], mut vertices: Vec<VertexId>, length: f64) -> Vec<[VertexId; 2]> {
    // Adding zero makes one zero of the two.
    let place = |v: &VertexId| (positions[v.index()] + Vec3::ZERO).to_array().map(f32::to_bits);
    vertices.sort_unstable_by_key(|v| (place(v), *v));
    let mut edges = Vec::new();
    let mut points = Vec::with_capacity(vertices.len());
    for run in vertices.chunk_by(|u, v| place(u) == place(v)) {
        edges.extend(run[1..].iter().map(|&v| [run[0], v]));
        points.push(Point::new(positions[run[0].index()].as_dvec3().to_array(), run[0]));
    }
    let tree = RTree::bulk_load(points.clone());
    let mut near = Near { from: DVec3::ZERO, length, blockers: Vec::new() };
    for point in &points {
        near.look_from(&tree, point);
        for other in tree.locate_with_selection_function(&near).filter(|other| other.data > point.data) {
            if is_empty(&tree, near.from, DVec3::from(*other.geom())) {
                edges.push([point.data, other.data]);
            }
        }
    }
    edges
}

/// Whether no point lies within the ball with this diameter. Points on its surface do not count.
fn is_empty(tree: &RTree<Point>, a: DVec3, b: DVec3) -> bool {
    // Wide enough that rounding leaves nothing out; then judged by the angle alone.
    let radius_squared = 0.2501 * a.distance_squared(b);
    let mut around = tree.locate_within_distance(((a + b) * 0.5).to_array(), radius_squared);
    !around.any(|other| is_inside(DVec3::from(*other.geom()), a, b))
}

/// Whether a point lies within the ball with this diameter: it sees the diameter under an obtuse angle.
fn is_inside(point: DVec3, a: DVec3, b: DVec3) -> bool {
    (a - point).dot(b - point) < 0.0
}

/// Where neighbours of a point can be: not far away, and not behind a point close by.
struct Near {
    from: DVec3,
    length: f64,
    /// The nearest points. What lies beyond the plane through one of them, upright on the way to it, has it in its ball.
    blockers: Vec<DVec3>,
}

/// More blockers rule out more, and take longer to ask.
const BLOCKERS: usize = 24;

impl Near {
    fn look_from(&mut self, tree: &RTree<Point>, point: &Point) {
        self.from = DVec3::from(*point.geom());
        self.blockers.clear();
        let nearest = tree.nearest_neighbor_iter(*point.geom()).take(BLOCKERS + 1);
        self.blockers.extend(nearest.map(|other| DVec3::from(*other.geom())).filter(|&p| p != self.from));
    }
}

impl SelectionFunction<Point> for &Near {
    fn should_unpack_parent(&self, envelope: &AABB<[f64; 3]>) -> bool {
        let [low, high] = [envelope.lower(), envelope.upper()].map(DVec3::from);
        let nearest = self.from.clamp(low, high);
        if nearest.distance_squared(self.from) > self.length * self.length * 1.0001 {
            return false;
        }
        // With some room, so that rounding rules nothing out.
        let behind = |&blocker: &DVec3| {
            let way = blocker - self.from;
            let least = ((low - self.from) * way).min((high - self.from) * way).element_sum();
            least > way.length_squared() * 1.0001
        };
        !self.blockers.iter().any(behind)
    }

    fn should_unpack_leaf(&self, leaf: &Point) -> bool {
        let to = DVec3::from(*leaf.geom());
        to.distance_squared(self.from) <= self.length * self.length
            && !self.blockers.iter().any(|&blocker| is_inside(blocker, self.from, to))
    }
}
