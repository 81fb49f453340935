//! Edge collapse on manifold triangle meshes, both kinds, by any metric.
//!
//! A full edge collapse (`[Hoppe1996]`) puts a new vertex where the metric likes it best; a half-edge collapse pulls one
//! end onto the other and makes no vertex. The link condition (`[DeyEdelsbrunner1999]`, with a cone over the
//! boundary) keeps the mesh a manifold of the same topology; both stars are tested for folding over against the final
//! position. Deviation from `[GarlandHeckbert1997]`: every collapse of a full edge makes a new vertex id, so an edge's
//! price holds as long as the edge does and nothing in the queue needs a stamp, unless the metric sees neighbours.

pub(crate) mod legal;
pub(crate) mod manifold;
mod regions;
#[cfg(test)]
mod tests;

pub use regions::Memory;

use crate::metric::{Boundary, BoundaryEdge, Merge, Metric, Offer, Place, Quadrics};
use mt_core::analysis::{Draft, Operator, Unfit};
use mt_core::{Complex, Plan, Refusal, VertexId};

/// Where the vertex of a collapsed edge goes.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// A new vertex where the metric likes it best.
    #[default]
    Optimal,
    /// One end stays as it is (half-edge collapse).
    End,
}

/// What may happen to boundary edges.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum BoundaryRule {
    /// Boundaries are coarsened too, held in place by what the metric has against moving them.
    #[default]
    Weighted,
    /// Boundary vertices neither move nor go.
    Locked,
}

/// Edge collapse by a metric.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct EdgeCollapse<M = Quadrics> {
    /// Where the vertex goes.
    pub placement: Placement,
    /// What may happen to boundaries.
    pub boundary: BoundaryRule,
    /// What moving a boundary counts, for metrics that ask; for quadrics, the weight of boundary planes in squared edge
    /// lengths.
    pub boundary_weight: f64,
    /// The least cosine between a triangle's normal before and after; 1 forbids any turn, -1 allows all.
    pub fold_cosine: f64,
    /// What a collapse costs, and where its vertex goes.
    pub metric: M,
}

impl EdgeCollapse {
    /// Full edge collapse with optimal placement, by quadrics.
    pub const FULL: Self = Self {
        placement: Placement::Optimal,
        boundary: BoundaryRule::Weighted,
        boundary_weight: 4.0,
        fold_cosine: 0.2,
        metric: Quadrics,
    };
    /// Half-edge collapse, by quadrics.
    pub const HALF: Self = Self { placement: Placement::End, ..Self::FULL };
}

impl<M> EdgeCollapse<M> {
    /// The same with another metric.
    pub fn with<N: Metric>(self, metric: N) -> EdgeCollapse<N> {
        let Self { placement, boundary, boundary_weight, fold_cosine, metric: _ } = self;
        EdgeCollapse { placement, boundary, boundary_weight, fold_cosine, metric }
    }
}

/// An edge, and the sum of how often its ends have changed, which is 0 for good where every change makes a new vertex.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Edge {
    a: VertexId,
    b: VertexId,
    stamp: u32,
    /// Whether to go for the second choice of target, because the first folds something over.
    second: bool,
}

/// The metric's state, boundary flags and stamps of the vertices.
#[derive(Clone, Debug, Default)]
pub struct Aux<S> {
    metric: S,
    on_boundary: Vec<bool>,
    /// Whether the triangles of every inner edge pass it in opposite directions; collapses keep that.
    coherent: bool,
    /// How often the prices at each vertex have changed; empty where a change of price is a new vertex.
    stamps: Vec<u32>,
}

impl<M: Metric> Operator<3> for EdgeCollapse<M> {
    type Site = Edge;
    type Aux = Aux<M::State>;

