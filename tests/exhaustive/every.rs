//! Explicit models, tetrahedra and hierarchies under every scheme: all their fronts, all steps, every tie.

use crate::family;
use crate::lattice::{Lattice, Mask, closed_sets, explore, front_of, hold, mask_of, set_of};
use mt_core::check::{self, Domain};
use mt_core::hierarchy::Dependency;
use mt_core::model::{MultiTessellation, View, cells_of};
use mt_core::{Bound, Explicit, Hierarchy, NodeId, Rule};
use mt_tests::History;
use mt_tests::truth::{Cells, Merges, Set, Truth, UnderScheme};
use operators::order::{Scheme, Visit};
use selective::{Limits, State, Strategy, UniformError, adapt, extract};
use std::sync::Arc;

/// How many fronts and steps were seen.
#[derive(Default, Debug)]
struct Seen {
    models: usize,
    fronts: usize,
    steps: usize,
    extractions: usize,
}

/// Everything about a model: its fronts, and what the engine makes of each error from wherever it starts.
fn judge<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    truth: &impl Truth<N>,
    seen: &mut Seen,
    crack_free: impl Fn(&View<M::Mesh>) -> Result<(), String>,
) -> Result<(), String> {
    let lattice = explore(model, truth)?;
    let full: Mask = (1 << model.len()) - 1;
    hold(lattice.meshes.contains_key(&full), || "the input is not reached".into())?;
    for (&mask, mesh) in &lattice.meshes {
        crack_free(&View { front: front_of(mask, model.len()), mesh: mesh.clone() })?;
    }
    seen.models += 1;
    seen.fronts += lattice.meshes.len();
    seen.steps += lattice.steps;
    if let Some(order) = truth.order() {
        let mut reached: Vec<Mask> = lattice.meshes.keys().copied().collect();
        reached.sort_unstable();
        hold(reached == closed_sets(order, model.len()), || "what is reached is not what is closed".into())?;
    }
    ask(model, truth, &lattice, seen)
}

/// Thresholds at every error, a hair to either side, and beyond all.
fn thresholds(bounds: &[Bound]) -> Vec<f32> {
    let mut errors: Vec<f32> = bounds.iter().flat_map(|b| [b.error, b.error.next_up(), b.error.next_down()]).collect();
    errors.extend([-1.0, f32::MAX]);
    errors.sort_by(f32::total_cmp);
    errors.dedup();
    errors
}

/// Extracts and adapts at every threshold, from every front.
fn ask<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    truth: &impl Truth<N>,
    lattice: &Lattice<M::Mesh>,
    seen: &mut Seen,
) -> Result<(), String> {
    let bounds: Vec<Bound> = (0..model.len()).map(|m| model.bound(NodeId(m))).collect();
    for error_max in thresholds(&bounds) {
        let asked: Set = bounds.iter().map(|bound| bound.error > error_max).collect();
        let criterion = UniformError { error_max };
        let judge = |state: &State<N, M, ()>, complete: bool| judge_asked(model, truth, &asked, state, complete);
        for strategy in [Strategy::TopDown, Strategy::Priority] {
            let (state, outcome) = extract(model, &criterion, &Limits::NONE, strategy, ());
            judge(&state, outcome.complete).map_err(|what| format!("{strategy:?} at {error_max}: {what}"))?;
        }
        for (&mask, mesh) in &lattice.meshes {
            let mut state = State::new(model, ());
            state.view = View { front: front_of(mask, model.len()), mesh: mesh.clone() };
            let outcome = adapt(model, &criterion, &Limits::NONE, &mut state);
            judge(&state, outcome.complete).map_err(|what| format!("from {mask:b} at {error_max}: {what}"))?;
            seen.extractions += 1;
        }
    }
    Ok(())
}

/// What was asked for is refined; under an order, with what that needs and no more.
fn judge_asked<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    truth: &impl Truth<N>,
    asked: &[bool],
    state: &State<N, M, ()>,
    complete: bool,
) -> Result<(), String> {
    let refined = set_of(mask_of(state.front()), model.len());
    let right = match truth.order() {
        Some(order) => refined == order.closure(asked),
        None => (0..refined.len()).all(|m| refined[m] || !asked[m]),
    };
    hold(right && complete, || format!("{asked:?} is asked for, {refined:?} refined, complete: {complete}"))?;
    hold(cells_of(model, &state.view.mesh) == truth.mesh(&refined), || format!("{refined:?} has another mesh"))
}

