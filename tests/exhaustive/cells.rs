//! Exact criteria and budgets on explicit models: brute force over every closed set.

use crate::{family, lattice};
use mt_core::model::{MultiTessellation, mesh_of};
use mt_core::{Explicit, Front, Mesh, NodeId, check};
use mt_tests::truth::{Cells, Truth};
use selective::{
    CellCriterion, CellView, ErrorBelow, Focus, Limits, Region, State, UniformError, adapt, approach, extract_exact,
};

fn small_models() -> impl Iterator<Item = (String, Explicit<3>)> {
    let kinds = ["edge-collapse", "half-edge-collapse"];
    let model = move |(name, mesh): (String, Mesh<3>)| {
        kinds
            .into_iter()
            .filter_map(move |kind| Some((format!("{name} {kind}"), family::history(&mesh, kind)?.explicit)))
    };
    family::meshes().into_iter().flat_map(model)
}

/// All closed sets, straight from the definition.
fn closed_sets(model: &Explicit<3>) -> Vec<Front> {
    let truth = Cells::new(model);
    let order = truth.order().expect("cells have an order");
    lattice::closed_sets(order, model.len()).into_iter().map(|set| lattice::front_of(set, model.len())).collect()
}

#[test]
fn exact_extraction_is_least_among_all_meshes_that_satisfy_the_criterion() {
    for (name, model) in small_models() {
        let sets = closed_sets(&model);
        let box_of = |size: f32| Region { low: glam::Vec3::splat(-0.1), high: glam::Vec3::splat(size) };
        let errors: Vec<f32> = (0..model.len()).map(|m| model.bound(NodeId(m)).error * 0.999).collect();
        for &error_max in &errors {
            for (region, focus) in
                [(None, Focus::Loose), (Some(box_of(1.0)), Focus::Loose), (Some(box_of(0.6)), Focus::Strict)]
            {
                let criterion = ErrorBelow { error_max, region, focus };
                let (state, _) = extract_exact(&model, &criterion, ());
                let least =
                    sets.iter().filter(|front| satisfies(&model, front, &criterion)).min_by_key(|front| front.len());
                assert_eq!(state.front(), least.expect("the input satisfies everything"), "{name} {criterion:?}");
            }
        }
    }
}

/// Whether every cell of a front's mesh that is not of the input satisfies the criterion.
fn satisfies(model: &Explicit<3>, front: &Front, criterion: &ErrorBelow) -> bool {
    let cells = check::set_algebra(model, front).expect("the front is closed");
    cells.into_iter().all(|cell| {
        let Some(m) = (0..model.len()).map(NodeId).find(|&m| model.coarse_side(m).any(|c| c == cell)) else {
            return true;
        };
        let corners = model.corners(cell).map(|v| model.positions()[v.index()]);
        criterion.holds(&CellView { corners, error: model.bound(m).error })
    })
}

#[test]
fn a_budget_is_never_overshot_and_a_still_camera_rests() {
    for (name, model) in small_models() {
        let criterion = UniformError { error_max: -1.0 };
        for start in closed_sets(&model).iter().step_by(7) {
            let mut state = State::new(&model, ());
            approach(&model, start, &mut state);
            for cells in 0..mesh_of(&model, &state.view.mesh).cell_count() as u32 + 3 {
                let limits = Limits { cells: Some(cells), time: None };
                adapt(&model, &criterion, &limits, &mut state);
                let most = cells.max(model.base_cells().len() as u32);
                assert!(state.cell_count(&model) <= most, "{name}: {} > {cells}", state.cell_count(&model));
                let again = adapt(&model, &criterion, &limits, &mut state);
                assert_eq!(again.refined + again.coarsened, 0, "{name}: not at rest at {cells}");
            }
        }
    }
}