    fn name(&self) -> &'static str {
        match self.placement {
            Placement::Optimal => "edge-collapse",
            Placement::End => "half-edge-collapse",
        }
    }

    fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Edge>) -> Result<Self::Aux, Unfit> {
        let edges = manifold::check(&draft.complex, true)?;
        sites.extend(edges.ends().map(|[a, b]| Edge { a, b, stamp: 0, second: false }));
        self.aux_of(draft, &edges)
    }

    fn price(&self, draft: &Draft<3>, aux: &Self::Aux, site: Edge) -> Option<f64> {
        if aux.is_stale(draft, site) {
            return None;
        }
        Some(self.target(draft, aux, site).offer.price)
    }

    fn plan(&self, draft: &Draft<3>, aux: &Self::Aux, site: Edge, plan: &mut Plan<3>) -> Result<(), Refusal> {
        if aux.is_stale(draft, site) {
            return Err(Refusal::Stale);
        }
        let boundary = [aux.on_boundary[site.a.index()], aux.on_boundary[site.b.index()]];
        if self.boundary == BoundaryRule::Locked && boundary == [true, true] {
            return Err(Refusal::Boundary);
        }
        legal::link_condition(&draft.complex, [site.a, site.b], boundary, aux.coherent, &mut plan.scratch)?;
        let target = self.target(draft, aux, site);
        let Offer { position, error, .. } = target.offer;
        plan.error = error as f32;
        if !plan.error.is_finite() || !position.is_finite() {
            return Err(Refusal::NotFinite);
        }
        legal::fold_over(draft, [site.a, site.b], position, self.fold_cosine)?;
        fill(draft, site, &target, plan);
        Ok(())
    }

    fn alternative(&self, site: Edge, refusal: Refusal) -> Option<Edge> {
        let folds = matches!(refusal, Refusal::FoldOver | Refusal::Degenerate);
        (folds && !site.second).then_some(Edge { second: true, ..site })
    }

    fn applied(&self, draft: &Draft<3>, aux: &mut Self::Aux, plan: &Plan<3>, again: &mut Vec<Edge>) {
        let (ends, merged) = match *plan.retired.as_slice() {
            [a, b] => {
                aux.on_boundary.push(aux.on_boundary[a.index()] || aux.on_boundary[b.index()]);
                aux.stamps.extend((!aux.stamps.is_empty()).then_some(0));
                ([a, b], VertexId::new(aux.on_boundary.len() - 1))
            }
            [gone] => {
                let kept = plan.kept.expect("a half-edge collapse keeps an end");
                aux.on_boundary[kept.index()] |= aux.on_boundary[gone.index()];
                aux.stamps[kept.index()] += 1;
                ([kept, gone], kept)
            }
            _ => unreachable!("a collapse retires one vertex or two"),
        };
        self.metric.merged(draft, &mut aux.metric, &Merge { ends, into: merged, error: plan.error });
        if self.metric.sees_neighbours() {
            return aux.edges_around(&draft.complex, merged, again);
        }
        // Around an inner vertex of a coherently oriented mesh each neighbour comes first in one triangle.
        let each_once = aux.coherent && !aux.on_boundary[merged.index()];
        let from = again.len();
        for (slot, i) in draft.complex.star(merged) {
            let cell = draft.complex.cell(slot);
            again.push(aux.edge(merged, cell[(i + 1) % 3]));
            if !each_once {
                again.push(aux.edge(merged, cell[(i + 2) % 3]));
            }
        }
        if !each_once {
            again[from..].sort_unstable();
            again.dedup();
        }
    }
}

/// The places of the two ends.
const END: [Place; 2] = [Place::First, Place::Second];

/// Where a collapse leads: an offer of the metric, and the end that stays, if one does.
#[derive(Copy, Clone, Debug)]
struct Target {
    offer: Offer,
    kept: Option<VertexId>,
}

impl<M: Metric> EdgeCollapse<M> {
    #[inline]
    fn target(&self, draft: &Draft<3>, aux: &Aux<M::State>, site: Edge) -> Target {
        let ends = [site.a, site.b];
        let pair = self.metric.pair(draft, &aux.metric, ends);
        let (place, kept) = match (self.locked_end(aux, site), self.placement) {
            (Some(locked), _) => (END[locked], Some(ends[locked])),
            (None, Placement::Optimal) if site.second => (Place::Middle, None),
            (None, Placement::Optimal) => (Place::Best, None),
            (None, Placement::End) => {
                let cheaper = self.cheaper_end(draft, ends, &pair);
                let chosen = if site.second { 1 - cheaper } else { cheaper };
                (END[chosen], Some(ends[chosen]))
            }
        };
        // Asked in one place, so that it becomes one with what asks.
        Target { offer: self.metric.offer(draft, ends, &pair, place), kept }
    }

    fn cheaper_end(&self, draft: &Draft<3>, ends: [VertexId; 2], pair: &M::Pair) -> usize {
        let [first, second] = END.map(|place| self.metric.offer(draft, ends, pair, place).price);
        usize::from(second < first)
    }

    /// What is kept beside a mesh that has these edges.
    fn aux_of(&self, draft: &Draft<3>, edges: &manifold::Edges) -> Result<Aux<M::State>, Unfit> {
        let vertices = draft.positions.len();
        let mut on_boundary = vec![false; vertices];
        edges.border.iter().flat_map(|(ends, _)| ends).for_each(|v| on_boundary[v.index()] = true);
        let border = edges.border.iter();
        let boundary: Vec<BoundaryEdge> =
            border.map(|&(ends, slot)| BoundaryEdge { ends, cell: *draft.complex.cell(slot) }).collect();
        Ok(Aux {
            metric: self.metric.prepare(draft, &Boundary { edges: &boundary, weight: self.boundary_weight })?,
            on_boundary,
            coherent: edges.coherent,
            stamps: self.stamps(vertices),
        })
    }

