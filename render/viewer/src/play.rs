//! A view of a model whose type nobody needs to know, that can go back in time.

use crate::ask::Asked;
use glam::Vec3;
use mt_core::hierarchy::Dependency;
use mt_core::log::{Log, LogError};
use mt_core::model::mesh_of;
use mt_core::{Bound, Cell, CellId, Hierarchy, Mesh, MultiTessellation, NodeId, Rule, Sink, Step, VertexId};
use operators::order::Visit;
use papers::study::StrategyKind;
use render::{Inspect, Legend, LiveMesh, Look, Placed, Places, Scene, Seen, Tint};
use selective::{Criterion, Hysteresis, OnPath, Outcome, State, Strategy, adapt, approach, extract};
use std::collections::HashSet;
use std::sync::Arc;

/// Steps that a log keeps: 64 MB. Older ones go, half of them at a time.
const STEPS_KEPT: usize = 8_000_000;
/// Nodes of a chain that are told; the rest is counted.
const CHAIN_SHOWN: usize = 64;

/// A view that a window shows, whatever its model.
pub trait Play: Send {
    /// Brings the mesh to what is asked. If a log was gone back in, what came after is forgotten.
    fn adapt(&mut self, asked: &Asked) -> Outcome;
    /// The steps so far, frame by frame.
    fn log(&self) -> &Log;
    /// Whether the log begins at the base mesh still; long ones lose their beginning.
    fn is_log_whole(&self) -> bool;
    /// Takes another log for its own, and goes to its beginning. Refused is what the model cannot follow.
    fn take_log(&mut self, log: Log) -> Result<(), LogError>;
    /// How many steps of the log are taken.
    fn at(&self) -> usize;
    /// Goes to where so many are, forward or back. O(steps in between).
    fn seek(&mut self, at: usize);
    /// The triangles in their places.
    fn places(&self) -> &Places;
    /// The same, for whoever sends them to a device.
    fn places_mut(&mut self) -> &mut Places;
    /// Colours the triangles, and those of `marked` in a colour of their own.
    fn tint(&mut self, tint: Tint, asked: &Asked, marked: &HashSet<CellId>) -> Option<Legend>;
    /// What a triangle is, at one of its corners.
    fn pick(&self, placed: Placed, corner: VertexId) -> Picked;
    /// The mesh by itself. O(vertices of the model).
    fn mesh(&self) -> Mesh<3>;
    /// Positions of all vertices of the model.
    fn positions(&self) -> &[Vec3];
    /// The pieces of the input that the vertices of the mesh stand for, as a scene; none of explicit models.
    fn pieces(&self) -> Option<Scene>;
    /// Where the boundary of the mesh must be, where the model can tell.
    fn boundary(&self) -> Option<HashSet<[VertexId; 2]>>;
    /// Number of refined nodes, and of all.
    fn nodes(&self) -> [u32; 2];
    /// Whether the mesh is taken back in time.
    fn is_past(&self) -> bool {
        self.at() < self.log().steps.len()
    }
}

/// A node, for a reader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeFacts {
    /// Which.
    pub node: NodeId,
    /// Its sphere, error and cone.
    pub bound: Bound,
    /// Triangles won by refining it, where that does not depend on the front.
    pub gain: Option<i32>,
}

/// A triangle that was pointed at, and its nearest corner.
#[derive(Clone, Debug)]
pub struct Picked {
    /// The triangle.
    pub placed: Placed,
    /// The corner.
    pub corner: VertexId,
    /// Where the corner is.
    pub position: Vec3,
    /// The refined node that it came with; none in the base mesh.
    pub came_with: Option<NodeFacts>,
    /// The coarse node that refines it; none where it is the input's.
    pub refined_by: Option<NodeFacts>,
    /// How many nodes have to be refined for what is there now: the closure of the needs of `came_with`, itself included.
    pub ancestors: usize,
    /// The longest chain among them.
    pub level: usize,
    /// The forced chain: what refining `refined_by` would take, in order, itself last; at most 64 of them.
    pub chain: Vec<NodeFacts>,
    /// How many it has.
    pub chain_length: usize,
    /// The triangles that these steps would replace.
    pub replaced: HashSet<CellId>,
}

/// The positions of a shared model.
struct PositionsOf<M>(Arc<M>);

impl<M: MultiTessellation<3>> AsRef<[Vec3]> for PositionsOf<M> {
    fn as_ref(&self) -> &[Vec3] {
        self.0.positions()
    }
}

/// A view of a model, with its log.
struct Player<M: Inspect> {
    model: Arc<M>,
    state: State<3, M, LiveMesh<PositionsOf<M>>>,
    index: M::Index,
    log: Log,
    is_log_whole: bool,
    at: usize,
    /// The steps of the last frame.
    last: Vec<Step>,
    /// Found when somebody asks.
    levels: Vec<u32>,
    is_plain: bool,
}

