//! Edge collapse on manifold triangle meshes, both kinds, by quadrics.
//!
//! A full edge collapse (`[Hoppe1996]`) puts a new vertex where the quadrics of both ends are least; a half-edge collapse
//! pulls one end onto the other and makes no vertex. The link condition (`[DeyEdelsbrunner1999]`, with a cone over the
//! boundary) keeps the mesh a manifold of the same topology; both stars are tested for folding over against the final
//! position. Deviation from `[GarlandHeckbert1997]`: every collapse of a full edge makes a new vertex id, so an edge's
//! price holds as long as the edge does and nothing in the queue needs a stamp.

pub(crate) mod legal;
pub(crate) mod manifold;

use crate::metric::Quadric;
use glam::{DVec3, Vec3};
use mt_core::analysis::{Draft, Operator, Unfit};
use mt_core::mesh::area_vector;
use mt_core::{Complex, Plan, Refusal, VertexId};

/// Where the vertex of a collapsed edge goes.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// A new vertex where the quadric is least.
    #[default]
    Optimal,
    /// One end stays as it is (half-edge collapse).
    End,
}

/// What may happen to boundary edges.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub enum BoundaryRule {
    /// Boundaries are coarsened too, held in place by quadrics of upright planes.
    #[default]
    Weighted,
    /// Boundary vertices neither move nor go.
    Locked,
}

/// Edge collapse by quadrics.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct EdgeCollapse {
    /// Where the vertex goes.
    pub placement: Placement,
    /// What may happen to boundaries.
    pub boundary: BoundaryRule,
    /// Weight of boundary planes, in squared edge lengths.
    pub boundary_weight: f64,
    /// The least cosine between a triangle's normal before and after; 1 forbids any turn, -1 allows all.
    pub fold_cosine: f64,
}

impl EdgeCollapse {
    /// Full edge collapse with optimal placement.
    pub const FULL: Self = Self {
        placement: Placement::Optimal,
        boundary: BoundaryRule::Weighted,
        boundary_weight: 4.0,
        fold_cosine: 0.2,
    };
    /// Half-edge collapse.
    pub const HALF: Self = Self { placement: Placement::End, ..Self::FULL };
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

/// Quadrics, boundary flags and stamps of the vertices.
#[derive(Clone, Debug, Default)]
pub struct Aux {
    quadrics: Vec<Quadric>,
    on_boundary: Vec<bool>,
    /// Whether the triangles of every inner edge pass it in opposite directions; collapses keep that.
    coherent: bool,
    /// How often each vertex has changed; empty where changes make new vertices.
    stamps: Vec<u32>,
}

impl Operator<3> for EdgeCollapse {
    type Site = Edge;
    type Aux = Aux;

    fn name(&self) -> &'static str {
        match self.placement {
            Placement::Optimal => "edge-collapse",
            Placement::End => "half-edge-collapse",
        }
    }

    fn prepare(&self, draft: &Draft<3>, sites: &mut Vec<Edge>) -> Result<Aux, Unfit> {
        let edges = manifold::check(&draft.complex)?;
        let vertices = draft.positions.len();
        let mut aux = Aux {
            quadrics: vec![Quadric::default(); vertices],
            on_boundary: vec![false; vertices],
            coherent: edges.iter().all(|edge| edge.coherent),
            stamps: if self.keeps_ends() { vec![0; vertices] } else { Vec::new() },
        };
        for (_, cell) in draft.complex.cells() {
            let quadric = Quadric::of_triangle(cell.map(|v| draft.positions[v.index()].as_dvec3()));
            for v in cell {
                aux.quadrics[v.index()] += quadric;
            }
        }
        for edge in edges.iter().filter(|edge| edge.on_boundary) {
            let ends = edge.ends.map(|v| draft.positions[v.index()].as_dvec3());
            let cell = draft.complex.cell(edge.slot);
            let upright = area_vector(cell.map(|v| draft.positions[v.index()].as_dvec3()));
            let quadric = Quadric::of_boundary_edge(ends[0], ends[1], upright, self.boundary_weight);
            for v in edge.ends {
                aux.quadrics[v.index()] += quadric;
                aux.on_boundary[v.index()] = true;
            }
        }
        sites.extend(edges.iter().map(|edge| Edge { a: edge.ends[0], b: edge.ends[1], stamp: 0, second: false }));
        Ok(aux)
    }

    fn price(&self, draft: &Draft<3>, aux: &Aux, site: Edge) -> Option<f64> {
        if aux.is_stale(draft, site) {
            return None;
        }
        let quadric = aux.quadrics[site.a.index()] + aux.quadrics[site.b.index()];
        Some(quadric.value(self.target(draft, aux, site, &quadric).position.as_dvec3()))
    }

    fn plan(&self, draft: &Draft<3>, aux: &Aux, site: Edge, plan: &mut Plan<3>) -> Result<(), Refusal> {
        if aux.is_stale(draft, site) {
            return Err(Refusal::Stale);
        }
        let boundary = [aux.on_boundary[site.a.index()], aux.on_boundary[site.b.index()]];
        if self.boundary == BoundaryRule::Locked && boundary == [true, true] {
            return Err(Refusal::Boundary);
        }
        legal::link_condition(&draft.complex, [site.a, site.b], boundary, aux.coherent, &mut plan.scratch)?;
        let quadric = aux.quadrics[site.a.index()] + aux.quadrics[site.b.index()];
        let target = self.target(draft, aux, site, &quadric);
        plan.error = quadric.distance(target.position.as_dvec3()) as f32;
        if !plan.error.is_finite() || !target.position.is_finite() {
            return Err(Refusal::NotFinite);
        }
        legal::fold_over(draft, [site.a, site.b], target.position, self.fold_cosine)?;
        fill(draft, site, &target, plan);
        Ok(())
    }