    /// Stamps of so many vertices, where they are needed.
    fn stamps(&self, vertices: usize) -> Vec<u32> {
        if self.changes_prices() { vec![0; vertices] } else { Vec::new() }
    }

    /// Whether the price of an edge may change while both of its ends are there.
    fn changes_prices(&self) -> bool {
        self.placement == Placement::End || self.boundary == BoundaryRule::Locked || self.metric.sees_neighbours()
    }

    /// Which end may not move, under the locked boundary rule.
    fn locked_end(&self, aux: &Aux<M::State>, site: Edge) -> Option<usize> {
        if self.boundary == BoundaryRule::Weighted {
            return None;
        }
        [site.a, site.b].iter().position(|v| aux.on_boundary[v.index()])
    }
}

impl<S> Aux<S> {
    fn is_stale(&self, draft: &Draft<3>, site: Edge) -> bool {
        !draft.complex.has_star(site.a) || !draft.complex.has_star(site.b) || self.stamp(site.a, site.b) != site.stamp
    }

    #[inline]
    fn stamp(&self, u: VertexId, v: VertexId) -> u32 {
        if self.stamps.is_empty() { 0 } else { self.stamps[u.index()].wrapping_add(self.stamps[v.index()]) }
    }

    fn edge(&self, u: VertexId, v: VertexId) -> Edge {
        Edge { a: u.min(v), b: u.max(v), stamp: self.stamp(u, v), second: false }
    }

    /// The edges at `v` and at each of its neighbours, all of which have a new price, with new stamps.
    fn edges_around(&mut self, complex: &Complex<3>, v: VertexId, again: &mut Vec<Edge>) {
        let (mut near, mut far) = (Vec::new(), Vec::new());
        complex.neighbours(v, &mut near);
        for w in &near {
            self.stamps[w.index()] = self.stamps[w.index()].wrapping_add(1);
        }
        for &w in &near {
            complex.neighbours(w, &mut far);
            again.extend(far.iter().map(|&x| self.edge(w, x)));
        }
        again.sort_unstable();
        again.dedup();
    }
}

/// Writes a legal collapse down: cells that stay first, so that `makes[i]` takes the place of `kills[i]`.
fn fill(draft: &Draft<3>, site: Edge, target: &Target, plan: &mut Plan<3>) {
    let (ends, into) = match target.kept {
        Some(kept) => (if kept == site.a { [site.b, site.b] } else { [site.a, site.a] }, kept),
        None => ([site.a, site.b], VertexId::new(draft.positions.len())),
    };
    let complex = &draft.complex;
    let gone = if ends[0] == ends[1] { &ends[..1] } else { &ends[..] };
    let mut dying = [None; 2];
    for &end in gone {
        let other = if end == site.a { site.b } else { site.a };
        let mut both = dying.iter_mut();
        for (slot, i) in complex.star(end) {
            if legal::sides(complex, slot, i).contains(&other) {
                *both.next().expect("an edge of a manifold has one triangle or two") = Some(slot);
                continue;
            }
            let mut cell = *complex.cell(slot);
            cell[i] = into;
            plan.kills.push(slot);
            plan.makes.push(cell);
        }
    }
    if target.kept.is_some() {
        remake_behind(complex, gone[0], into, plan);
    }
    plan.kills.extend(dying.into_iter().flatten());
    plan.retired.extend_from_slice(gone);
    plan.kept = target.kept;
    if target.kept.is_none() {
        plan.vertices.push(target.offer.position);
    }
}

/// Where a dying triangle `u v c` has the boundary edge `u c`, its edge `v c` becomes boundary. The triangle behind that
/// edge has to know, or it could be coarsened away while the dying one is there: it is made anew, the same corners under
/// another id.
fn remake_behind(complex: &Complex<3>, u: VertexId, v: VertexId, plan: &mut Plan<3>) {
    for (dying, _) in complex.star(u) {
        let cell = complex.cell(dying);
        let Some(&apex) = cell.iter().find(|w| **w != u && **w != v).filter(|_| cell.contains(&v)) else { continue };
        if complex.edge_degree(u, apex) > 1 {
            continue;
        }
        let behind =
            complex.star(v).map(|(slot, _)| slot).find(|&slot| slot != dying && complex.cell(slot).contains(&apex));
        if let Some(slot) = behind.filter(|slot| !plan.kills.contains(slot)) {
            plan.kills.push(slot);
            plan.makes.push(*complex.cell(slot));
        }
    }
}
