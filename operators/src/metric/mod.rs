//! Metrics: what it costs to make two vertices one, where that one goes, and how far the surface is then from the input.
//!
//! A [`Metric`] is a part of its own: it knows positions and stars, not the operator that asks. Any two vertices will
//! do, an edge between them or not, on a manifold or not. An operator [prepares](Metric::prepare) it once, asks for a
//! [pair](Metric::pair) and for [offers](Metric::offer) for that pair, and [tells](Metric::merged) it what was done.
//!
//! | name | type | price | state of a vertex |
//! |---|---|---|---|
//! | `quadric` | [`Quadrics`] | weighted squared distances to planes | a quadric |
//! | `quadric-attributes` | [`QuadricAttributes`] | the same in the space of positions and attributes | a quadric, attributes |
//! | `lindstrom-turk` | [`LindstromTurk`] | squared volumes and boundary areas of this step | an error |
//! | `edge-length` | [`EdgeLength`] | the distance between the two | a displacement |
//!
//! [`AnyMetric`] is one of these, by name.

mod any;
mod attributes;
mod constraints;
mod edge_length;
mod lindstrom_turk;
mod quadric;

pub use any::{AnyMetric, AnyPair, AnyState, UnknownMetric};
pub use attributes::{AttributePair, AttributeQuadric, AttributeState, QuadricAttributes};
pub use edge_length::{Displacements, EdgeLength};
pub use lindstrom_turk::{LindstromTurk, Memoryless, Surroundings};
pub use quadric::{Quadric, Quadrics};

use glam::Vec3;
use mt_core::VertexId;
use mt_core::analysis::{Draft, Unfit};

/// An edge with one triangle, at the beginning of analysis.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct BoundaryEdge {
    /// Its ends.
    pub ends: [VertexId; 2],
    /// Its triangle's corners.
    pub cell: [VertexId; 3],
}

/// The boundary before anything is done, and how much it weighs.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Boundary<'a> {
    /// Each boundary edge once.
    pub edges: &'a [BoundaryEdge],
    /// What moving a boundary counts against moving a surface, for metrics that weigh the two.
    pub weight: f64,
}

/// Where the vertex that two vertices become may go.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Where the metric likes it best.
    Best,
    /// Halfway: what an operator falls back to when the best place is refused.
    Middle,
    /// Where the first of the two is, which then stays as it is.
    First,
    /// Where the second of the two is, which then stays as it is.
    Second,
}

/// What a metric says of two vertices becoming one at a place.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Offer {
    /// The place.
    pub position: Vec3,
    /// Its price, not below 0. Prices of one metric compare with each other and with nothing else.
    pub price: f64,
    /// Distance of the surface from the input afterwards, in model units: an estimate, of which each metric says what it
    /// is worth.
    pub error: f64,
}

/// Two vertices that have become one.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Merge {
    /// The two. Where one of them stays, it is the first.
    pub ends: [VertexId; 2],
    /// What they have become: the first of them, or the vertex after all those that the metric knows.
    pub into: VertexId,
    /// The error that was recorded for it, in model units.
    pub error: f32,
}

/// A measure of what is lost when two vertices become one.
///
/// All of it is pure but [`merged`](Metric::merged), so an operator may ask as often as it likes.
pub trait Metric {
    /// What is kept for the vertices while an analysis runs, such as a quadric each.
    type State;
    /// What the metric knows of two vertices taken together; made once, asked for several places.
    type Pair;

    /// The metric's name in reports and on command lines.
    fn name(&self) -> &'static str;

    /// Whether prices depend on the triangles around the two vertices as they are now. Then moving a vertex changes the
    /// prices of pairs of which a neighbour of it is one, and the operator has to ask for those again too.
    fn sees_neighbours(&self) -> bool {
        false
    }

    /// The state before anything is done, or why the metric cannot take the mesh.
    fn prepare(&self, draft: &Draft<3>, boundary: &Boundary<'_>) -> Result<Self::State, Unfit>;

    /// What there is to know of two live vertices. O(1), or O(stars) for one that sees neighbours.
    fn pair(&self, draft: &Draft<3>, state: &Self::State, ends: [VertexId; 2]) -> Self::Pair;

    /// Price and error of the pair becoming one vertex at `place`. The same `ends` and the same draft as for the pair.
    fn offer(&self, draft: &Draft<3>, ends: [VertexId; 2], pair: &Self::Pair, place: Place) -> Offer;

    /// Hears that two vertices have become one; `draft` is as it is after that, and still has the positions of both.
    /// Several that become one are told one after the other.
    fn merged(&self, draft: &Draft<3>, state: &mut Self::State, merge: &Merge);
}

/// A metric whose state can be told vertex by vertex, as an analysis by regions needs it.
pub trait RegionMetric: Metric<State: Send + Sync> + Sync {
    /// What is kept for one vertex.
    type Memory: Copy + Send + Sync;

    /// What is kept for `v`.
    fn recall(&self, state: &Self::State, v: VertexId) -> Self::Memory;

    /// The state of vertices with these memories. What holds for the whole mesh is as in `of`.
    fn resume(&self, of: &Self::State, memories: impl Iterator<Item = Self::Memory>) -> Self::State;
}

/// Length of the diagonal of the box around all positions.
fn diagonal(positions: &[Vec3]) -> f64 {
    let Some(&first) = positions.first() else { return 0.0 };
    let (low, high) = positions.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
    (high.as_dvec3() - low.as_dvec3()).length()
}

/// The positions of two vertices.
#[inline]
fn ends_of(draft: &Draft<3>, ends: [VertexId; 2]) -> [Vec3; 2] {
    ends.map(|v| draft.positions[v.index()])
}

/// Where a place is, if it does not take the metric to say so.
#[inline]
fn fixed(ends: [Vec3; 2], place: Place) -> Option<Vec3> {
    match place {
        Place::Best => None,
        Place::Middle => Some(ends[0].midpoint(ends[1])),
        Place::First => Some(ends[0]),
        Place::Second => Some(ends[1]),
    }
}

/// Gives a vertex its value: one that is there, or the one after the last.
fn put<T>(values: &mut Vec<T>, v: VertexId, value: T) {
    match values.get_mut(v.index()) {
        Some(place) => *place = value,
        None => values.push(value),
    }
}
