//! Every closed set of small models: brute force against the order, the engine and the laws.

use mt_core::analysis::{Options, simplify};
use mt_core::generate;
use mt_core::model::{MultiTessellation, cells_of, mesh_of};
use mt_core::{Explicit, Front, Mesh, NodeId, check};
use operators::EdgeCollapse;
use selective::{
    CellCriterion, CellView, ErrorBelow, Focus, Limits, Region, State, Strategy, UniformError, adapt, approach,
    extract, extract_exact, wish_closure,
};

/// Models of at most 18 modifications, from small meshes of several kinds.
fn small_models() -> Vec<(String, Explicit<3>)> {
    let meshes: Vec<(&str, Mesh<3>)> = vec![
        ("octahedron", generate::octahedron()),
        ("icosahedron", generate::icosahedron()),
        ("grid", generate::bumpy_grid(3, 3, 0.3, 5)),
        ("cylinder", generate::cylinder(6, 2)),
        ("cube", generate::sharp_box(2)),
        ("moebius", generate::moebius(9)),
        ("ball", generate::bumpy_sphere(2, 0.1, 2)),
        ("slab", generate::bumpy_grid(5, 4, 0.2, 8)),
        ("strip", generate::strip(7)),
        ("annulus", generate::annulus(6, 1)),
        ("torus", generate::torus(5, 4)),
        ("two", generate::components(&[generate::octahedron(), generate::grid(2, 2)])),
    ];
    let mut models = Vec::new();
    for (name, mesh) in meshes {
        for (kind, operator) in [("full", EdgeCollapse::FULL), ("half", EdgeCollapse::HALF)] {
            // A collapse takes two triangles at the most, so this is at most 13 modifications, or 18 on boundaries.
            let until_cells = Some((mesh.cell_count() as u32).saturating_sub(26));
            let options = Options { until_cells, ..Options::default() };
            let model = simplify(&mesh, &operator, &options, &mut |_| true).expect("the meshes are manifolds").model;
            assert!(model.len() <= 18, "{name} has {} modifications", model.len());
            models.push((format!("{name} {kind}"), model));
        }
    }
    models
}

/// All closed sets, straight from the definition.
fn closed_sets(model: &Explicit<3>) -> Vec<Front> {
    let mut needs = vec![0u32; model.len() as usize];
    let mut row = Vec::new();
    for m in 0..model.len() {
        row.clear();
        model.needs(NodeId(m), &mut row);
        needs[m as usize] = row.iter().map(|n| 1 << n.0).sum();
    }
    let closed = |set: u32| (0..model.len()).all(|m| set >> m & 1 == 0 || needs[m as usize] & !set == 0);
    let front = |set: u32| Front::from_nodes(model.len(), (0..model.len()).filter(|m| set >> m & 1 == 1).map(NodeId));
    (0..1u32 << model.len()).filter(|&set| closed(set)).map(front).collect()
}

#[test]
fn every_closed_set_is_a_mesh_without_cracks() {
    let mut count = 0;
    for (name, model) in small_models() {
        let domain = check::conformity(&model).unwrap_or_else(|breach| panic!("{name}: {breach}"));
        for front in closed_sets(&model) {
            let mut state = State::new(&model, ());
            approach(&model, &front, &mut state);
            let cells = cells_of(&model, &state.view.mesh);
            let algebra = check::set_algebra(&model, &front).unwrap_or_else(|breach| panic!("{name}: {breach}"));
            assert!(algebra.iter().eq(cells.iter().map(|(id, _)| id)), "{name}: the mesh is not what set algebra says");
            let corners: Vec<_> = cells.iter().map(|(_, corners)| *corners).collect();
            check::crack_free(&corners, model.positions(), &domain, &domain.boundary_at(&front))
                .unwrap_or_else(|breach| panic!("{name}: {breach}"));
            count += 1;
        }
    }
    assert!(count > 2_000, "only {count} closed sets were seen");
}

#[test]
fn extract_and_adapt_are_least_among_all_closed_sets() {
    for (name, model) in small_models() {
        let sets = closed_sets(&model);
        let mut errors: Vec<f32> = (0..model.len()).map(|m| model.bound(NodeId(m)).error).collect();
        // Thresholds at every error, below and above all of them.
        errors.extend([-1.0, f32::MAX]);
        for error_max in errors {
            let criterion = UniformError { error_max };
            let asked = |front: &&Front| {
                (0..model.len()).all(|m| model.bound(NodeId(m)).error <= error_max || front.is_refined(NodeId(m)))
            };
            let least =
                sets.iter().filter(asked).min_by_key(|front| front.len()).expect("the full set satisfies every wish");
            for strategy in [Strategy::TopDown, Strategy::Priority] {
                let (state, _) = extract(&model, &criterion, &Limits::NONE, strategy, ());
                assert_eq!(state.front(), least, "{name} {strategy:?} at {error_max}");
            }
            assert_eq!(wish_closure(&model, &criterion), *least, "{name} at {error_max}");
            for start in sets.iter().step_by(sets.len() / 50 + 1) {
                let mut state = State::new(&model, ());
                approach(&model, start, &mut state);
                adapt(&model, &criterion, &Limits::NONE, &mut state);
                assert_eq!(state.front(), least, "{name}: adapt at {error_max}");
            }
        }
    }
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
