//! Two views of one model, driven by operations and compared with what they must be after each of them.

use super::asking::{Asking, Scene};
use super::engine::{Ear, Engine, Seated};
use super::expect;
use super::ops::{Act, Op};
use crate::truth::{Set, Truth};
use mt_core::model::{MultiTessellation, View, cells_of, take};
use mt_core::random::Random;
use mt_core::{Bound, Coarsen, Front, NodeId, Step};
use selective::{Criterion, Hysteresis, Limits, OnPath, Outcome, State, Strategy, approach, extract};
use std::collections::HashMap;

/// A model and all that is known of it beforehand.
pub struct Kit<const N: usize, M, T> {
    pub model: M,
    pub truth: T,
    pub scene: Scene,
    pub bounds: Vec<Bound>,
    /// Under which node each is discovered.
    pub under: Vec<usize>,
    /// Writes the model and reads it.
    pub reload: Box<dyn Fn() -> M>,
}

impl<const N: usize, M: MultiTessellation<N, Bound = Bound>, T: Truth<N>> Kit<N, M, T> {
    pub fn new(model: M, truth: T, cells: usize, leaves: usize, reload: Box<dyn Fn() -> M>) -> Self {
        let bounds: Vec<Bound> = (0..model.len()).map(|m| model.bound(NodeId(m))).collect();
        let scene = Scene::new(&model.positions()[..leaves], cells, bounds.iter().copied());
        let under = expect::discovery(&model);
        Self { truth, scene, bounds, under, reload, model }
    }
}

/// A view, what it was told to ask, and where it must be.
struct Seat<const N: usize, M: MultiTessellation<N>> {
    state: Seated<N, M>,
    asking: Asking,
    refined: Set,
    /// All steps from the base mesh.
    path: Vec<Step>,
    /// How many of these were cleared from the log.
    cleared: usize,
    /// Lengths of the path after each operation.
    marks: Vec<usize>,
    undone: Vec<Step>,
}

impl<const N: usize, M: MultiTessellation<N>> Seat<N, M> {
    fn new(state: Seated<N, M>, count: usize, asking: Asking) -> Self {
        let refined = vec![false; count];
        Self { state, asking, refined, path: Vec::new(), cleared: 0, marks: vec![0], undone: Vec::new() }
    }
}

/// Two views of one model.
pub struct Rig<'a, const N: usize, M: MultiTessellation<N>, T> {
    kits: &'a [Kit<N, M, T>; 2],
    which: usize,
    model: M,
    engine: Engine,
    seats: [Seat<N, M>; 2],
    /// The mesh of every front met, which is one mesh.
    known: HashMap<Set, M::Mesh>,
}

type Judged = Result<(), String>;

fn hold(holds: bool, what: impl FnOnce() -> String) -> Judged {
    if holds { Ok(()) } else { Err(what()) }
}

fn set(refined: &mut [bool], step: Step) {
    refined[step.node.index()] = step.refined;
}

fn names(refined: &[bool]) -> Vec<usize> {
    (0..refined.len()).filter(|&m| refined[m]).collect()
}

fn is_subset(inner: &[bool], outer: &[bool]) -> bool {
    inner.iter().zip(outer).all(|(&inner, &outer)| outer || !inner)
}

/// Drives the engine through operations; the first thing that is not as it must be, with the operation after which.
pub fn play<const N: usize, M, T: Truth<N>>(kits: &[Kit<N, M, T>; 2], engine: Engine, ops: &[Op]) -> Judged
where
    M: MultiTessellation<N, Bound = Bound> + Clone,
{
    let model = kits[0].model.clone();
    let seat = || Seat::new(State::new(&model, Ear::default()), model.len() as usize, Asking::default());
    let seats = [seat(), seat()];
    let mut rig = Rig { kits, which: 0, model, engine, seats, known: HashMap::new() };
    rig.check(0).and_then(|()| rig.check(1)).map_err(|what| format!("at the start: {what}"))?;
    for (i, op) in ops.iter().enumerate() {
        rig.act(*op).map_err(|what| format!("operation {i}, {op:?}: {what}"))?;
    }
    Ok(())
}

