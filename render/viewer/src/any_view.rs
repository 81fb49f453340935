//! A view of a model whose type nobody needs to know, that can go back in time.

use crate::ask::Asked;
use glam::Vec3;
use mt_core::hierarchy::Dependency;
use mt_core::log::{Log, LogError};
use mt_core::model::{mesh_of, take};
use mt_core::{Bound, Cell, CellId, Hierarchy, Mesh, MultiTessellation, NodeId, Rule, Sink, Step, VertexId};
use operators::order::Visit;
use papers::study::StrategyKind;
use render::{Index, Inspect, Legend, LiveMesh, Look, Placed, Places, Scene, Seen, Tint};
use selective::{Criterion, Outcome, Pace, State, Strategy, adapt, approach, extract};
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

/// Steps that a log keeps: 64 MB. Older ones go, half of them at a time.
const STEPS_KEPT: usize = 8_000_000;
/// Nodes that are told of a chain or of ancestors; the rest is counted.
const SHOWN: usize = 64;

/// A view that a window shows, whatever its model.
pub trait AnyView: Send {
    /// Brings the mesh to what is asked, from the end of the log.
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
    /// Another view of the same model: its base mesh.
    fn beside(&self) -> Box<dyn AnyView>;
    /// Colours the triangles, and those of `marked` in a colour of their own. What is forced is judged by the question that
    /// was answered last.
    fn tint(&mut self, tint: Tint, marked: &HashSet<CellId>) -> Option<Legend>;
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
    /// What had to be refined for what is there now: the closure of the needs of `came_with`, itself first; at most 64 of them.
    pub ancestors: Vec<NodeId>,
    /// How many they are.
    pub ancestor_count: usize,
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
    index: Index<M>,
    log: Log,
    is_log_whole: bool,
    at: usize,
    /// The steps that led here from the frame before, or from where in the log the view was.
    last: Vec<Step>,
    /// What was answered last.
    asked: Option<Asked>,
    is_plain: bool,
    /// Steps beyond which the log loses its older half.
    steps_kept: usize,
}

/// A view of an explicit model, or of any other that is shared: its base mesh, drawn relative to `origin`.
pub fn view_of<M: Inspect + Send + Sync + 'static>(model: Arc<M>, origin: Vec3) -> Box<dyn AnyView> {
    let live = LiveMesh::new(PositionsOf(Arc::clone(&model)), model.cell_capacity(), origin, Look::default().material);
    let state = State::new(&*model, live);
    Box::new(Player {
        index: Index::of(&*model),
        log: Log::new(model.len()),
        is_log_whole: true,
        at: 0,
        last: Vec::new(),
        asked: None,
        is_plain: true,
        steps_kept: STEPS_KEPT,
        state,
        model,
    })
}

/// A view of a hierarchy, drawn relative to this point, whatever its dependencies.
pub struct ViewFrom(pub Vec3);

impl Visit for ViewFrom {
    type Output = Box<dyn AnyView>;
    fn visit<D: Dependency + Send + Clone + 'static>(self, model: &Hierarchy<D>) -> Box<dyn AnyView> {
        view_of(Arc::new(model.clone()), self.0)
    }
}

impl<M: Inspect> Player<M> {
    /// Answers from the base mesh, and goes to the front that this ends in.
    fn answer_afresh(&mut self, asked: &Asked, strategy: Strategy) -> Outcome {
        let model = &*self.model;
        let (target, outcome) = extract(model, &asked.wish, &asked.limits, strategy, ());
        match M::RULE {
            Rule::Static => _ = approach(model, target.front(), &mut self.state),
            // Fronts need have no legal way between them, so the log begins anew.
            Rule::Dynamic => {
                self.restart(Log::new(self.model.len()));
                target.steps.iter().for_each(|&step| self.state.take(&*self.model, step));
            }
        }
        // What was done is the way between two meshes; what the extraction forced is another count.
        let refined = self.state.steps.iter().filter(|step| step.refined).count() as u32;
        let steps = self.state.steps.len() as u32;
        let way = Outcome { refined, coarsened: steps - refined, singles: steps, ..Outcome::default() };
        Outcome { complete: outcome.complete, ..way }
    }

    /// Down to the base mesh, and at the beginning of a log. Any front goes away in the order of the analysis.
    fn restart(&mut self, log: Log) {
        let front = self.state.view.front.clone();
        front.finest_first().for_each(|m| self.state.take(&*self.model, Step::coarsen(m)));
        self.state.steps.clear();
        self.last.clear();
        (self.log, self.at, self.is_log_whole) = (log, 0, true);
    }

