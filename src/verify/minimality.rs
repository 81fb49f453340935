//! Law 10: extract and adapt end in the least closure of the wish, for random criteria of every kind.

use glam::Vec3;
use mt_core::check::{Breach, Law, Random};
use mt_core::model::{MultiTessellation, View};
use mt_core::{Bound, Camera, Front, NodeId, Order};
use selective::{
    Criterion, InRegion, Limits, Region, ScreenError, State, Strategy, UniformError, Wish, adapt, extract, wish_closure,
};
use std::time::Duration;

/// A criterion drawn at random: uniform, in a region, or on a screen.
fn draw<const N: usize>(model: &impl MultiTessellation<N, Bound = Bound>, random: &mut Random) -> Wish {
    // A threshold that is some node's error, so that ties occur.
    let error_max = model.bound(NodeId::new(random.below(model.len() as usize))).error;
    let at = model.bound(NodeId::new(random.below(model.len() as usize))).center;
    let extent = model.bound(NodeId(model.len() - 1)).radius.max(f32::MIN_POSITIVE);
    let size = extent * random.unit() as f32;
    match random.below(3) {
        0 => Wish::Uniform(UniformError { error_max }),
        1 => Wish::Region(InRegion { region: Region { low: at - size, high: at + size }, error_max }),
        _ => {
            let from = Vec3::new(random.unit() as f32 - 0.5, random.unit() as f32 - 0.5, random.unit() as f32 - 0.5);
            let camera = Camera::around(at - size, at + size, from);
            Wish::Screen(Box::new(ScreenError::new(&camera, 20.0 * random.unit() as f32)))
        }
    }
}

/// Law 10 from the front of `view`: adapt from there, extract by both strategies, and the least closure of the wish all
/// give one front; under a budget, no front is too large and a second call changes nothing. O(front + closure).
pub fn minimality<const N: usize, M: MultiTessellation<N, Bound = Bound>>(
    model: &M,
    order: &Order,
    view: &View<M::Mesh>,
    random: &mut Random,
) -> Result<(), Breach> {
    if model.is_empty() {
        return Ok(());
    }
    let criterion = draw(model, random);
    let wish = wish_closure(model, &criterion);
    let breach = |what: String| Breach { law: Law::Minimality, what, node: None };
    for strategy in [Strategy::TopDown, Strategy::Priority] {
        let (state, outcome) = extract(model, &criterion, &Limits::NONE, strategy, ());
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
    adapt(model, &criterion, &Limits::NONE, &mut state);
    if *state.front() != wish {
        let (extra, missing) = (state.front().difference(&wish).next(), wish.difference(state.front()).next());
        return Err(breach(format!(
            "adapt ends in {} nodes, the least closure has {}; extra: {extra:?}, missing: {missing:?}",
            state.front().len(),
            wish.len()
        )));
    }
    closed(order, state.front())?;
    budget(model, order, &criterion, state, random)
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
