//! Vertex-pair collapse: two vertices become one, whether an edge joins them or not, so topology is coarsened too.
//!
//! After El-Sana and Varshney (`[ElSanaVarshney1999]`). Pairs are the edges of triangles and the
//! [virtual edges](VirtualEdges); a pair stays one until its ends are merged, under whatever ids they have by then. It is
//! *real* while a triangle has both of its ends, so a virtual edge turns real when a merge closes its gap, and an edge
//! whose triangles have all died goes on as a virtual one: what was joined once can still be pulled together.
//!
//! Any mesh will do: several components, holes, edges with many triangles, vertices where sheets touch. Nothing has to
//! stay a manifold. A triangle that gets two equal corners dies. Two triangles with the same corners are both kept, for
//! the mesh is the quotient of the input by its merges, a multiset; who draws it may drop the second.
//!
//! A vertex that has lost all its triangles is no longer seen, but keeps what the metric knows of it and its pairs, so a
//! vertex with triangles that merges with it is pulled as far as what is gone weighs. Two such vertices wait until one
//! of them merges with something that can be seen. The last triangles of the whole mesh stay.
//!
//! Deviations: the paper joins vertices on boundaries of patches by a Delaunay triangulation; here it is the Gabriel
//! graph, a part of it ([`virtual_edges`]). Its two preferences are [`Preference`].

mod gabriel;
mod link;
#[cfg(test)]
mod tests;
mod virtual_edges;

pub use virtual_edges::{VirtualEdges, virtual_edges};

use crate::edge_collapse::legal;
use crate::metric::{Boundary, BoundaryEdge, Merge, Metric, Offer, Place, Quadrics};
use mt_core::analysis::{Draft, Operator, Unfit};
use mt_core::{Complex, Mesh, Plan, Refusal, VertexId};

/// What comes first.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Preference {
    /// Collapses that keep the topology come before all others. One that would fold over at its turn waits until the
    /// others have had theirs.
    #[default]
    GeometryFirst,
    /// The price alone decides.
    Equal,
}

/// Vertex-pair collapse by a metric.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct VertexPair<M = Quadrics> {
    /// What comes first.
    pub preference: Preference,
    /// Which vertices that share no triangle may merge.
    pub virtual_edges: VirtualEdges,
    /// What moving an edge with a single triangle counts, for metrics that ask.
    pub boundary_weight: f64,
    /// The least cosine between a triangle's normal before and after; `None` lets triangles fold over and lose their area.
    pub fold_cosine: Option<f64>,
    /// What a merge costs, and where its vertex goes.
    pub metric: M,
}

impl Default for VertexPair {
    fn default() -> Self {
        Self {
            preference: Preference::GeometryFirst,
            virtual_edges: VirtualEdges::default(),
            boundary_weight: 4.0,
            fold_cosine: Some(0.2),
            metric: Quadrics,
        }
    }
}

impl<M> VertexPair<M> {
    /// The same with another metric.
    pub fn with<N: Metric>(self, metric: N) -> VertexPair<N> {
        let Self { preference, virtual_edges, boundary_weight, fold_cosine, metric: _ } = self;
        VertexPair { preference, virtual_edges, boundary_weight, fold_cosine, metric }
    }

    /// The virtual edges that this operator finds in a mesh: [`virtual_edges`] under its options.
    pub fn pairs(&self, mesh: &Mesh<3>) -> Vec<[VertexId; 2]> {
        virtual_edges(mesh, &self.virtual_edges)
    }
}

/// Two vertices that may merge, and how.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pair {
    a: VertexId,
    b: VertexId,
    /// How often the prices at both ends have changed; 0 for good where the metric does not see neighbours.
    stamp: u32,
    /// Whether only a merge that keeps the topology will do.
    keeps_topology: bool,
    /// Whether to go halfway, because the best place folds something over.
    second: bool,
}

/// The metric's state, and the pairs.
#[derive(Clone, Debug, Default)]
pub struct Aux<S> {
    metric: S,
    /// Of each vertex: those with which it may merge, ascending. Real and virtual alike, and always both ways; none once
    /// a vertex is merged.
    partners: Vec<Vec<VertexId>>,
    /// How often the prices at each vertex have changed; empty where a change of price is a new vertex.
    stamps: Vec<u32>,
    /// What turns a price into a share of a usual one, whatever the metric's unit.
    price_scale: f64,
}