/// A view of an explicit model, or of any other that is shared: its base mesh, drawn relative to `origin`.
pub fn play<M: Inspect + Send + Sync + 'static>(model: Arc<M>, origin: Vec3) -> Box<dyn Play> {
    let live = LiveMesh::new(PositionsOf(Arc::clone(&model)), model.cell_capacity(), origin, Look::default().material);
    let state = State::new(&*model, live);
    Box::new(Player {
        index: model.index(),
        log: Log::new(model.len()),
        is_log_whole: true,
        at: 0,
        last: Vec::new(),
        levels: Vec::new(),
        is_plain: true,
        state,
        model,
    })
}

/// A view of a hierarchy, drawn relative to this point, whatever its dependencies.
pub struct PlayFrom(pub Vec3);

impl Visit for PlayFrom {
    type Output = Box<dyn Play>;
    fn visit<D: Dependency + Send + Clone + 'static>(self, model: &Hierarchy<D>) -> Box<dyn Play> {
        play(Arc::new(model.clone()), self.0)
    }
}

impl<M: Inspect> Player<M> {
    /// Answers from the base mesh, and goes to the front that this ends in.
    fn answer_afresh(&mut self, asked: &Asked, strategy: Strategy) -> Outcome {
        let model = &*self.model;
        let (target, outcome) = extract(model, &asked.wish, &asked.limits, strategy, ());
        match M::RULE {
            Rule::Static => _ = approach(model, target.front(), &mut self.state),
            // Fronts need have no legal way between them: down to the base mesh in the order of the analysis, and up again.
            Rule::Dynamic => {
                let front = self.state.view.front.clone();
                front.finest_first().for_each(|m| self.state.take(model, Step::coarsen(m)));
                target.steps.iter().for_each(|&step| self.state.take(model, step));
            }
        }
        outcome
    }

    /// Adds the steps of a frame to the log.
    fn keep(&mut self) {
        self.last.clear();
        self.last.append(&mut self.state.steps);
        if self.last.is_empty() {
            return;
        }
        self.log.push(&self.last);
        if self.log.steps.len() > STEPS_KEPT {
            let frame = self.log.frame_of(STEPS_KEPT / 2);
            let cut = self.log.frame_ends[frame];
            self.log.steps.drain(..cut);
            self.log.frame_ends.drain(..=frame);
            self.log.frame_ends.iter_mut().for_each(|end| *end -= cut);
            self.is_log_whole = false;
        }
        self.at = self.log.steps.len();
    }

    fn facts(&self, node: NodeId) -> NodeFacts {
        NodeFacts { node, bound: self.model.bound(node), gain: self.model.gain(node) }
    }

    /// The closure of the needs of a node, and its longest chain.
    fn ancestors(&self, from: NodeId) -> (usize, usize) {
        let mut depth: std::collections::BTreeMap<NodeId, usize> = [(from, 1)].into();
        let (mut count, mut longest) = (0, 0);
        let mut needs = Vec::new();
        // What a node needs has a larger id: each is looked at after all that need it.
        while let Some((m, level)) = depth.pop_first() {
            (count, longest) = (count + 1, longest.max(level));
            needs.clear();
            self.model.needs(m, &mut needs);
            for &need in &needs {
                let known = depth.entry(need).or_insert(0);
                *known = (*known).max(level + 1);
            }
        }
        (count, longest)
    }

    /// What refining a coarse node takes, and which triangles of the mesh it would replace: tried in a copy of the view.
    fn chain(&self, node: NodeId) -> (Vec<NodeId>, HashSet<CellId>) {
        let mut copy = State::new(&*self.model, Replaced::default());
        copy.view = self.state.view.clone();
        copy.sink = Replaced::default();
        copy.force(&*self.model, node);
        let chain = copy.steps.iter().map(|step| step.node).collect();
        (chain, copy.sink.0)
    }
}

/// Hears which triangles are replaced or changed.
#[derive(Default)]
struct Replaced(HashSet<CellId>);

impl Sink<3> for Replaced {
    fn kill(&mut self, cell: CellId) {
        self.0.insert(cell);
    }
    fn make(&mut self, _: CellId, _: Cell<3>) {}
    fn relabel(&mut self, cell: CellId, _: Cell<3>) {
        self.0.insert(cell);
    }
}

/// Triangles that steps would replace.
const MARKED: [u8; 4] = [250, 208, 60, 255];

