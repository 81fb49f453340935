//! The run of half-edge collapses that a fan is: simulated on marks, each legal where the ones before leave it.
//!
//! Let `u` be merged into the hub while some of its neighbours are already merged. What is around `u` then is what was
//! around it in the mesh, without those: they have become the hub, next to which `u` always was. So no triangle has to
//! be moved to see whether `u` may go; marks on vertices say which are around the hub and which have gone into it. The
//! boundary counts as one more vertex, next to all boundary vertices.

use super::aux::Aux;
use super::{Demand, FanMerge, LINK_MAX, Planes};
use crate::edge_collapse::legal;
use crate::metric::Quadric;
use glam::DVec3;
use mt_core::analysis::Draft;
use mt_core::{Plan, Refusal, Slot, VertexId};

/// Room for planning, used over and over.
#[derive(Debug, Default)]
pub(super) struct Work {
    /// Of each vertex: `now` if it is around the hub, `now + 1` if it was merged into it, anything below if neither.
    marks: Vec<u32>,
    now: u32,
    /// The vertices around the hub before anything is merged.
    pub(super) ring: Vec<VertexId>,
    /// The vertices around another one.
    pub(super) around: Vec<VertexId>,
    /// Children that are not merged yet, cheapest first.
    waiting: Vec<Child>,
    merged: Vec<Child>,
    /// Triangles that go without a successor.
    dying: Vec<Slot>,
    /// Whether the last plan merged all that was around the hub.
    pub(super) was_full: bool,
}

#[derive(Copy, Clone, Debug)]
struct Child {
    vertex: VertexId,
    cost: f64,
}

impl Work {
    pub(super) fn new(vertices: usize) -> Self {
        Self { marks: vec![0; vertices], now: 2, ..Self::default() }
    }

    /// Forgets all marks, and marks what is around `hub`.
    pub(super) fn surround(&mut self, aux: &Aux, draft: &Draft<3>, hub: VertexId) {
        if self.now >= u32::MAX - 4 {
            self.marks.fill(0);
            self.now = 0;
        }
        self.now += 2;
        aux.link(&draft.complex, hub, &mut self.ring);
        for u in &self.ring {
            self.marks[u.index()] = self.now;
        }
    }

    fn is_around(&self, v: VertexId) -> bool {
        self.marks[v.index()] == self.now
    }

    fn is_merged(&self, v: VertexId) -> bool {
        self.marks[v.index()] == self.now + 1
    }

    /// The planes of the triangles at `u` that stay when all around the hub is merged; nothing may be merged yet.
    pub(super) fn modified(&self, draft: &Draft<3>, u: VertexId, hub: VertexId) -> Quadric {
        let mut sum = Quadric::default();
        for (slot, i) in draft.complex.star(u) {
            let cell = draft.complex.cell(slot);
            if [cell[(i + 1) % 3], cell[(i + 2) % 3]].iter().all(|&w| w != hub && !self.is_around(w)) {
                sum += Quadric::of_triangle(cell.map(|v| draft.positions[v.index()].as_dvec3()));
            }
        }
        sum
    }
}

/// Finds a legal run that meets the demand, cheapest child first, and writes it down.
pub(super) fn plan(
    fan: &FanMerge,
    draft: &Draft<3>,
    aux: &Aux,
    hub: VertexId,
    demand: Demand,
    plan: &mut Plan<3>,
) -> Result<(), Refusal> {
    let work = &mut *aux.work();
    work.surround(aux, draft, hub);
    work.waiting.clear();
    work.merged.clear();
    let at = draft.positions[hub.index()].as_dvec3();
    for k in 0..work.ring.len() {
        let u = work.ring[k];
        if aux.may_go(fan, u, hub) {
            let cost = aux.cost(fan, work, draft, u, hub).value(at);
            work.waiting.push(Child { vertex: u, cost });
        }
    }
    let degree = work.ring.len();
    let (least, most) = match demand {
        Demand::All if work.waiting.len() < degree => return Err(Refusal::Boundary),
        Demand::All if degree > LINK_MAX => return Err(Refusal::Limit),
        Demand::All => (degree, degree),
        Demand::Between(least, most) => (least, most),
    };
    work.waiting.sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost).then(a.vertex.cmp(&b.vertex)));
    Run { fan, draft, aux, hub, at, ring_len: degree + usize::from(aux.is_on_boundary(hub)) }
        .make(work, least, most)?;
    work.was_full = work.merged.len() == degree;
    judge(fan, draft, aux, hub, work, plan)?;
    fill(draft, hub, work, plan);
    Ok(())
}