impl<const N: usize, M: MultiTessellation<N, Bound = Bound> + Clone, T: Truth<N>> Rig<'_, N, M, T> {
    fn kit(&self) -> &Kit<N, M, T> {
        &self.kits[self.which]
    }

    /// One operation, and all checks.
    fn act(&mut self, op: Op) -> Judged {
        let s = usize::from(op.second);
        let length = self.seats[s].path.len();
        match op.act {
            Act::Wish { .. }
            | Act::Memory { .. }
            | Act::Path { .. }
            | Act::Camera { .. }
            | Act::Budget { .. }
            | Act::Time { .. } => choose(&mut self.seats[s].asking, op.act),
            Act::Forget => {
                self.seats[s].cleared = length;
                self.seats[s].state.steps.clear();
            }
            Act::Reload { anew } => self.reload(anew)?,
            Act::Other => self.other(),
            Act::RollBack { to } => self.roll_back(s, to)?,
            Act::Forward => self.forward(s)?,
            _ if self.model.is_empty() => {}
            Act::Adapt | Act::AdaptByAndBy | Act::Extract { .. } => self.ask(s, op.act)?,
            Act::Force { node } => self.force(s, node)?,
            Act::Refine { node } => self.refine(s, node)?,
            Act::Coarsen { node } => {
                let nodes = names(&self.seats[s].refined);
                let one = nodes.get(usize::from(node) % nodes.len().max(1)).copied();
                self.coarsen(s, one.into_iter())?;
            }
            Act::Thin { every } => {
                let nodes = names(&self.seats[s].refined);
                self.coarsen(s, nodes.into_iter().step_by(usize::from(every)))?;
            }
            Act::Approach { seed } => self.approach(s, seed)?,
        }
        let seat = &mut self.seats[s];
        if seat.path.len() > length && op.act != Act::Forward {
            seat.undone.clear();
        }
        seat.marks.push(seat.path.len());
        self.check(0)?;
        self.check(1).map_err(|what| format!("in the other view: {what}"))
    }

    /// Front, mesh, mirror, count and log of a view are what they must be.
    fn check(&mut self, s: usize) -> Judged {
        let (seat, model) = (&self.seats[s], &self.model);
        let view = &seat.state.view;
        let front: Vec<usize> = view.front.finest_first().map(NodeId::index).collect();
        hold(front == names(&seat.refined), || format!("the front is {front:?}, not {:?}", names(&seat.refined)))?;
        let wanted = self.kits[self.which].truth.mesh(&seat.refined);
        let cells = cells_of(model, &view.mesh);
        hold(cells == wanted, || format!("the mesh is {cells:?}, not {wanted:?}"))?;
        let heard = seat.state.sink.mirror.cells()?;
        hold(heard == wanted, || format!("the sink knows {heard:?}, not {wanted:?}"))?;
        let count = seat.state.cell_count(model) as usize;
        hold(count == wanted.len(), || format!("{count} cells are counted, not {}", wanted.len()))?;
        let log = &seat.path[seat.cleared..];
        hold(seat.state.steps == log, || format!("the log is {:?}, not {log:?}", seat.state.steps))?;
        let known = self.known.entry(seat.refined.clone()).or_insert_with(|| view.mesh.clone());
        hold(*known == view.mesh, || "this front had another mesh before".into())
    }

    /// Takes note of what was logged since the view was `before`: every step was legal, they lead from there to here, and
    /// their inverses lead back. Under a budget a dynamic rule may go down to the base mesh without asking.
    fn absorb(&mut self, s: usize, before: View<M::Mesh>, unasked: bool) -> Result<Vec<Step>, String> {
        let (seat, model, truth) = (&mut self.seats[s], &self.model, &self.kits[self.which].truth);
        let logged = seat.path.len() - seat.cleared;
        hold(seat.state.steps.get(..logged) == Some(&seat.path[seat.cleared..]), || "the log was rewritten".into())?;
        let steps = seat.state.steps[logged..].to_vec();
        let mut view = before.clone();
        let mut illegal = None;
        for &step in &steps {
            let told = truth.allows(&seat.refined, step);
            let says = says_legal(model, step, &view);
            let agree = told.is_none_or(|told| told == says);
            hold(agree || illegal.is_some(), || format!("{step:?} is legal: {told:?}, the model says {says}"))?;
            if !says {
                hold(unasked && !step.refined, || format!("{step:?} is not legal"))?;
                illegal = Some(step);
            }
            take(model, step, &mut view, &mut ());
            set(&mut seat.refined, step);
            if view.front.is_empty() {
                illegal = None;
            }
        }
        hold(illegal.is_none(), || format!("{illegal:?} is neither legal nor on the way to the base mesh"))?;
        hold(view == seat.state.view, || "the steps of the log lead elsewhere".into())?;
        for &step in steps.iter().rev() {
            take(model, step.inverse(), &mut view, &mut ());
        }
        hold(view == before, || "the inverse of the log does not lead back".into())?;
        seat.path.extend(&steps);
        Ok(steps)
    }

    fn force(&mut self, s: usize, node: u16) -> Judged {
        let m = usize::from(node) % self.kit().truth.len();
        let (before, mut wish) = (self.seats[s].state.view.clone(), self.seats[s].refined.clone());
        let was = wish.clone();
        self.seats[s].state.force(&self.model, NodeId::new(m));
        self.absorb(s, before, false)?;
        let now = &self.seats[s].refined;
        wish[m] = true;
        if let Some(order) = self.kit().truth.order() {
            let least = order.closure(&wish);
            return hold(*now == least, || format!("forced {:?}, not {:?}", names(now), names(&least)));
        }
        hold(now[m] && is_subset(&was, now), || format!("forcing {m} leads to {:?}", names(now)))
    }

    fn refine(&mut self, s: usize, node: u16) -> Judged {
        let (truth, seat) = (&self.kit().truth, &self.seats[s]);
        let count = truth.len();
        let legal = |m: &usize| {
            let step = Step::refine(NodeId::new(*m));
            let says = || !seat.refined[*m] && says_legal(&self.model, step, &seat.state.view);
            truth.allows(&seat.refined, step).unwrap_or_else(says)
        };
        let Some(m) = (0..count).map(|i| (i + usize::from(node)) % count).find(legal) else {
            return hold(seat.refined.iter().all(|&r| r), || "nothing may be refined, but not all is".into());
        };
        let before = seat.state.view.clone();
        self.seats[s].state.take(&self.model, Step::refine(NodeId::new(m)));
        self.absorb(s, before, false).map(|_| ())
    }

    /// Tries to coarsen refined nodes in turn.
    fn coarsen(&mut self, s: usize, nodes: impl Iterator<Item = usize>) -> Judged {
        for m in nodes {
            let step = Step::coarsen(NodeId::new(m));
            let seat = &mut self.seats[s];
            let may = self.kits[self.which].truth.allows(&seat.refined, step);
            let before = seat.state.view.clone();
            let did = self.engine.coarsen(&self.model, &mut seat.state, step.node);
            hold(may.is_none_or(|may| may == did), || format!("coarsening {m} may {may:?}, did {did}"))?;
            let steps = self.absorb(s, before, false)?;
            hold(steps.len() == usize::from(did), || format!("{steps:?} were taken, but the answer is {did}"))?;
        }
        Ok(())
    }

    fn approach(&mut self, s: usize, seed: u8) -> Judged {
        let Some(order) = self.kit().truth.order() else { return Ok(()) };
        let mut random = Random::new(u64::from(seed));
        let share = 1 + random.below(8);
        let wish: Set = self.seats[s].refined.iter().map(|_| random.below(8) < share && random.below(8) == 0).collect();
        let target = order.closure(&wish);
        let before = self.seats[s].state.view.clone();
        let front = Front::from_nodes(self.model.len(), names(&target).into_iter().map(NodeId::new));
        let outcome = approach(&self.model, &front, &mut self.seats[s].state);
        let steps = self.absorb(s, before, false)?;
        count(&outcome, &steps)?;
        hold(outcome.complete && self.seats[s].refined == target, || format!("did not reach {:?}", names(&target)))
    }

    fn roll_back(&mut self, s: usize, to: u16) -> Judged {
        let seat = &mut self.seats[s];
        // Between two operations of a dynamic rule there may be meshes that are nobody's.
        let marks: Vec<usize> = if self.kits[self.which].truth.order().is_some() {
            (seat.cleared..=seat.path.len()).collect()
        } else {
            seat.marks.iter().copied().filter(|&mark| mark >= seat.cleared).collect()
        };
        let Some(&mark) = marks.get(usize::from(to) % marks.len().max(1)) else { return Ok(()) };
        self.engine.roll_back(&self.model, &mut seat.state, mark - seat.cleared);
        let undone = seat.path.split_off(mark);
        undone.iter().rev().for_each(|step| set(&mut seat.refined, step.inverse()));
        seat.marks.retain(|&other| other <= mark);
        if !undone.is_empty() {
            seat.undone = undone;
        }
        Ok(())
    }

    fn forward(&mut self, s: usize) -> Judged {
        let seat = &mut self.seats[s];
        for step in std::mem::take(&mut seat.undone) {
            seat.state.take(&self.model, step);
            set(&mut seat.refined, step);
            seat.path.push(step);
        }
        Ok(())
    }

    fn reload(&mut self, anew: bool) -> Judged {
        self.model = (self.kit().reload)();
        for s in 0..if anew { 2 } else { 0 } {
            let seat = &mut self.seats[s];
            let mut state = State::new(&self.model, Ear::default());
            if self.kits[self.which].truth.order().is_some() {
                approach(&self.model, &seat.state.view.front.clone(), &mut state);
                seat.path.clone_from(&state.steps);
                seat.marks.clear();
            } else {
                seat.path.iter().for_each(|&step| state.take(&self.model, step));
            }
            (seat.state, seat.cleared) = (state, 0);
            seat.undone.clear();
        }
        Ok(())
    }

    fn other(&mut self) {
        self.which = 1 - self.which;
        self.model = self.kit().model.clone();
        self.known.clear();
        for s in 0..2 {
            let empty = State::new(&self.model, Ear::default());
            let old = std::mem::replace(&mut self.seats[s].state, empty);
            let state = self.engine.restart(&self.model, old);
            self.seats[s] = Seat::new(state, self.model.len() as usize, self.seats[s].asking);
        }
    }

    /// Asks as has been chosen: with memory or without, on a path or not.
    fn ask(&mut self, s: usize, act: Act) -> Judged {
        let asking = self.seats[s].asking;
        let scene = &self.kit().scene;
        let (criterion, path) = (scene.wish(&asking), scene.path(&asking));
        let margin = asking.margin.map(|margin| [0.0, 0.01, 0.3, 4.0][usize::from(margin) % 4]);
        match (margin, path) {
            (None, None) => self.ask_as(s, act, &criterion),
            (Some(margin), None) => self.ask_as(s, act, &Hysteresis { criterion, margin }),
            (None, Some(path)) => self.ask_as(s, act, &OnPath { criterion, path }),
            (Some(margin), Some(path)) => {
                self.ask_as(s, act, &OnPath { criterion: Hysteresis { criterion, margin }, path })
            }
        }
    }

    fn ask_as<C: Criterion<Bound>>(&mut self, s: usize, act: Act, criterion: &C) -> Judged {
        let mut limits = self.kit().scene.limits(&self.seats[s].asking);
        let anew = matches!(act, Act::Extract { .. });
        let count_nodes = self.kit().truth.len();
        if let Act::Extract { priority } = act {
            let strategy = if priority { Strategy::Priority } else { Strategy::TopDown };
            let asking = self.seats[s].asking;
            let (state, outcome) = extract(&self.model, criterion, &limits, strategy, Ear::default());
            self.seats[s] = Seat::new(state, count_nodes, asking);
            return self.judge(s, criterion, &limits, self.model.base_view(), &outcome);
        }
        if act == Act::Adapt {
            return self.adapt(s, criterion, &limits).and_then(|_| self.rest(s, criterion, &limits));
        }
        debug_assert!(!anew);
        limits.time = Some(std::time::Duration::ZERO);
        for _ in 0..1000 {
            let outcome = self.adapt(s, criterion, &limits)?;
            if outcome.complete || outcome.refined + outcome.coarsened == 0 {
                limits.time = None;
                // What is complete, or cannot go on, is where it would be with all the time there is.
                return self.rest(s, criterion, &limits);
            }
        }
        hold(self.kit().truth.order().is_none(), || "calls without time never finish".into())
    }

    fn adapt<C: Criterion<Bound>>(&mut self, s: usize, criterion: &C, limits: &Limits) -> Result<Outcome, String> {
        let before = self.seats[s].state.view.clone();
        let outcome = self.engine.adapt(&self.model, criterion, limits, &mut self.seats[s].state);
        let [first, second] = &mut self.seats;
        let (seat, other) = if s == 0 { (first, second) } else { (second, first) };
        self.engine.adapted(&seat.state, &mut other.state);
        self.judge(s, criterion, limits, before, &outcome)?;
        Ok(outcome)
    }

    /// A still camera rests: always under a static order, unless memory meets a budget.
    fn rest<C: Criterion<Bound>>(&mut self, s: usize, criterion: &C, limits: &Limits) -> Judged {
        let restless =
            self.kit().truth.order().is_none() || limits.time.is_some() || C::MEMORY && limits.cells.is_some();
        if restless {
            return Ok(());
        }
        let again = self.adapt(s, criterion, limits)?;
        hold(again.refined + again.coarsened == 0, || format!("a still camera does not rest: {again:?}"))
    }

    /// Judges a call that led from `before` to the view as it is.
    fn judge<C: Criterion<Bound>>(
        &mut self,
        s: usize,
        criterion: &C,
        limits: &Limits,
        before: View<M::Mesh>,
        outcome: &Outcome,
    ) -> Judged {
        let was = self.seats[s].refined.clone();
        let is_dynamic = self.kit().truth.order().is_none();
        let steps = self.absorb(s, before, is_dynamic && limits.cells.is_some())?;
        count(outcome, &steps)?;
        let (kit, now) = (self.kit(), &self.seats[s].refined);
        if let Some(cells_max) = limits.cells {
            let cells = kit.truth.mesh(now).len();
            let most = (cells_max as usize).max(kit.truth.mesh(&vec![false; now.len()]).len());
            hold(cells <= most, || format!("{cells} cells under a budget of {cells_max}"))?;
        }
        let goals = expect::goals(&kit.bounds, &kit.truth, criterion, &was);
        let asked = expect::asked(&goals);
        let Some(order) = kit.truth.order() else {
            let done = limits.cells.is_some() || limits.time.is_some() || is_subset(&asked, now) && outcome.complete;
            return hold(done, || format!("{:?} are asked for, {:?} refined", names(&asked), names(now)));
        };
        let (target, fits) = match limits.cells {
            Some(most) => expect::within_budget(&kit.truth, order, &kit.under, &goals, most as usize),
            None => (order.closure(&asked), true),
        };
        let differ = || format!("the front is {:?}, not {:?}", names(now), names(&target));
        if limits.time.is_some() && !outcome.complete {
            let union: Set = was.iter().zip(&target).map(|(&was, &target)| was || target).collect();
            return hold(is_subset(now, &union), differ);
        }
        hold(*now == target, differ)?;
        hold(outcome.complete == fits, || format!("{outcome:?}, but all fitted: {fits}"))?;
        let forced = steps.iter().filter(|step| step.refined && !asked[step.node.index()]).count();
        let told = outcome.forced as usize;
        hold(limits.cells.is_some() || told == forced, || format!("{told} forced are told, {forced} were"))
    }
}

/// What an outcome counts is in the log.
fn count(outcome: &Outcome, steps: &[Step]) -> Judged {
    let refined = steps.iter().filter(|step| step.refined).count();
    let same = (outcome.refined as usize, outcome.coarsened as usize) == (refined, steps.len() - refined);
    hold(same, || format!("{outcome:?} after {} steps, {refined} of them refining", steps.len()))
}

/// Whether the model itself says that a step is legal.
fn says_legal<const N: usize, M: MultiTessellation<N>>(model: &M, step: Step, view: &View<M::Mesh>) -> bool {
    let mut out = Vec::new();
    if step.refined {
        model.prerequisites(step.node, view, &mut out);
        return out.is_empty();
    }
    model.obstacles(step.node, view, &mut out) == Coarsen::Now
}

fn choose(asking: &mut Asking, act: Act) {
    match act {
        Act::Wish { kind, level, hair } => (asking.kind, asking.level) = (kind, (level, hair)),
        Act::Memory { margin } => asking.margin = margin,
        Act::Path { path } => asking.path = path,
        Act::Camera { turn, distance } => asking.camera = (turn, distance),
        Act::Budget { cells } => asking.cells = cells,
        Act::Time { none } => asking.hurried = none,
        _ => {}
    }
}