    /// Adds the steps of a frame to the log.
    fn keep(&mut self) {
        self.last.clear();
        self.last.append(&mut self.state.steps);
        if self.last.is_empty() {
            return;
        }
        self.log.push(&self.last);
        if self.log.steps.len() > self.steps_kept {
            let frame = self.log.frame_of(self.steps_kept / 2);
            let cut = self.log.frame_ends[frame];
            self.log.steps.drain(..cut);
            self.log.frame_ends.drain(..=frame);
            self.log.frame_ends.iter_mut().for_each(|end| *end -= cut);
            self.is_log_whole = false;
        }
        self.at = self.log.steps.len();
    }

    /// Whether a node was asked for by the question that was answered last, as it was answered.
    fn asks(&self, m: NodeId) -> bool {
        let Some(asked) = &self.asked else { return true };
        let bound = |m| self.model.bound(m);
        match asked.strategy {
            StrategyKind::Hysteresis => asked.lasting().asks(&bound(m), true),
            StrategyKind::Dual | StrategyKind::DualDistance | StrategyKind::Coarse => {
                let wish = asked.on_path();
                let last = *self.model.run(m).end();
                let as_one = wish.pace(&bound(last)) == Pace::Whole;
                wish.asks(&bound(m), true) || as_one && wish.asks(&bound(last), true)
            }
            _ => asked.wish.asks(&bound(m), true),
        }
    }

    fn facts(&self, node: NodeId) -> NodeFacts {
        NodeFacts { node, bound: self.model.bound(node), gain: self.model.gain(node) }
    }

    /// The closure of the needs of a node, coarsest last, and its longest chain.
    fn ancestors(&self, from: NodeId) -> (Vec<NodeId>, usize) {
        let mut open: BTreeMap<NodeId, usize> = [(from, 1)].into();
        let (mut all, mut longest) = (Vec::new(), 0);
        let mut needs = Vec::new();
        // What a node needs has a larger id: each is looked at after all that need it.
        while let Some((m, level)) = open.pop_first() {
            all.push(m);
            longest = longest.max(level);
            needs.clear();
            self.model.needs(m, &mut needs);
            for &need in &needs {
                let known = open.entry(need).or_insert(0);
                *known = (*known).max(level + 1);
            }
        }
        (all, longest)
    }

    /// What refining a coarse node takes, and which triangles of the mesh it would replace: tried in a copy of the view.
    fn chain(&self, node: NodeId) -> (Vec<NodeId>, HashSet<CellId>) {
        let mut copy = State::new(&*self.model, Replaced::default());
        copy.view = self.state.view.clone();
        copy.sink = Replaced::default();
        copy.force(&*self.model, node);
        let chain = copy.steps.iter().map(|step| step.node).collect();
        (chain, copy.sink.gone)
    }
}

/// Hears which triangles of the mesh as it was are replaced or changed.
#[derive(Default)]
struct Replaced {
    gone: HashSet<CellId>,
    /// Those that were not there before.
    made: HashSet<CellId>,
}

impl Sink<3> for Replaced {
    fn kill(&mut self, cell: CellId) {
        if !self.made.remove(&cell) {
            self.gone.insert(cell);
        }
    }
    fn make(&mut self, cell: CellId, _: Cell<3>) {
        self.made.insert(cell);
    }
    fn relabel(&mut self, cell: CellId, _: Cell<3>) {
        if !self.made.contains(&cell) {
            self.gone.insert(cell);
        }
    }
}

/// Triangles that steps would replace.
const MARKED: [u8; 4] = [250, 208, 60, 255];