fn on_cells<const N: usize>(model: &Explicit<N>, joins: bool, seen: &mut Seen) -> Result<(), String> {
    // A pair may join sheets, so that its input is a manifold says nothing of its other meshes.
    let domain = if joins { check::conformity_of_quotient(model) } else { check::conformity(model) };
    let domain = domain.map_err(|breach| breach.to_string())?;
    judge(model, &Cells::new(model), seen, |view| {
        let corners: Vec<_> = cells_of(model, &view.mesh).into_iter().map(|(_, corners)| corners).collect();
        let boundary = domain.boundary_at(&view.front);
        check::crack_free(&corners, model.positions(), &domain, &boundary).map_err(|breach| breach.to_string())
    })
}

/// A scheme on a history.
struct Under<'a> {
    truth: UnderScheme,
    seen: &'a mut Seen,
}

impl Visit for Under<'_> {
    type Output = Result<(), String>;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Self::Output {
        let replay = &model.replay;
        let told = self.truth.order().is_some();
        hold(told == (D::RULE == Rule::Static), || "what is told of the rule is not what it says of itself".into())?;
        let mut domain = Domain { content: None, ..Domain::of_mesh(&replay.reference()) };
        if !replay.is_manifold() {
            (domain.manifold, domain.oriented) = (false, false);
        }
        judge(model, &self.truth, self.seen, |view| {
            let corners: Vec<_> = cells_of(model, &view.mesh).into_iter().map(|(_, corners)| corners).collect();
            let boundary = check::boundary_chain(replay, &view.front);
            check::crack_free(&corners, model.positions(), &domain, &boundary).map_err(|breach| breach.to_string())
        })
    }
}

fn on_histories(each: impl Fn(&History, &mut Seen) -> Result<(), String>) -> Seen {
    let mut seen = Seen::default();
    for (name, mesh) in family::meshes() {
        for operator in family::OPERATORS {
            let Some(history) = family::history(&mesh, operator) else { continue };
            each(&history, &mut seen).unwrap_or_else(|what| panic!("{name}, {operator}: {what}"));
        }
    }
    println!("{seen:?}");
    seen
}

fn on_scheme(history: &History, scheme: Scheme, seen: &mut Seen) -> Result<(), String> {
    let merges = Arc::new(Merges::new(&history.mesh, &history.links, &history.sequence));
    let judged = scheme.visit(&history.replay(), Under { truth: UnderScheme::new(merges, scheme), seen });
    // A scheme may refuse a history: of pairs, or of fans.
    judged.unwrap_or(Ok(())).map_err(|what| format!("{scheme}: {what}"))
}

#[test]
fn every_front_of_every_explicit_model() {
    let seen = on_histories(|history, seen| on_cells(&history.explicit, !history.links.is_empty(), seen));
    assert!(seen.models > 200 && seen.fronts > 2_000, "{seen:?}");
}

#[test]
fn every_front_of_tetrahedra() {
    let mut seen = Seen::default();
    for (name, model) in family::tetrahedral() {
        on_cells(&model, false, &mut seen).unwrap_or_else(|what| panic!("{name}: {what}"));
    }
    assert!(seen.fronts > 100, "{seen:?}");
}

#[test]
fn every_front_under_every_static_scheme() {
    let schemes = || Scheme::ALL.into_iter().filter(|scheme| scheme.is_static());
    let seen = on_histories(|history, seen| schemes().try_for_each(|scheme| on_scheme(history, scheme, seen)));
    assert!(seen.models > 900 && seen.fronts > 50_000, "{seen:?}");
}

#[test]
fn every_valid_front_under_every_dynamic_rule() {
    // Stored ids are unsound, as `orders` shows; the other rules are held to everything.
    let rules = [Scheme::ImplicitIds, Scheme::DualPieceFree];
    let seen = on_histories(|history, seen| rules.into_iter().try_for_each(|scheme| on_scheme(history, scheme, seen)));
    assert!(seen.models > 300 && seen.fronts > 30_000, "{seen:?}");
}
