//! Law 10: extract and adapt end in the least closure of the wish, for random criteria of every kind.

use glam::Vec3;
use mt_core::check::{self, Breach, Law, Random};
use mt_core::model::{MultiTessellation, View};
use mt_core::{Bound, Camera, Front, NodeId, Order};
use selective::{
    Criterion, Facing, FeaturePoints, Frustum, InRegion, InView, Limits, Measure, Moving, NormalChange, OnPath, Pace,
    Path, PointIndex, Reading, Region, ScreenError, Silhouette, State, Strategy, Transfer, UniformError, VisualError,
    Wish, adapt, certify, extract,
};
use std::f32::consts::PI;
use std::sync::Arc;
use std::time::Duration;

/// A criterion drawn at random, of any kind without memory. Requires: the model has a node.
pub(super) fn draw<const N: usize, M: MultiTessellation<N, Bound = Bound>>(model: &M, random: &mut Random) -> Wish {
    Draw::new(model, random).wish()
}

/// Draws criteria for a model: about the bounds of its own nodes, so that ties and halves occur.
struct Draw<'a, const N: usize, M> {
    model: &'a M,
    random: &'a mut Random,
    camera: Camera,
}

impl<'a, const N: usize, M: MultiTessellation<N, Bound = Bound>> Draw<'a, N, M> {
    fn new(model: &'a M, random: &'a mut Random) -> Self {
        let mut draw = Self { model, random, camera: Camera::around(Vec3::ZERO, Vec3::ONE, Vec3::Z) };
        let (at, size, from) = (draw.bound().center, draw.size(), draw.direction());
        draw.camera = Camera::around(at - size, at + size, from);
        draw
    }

    fn node(&mut self) -> NodeId {
        NodeId::new(self.random.below(self.model.len() as usize))
    }

    /// That of some node.
    fn bound(&mut self) -> Bound {
        let m = self.node();
        self.model.bound(m)
    }

    fn unit(&mut self) -> f32 {
        self.random.unit() as f32
    }

    /// Up to the extent of the model.
    fn size(&mut self) -> f32 {
        let extent = self.model.bound(NodeId(self.model.len() - 1)).radius;
        extent.max(f32::MIN_POSITIVE) * self.unit()
    }

    fn direction(&mut self) -> Vec3 {
        let way = Vec3::new(self.unit(), self.unit(), self.unit()) - 0.5;
        way.normalize_or(Vec3::Z)
    }

    /// A criterion that wraps no other.
    fn simple(&mut self) -> Wish {
        let (eye, error_max) = (self.camera.eye, self.bound().error);
        match self.random.below(7) {
            0 => Wish::Uniform(UniformError { error_max }),
            1 => {
                let (at, size) = (self.bound().center, self.size());
                Wish::Region(InRegion { region: Region { low: at - size, high: at + size }, error_max })
            }
            2 => {
                let error_px = 20.0 * self.unit();
                Wish::Screen(Box::new(ScreenError::new(&self.camera, error_px)))
            }
            3 => Wish::Transfer(Box::new(self.transfer())),
            4 => {
                let (apart, light, epsilon) = (eye.distance(self.bound().center), self.direction(), self.unit());
                let (reading, scale) = match self.random.below(2) {
                    0 => (Reading::Tolerance, error_max / apart.max(f32::MIN_POSITIVE)),
                    _ => (Reading::Error, error_max * apart),
                };
                let error_min = error_max * self.unit();
                Wish::Visual(Box::new(VisualError { eye, light, epsilon, scale, error_min, reading }))
            }
            5 => {
                let points: Vec<Vec3> = (0..self.random.below(5)).map(|_| self.bound().center).collect();
                let (points, error_at) = (Arc::new(PointIndex::new(points)), error_max * self.unit());
                Wish::Features(Box::new(FeaturePoints { points, error_at, error_max }))
            }
            _ => Wish::Normals(NormalChange { angle_max: PI * self.unit() }),
        }
    }

