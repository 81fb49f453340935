//! What fan-merge keeps beside the mesh, and what a merge would cost.

use super::run::Work;
use super::{FanMerge, Planes, Round, Site};
use crate::edge_collapse::BoundaryRule;
use crate::edge_collapse::manifold::Edges;
use crate::metric::Quadric;
use glam::DVec3;
use mt_core::analysis::Draft;
use mt_core::mesh::area_vector;
use mt_core::{Complex, Plan, VertexId};
use std::cell::RefCell;

/// Quadrics, errors, stamps and boundary flags of the vertices.
#[derive(Debug)]
pub struct Aux {
    quadrics: Vec<Quadric>,
    /// The error of the last merge into each vertex.
    errors: Vec<f32>,
    /// How often the price of each vertex has changed.
    stamps: Vec<u32>,
    on_boundary: Vec<bool>,
    /// Of each vertex: the sum of what merging those around it would cost, with accumulated planes, and their number.
    sums: Vec<(f64, u32)>,
    /// Whether the triangles of every inner edge pass it in opposite directions; collapses keep that.
    coherent: bool,
    /// Makes a price a number that does not depend on the unit of the model, and hardly exceeds 1.
    scale: f64,
    /// Whether a fan has been merged in part.
    stalled: bool,
    /// Room for planning; holds nothing between two calls but what the last plan was.
    work: RefCell<Work>,
}

/// Prices of a round, as powers of 2, are between 0 and so many below.
const OCTAVES: i32 = 60;

