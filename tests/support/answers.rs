//! A model some of whose answers are changed: for faults to be planted in, and for models that know less.

use glam::Vec3;
use mt_core::explicit::Alive;
use mt_core::model::{MultiTessellation, View};
use mt_core::{Bound, Cell, CellId, Coarsen, Explicit, NodeId, Rule, Sink};
use std::ops::RangeInclusive;

/// What a model answers, which is what an explicit model answers unless it is told otherwise.
#[allow(missing_docs, reason = "each is what MultiTessellation has under that name")]
pub trait Answers: Sync {
    fn cell_count(&self, model: &Explicit<3>, mesh: &Alive) -> u32 {
        model.cell_count(mesh)
    }
    fn children(&self, model: &Explicit<3>, m: NodeId, out: &mut Vec<NodeId>) {
        model.children(m, out);
    }
    fn bound(&self, model: &Explicit<3>, m: NodeId) -> Bound {
        model.bound(m)
    }
    fn gain(&self, model: &Explicit<3>, m: NodeId) -> Option<i32> {
        model.gain(m)
    }
    fn needs(&self, model: &Explicit<3>, m: NodeId, out: &mut Vec<NodeId>) {
        model.needs(m, out);
    }
    fn prerequisites(&self, model: &Explicit<3>, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) {
        model.prerequisites(m, view, out);
    }
    fn obstacles(&self, model: &Explicit<3>, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) -> Coarsen {
        model.obstacles(m, view, out)
    }
    fn run(&self, m: NodeId) -> RangeInclusive<NodeId> {
        m..=m
    }
    fn refine(&self, model: &Explicit<3>, m: NodeId, mesh: &mut Alive, sink: &mut impl Sink<3>) {
        model.refine(m, mesh, sink);
    }
    fn coarsen(&self, model: &Explicit<3>, m: NodeId, mesh: &mut Alive, sink: &mut impl Sink<3>) {
        model.coarsen(m, mesh, sink);
    }
}

/// An explicit model with other answers.
#[derive(Clone, Debug)]
pub struct Answering<A> {
    /// What it is.
    pub model: Explicit<3>,
    /// What it says.
    pub answers: A,
}

impl<A: Answers> MultiTessellation<3> for Answering<A> {
    type Mesh = Alive;
    type Bound = Bound;
    const RULE: Rule = Rule::Static;

    fn len(&self) -> u32 {
        self.model.len()
    }
    fn base(&self) -> Alive {
        self.model.base()
    }
    fn cells(&self, mesh: &Alive, each: impl FnMut(CellId, Cell<3>)) {
        self.model.cells(mesh, each);
    }
    fn cell_count(&self, mesh: &Alive) -> u32 {
        self.answers.cell_count(&self.model, mesh)
    }
    fn positions(&self) -> &[Vec3] {
        self.model.positions()
    }
    fn roots(&self, out: &mut Vec<NodeId>) {
        self.model.roots(out);
    }
    fn children(&self, m: NodeId, out: &mut Vec<NodeId>) {
        self.answers.children(&self.model, m, out);
    }
    fn bound(&self, m: NodeId) -> Bound {
        self.answers.bound(&self.model, m)
    }
    fn gain(&self, m: NodeId) -> Option<i32> {
        self.answers.gain(&self.model, m)
    }
    fn needs(&self, m: NodeId, out: &mut Vec<NodeId>) {
        self.answers.needs(&self.model, m, out);
    }
    fn prerequisites(&self, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) {
        self.answers.prerequisites(&self.model, m, view, out);
    }
    fn obstacles(&self, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) -> Coarsen {
        self.answers.obstacles(&self.model, m, view, out)
    }
    fn run(&self, m: NodeId) -> RangeInclusive<NodeId> {
        self.answers.run(m)
    }
    fn refine(&self, m: NodeId, mesh: &mut Alive, sink: &mut impl Sink<3>) {
        self.answers.refine(&self.model, m, mesh, sink);
    }
    fn coarsen(&self, m: NodeId, mesh: &mut Alive, sink: &mut impl Sink<3>) {
        self.answers.coarsen(&self.model, m, mesh, sink);
    }
}