    /// Three knots, by distance or by size.
    fn transfer(&mut self) -> Transfer {
        let (eye, by_size) = (self.camera.eye, self.random.below(2) == 1);
        let mut errors = [self.bound().error, self.bound().error, self.bound().error];
        errors.sort_by(f32::total_cmp);
        let measure = match by_size {
            true => Measure::SizePx { pixels_per_unit: self.camera.pixels_per_unit(), near: self.camera.near },
            false => Measure::Distance,
        };
        // What is larger on the screen may not be coarser; what is farther may.
        let (unit, errors) = match by_size {
            true => (100.0, [errors[2], errors[1], errors[0]]),
            // Far apart in a large model squares overflow; a quarter of the most leaves room for the last knot.
            false => (eye.distance(self.bound().center).clamp(f32::MIN_POSITIVE, f32::MAX * 0.25), errors),
        };
        Transfer::new(eye, measure, [0.5, 1.0, 2.0].map(|at| at * unit).into_iter().zip(errors).collect())
            .expect("knots ascend, and so do tolerances")
    }

    /// Any criterion without memory.
    fn wish(&mut self) -> Wish {
        let eye = self.camera.eye;
        match self.random.below(10) {
            0 => Wish::InView(Box::new(InView { frustum: Frustum::new(&self.camera), criterion: self.simple() })),
            1 => Wish::Facing(Box::new(Facing { eye, criterion: self.simple() })),
            2 => Wish::Silhouette(Box::new(Silhouette { eye, outline: self.simple(), elsewhere: self.simple() })),
            3 => Wish::Moving(Box::new(Moving::new(self.simple(), 2.0, self.unit(), 1.0))),
            4 => Wish::Any((0..self.random.below(4)).map(|_| self.simple()).collect()),
            _ => self.simple(),
        }
    }

    fn path(&mut self) -> Path {
        let eye = self.camera.eye;
        match self.random.below(4) {
            0 => Path::Fine,
            1 => Path::Difference,
            2 => Path::Distance { eye, beyond: eye.distance(self.bound().center) },
            _ => Path::Coarse,
        }
    }
}

/// Law 10 from the front of `view`, for a criterion drawn at random; where nodes come in runs, often on a path.
pub fn minimality<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    order: &Order,
    view: &View<M::Mesh>,
    random: &mut Random,
) -> Result<(), Breach> {
    if model.is_empty() {
        return Ok(());
    }
    let mut draw = Draw::new(model, random);
    let criterion = draw.wish();
    let run = model.run(draw.node());
    if run.start() == run.end() {
        return ends_in_least(model, order, &criterion, criterion.name(), view, random);
    }
    let on_path = OnPath { path: draw.path(), criterion };
    ends_in_least(model, order, &on_path, on_path.criterion.name(), view, random)
}

/// Law 10 at ties: for an error everywhere that is that of some nodes, or a little below, extract and adapt refine the
/// least closure of those above it, and all of them. Tries each distinct error of a small model, and about `TIES` drawn
/// at random of a larger one; gives how many. O(nodes log nodes + tries × front).
pub fn ties<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    order: &Order,
    seed: u64,
) -> Result<u32, Breach> {
    let mut errors: Vec<f32> = (0..model.len()).map(|m| model.bound(NodeId(m)).error).collect();
    errors.sort_by(f32::total_cmp);
    errors.dedup();
    let mut random = Random::new(seed);
    let tries = match model.len() {
        0..=SMALL => errors.len(),
        _ => errors.len().min(TIES),
    };
    for i in 0..tries {
        let at = if tries == errors.len() { i } else { random.below(errors.len()) };
        for error_max in [errors[at], errors[at].next_down()] {
            let criterion = UniformError { error_max };
            let wish = least(model, order, &criterion);
            let (mut state, _) = extract(model, &criterion, &Limits::NONE, Strategy::TopDown, ());
            let extracted = *state.front() == wish;
            // From the other side of the tie.
            adapt(model, &UniformError { error_max: errors[at].next_up() }, &Limits::NONE, &mut state);
            adapt(model, &criterion, &Limits::NONE, &mut state);
            if !extracted || *state.front() != wish {
                let what = format!(
                    "at error {error_max:e}, which nodes have: {} refines {} nodes, the least closure has {}",
                    if extracted { "adapt" } else { "extract" },
                    state.front().len(),
                    wish.len()
                );
                return Err(Breach { law: Law::Minimality, what, node: None });
            }
        }
    }
    Ok(2 * tries as u32)
}

/// Models up to this many nodes have all their ties tried.
const SMALL: u32 = 128;
/// How many distinct errors of a larger model are tried.
const TIES: usize = 4;