    fn alternative(&self, site: Edge, refusal: Refusal) -> Option<Edge> {
        let folds = matches!(refusal, Refusal::FoldOver | Refusal::Degenerate);
        (folds && !site.second).then_some(Edge { second: true, ..site })
    }

    fn applied(&self, draft: &Draft<3>, aux: &mut Aux, plan: &Plan<3>, again: &mut Vec<Edge>) {
        let merged = match *plan.retired.as_slice() {
            [a, b] => {
                aux.quadrics.push(aux.quadrics[a.index()] + aux.quadrics[b.index()]);
                aux.on_boundary.push(aux.on_boundary[a.index()] || aux.on_boundary[b.index()]);
                aux.stamps.extend((!aux.stamps.is_empty()).then_some(0));
                VertexId::new(aux.quadrics.len() - 1)
            }
            [gone] => {
                let kept = plan.kept.expect("a half-edge collapse keeps an end");
                aux.quadrics[kept.index()] = aux.quadrics[kept.index()] + aux.quadrics[gone.index()];
                aux.on_boundary[kept.index()] |= aux.on_boundary[gone.index()];
                aux.stamps[kept.index()] += 1;
                kept
            }
            _ => unreachable!("a collapse retires one vertex or two"),
        };
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

/// Where a collapse leads: a position, and the end that stays there, if one does.
#[derive(Copy, Clone, Debug)]
struct Target {
    position: Vec3,
    kept: Option<VertexId>,
}

impl EdgeCollapse {
    fn target(&self, draft: &Draft<3>, aux: &Aux, site: Edge, quadric: &Quadric) -> Target {
        let ends = [site.a, site.b].map(|v| draft.positions[v.index()]);
        if let Some(locked) = self.locked_end(aux, site) {
            let kept = [site.a, site.b][locked];
            return Target { position: ends[locked], kept: Some(kept) };
        }
        match self.placement {
            Placement::End => {
                let cheaper = usize::from(quadric.value(ends[1].as_dvec3()) < quadric.value(ends[0].as_dvec3()));
                let chosen = if site.second { 1 - cheaper } else { cheaper };
                Target { position: ends[chosen], kept: Some([site.a, site.b][chosen]) }
            }
            Placement::Optimal if site.second => Target { position: ends[0].midpoint(ends[1]), kept: None },
            Placement::Optimal => {
                Target { position: optimal(ends.map(|p| p.as_dvec3()), quadric).as_vec3(), kept: None }
            }
        }
    }

    /// Whether a vertex may outlive a collapse of one of its edges, whose price then changes.
    fn keeps_ends(&self) -> bool {
        self.placement == Placement::End || self.boundary == BoundaryRule::Locked
    }

    /// Which end may not move, under the locked boundary rule.
    fn locked_end(&self, aux: &Aux, site: Edge) -> Option<usize> {
        if self.boundary == BoundaryRule::Weighted {
            return None;
        }
        [site.a, site.b].iter().position(|v| aux.on_boundary[v.index()])
    }
}

/// The quadric's minimum if it is near the edge, else the best point of the edge.
fn optimal([a, b]: [DVec3; 2], quadric: &Quadric) -> DVec3 {
    // Planes that are nearly parallel pin their meeting point down badly; it may be far away.
    let near = |p: &DVec3| p.distance_squared((a + b) * 0.5) <= 4.0 * a.distance_squared(b);
    quadric.minimum().filter(near).unwrap_or_else(|| quadric.minimum_on(a, b))
}

impl Aux {
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
}

/// Writes a legal collapse down: cells that stay first, so that `makes[i]` takes the place of `kills[i]`.
fn fill(draft: &Draft<3>, site: Edge, target: &Target, plan: &mut Plan<3>) {
    let (ends, into) = match target.kept {
        Some(kept) => (if kept == site.a { [site.b, site.b] } else { [site.a, site.a] }, kept),
        None => ([site.a, site.b], VertexId::new(draft.positions.len())),
    };
    let complex = &draft.complex;
    let gone = if ends[0] == ends[1] { &ends[..1] } else { &ends[..] };
    for &end in gone {
        let other = if end == site.a { site.b } else { site.a };
        for (slot, i) in complex.star(end) {
            let mut cell = *complex.cell(slot);
            if !cell.contains(&other) {
                cell[i] = into;
                plan.kills.push(slot);
                plan.makes.push(cell);
            }
        }
    }
    let has_both = |slot: &u32| complex.cell(*slot).contains(&site.a) && complex.cell(*slot).contains(&site.b);
    if target.kept.is_some() {
        remake_behind(complex, gone[0], into, plan);
    }
    plan.kills.extend(complex.star(gone[0]).map(|(slot, _)| slot).filter(has_both));
    plan.retired.extend_from_slice(gone);
    plan.kept = target.kept;
    if target.kept.is_none() {
        plan.vertices.push(target.position);
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
