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
    /// Of each vertex: why its full fan was refused, and what must change before that is asked again.
    witnesses: Vec<Witness>,
    /// The vertices around the hub before anything is merged.
    pub(super) ring: Vec<VertexId>,
    /// The vertices around another one.
    pub(super) around: Vec<VertexId>,
    /// Children that are not merged yet, cheapest first.
    waiting: Vec<Child>,
    pub(super) merged: Vec<Child>,
    /// The triangles at the children, child by child.
    sides: Vec<Side>,
    /// The vertices around the children, child by child.
    links: Vec<VertexId>,
    /// Triangles that would fold over, child by child: of the other corners, one must have gone before.
    folds: Vec<[VertexId; 2]>,
    /// Triangles that go without a successor.
    dying: Vec<Slot>,
    /// What the last plan was for, and whether it merged all that was around it.
    pub(super) hub: VertexId,
    pub(super) was_full: bool,
}

/// A vertex around the hub, with its places in the lists of [`Work`].
#[derive(Copy, Clone, Debug)]
pub(super) struct Child {
    pub(super) vertex: VertexId,
    cost: f64,
    sides: [u32; 2],
    links: [u32; 2],
    folds: [u32; 2],
}

/// A triangle at a child.
#[derive(Copy, Clone, Debug)]
struct Side {
    slot: Slot,
    /// Which corner the child is.
    corner: u32,
    others: [VertexId; 2],
}

#[derive(Copy, Clone, Debug)]
struct Witness {
    hub_stamp: u32,
    /// The vertex around the hub at which nothing may change; none for all of them.
    child: VertexId,
    stamp: u32,
    refusal: Refusal,
}

fn part<T>(all: &[T], [from, to]: [u32; 2]) -> &[T] {
    &all[from as usize..to as usize]
}

impl Work {
    pub(super) fn new(vertices: usize) -> Self {
        let none = Witness { hub_stamp: u32::MAX, child: VertexId::NONE, stamp: 0, refusal: Refusal::Stale };
        Self { marks: vec![0; vertices], now: 2, witnesses: vec![none; vertices], ..Self::default() }
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

    #[inline]
    fn is_around(&self, v: VertexId) -> bool {
        self.marks[v.index()] == self.now
    }

    #[inline]
    fn is_merged(&self, v: VertexId) -> bool {
        self.marks[v.index()] == self.now + 1
    }

    /// The vertices around a child of the last plan, as they were when it was made.
    pub(super) fn link_of(&self, child: &Child) -> &[VertexId] {
        part(&self.links, child.links)
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
    let at = draft.positions[hub.index()].as_dvec3();
    let mut run = Run { fan, draft, aux, hub, at, ring_len: 0, why: Refusal::Boundary };
    let all = matches!(demand, Demand::All);
    if all {
        run.recall_child(work)?;
    }
    work.surround(aux, draft, hub);
    if all {
        run.recall_ring(work)?;
    }
    let degree = work.ring.len();
    run.ring_len = degree + usize::from(aux.is_on_boundary(hub));
    let (least, most) = match demand {
        Demand::All if degree > LINK_MAX => return Err(Refusal::Limit),
        Demand::All => (degree, degree),
        Demand::Between(least, most) => (least, most),
    };
    run.gather(work, all)?;
    work.waiting.sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost).then(a.vertex.cmp(&b.vertex)));
    run.make(work, least, most).inspect_err(|&refusal| {
        if all {
            run.remember(work, refusal);
        }
    })?;
    work.hub = hub;
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
    /// Why the last child that never can go may not.
    why: Refusal,
}