/// Whether a node is asked for: by itself, or by the last of its run where that decides for the run.
fn asks<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    criterion: &impl Criterion<Bound>,
    m: NodeId,
) -> bool {
    let last = model.bound(*model.run(m).end());
    criterion.asks(&model.bound(m), false) || criterion.pace(&last) == Pace::Whole && criterion.asks(&last, false)
}

/// The engine's front has a certificate of minimality, and the checker that knows order and wish alone accepts it.
fn certified<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    order: &Order,
    criterion: &impl Criterion<Bound>,
    front: &Front,
) -> Result<(), Breach> {
    let asked = |m: NodeId| asks(model, criterion, m);
    check::is_least(order, &asked, &certify(order, &asked, front)?)
}

/// The least closed front that has all that is asked for: node by node, and nothing shared with the engine. A node is
/// asked for by itself, or by the last of its run where that decides for the run.
pub(super) fn least<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    order: &Order,
    criterion: &impl Criterion<Bound>,
) -> Front {
    let asked = (0..model.len()).map(NodeId).filter(|&m| asks(model, criterion, m));
    let mut front = Front::from_nodes(model.len(), asked);
    order.close(&mut front);
    front
}

/// Law 10 from the front of `view`: adapt from there, extract by both strategies, and the least closure of the wish all
/// give one front; under a budget, no front is too large and a second call changes nothing. O(front + closure).
pub(super) fn ends_in_least<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    order: &Order,
    criterion: &impl Criterion<Bound>,
    name: &str,
    view: &View<M::Mesh>,
    random: &mut Random,
) -> Result<(), Breach> {
    let wish = least(model, order, criterion);
    let breach = |what: String| Breach { law: Law::Minimality, what: format!("{name}: {what}"), node: None };
    for strategy in [Strategy::TopDown, Strategy::Priority] {
        let (state, outcome) = extract(model, criterion, &Limits::NONE, strategy, ());
        if *state.front() != wish || !outcome.complete {
            let extra = state.front().difference(&wish).next();
            return Err(breach(format!(
                "extract ({strategy:?}) refines {} nodes, the least closure has {}; first extra: {extra:?}",
                state.front().len(),
                wish.len()
            )));
        }
    }
    let mut state = State::new(model, ());
    state.view = view.clone();
    adapt(model, criterion, &Limits::NONE, &mut state);
    if *state.front() != wish {
        let (extra, missing) = (state.front().difference(&wish).next(), wish.difference(state.front()).next());
        return Err(breach(format!(
            "adapt ends in {} nodes, the least closure has {}; extra: {extra:?}, missing: {missing:?}",
            state.front().len(),
            wish.len()
        )));
    }
    closed(order, state.front())?;
    certified(model, order, criterion, state.front())?;
    budget(model, order, criterion, state, random)
}

/// The front of an engine is closed.
fn closed(order: &Order, front: &Front) -> Result<(), Breach> {
    let unmet = order.unmet(front);
    let breach = |(m, need)| Breach {
        law: Law::Closure,
        what: format!("the engine refined node {m} without node {need}, which it needs"),
        node: Some(m),
    };
    unmet.map(breach).map_or(Ok(()), Err)
}

fn budget<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    order: &Order,
    criterion: &impl Criterion<Bound>,
    mut state: State<N, M, ()>,
    random: &mut Random,
) -> Result<(), Breach> {
    let breach = |what: String| Err(Breach { law: Law::Minimality, what, node: None });
    let base = model.cell_count(&model.base());
    let now = state.cell_count(model);
    let cells_max = base + random.below(now.saturating_sub(base) as usize + 1) as u32;
    // With no time at all the mesh has to be within the budget all the same.
    adapt(model, criterion, &Limits { cells: Some(cells_max), time: Some(Duration::ZERO) }, &mut state);
    closed(order, state.front())?;
    if state.cell_count(model) > cells_max {
        return breach(format!("{} cells under a budget of {cells_max}, without time", state.cell_count(model)));
    }
    let limits = Limits { cells: Some(cells_max), time: None };
    adapt(model, criterion, &limits, &mut state);
    if state.cell_count(model) > cells_max {
        return breach(format!("{} cells under a budget of {cells_max}", state.cell_count(model)));
    }
    let rested = adapt(model, criterion, &limits, &mut state);
    if rested.refined + rested.coarsened > 0 {
        return breach(format!(
            "under a budget of {cells_max} cells a still criterion moves {} nodes",
            rested.refined + rested.coarsened
        ));
    }
    Ok(())
}
