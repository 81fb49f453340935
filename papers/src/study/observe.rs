//! Extraction along the camera path under one dependency, for every criterion and strategy.

use super::choices::{Query, Scene, is_sensible};
use super::features::folds;
use super::{DependencyKind, Observation, Ordered, Results, Steps, StrategyKind, StudyError};
use crate::bench::nanoseconds_a_step;
use mt_core::hierarchy::Dependency;
use mt_core::model::cells_of;
use mt_core::{Bits, Bound, Cell, CellId, Hierarchy, MultiTessellation, Rule, Sink, check};
use operators::order::Visit;
use selective::{Hysteresis, OnPath, Outcome, State, Strategy, adapt, extract};
use std::time::Instant;

/// Folds are counted in every so many frames.
const FOLDS_EVERY: usize = 10;

/// Counts the triangles that steps touch.
#[derive(Clone, Copy, Debug, Default)]
struct Touched(u32);

impl Sink<3> for Touched {
    #[inline]
    fn kill(&mut self, _: CellId) {
        self.0 += 1;
    }
    #[inline]
    fn make(&mut self, _: CellId, _: Cell<3>) {
        self.0 += 1;
    }
    #[inline]
    fn relabel(&mut self, _: CellId, _: Cell<3>) {
        self.0 += 1;
    }
}

/// Observes a model under one dependency: all sensible combinations of the rest.
pub(super) struct Observe<'a, 'b> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) operator: &'a str,
    pub(super) dependency: DependencyKind,
    pub(super) has_runs: bool,
    /// When deriving the dependency began.
    pub(super) begun: Instant,
    pub(super) results: &'a mut Results,
    pub(super) steps: &'a mut Steps<'b>,
}

impl Visit for Observe<'_, '_> {
    type Output = Result<(), StudyError>;

    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Self::Output {
        self.model(model, model.bytes())
    }
}

impl Observe<'_, '_> {
    /// Observes any model of so many bytes.
    pub(super) fn model<M: MultiTessellation<3, Bound = Bound>>(
        mut self,
        model: &M,
        bytes: usize,
    ) -> Result<(), StudyError> {
        let seconds = self.begun.elapsed().as_secs_f64();
        self.note_order(model, bytes, seconds)?;
        let config = self.scene.config;
        for &criterion in &config.criteria {
            for &strategy in &config.strategies {
                if is_sensible(self.dependency, criterion, strategy, self.has_runs) {
                    self.steps.go_on(&self.scene.subject.name)?;
                    self.follow(model, criterion, strategy);
                }
            }
        }
        Ok(())
    }

    /// What the order is by itself, and how fast it steps.
    fn note_order<M: MultiTessellation<3, Bound = Bound>>(
        &mut self,
        model: &M,
        bytes: usize,
        seconds: f64,
    ) -> Result<(), StudyError> {
        let subject = self.scene.subject;
        let order = check::order_of(model).map_err(|breach| StudyError::Law(subject.name.clone(), breach))?;
        // What a hierarchy stores are the needs besides parents; the explicit model stores none, they follow from cells.
        let mut roots = Vec::new();
        model.roots(&mut roots);
        let parents = model.len() as usize - roots.len();
        let begun = Instant::now();
        let wall = || begun.elapsed().as_secs_f64();
        let is_stored = M::RULE == Rule::Static && self.dependency != DependencyKind::Cells;
        self.results.ordered.push(Ordered {
            model: subject.name.clone(),
            operator: self.operator.to_owned(),
            dependency: self.dependency.name(),
            is_static: M::RULE == Rule::Static,
            arcs: order.arc_count(),
            beyond_forest: is_stored.then(|| order.arc_count() - parents),
            depth: order.depth(),
            bytes_per_vertex: bytes as f64 / subject.mesh.vertex_count().max(1) as f64,
            seconds,
            nanoseconds_a_step: (0..3).map(|_| nanoseconds_a_step(model, &wall)).fold(f64::INFINITY, f64::min),
        });
        Ok(())
    }

    /// One criterion and strategy along the whole path.
    fn follow<M: MultiTessellation<3, Bound = Bound>>(
        &mut self,
        model: &M,
        criterion: super::CriterionKind,
        strategy: StrategyKind,
    ) {
        let mut state = State::new(model, Touched::default());
        let mut seen = Bits::new(model.positions().len() as u32);
        for frame in 0..self.scene.cameras.len() {
            let query = self.scene.query(criterion, frame);
            let before = state.front().clone();
            state.steps.clear();
            state.sink = Touched::default();
            let begun = Instant::now();
            let outcome = self.answer(model, &query, strategy, frame, &mut state);
            let seconds = begun.elapsed().as_secs_f64();
            let mut chains: Vec<u32> = state.chains().to_vec();
            chains.sort_unstable();
            let chain_p95 = chains.get(chains.len().saturating_sub(1) * 95 / 100).copied().unwrap_or(0);
            let is_counted = frame % FOLDS_EVERY == 0 && strategy == StrategyKind::Incremental;
            let turned = before.difference(state.front()).count() + state.front().difference(&before).count();
            self.results.observations.push(Observation {
                model: self.scene.subject.name.clone(),
                operator: self.operator.to_owned(),
                dependency: self.dependency.name(),
                criterion: criterion.name(),
                strategy: strategy.name(),
                frame: frame as u32,
                vertices: vertex_count(model, &state, &mut seen),
                triangles: state.cell_count(model),
                refined: outcome.refined,
                coarsened: outcome.coarsened,
                forced: outcome.forced,
                chain_p95,
                chain_max: outcome.chain_max,
                fan_steps: outcome.runs,
                edge_steps: outcome.singles,
                changed: turned as u32,
                touched: state.sink.0,
                folds: is_counted.then(|| {
                    let cells: Vec<_> = cells_of(model, &state.view.mesh).into_iter().map(|(_, cell)| cell).collect();
                    folds(&cells, model.positions())
                }),
                seconds,
            });
        }
    }

    fn answer<M: MultiTessellation<3, Bound = Bound>>(
        &self,
        model: &M,
        query: &Query,
        strategy: StrategyKind,
        frame: usize,
        state: &mut State<3, M, Touched>,
    ) -> Outcome {
        let wish = &query.criterion;
        let sequence = match strategy {
            StrategyKind::TopDown => Strategy::TopDown,
            StrategyKind::Priority => Strategy::Priority,
            StrategyKind::Incremental => return adapt(model, wish, &query.limits, state),
            StrategyKind::Hysteresis => {
                let margin = 0.5 * self.scene.config.error_px;
                return adapt(model, &Hysteresis { criterion: wish, margin }, &query.limits, state);
            }
            StrategyKind::Dual | StrategyKind::DualDistance | StrategyKind::Coarse => {
                let path = self.scene.path(strategy, frame);
                return adapt(model, &OnPath { criterion: wish, path }, &query.limits, state);
            }
        };
        let (fresh, outcome) = extract(model, wish, &query.limits, sequence, Touched::default());
        *state = fresh;
        outcome
    }
}

fn vertex_count<M: MultiTessellation<3>, S>(model: &M, state: &State<3, M, S>, seen: &mut Bits) -> usize {
    seen.clear();
    model.cells(&state.view.mesh, |_, corners| corners.iter().for_each(|v| _ = seen.insert(v.0)));
    seen.count() as usize
}