impl Run<'_> {
    /// Refuses as the last time, if one child stood in the way that is as it was.
    fn recall_child(&self, work: &Work) -> Result<(), Refusal> {
        let witness = work.witnesses[self.hub.index()];
        let same = !witness.child.is_none()
            && witness.hub_stamp == self.aux.stamp(self.hub)
            && witness.stamp == self.aux.stamp(witness.child);
        if same { Err(witness.refusal) } else { Ok(()) }
    }

    /// Refuses as the last time, if all around the hub is as it was.
    fn recall_ring(&self, work: &Work) -> Result<(), Refusal> {
        let witness = work.witnesses[self.hub.index()];
        let same = witness.child.is_none()
            && witness.hub_stamp == self.aux.stamp(self.hub)
            && witness.stamp == self.stamp_of_ring(work);
        if same { Err(witness.refusal) } else { Ok(()) }
    }

    /// Grows when anything changes at the vertices around the hub.
    fn stamp_of_ring(&self, work: &Work) -> u32 {
        work.ring.iter().fold(0, |sum, &u| sum.wrapping_add(self.aux.stamp(u)))
    }

    fn remember(&self, work: &mut Work, refusal: Refusal) {
        let [hub_stamp, stamp] = [self.aux.stamp(self.hub), self.stamp_of_ring(work)];
        work.witnesses[self.hub.index()] = Witness { hub_stamp, child: VertexId::NONE, stamp, refusal };
    }

    /// Lists the children that may go sooner or later, with what is around them. Where all are wanted, the first that
    /// never may ends it.
    fn gather(&mut self, work: &mut Work, all: bool) -> Result<(), Refusal> {
        work.waiting.clear();
        work.merged.clear();
        work.sides.clear();
        work.links.clear();
        work.folds.clear();
        if all {
            self.put_witness_first(work);
        }
        for k in 0..work.ring.len() {
            let u = work.ring[k];
            if !self.aux.may_go(self.fan, u, self.hub) {
                if all {
                    return Err(Refusal::Boundary);
                }
                continue;
            }
            let mut child = self.child(u, work);
            match self.find_folds(&child, work) {
                Ok(folds) => {
                    child.folds = folds;
                    work.waiting.push(child);
                }
                Err(refusal) if all => {
                    let [hub_stamp, stamp] = [self.hub, u].map(|v| self.aux.stamp(v));
                    work.witnesses[self.hub.index()] = Witness { hub_stamp, child: u, stamp, refusal };
                    return Err(refusal);
                }
                Err(refusal) => self.why = refusal,
            }
        }
        let mut waiting = std::mem::take(&mut work.waiting);
        for child in &mut waiting {
            child.cost = self.aux.cost(self.fan, work, self.draft, child.vertex, self.hub).value(self.at);
        }
        work.waiting = waiting;
        Ok(())
    }

    /// Who stood in the way the last time is likely to do so again.
    fn put_witness_first(&self, work: &mut Work) {
        let witness = work.witnesses[self.hub.index()].child;
        if let Some(k) = work.ring.iter().position(|&u| u == witness) {
            work.ring.swap(0, k);
        }
    }

    /// Looks at what is around `u`.
    fn child(&self, u: VertexId, work: &mut Work) -> Child {
        let [side, link] = [work.sides.len(), work.links.len()].map(|n| n as u32);
        let goes_around = self.aux.goes_around(u);
        for (slot, i) in self.draft.complex.star(u) {
            let cell = self.draft.complex.cell(slot);
            let others = [cell[(i + 1) % 3], cell[(i + 2) % 3]];
            work.sides.push(Side { slot, corner: i as u32, others });
            if goes_around {
                work.links.push(others[0]);
            }
        }
        if !goes_around {
            self.aux.link(&self.draft.complex, u, &mut work.around);
            work.links.extend_from_slice(&work.around);
        }
        Child {
            vertex: u,
            cost: 0.0,
            sides: [side, work.sides.len() as u32],
            links: [link, work.links.len() as u32],
            folds: [0, 0],
        }
    }

    /// Lists the triangles at a child that would fold over unless one of their other corners has gone; refuses where
    /// none of these ever will.
    fn find_folds(&self, child: &Child, work: &mut Work) -> Result<[u32; 2], Refusal> {
        let position = |v: VertexId| self.draft.positions[v.index()].as_dvec3();
        let from = work.folds.len() as u32;
        let old = position(child.vertex);
        if old == self.at || self.fan.fold_cosine <= -1.0 {
            return Ok([from, from]);
        }
        for k in child.sides[0]..child.sides[1] {
            let others = work.sides[k as usize].others;
            if others.contains(&self.hub) {
                continue;
            }
            let [a, b] = others.map(position);
            if let Err(refusal) = legal::turn([old, a, b], [self.at, a, b], self.fan.fold_cosine) {
                if !others.iter().any(|&w| work.is_around(w)) {
                    return Err(refusal);
                }
                work.folds.push(others);
            }
        }
        Ok([from, work.folds.len() as u32])
    }

    fn make(&mut self, work: &mut Work, least: usize, most: usize) -> Result<(), Refusal> {
        while work.merged.len() < most {
            let mut refusal = self.why;
            let legal = (0..work.waiting.len()).find(|&k| match self.may_merge(&work.waiting[k], work) {
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

    /// Whether the half-edge collapse of a child into the hub is legal, as the mesh would be now.
    fn may_merge(&self, child: &Child, work: &Work) -> Result<(), Refusal> {
        let (mut shared, mut all) = (0, 0);
        for &w in part(&work.links, child.links) {
            shared += usize::from(work.is_around(w));
            all += usize::from(w != self.hub && !work.is_merged(w));
        }
        // Whoever may go from the boundary goes to the boundary.
        let boundary = usize::from(self.aux.is_on_boundary(child.vertex));
        // On a surface the vertices next to `u` around the hub are always shared.
        if shared + boundary != 2 {
            return Err(if boundary == 1 { Refusal::Pinch } else { Refusal::Link });
        }
        // All that is left: a tetrahedron, or a triangle on its own.
        if all + boundary == 2 && self.ring_len == 3 {
            return Err(Refusal::Link);
        }
        let mut folds = part(&work.folds, child.folds).iter();
        match folds.find(|others| !others.iter().any(|&w| work.is_merged(w))) {
            Some(_) => Err(Refusal::FoldOver),
            None => Ok(()),
        }
    }

    fn merge(&mut self, k: usize, work: &mut Work) {
        let child = work.waiting.remove(k);
        work.marks[child.vertex.index()] = work.now + 1;
        self.ring_len -= 1;
        for w in part(&work.links, child.links) {
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
        for k in child.sides[0]..child.sides[1] {
            let Side { slot, corner, others } = work.sides[k as usize];
            if others.iter().all(|&w| w != hub && !work.is_merged(w)) {
                let mut cell = *complex.cell(slot);
                cell[corner as usize] = hub;
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

/// Where a dying triangle has an edge `hub c`, `c` stays and no triangle with that edge is made, since all from there to
/// the boundary die, the edge becomes boundary. As in a single collapse, the triangle behind it is made anew, so that it
/// knows.
fn remake_behind(draft: &Draft<3>, hub: VertexId, work: &Work, plan: &mut Plan<3>) {
    let complex = &draft.complex;
    for &dying in &work.dying {
        let cell = complex.cell(dying);
        let stays = cell.iter().find(|&&c| c != hub && !work.is_merged(c));
        let Some(c) = stays.filter(|_| cell.contains(&hub)) else { continue };
        // One that was made anew already is on both sides.
        if plan.makes.iter().any(|made| made.contains(&hub) && made.contains(c)) {
            continue;
        }
        let mut beside = complex.star(hub).map(|(slot, _)| slot).filter(|&slot| complex.cell(slot).contains(c));
        if let Some(slot) = beside.find(|slot| !work.dying.contains(slot)) {
            plan.kills.push(slot);
            plan.makes.push(*complex.cell(slot));
        }
    }
}