/// A run of collapses into the hub, being made.
struct Run<'a> {
    fan: &'a FanMerge,
    draft: &'a Draft<3>,
    aux: &'a Aux,
    hub: VertexId,
    /// The hub's position.
    at: DVec3,
    /// How many vertices are around the hub, the boundary counted as one.
    ring_len: usize,
}

impl Run<'_> {
    fn make(&mut self, work: &mut Work, least: usize, most: usize) -> Result<(), Refusal> {
        while work.merged.len() < most {
            let mut refusal = Refusal::Boundary;
            let legal = (0..work.waiting.len()).find(|&k| match self.may_merge(work.waiting[k].vertex, work) {
                Ok(()) => true,
                Err(why) => {
                    refusal = why;
                    false
                }
            });
            match legal {
                Some(k) => self.merge(k, work),
                None if work.merged.len() < least => return Err(refusal),
                None => break,
            }
        }
        Ok(())
    }

    /// Whether the half-edge collapse of `u` into the hub is legal, as the mesh would be now.
    fn may_merge(&self, u: VertexId, work: &mut Work) -> Result<(), Refusal> {
        let mut around = std::mem::take(&mut work.around);
        self.aux.link(&self.draft.complex, u, &mut around);
        let left = around.iter().filter(|&&w| w != self.hub && !work.is_merged(w));
        let (shared, all) = left.fold((0, 0), |(shared, all), &w| (shared + usize::from(work.is_around(w)), all + 1));
        work.around = around;
        // Whoever may go from the boundary goes to the boundary.
        let boundary = usize::from(self.aux.is_on_boundary(u));
        // In a triangulated surface the neighbours of `u` around the hub are always shared.
        if shared + boundary != 2 {
            return Err(if boundary == 1 { Refusal::Pinch } else { Refusal::Link });
        }
        // All that is left: a tetrahedron, or a triangle on its own.
        if all + boundary == 2 && self.ring_len == 3 {
            return Err(Refusal::Link);
        }
        self.fold_over(u, work)
    }

    fn fold_over(&self, u: VertexId, work: &Work) -> Result<(), Refusal> {
        if self.fan.fold_cosine <= -1.0 {
            return Ok(());
        }
        let position = |v: VertexId| self.draft.positions[v.index()].as_dvec3();
        let old = position(u);
        if old == self.at {
            return Ok(());
        }
        for (slot, i) in self.draft.complex.star(u) {
            let cell = self.draft.complex.cell(slot);
            let [a, b] = [cell[(i + 1) % 3], cell[(i + 2) % 3]];
            // What has a corner at the hub, or one that went there, dies.
            if [a, b].iter().all(|&w| w != self.hub && !work.is_merged(w)) {
                let [a, b] = [a, b].map(position);
                legal::turn([old, a, b], [self.at, a, b], self.fan.fold_cosine)?;
            }
        }
        Ok(())
    }

    fn merge(&mut self, k: usize, work: &mut Work) {
        let child = work.waiting.remove(k);
        self.aux.link(&self.draft.complex, child.vertex, &mut work.around);
        work.marks[child.vertex.index()] = work.now + 1;
        self.ring_len -= 1;
        for w in &work.around {
            let mark = &mut work.marks[w.index()];
            if *mark < work.now && *w != self.hub {
                *mark = work.now;
                self.ring_len += 1;
            }
        }
        work.merged.push(child);
    }
}