impl<M: Metric> Operator<3> for VertexPair<M> {
    type Site = Pair;
    type Aux = Aux<M::State>;

    fn name(&self) -> &'static str {
        "vertex-pair"
    }

    fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Pair>) -> Result<Self::Aux, Unfit> {
        let cells = draft.complex.cells().map(|(_, cell)| *cell).collect();
        let mesh = Mesh { positions: draft.positions.clone(), cells };
        let mut partners = vec![Vec::new(); draft.positions.len()];
        let mut join = |[a, b]: [VertexId; 2]| {
            partners[a.index()].push(b);
            partners[b.index()].push(a);
        };
        mesh.cells.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).for_each(&mut join);
        self.pairs(&mesh).into_iter().for_each(join);
        for row in &mut partners {
            row.sort_unstable();
            row.dedup();
        }
        let boundary = boundary_edges(&draft.complex);
        let mut aux = Aux {
            metric: self.metric.prepare(draft, &Boundary { edges: &boundary, weight: self.boundary_weight })?,
            stamps: if self.metric.sees_neighbours() { vec![0; partners.len()] } else { Vec::new() },
            partners,
            price_scale: 1.0,
        };
        for a in (0..aux.partners.len()).map(VertexId::new) {
            let above = aux.partners[a.index()].iter().filter(|&&b| b > a);
            sites.extend(above.map(|&b| self.site(draft, &aux, a, b)));
        }
        // Whatever the metric's unit: a usual price of the input counts 1.
        let some = sites.iter().step_by(sites.len() / 64 + 1).map(|&site| self.offer(draft, &aux, site).price);
        let (sum, count) =
            some.filter(|price| price.is_finite()).fold((0.0, 0.0), |(s, n), price| (s + price, n + 1.0));
        aux.price_scale = Some(count / sum).filter(|scale: &f64| scale.is_normal()).unwrap_or(1.0);
        Ok(aux)
    }

    fn price(&self, draft: &Draft<3>, aux: &Self::Aux, site: Pair) -> Option<f64> {
        if aux.is_stale(draft, site) {
            return None;
        }
        let price = self.offer(draft, aux, site).price;
        Some(match self.preference {
            Preference::Equal => price,
            Preference::GeometryFirst => in_class(price * aux.price_scale, site.keeps_topology),
        })
    }

    fn plan(&self, draft: &Draft<3>, aux: &Self::Aux, site: Pair, plan: &mut Plan<3>) -> Result<(), Refusal> {
        if aux.is_stale(draft, site) {
            return Err(Refusal::Stale);
        }
        let ends = [site.a, site.b];
        if site.keeps_topology && !link::keeps_topology(&draft.complex, ends) {
            return Err(Refusal::Link);
        }
        let Offer { position, error, .. } = self.offer(draft, aux, site);
        plan.error = error as f32;
        if !plan.error.is_finite() || !position.is_finite() {
            return Err(Refusal::NotFinite);
        }
        if let Some(cosine) = self.fold_cosine {
            legal::fold_over(draft, ends, position, cosine)?;
        }
        fill(&draft.complex, ends, VertexId::new(draft.positions.len()), plan);
        if plan.makes.is_empty() && plan.kills.len() == draft.complex.cell_count() {
            return Err(Refusal::Limit);
        }
        plan.vertices.push(position);
        Ok(())
    }

    fn alternative(&self, site: Pair, refusal: Refusal) -> Option<Pair> {
        match refusal {
            Refusal::Link => Some(Pair { keeps_topology: false, second: false, ..site }),
            Refusal::FoldOver | Refusal::Degenerate if !site.second => Some(Pair { second: true, ..site }),
            _ => None,
        }
    }

    fn applied(&self, draft: &Draft<3>, aux: &mut Self::Aux, plan: &Plan<3>, again: &mut Vec<Pair>) {
        let &[a, b] = plan.retired.as_slice() else { unreachable!("a merge retires two vertices") };
        let merged = aux.merge([a, b]);
        self.metric.merged(draft, &mut aux.metric, &Merge { ends: [a, b], into: merged, error: plan.error });
        let mut near = Vec::new();
        draft.complex.neighbours(merged, &mut near);
        again.extend(aux.partners[merged.index()].iter().map(|&p| self.site(draft, aux, p, merged)));
        if self.metric.sees_neighbours() {
            for w in &near {
                aux.stamps[w.index()] = aux.stamps[w.index()].wrapping_add(1);
            }
            for &w in &near {
                again.extend(aux.partners[w.index()].iter().map(|&x| self.site(draft, aux, w, x)));
            }
        } else if self.preference == Preference::GeometryFirst {
            // Two neighbours of the merged vertex had two vertices in common that are one now: what the link condition
            // says of their edge may have changed.
            for &w in &near {
                let both = aux.partners[w.index()].iter().filter(|&&x| x > w && near.binary_search(&x).is_ok());
                again.extend(both.map(|&x| self.site(draft, aux, w, x)).filter(|site| site.keeps_topology));
            }
        }
        again.sort_unstable();
        again.dedup();
    }
}

