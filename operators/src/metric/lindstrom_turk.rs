//! The memoryless metric of `[LindstromTurk1998]`: volume and boundary kept, and the rest by least squares.
//!
//! Nothing of the input is remembered: each step is judged against the mesh as it is, as `[LindstromTurk1999]` finds
//! worthwhile. The place of a vertex comes from equations in order of importance, until three pin it down: the volume
//! stays, the area along the boundary stays, the squares of what single triangles sweep are least, the same along the
//! boundary, and the triangles are well shaped. The price is the paper's sum of squared volumes and, with the edge's squared
//! length, of squared boundary areas.
//!
//! Deviations: rows so short that they are noise are not taken (the paper's test compares directions only); a place
//! further from the middle than twice the edge's length is given up for a well-shaped one; a mesh whose triangles are not
//! coherently oriented has no volume to keep, so there the two preservations are left out.

use super::constraints::Constraints;
use super::quadric::Quadric;
use super::{Boundary, Merge, Metric, Offer, Place, RegionMetric, diagonal, ends_of, fixed, put};
use glam::{DMat3, DVec3};
use mt_core::VertexId;
use mt_core::analysis::{Draft, Unfit};
use mt_core::mesh::area_vector;

/// Less than this share of the whole pins nothing down: what bends in a direction, against the sum over all directions.
const NOISE: f64 = 1e-4;

/// The metric of `[LindstromTurk1998]`.
///
/// Its error is our own, as the paper states none: the error of the worse of the two vertices, plus the distance of this
/// step, which is the root mean square distance of the new vertex to the planes of the triangles around (weighted by squared
/// area, as the price is) or to the boundary edges around, whichever is more. So it never falls along the vertices, adds up
/// as the triangle inequality does, and is an estimate, not a bound, as root mean squares are.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct LindstromTurk {
    /// The share of volume in the price, 0 to 1; the rest is the share of the boundary.
    pub volume_share: f64,
}

impl LindstromTurk {
    /// The paper's share, a half.
    pub const DEFAULT: Self = Self { volume_share: 0.5 };
}

impl Default for LindstromTurk {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// What is kept of the vertices: errors so far, and where the boundary is.
#[derive(Clone, Debug, Default)]
pub struct Memoryless {
    errors: Vec<f32>,
    on_boundary: Vec<bool>,
    /// Whether triangles that share an edge pass it in opposite directions.
    coherent: bool,
    /// What makes prices those of a mesh of diagonal 1, so that they stay within the range of single precision.
    scale: f64,
}

/// The triangles around two vertices, and what moving both to one point does to them. Seen from the middle of the two.
#[derive(Copy, Clone, Debug, Default)]
pub struct Surroundings {
    middle: DVec3,
    length_squared: f64,
    /// Squared volumes of the tetrahedra over the triangles, times 36.
    volumes: Quadric,
    /// The sum of these volumes, times 6, is `normal . x - offset`.
    normal: DVec3,
    offset: f64,
    /// Squared areas of the triangles over the boundary edges, times 4.
    areas: Quadric,
    /// The sum of boundary edges as vectors, and of the cross products of their ends.
    edges: DVec3,
    crosses: DVec3,
    /// The sum of the neighbours, and their number.
    neighbours: DVec3,
    count: f64,
    coherent: bool,
    error: f64,
    scale: f64,
}

impl Metric for LindstromTurk {
    type State = Memoryless;
    type Pair = Surroundings;

    fn name(&self) -> &'static str {
        "lindstrom-turk"
    }

    fn sees_neighbours(&self) -> bool {
        true
    }

    fn prepare(&self, draft: &Draft<3>, boundary: &Boundary<'_>) -> Result<Memoryless, Unfit> {
        let mut on_boundary = vec![false; draft.positions.len()];
        boundary.edges.iter().flat_map(|edge| edge.ends).for_each(|v| on_boundary[v.index()] = true);
        let mut sides: Vec<_> = draft.complex.cells().flat_map(|(_, &[a, b, c])| [(a, b), (b, c), (c, a)]).collect();
        sides.sort_unstable();
        let scale = diagonal(&draft.positions).powi(-6);
        Ok(Memoryless {
            errors: vec![0.0; draft.positions.len()],
            on_boundary,
            coherent: sides.windows(2).all(|pair| pair[0] != pair[1]),
            scale: if scale.is_finite() { scale } else { 1.0 },
        })
    }

    fn pair(&self, draft: &Draft<3>, state: &Memoryless, ends: [VertexId; 2]) -> Surroundings {
        Surroundings::new(draft, state, ends)
    }

    fn offer(&self, draft: &Draft<3>, ends: [VertexId; 2], pair: &Surroundings, place: Place) -> Offer {
        let ends = ends_of(draft, ends);
        let position = fixed(ends, place).unwrap_or_else(|| (pair.best() + pair.middle).as_vec3());
        let x = position.as_dvec3() - pair.middle;
        let volume = pair.volumes.value(x) / 36.0;
        let boundary = pair.areas.value(x) / 4.0 * pair.length_squared;
        Offer {
            position,
            price: (self.volume_share * volume + (1.0 - self.volume_share) * boundary) * pair.scale,
            error: pair.error + pair.volumes.distance(x).max(pair.areas.distance(x)),
        }
    }