/// Writes down the errors of the prefixes, and the last of them as that of the whole.
fn judge(
    fan: &FanMerge,
    draft: &Draft<3>,
    aux: &Aux,
    hub: VertexId,
    work: &mut Work,
    plan: &mut Plan<3>,
) -> Result<(), Refusal> {
    let at = draft.positions[hub.index()].as_dvec3();
    let mut gathered = match fan.planes {
        Planes::Accumulated => *aux.quadric(hub),
        Planes::Current => Quadric::default(),
    };
    let mut before = aux.error(hub);
    let mut error = before;
    if fan.planes == Planes::Current {
        // What is around the hub is to be known as it was before the run.
        work.surround(aux, draft, hub);
    }
    for child in &work.merged {
        gathered += aux.cost(fan, work, draft, child.vertex, hub);
        before = before.max(aux.error(child.vertex));
        let distance = gathered.distance(at) as f32;
        error = error.max(match fan.planes {
            Planes::Accumulated => before.max(distance),
            Planes::Current => before + distance,
        });
        plan.errors.push(error);
    }
    plan.error = error;
    if fan.planes == Planes::Current {
        work.merged.iter().for_each(|child| work.marks[child.vertex.index()] = work.now + 1);
    }
    if error.is_finite() { Ok(()) } else { Err(Refusal::NotFinite) }
}

/// Writes a legal run down: cells that stay first, so that `makes[i]` takes the place of `kills[i]`.
fn fill(draft: &Draft<3>, hub: VertexId, work: &mut Work, plan: &mut Plan<3>) {
    let complex = &draft.complex;
    work.dying.clear();
    for child in &work.merged {
        let u = child.vertex;
        for (slot, i) in complex.star(u) {
            let mut cell = *complex.cell(slot);
            let others = [cell[(i + 1) % 3], cell[(i + 2) % 3]];
            if others.iter().all(|&w| w != hub && !work.is_merged(w)) {
                cell[i] = hub;
                plan.kills.push(slot);
                plan.makes.push(cell);
            } else if others.iter().all(|&w| w > u || !work.is_merged(w)) {
                // A dying triangle is met at each child that it has, and counts at the lowest.
                work.dying.push(slot);
            }
        }
    }
    plan.retired.extend(work.merged.iter().map(|child| child.vertex));
    plan.kept = Some(hub);
    if !work.was_full {
        remake_behind(draft, hub, work, plan);
    }
    plan.kills.extend_from_slice(&work.dying);
}

/// Where a dying triangle `u hub c` has the boundary edge `u c`, the edge `hub c` becomes boundary, if `c` stays. As in a
/// single collapse, the triangle behind it is made anew, so that it knows.
fn remake_behind(draft: &Draft<3>, hub: VertexId, work: &Work, plan: &mut Plan<3>) {
    let complex = &draft.complex;
    for &dying in &work.dying {
        let cell = complex.cell(dying);
        let stays = cell.iter().find(|&&c| c != hub && !work.is_merged(c));
        let Some(&c) = stays.filter(|_| cell.contains(&hub)) else { continue };
        let Some(&u) = cell.iter().find(|&&u| work.is_merged(u)) else { continue };
        if complex.edge_degree(u, c) > 1 {
            continue;
        }
        let behind = complex.star(hub).map(|(slot, _)| slot);
        let behind = behind.filter(|slot| *slot != dying && complex.cell(*slot).contains(&c));
        // One that dies has no need to know.
        for slot in behind.filter(|slot| !work.dying.contains(slot)) {
            if !plan.kills.contains(&slot) {
                plan.kills.push(slot);
                plan.makes.push(*complex.cell(slot));
            }
        }
    }
}