impl<M: Inspect + Send + Sync> Play for Player<M> {
    fn adapt(&mut self, asked: &Asked) -> Outcome {
        self.log.steps.truncate(self.at);
        self.log.frame_ends.retain(|&end| end <= self.at);
        if self.log.frame_ends.last().copied().unwrap_or(0) < self.at {
            self.log.frame_ends.push(self.at);
        }
        self.state.steps.clear();
        let wish = &asked.wish;
        let outcome = match asked.strategy {
            StrategyKind::TopDown => self.answer_afresh(asked, Strategy::TopDown),
            StrategyKind::Priority => self.answer_afresh(asked, Strategy::Priority),
            StrategyKind::Incremental => adapt(&*self.model, wish, &asked.limits, &mut self.state),
            StrategyKind::Hysteresis => {
                let wish = Hysteresis { criterion: wish, margin: asked.margin };
                adapt(&*self.model, &wish, &asked.limits, &mut self.state)
            }
            StrategyKind::Dual | StrategyKind::DualDistance | StrategyKind::Coarse => {
                adapt(&*self.model, &OnPath { criterion: wish, path: asked.path }, &asked.limits, &mut self.state)
            }
        };
        let outcome = match asked.strategy {
            // What was done is the way between two meshes, not the extraction.
            StrategyKind::TopDown | StrategyKind::Priority => {
                let refined = self.state.steps.iter().filter(|step| step.refined).count() as u32;
                let steps = self.state.steps.len() as u32;
                Outcome { refined, coarsened: steps - refined, runs: 0, singles: steps, ..outcome }
            }
            _ => outcome,
        };
        self.keep();
        outcome
    }

    fn log(&self) -> &Log {
        &self.log
    }

    fn is_log_whole(&self) -> bool {
        self.is_log_whole
    }

    fn take_log(&mut self, log: Log) -> Result<(), LogError> {
        log.follow(&*self.model)?;
        // Down to the base mesh, where logs begin: any front goes away in the order of the analysis.
        let front = self.state.view.front.clone();
        self.state.steps.clear();
        front.finest_first().for_each(|m| self.state.take(&*self.model, Step::coarsen(m)));
        self.state.steps.clear();
        self.last.clear();
        (self.log, self.at, self.is_log_whole) = (log, 0, true);
        Ok(())
    }

    fn at(&self) -> usize {
        self.at
    }

    fn seek(&mut self, at: usize) {
        let at = at.min(self.log.steps.len());
        let model = &*self.model;
        self.state.steps.clear();
        while self.at < at {
            self.state.take(model, self.log.steps[self.at]);
            self.at += 1;
        }
        while self.at > at {
            self.at -= 1;
            self.state.take(model, self.log.steps[self.at].inverse());
        }
        self.last.clear();
        self.last.append(&mut self.state.steps);
    }

    fn places(&self) -> &Places {
        &self.state.sink.places
    }

    fn places_mut(&mut self) -> &mut Places {
        &mut self.state.sink.places
    }

    fn tint(&mut self, tint: Tint, asked: &Asked, marked: &HashSet<CellId>) -> Option<Legend> {
        let is_plain = tint == Tint::Plain && marked.is_empty();
        if is_plain && self.is_plain {
            return None;
        }
        self.is_plain = is_plain;
        if tint == Tint::Level && self.levels.is_empty() {
            self.levels = render::levels(&*self.model);
        }
        let model = &*self.model;
        let asks = |m: NodeId| asked.wish.asks(&model.bound(m), true);
        let (places, front) = (&mut self.state.sink.places, &self.state.view.front);
        let seen = Seen { model, index: &self.index, front, asks: &asks, steps: &self.last, levels: &self.levels };
        let tinting = seen.tinting(tint, places.triangles().map(|(placed, _)| placed), Look::default().material);
        places.recolour(|placed| if marked.contains(&placed.cell) { MARKED } else { tinting.colour(placed) });
        tinting.legend
    }

    fn pick(&self, placed: Placed, corner: VertexId) -> Picked {
        let (model, front) = (&*self.model, &self.state.view.front);
        let came_with = model.came_with(&self.index, placed.cell, corner, front);
        let refined_by = model.refined_by(placed.cell, corner, front);
        let (ancestors, level) = came_with.map_or((0, 0), |m| self.ancestors(m));
        let (chain, replaced) = refined_by.map_or_else(Default::default, |m| self.chain(m));
        Picked {
            placed,
            corner,
            position: model.positions()[corner.index()],
            came_with: came_with.map(|m| self.facts(m)),
            refined_by: refined_by.map(|m| self.facts(m)),
            ancestors,
            level,
            chain_length: chain.len(),
            // The last of them, so that the one that was asked for is there.
            chain: chain[chain.len().saturating_sub(CHAIN_SHOWN)..].iter().map(|&m| self.facts(m)).collect(),
            replaced,
        }
    }

    fn mesh(&self) -> Mesh<3> {
        mesh_of(&*self.model, &self.state.view.mesh)
    }

    fn positions(&self) -> &[Vec3] {
        self.model.positions()
    }

    fn pieces(&self) -> Option<Scene> {
        let above = self.model.pieces(&self.state.view.front)?;
        let input = self.model.input();
        let width_px = if self.places().triangle_count() > 2000 { 0.5 } else { 1.2 };
        Some(render::dual_pieces(&input, width_px, |v| above[v.index()]))
    }

    fn boundary(&self) -> Option<HashSet<[VertexId; 2]>> {
        self.model.boundary_at(&self.index, &self.state.view.front)
    }

    fn nodes(&self) -> [u32; 2] {
        [self.state.view.front.len(), self.model.len()]
    }
}