    fn merged(&self, _: &Draft<3>, state: &mut Memoryless, merge: &Merge) {
        let on_boundary = merge.ends.iter().any(|v| state.on_boundary[v.index()]);
        // An error that was measured may be below what was estimated before.
        let error = merge.ends.iter().map(|v| state.errors[v.index()]).fold(merge.error, f32::max);
        put(&mut state.on_boundary, merge.into, on_boundary);
        put(&mut state.errors, merge.into, error);
    }
}

impl RegionMetric for LindstromTurk {
    /// Error and whether it is on the boundary.
    type Memory = (f32, bool);

    fn recall(&self, state: &Memoryless, v: VertexId) -> (f32, bool) {
        (state.errors[v.index()], state.on_boundary[v.index()])
    }

    fn resume(&self, of: &Memoryless, memories: impl Iterator<Item = (f32, bool)>) -> Memoryless {
        let (errors, on_boundary) = memories.unzip();
        Memoryless { errors, on_boundary, coherent: of.coherent, scale: of.scale }
    }
}

impl Surroundings {
    fn new(draft: &Draft<3>, state: &Memoryless, ends: [VertexId; 2]) -> Self {
        let [a, b] = ends_of(draft, ends).map(|p| p.as_dvec3());
        let mut around = Self {
            middle: (a + b) * 0.5,
            length_squared: a.distance_squared(b),
            coherent: state.coherent,
            error: f64::from(ends.map(|v| state.errors[v.index()]).into_iter().fold(0.0, f32::max)),
            scale: state.scale,
            ..Self::default()
        };
        for (which, &end) in ends.iter().enumerate() {
            for (slot, _) in draft.complex.star(end) {
                let cell = draft.complex.cell(slot);
                // A triangle at both is met twice.
                if which == 0 || !cell.contains(&ends[0]) {
                    around.add_triangle(cell.map(|v| draft.positions[v.index()].as_dvec3() - around.middle));
                    around.add_neighbours(draft, cell, ends);
                }
            }
            if state.on_boundary[end.index()] {
                around.add_boundary(draft, ends, which);
            }
        }
        around
    }

    fn add_triangle(&mut self, corners: [DVec3; 3]) {
        let vector = area_vector(corners);
        let length = vector.length();
        if length > 0.0 {
            self.volumes += Quadric::of_plane(corners[0], vector / length, length * length);
        }
        self.normal += vector;
        self.offset += vector.dot(corners[0]);
    }

    /// Where two triangles meet at an edge, its far end counts twice, at the boundary once.
    fn add_neighbours(&mut self, draft: &Draft<3>, cell: &[VertexId; 3], ends: [VertexId; 2]) {
        for w in cell.iter().filter(|w| !ends.contains(w)) {
            self.neighbours += draft.positions[w.index()].as_dvec3() - self.middle;
            self.count += 1.0;
        }
    }

    /// The boundary edges at one of the ends; one between the two is with the first.
    fn add_boundary(&mut self, draft: &Draft<3>, ends: [VertexId; 2], which: usize) {
        let end = ends[which];
        for (slot, i) in draft.complex.star(end) {
            let cell = draft.complex.cell(slot);
            let [next, last] = [cell[(i + 1) % 3], cell[(i + 2) % 3]];
            for [from, to, far] in [[end, next, next], [last, end, last]] {
                let with_the_first = which == 1 && far == ends[0];
                if !with_the_first && draft.complex.edge_degree(end, far) == 1 {
                    let [a, b] = [from, to].map(|v| draft.positions[v.index()].as_dvec3() - self.middle);
                    self.areas += Quadric::of_line(a, b);
                    self.edges += b - a;
                    self.crosses += a.cross(b);
                }
            }
        }
    }

    /// The place of the vertex, seen from the middle.
    fn best(&self) -> DVec3 {
        let mut kept = Constraints::default();
        if self.coherent {
            // A sum that cancels out to less than this is rounding.
            let most = self.volumes.weight().sqrt();
            kept.add(self.normal, self.offset, NOISE * most);
            let (edges, crosses) = (self.edges, self.crosses);
            if edges.length_squared() > NOISE * self.areas.weight() {
                kept.minimise(line_matrix(edges), crosses.cross(edges), NOISE);
            }
        }
        let mut best = kept;
        best.minimise(self.volumes.matrix(), self.volumes.linear(), NOISE);
        best.minimise(self.areas.matrix(), self.areas.linear(), NOISE);
        self.shaped(best).or_else(|| self.shaped(kept)).unwrap_or(DVec3::ZERO)
    }

    /// The point that these leave, with what freedom there is used for short edges, if it is near.
    fn shaped(&self, mut constraints: Constraints) -> Option<DVec3> {
        constraints.minimise(DMat3::IDENTITY * self.count, -self.neighbours, NOISE);
        constraints.solve().filter(|x| x.length_squared() <= 4.0 * self.length_squared)
    }
}

/// `|e|² I - e eᵀ`: what the cross product with `e` does to squared lengths.
fn line_matrix(e: DVec3) -> DMat3 {
    DMat3::from_diagonal(DVec3::splat(e.length_squared())) - DMat3::from_cols(e * e.x, e * e.y, e * e.z)
}