impl<M: Inspect + Send + Sync + 'static> AnyView for Player<M> {
    fn adapt(&mut self, asked: &Asked) -> Outcome {
        self.seek(usize::MAX);
        let (model, state, limits) = (&*self.model, &mut self.state, &asked.limits);
        let outcome = match asked.strategy {
            StrategyKind::TopDown => self.answer_afresh(asked, Strategy::TopDown),
            StrategyKind::Priority => self.answer_afresh(asked, Strategy::Priority),
            StrategyKind::Incremental => adapt(model, &asked.wish, limits, state),
            StrategyKind::Hysteresis => adapt(model, &asked.lasting(), limits, state),
            StrategyKind::Dual | StrategyKind::DualDistance | StrategyKind::Coarse => {
                adapt(model, &asked.on_path(), limits, state)
            }
        };
        self.keep();
        self.asked = Some(asked.clone());
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
        self.restart(log);
        Ok(())
    }

    fn at(&self) -> usize {
        self.at
    }

    fn seek(&mut self, at: usize) {
        let at = at.min(self.log.steps.len());
        let State { view, sink, .. } = &mut self.state;
        self.last.clear();
        while self.at != at {
            let back = at < self.at;
            self.at -= usize::from(back);
            let step = self.log.steps[self.at];
            let step = if back { step.inverse() } else { step };
            take(&*self.model, step, view, sink);
            self.last.push(step);
            self.at += usize::from(!back);
        }
    }

    fn places(&self) -> &Places {
        &self.state.sink.places
    }

    fn places_mut(&mut self) -> &mut Places {
        &mut self.state.sink.places
    }

    fn beside(&self) -> Box<dyn AnyView> {
        view_of(Arc::clone(&self.model), self.places().origin())
    }

    fn tint(&mut self, tint: Tint, marked: &HashSet<CellId>) -> Option<Legend> {
        let is_plain = tint == Tint::Plain && marked.is_empty();
        // What steps make is plain of itself.
        if is_plain && self.is_plain {
            return None;
        }
        self.is_plain = is_plain;
        let mut places = std::mem::take(&mut self.state.sink.places);
        let seen = Seen {
            model: &*self.model,
            index: &self.index,
            front: &self.state.view.front,
            asks: &|m| self.asks(m),
            steps: &self.last,
        };
        let tinting = seen.tinting(tint, places.triangles().map(|(placed, _)| placed), Look::default().material);
        places.recolour(|placed| if marked.contains(&placed.cell) { MARKED } else { tinting.colour(placed) });
        let legend = tinting.legend;
        drop(tinting);
        self.state.sink.places = places;
        legend
    }

    fn pick(&self, placed: Placed, corner: VertexId) -> Picked {
        let (model, front) = (&*self.model, &self.state.view.front);
        let came_with = self.index.came_with(model, placed.cell, corner, front);
        let refined_by = model.refined_by(placed.cell, corner, front);
        let (mut ancestors, level) = came_with.map_or_else(Default::default, |m| self.ancestors(m));
        let ancestor_count = ancestors.len();
        ancestors.truncate(SHOWN);
        let (chain, replaced) = refined_by.map_or_else(Default::default, |m| self.chain(m));
        Picked {
            placed,
            corner,
            position: model.positions()[corner.index()],
            came_with: came_with.map(|m| self.facts(m)),
            refined_by: refined_by.map(|m| self.facts(m)),
            ancestors,
            ancestor_count,
            level,
            chain_length: chain.len(),
            // The last of them, so that the one that was asked for is there.
            chain: chain[chain.len().saturating_sub(SHOWN)..].iter().map(|&m| self.facts(m)).collect(),
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
        Some(render::dual_pieces(&input, self.places().origin(), |v| above[v.index()]))
    }

    fn boundary(&self) -> Option<HashSet<[VertexId; 2]>> {
        self.index.boundary_at(&*self.model, &self.state.view.front)
    }

    fn nodes(&self) -> [u32; 2] {
        [self.state.view.front.len(), self.model.len()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ask::{Ask, Extent};
    use crate::pilot::Pilot;
    use mt_core::analysis::{Options, simplify};
    use mt_core::generate;
    use operators::EdgeCollapse;

    /// What is left of a long log leads both ways: back to where it begins now, and to the mesh that it came from.
    #[test]
    fn a_long_log_loses_its_beginning_and_nothing_else() {
        let mesh = generate::sphere(3);
        let model = simplify(&mesh, &EdgeCollapse::FULL, &Options::default(), &mut |_| true).unwrap().model;
        let (model, extent) = (Arc::new(model), Extent::of(&mesh));
        let live = LiveMesh::new(PositionsOf(Arc::clone(&model)), model.cell_capacity(), Vec3::ZERO, [9; 4]);
        let mut player = Player {
            index: Index::of(&*model),
            log: Log::new(model.len()),
            is_log_whole: true,
            at: 0,
            last: Vec::new(),
            asked: None,
            is_plain: true,
            steps_kept: 700,
            state: State::new(&*model, live),
            model,
        };
        let camera = Pilot::around(extent.low, extent.high).camera([64, 64]);
        for error_share in [1e-3, 5e-3, 2e-3, 1e-3, 4e-3, 8e-4, 2e-3, 1e-3] {
            let ask = Ask { error_share, criterion: papers::study::CriterionKind::Uniform, ..Ask::usual(extent.cells) };
            player.adapt(&ask.of(&extent, &camera, camera.eye));
            let end = player.log.frame_ends.last().copied().unwrap_or(0);
            assert_eq!((player.at, end), (player.log.steps.len(), end));
        }
        assert!(!player.is_log_whole && player.log.steps.len() <= 700);
        let now = player.mesh();
        player.seek(0);
        assert!(!player.state.view.front.is_empty() && player.mesh() != now);
        player.seek(usize::MAX);
        assert!(player.mesh() == now);
    }
}