impl Aux {
    pub(super) fn new(fan: &FanMerge, draft: &Draft<3>, edges: &Edges) -> Self {
        let vertices = draft.positions.len();
        let mut aux = Self {
            quadrics: vec![Quadric::default(); vertices],
            errors: vec![0.0; vertices],
            stamps: vec![0; vertices],
            on_boundary: vec![false; vertices],
            sums: vec![(0.0, 0); vertices],
            coherent: edges.coherent,
            scale: 1.0,
            stalled: false,
            work: RefCell::new(Work::new(vertices)),
        };
        let position = |v: VertexId| draft.positions[v.index()].as_dvec3();
        let (mut low, mut high, mut area) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0.0);
        for (_, cell) in draft.complex.cells() {
            let corners = cell.map(position);
            let quadric = Quadric::of_triangle(corners);
            for (v, corner) in cell.iter().zip(corners) {
                aux.quadrics[v.index()] += quadric;
                (low, high) = (low.min(corner), high.max(corner));
            }
            area += 0.5 * area_vector(corners).length();
        }
        for &(ends, slot) in &edges.border {
            let [a, b] = ends.map(position);
            let upright = area_vector(draft.complex.cell(slot).map(position));
            let quadric = Quadric::of_boundary_edge(a, b, upright, fan.boundary_weight);
            for v in ends {
                aux.quadrics[v.index()] += quadric;
                aux.on_boundary[v.index()] = true;
            }
        }
        let scale = 1.0 / (area * (high - low).length_squared());
        aux.scale = if scale.is_finite() { scale } else { 1.0 };
        aux.add_up(fan, draft, edges);
        aux
    }

    /// Sets all sums. Cell by cell where it can, because the cells lie in a row and those of a star do not.
    fn add_up(&mut self, fan: &FanMerge, draft: &Draft<3>, edges: &Edges) {
        if !self.coherent {
            for v in (0..self.sums.len()).map(VertexId::new) {
                self.sums[v.index()] = self.sum(fan, draft, v);
            }
            return;
        }
        for (_, cell) in draft.complex.cells() {
            (0..3).for_each(|i| self.put_in(fan, draft, cell[(i + 1) % 3], cell[i]));
        }
        // The last neighbour of a boundary vertex does not come next after it in any cell.
        for &(ends, slot) in &edges.border {
            let cell = draft.complex.cell(slot);
            let [a, b] = ends;
            let forward = (0..3).any(|i| cell[i] == a && cell[(i + 1) % 3] == b);
            let [first, second] = if forward { [a, b] } else { [b, a] };
            self.put_in(fan, draft, first, second);
        }
    }

    pub(super) fn is_stale(&self, draft: &Draft<3>, site: Site) -> bool {
        self.stamps[site.hub.index()] != site.stamp || !draft.complex.has_star(site.hub)
    }

    pub(super) fn has_stalled(&self) -> bool {
        self.stalled
    }

    pub(super) fn is_on_boundary(&self, v: VertexId) -> bool {
        self.on_boundary[v.index()]
    }

    #[inline]
    pub(super) fn stamp(&self, v: VertexId) -> u32 {
        self.stamps[v.index()]
    }

    pub(super) fn quadric(&self, v: VertexId) -> &Quadric {
        &self.quadrics[v.index()]
    }

    pub(super) fn error(&self, v: VertexId) -> f32 {
        self.errors[v.index()]
    }

    pub(super) fn work(&self) -> std::cell::RefMut<'_, Work> {
        self.work.borrow_mut()
    }

    /// Whether around `v` each neighbour comes next after it in one triangle.
    #[inline]
    pub(super) fn goes_around(&self, v: VertexId) -> bool {
        self.coherent && !self.on_boundary[v.index()]
    }

    /// The vertices around `v`, each once, written over `out`.
    pub(super) fn link(&self, complex: &Complex<3>, v: VertexId, out: &mut Vec<VertexId>) {
        if self.goes_around(v) {
            out.clear();
            out.extend(followers(complex, v));
        } else {
            complex.neighbours(v, out);
        }
    }

    /// Whether the boundary rule lets `u` be merged into `hub`, as far as that can be told without looking at the edge.
    #[inline]
    pub(super) fn may_go(&self, fan: &FanMerge, u: VertexId, hub: VertexId) -> bool {
        !self.is_on_boundary(u) || (self.is_on_boundary(hub) && fan.boundary == BoundaryRule::Weighted)
    }

    /// Eq. 2 of `[LivnySokolovskyElSana2006]`: the sum over the vertices around `hub` of what merging each would cost.
    pub(super) fn price(&self, fan: &FanMerge, hub: VertexId) -> f64 {
        let (sum, count) = self.sums[hub.index()];
        weighed(fan, sum, count)
    }

    fn sum(&self, fan: &FanMerge, draft: &Draft<3>, hub: VertexId) -> (f64, u32) {
        let at = draft.positions[hub.index()].as_dvec3();
        let (mut sum, mut count) = (0.0, 0);
        let mut add = |u: VertexId| {
            if self.may_go(fan, u, hub) {
                sum += self.quadrics[u.index()].value(at);
                count += 1;
            }
        };
        if self.goes_around(hub) {
            followers(&draft.complex, hub).for_each(add);
        } else {
            let mut work = self.work.borrow_mut();
            self.link(&draft.complex, hub, &mut work.around);
            work.around.iter().for_each(|&u| add(u));
        }
        (sum, count)
    }

    /// The same with the planes of the triangles that the merge would modify.
    pub(super) fn price_of_current(&self, fan: &FanMerge, draft: &Draft<3>, hub: VertexId) -> f64 {
        let mut work = self.work.borrow_mut();
        work.surround(self, draft, hub);
        let children = work.ring.iter().filter(|&&u| self.may_go(fan, u, hub));
        let at = draft.positions[hub.index()].as_dvec3();
        let (sum, count) =
            children.fold((0.0, 0), |(sum, count), &u| (sum + work.modified(draft, u, hub).value(at), count + 1));
        weighed(fan, sum, count)
    }

    /// What merging the cheapest vertex around `hub` would cost.
    pub(super) fn least_price(&self, fan: &FanMerge, draft: &Draft<3>, hub: VertexId) -> f64 {
        let mut work = self.work.borrow_mut();
        work.surround(self, draft, hub);
        let at = draft.positions[hub.index()].as_dvec3();
        let children = work.ring.iter().filter(|&&u| self.may_go(fan, u, hub));
        let costs = children.map(|&u| self.cost(fan, &work, draft, u, hub).value(at));
        costs.fold(f64::INFINITY, f64::min)
    }

    /// The planes that merging `u` into `hub` is judged by; `work` knows the surroundings of the hub.
    pub(super) fn cost(&self, fan: &FanMerge, work: &Work, draft: &Draft<3>, u: VertexId, hub: VertexId) -> Quadric {
        match fan.planes {
            Planes::Accumulated => *self.quadric(u),
            Planes::Current => work.modified(draft, u, hub),
        }
    }

    /// Moves a price to where those of its round are, in the same order; the smallest of later rounds are not told apart.
    pub(super) fn in_round(&self, price: f64, round: Round) -> f64 {
        let step = OCTAVES + 2;
        // From 2^-126, the least that a queue of 32-bit prices tells from 0.
        let shift = |rounds: i32| f64::from(rounds * step - 64).exp2();
        let price = (price * self.scale).min(1.0);
        let floor = f64::from(-OCTAVES).exp2();
        match round {
            Round::Full => price * shift(0),
            Round::Again => price.max(floor) * shift(1),
            Round::Partial => price.max(floor) * shift(2),
            Round::Single => price.max(floor) * shift(3),
        }
    }

    /// Hears that a plan was applied: its children's planes are now the hub's, and all around have new prices.
    pub(super) fn merged(&mut self, fan: &FanMerge, draft: &Draft<3>, plan: &Plan<3>, again: &mut Vec<Site>) {
        let hub = plan.kept.expect("a fan is merged into a vertex that stays");
        let planned = self.work.get_mut();
        let is_known = planned.hub == hub && planned.merged.iter().map(|child| &child.vertex).eq(&plan.retired);
        debug_assert!(is_known, "the plan that is applied is not the last that was made");
        let was_full = planned.was_full;
        for u in &plan.retired {
            let quadric = self.quadrics[u.index()];
            self.quadrics[hub.index()] += quadric;
        }
        self.errors[hub.index()] = self.errors[hub.index()].max(plan.error);
        self.stalled |= !was_full;
        if fan.planes == Planes::Accumulated && was_full {
            self.take_out_merged(fan, draft, hub);
        }
        let mut ring = std::mem::take(&mut self.work.get_mut().ring);
        self.link(&draft.complex, hub, &mut ring);
        ring.push(hub);
        for &v in &ring {
            if fan.planes == Planes::Accumulated {
                match was_full && v != hub {
                    true => self.put_in(fan, draft, hub, v),
                    false => self.sums[v.index()] = self.sum(fan, draft, v),
                }
            }
            let stamp = &mut self.stamps[v.index()];
            *stamp += 1;
            again.push(Site { hub: v, stamp: *stamp, round: Round::Full });
        }
        self.work.get_mut().ring = ring;
    }

    /// Takes what was merged out of the sums of those around it: cheaper than adding all up anew, and as good as the sum
    /// of what is left is not far smaller than what is taken out.
    fn take_out_merged(&mut self, fan: &FanMerge, draft: &Draft<3>, hub: VertexId) {
        let work = std::mem::take(self.work.get_mut());
        for child in &work.merged {
            let u = child.vertex;
            for &w in work.link_of(child) {
                if w != hub && draft.complex.has_star(w) && self.may_go(fan, u, w) {
                    let cost = self.quadrics[u.index()].value(draft.positions[w.index()].as_dvec3());
                    let (sum, count) = &mut self.sums[w.index()];
                    *sum = (*sum - cost).max(0.0);
                    *count -= 1;
                }
            }
        }
        *self.work.get_mut() = work;
    }

    /// Adds what merging `u` into `hub` would cost to the hub's sum.
    fn put_in(&mut self, fan: &FanMerge, draft: &Draft<3>, u: VertexId, hub: VertexId) {
        if self.may_go(fan, u, hub) {
            let (sum, count) = &mut self.sums[hub.index()];
            *sum += self.quadrics[u.index()].value(draft.positions[hub.index()].as_dvec3());
            *count += 1;
        }
    }
}

#[cfg(test)]
impl Aux {
    /// Compares all sums with what they would be if they were added up now.
    pub(super) fn judge_sums(&self, fan: &FanMerge, draft: &Draft<3>) {
        for v in (0..self.sums.len()).map(VertexId::new).filter(|&v| draft.complex.has_star(v)) {
            let ((kept, count), (sum, wanted)) = (self.sums[v.index()], self.sum(fan, draft, v));
            assert!(
                count == wanted && (kept - sum).abs() <= 1e-9 * (1.0 + sum),
                "{v}: {kept} of {count}, {sum} of {wanted}"
            );
        }
    }
}

fn followers(complex: &Complex<3>, v: VertexId) -> impl Iterator<Item = VertexId> + '_ {
    complex.star(v).map(|(slot, i)| complex.cell(slot)[(i + 1) % 3])
}

fn weighed(fan: &FanMerge, sum: f64, count: u32) -> f64 {
    if fan.weigh_degree { sum * f64::from(count) } else { sum }
}