impl<M: Metric> VertexPair<M> {
    /// The first thing to try with two partners.
    fn site<S>(&self, draft: &Draft<3>, aux: &Aux<S>, u: VertexId, v: VertexId) -> Pair {
        let [a, b] = [u.min(v), u.max(v)];
        let keeps_topology = self.preference == Preference::GeometryFirst && draft.complex.edge_degree(a, b) > 0;
        Pair { a, b, stamp: aux.stamp(a, b), keeps_topology, second: false }
    }

    fn offer(&self, draft: &Draft<3>, aux: &Aux<M::State>, site: Pair) -> Offer {
        let ends = [site.a, site.b];
        let pair = self.metric.pair(draft, &aux.metric, ends);
        self.metric.offer(draft, ends, &pair, if site.second { Place::Middle } else { Place::Best })
    }
}

impl<S> Aux<S> {
    fn is_stale(&self, draft: &Draft<3>, site: Pair) -> bool {
        let merged = self.partners[site.a.index()].binary_search(&site.b).is_err();
        let unseen = !draft.complex.has_star(site.a) && !draft.complex.has_star(site.b);
        merged || unseen || self.stamp(site.a, site.b) != site.stamp
    }

    fn stamp(&self, a: VertexId, b: VertexId) -> u32 {
        if self.stamps.is_empty() { 0 } else { self.stamps[a.index()].wrapping_add(self.stamps[b.index()]) }
    }

    /// Gives the partners of both ends to a new vertex, which is after all others.
    fn merge(&mut self, ends: [VertexId; 2]) -> VertexId {
        let merged = VertexId::new(self.partners.len());
        let [mut row, other] = ends.map(|end| std::mem::take(&mut self.partners[end.index()]));
        row.extend(other);
        row.sort_unstable();
        row.dedup();
        row.retain(|v| !ends.contains(v));
        for v in &row {
            let partners = &mut self.partners[v.index()];
            partners.retain(|w| !ends.contains(w));
            partners.push(merged);
        }
        self.partners.push(row);
        self.stamps.extend((!self.stamps.is_empty()).then_some(0));
        merged
    }
}

/// A price, as a share of a usual one, such that every merge that keeps the topology is cheaper than every one that may not:
/// the former are below 1, by so much that prices as `f32` keep apart what matters.
fn in_class(price: f64, keeps_topology: bool) -> f64 {
    let factor = 2f64.powi(60);
    if keeps_topology { (price / factor).min(0.5) } else { 1.0 + price * factor }
}

/// The edges with a single triangle.
fn boundary_edges(complex: &Complex<3>) -> Vec<BoundaryEdge> {
    let side = |cell: [VertexId; 3]| {
        [[cell[0], cell[1]], [cell[1], cell[2]], [cell[2], cell[0]]].map(|[u, v]| ([u.min(v), u.max(v)], cell))
    };
    let mut sides: Vec<_> = complex.cells().flat_map(|(_, &cell)| side(cell)).collect();
    sides.sort_unstable();
    let single = sides.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() == 1);
    single.map(|run| BoundaryEdge { ends: run[0].0, cell: run[0].1 }).collect()
}

/// Writes a merge down: triangles that stay first, so that `makes[i]` takes the place of `kills[i]`.
fn fill(complex: &Complex<3>, [a, b]: [VertexId; 2], into: VertexId, plan: &mut Plan<3>) {
    for (end, other) in [(a, b), (b, a)] {
        for (slot, i) in complex.star(end) {
            let mut cell = *complex.cell(slot);
            if !cell.contains(&other) {
                cell[i] = into;
                plan.kills.push(slot);
                plan.makes.push(cell);
            }
        }
    }
    let has_both = complex.star(a).map(|(slot, _)| slot).filter(|&slot| complex.cell(slot).contains(&b));
    plan.kills.extend(has_both);
    plan.retired.extend([a, b]);
}
