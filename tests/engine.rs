//! The engine from outside: sinks, logs, interruption, budgets without known gains, two cameras on one model.

use mt_core::check::Mirror;
use mt_core::model::{MultiTessellation, cells_of};
use mt_core::{Camera, Explicit, Front, NodeId, check, generate};
use mt_tests::{Answering, Answers, model_of};
use operators::EdgeCollapse;
use selective::{Limits, ScreenError, State, Strategy, UniformError, adapt, extract};
use std::time::Duration;

fn model() -> Explicit<3> {
    model_of(&generate::bumpy_sphere(4, 0.15, 9), &EdgeCollapse::FULL)
}

fn cameras(model: &Explicit<3>, count: u32) -> Vec<Camera> {
    let (low, high) = model.reference().bounding_box().unwrap();
    let turn = |i: u32| i as f32 / count as f32 * std::f32::consts::TAU;
    let camera =
        |i: u32| Camera { near: 0.05, ..Camera::around(low, high, glam::Vec3::new(turn(i).sin(), 0.3, turn(i).cos())) };
    (0..count).map(camera).collect()
}

#[test]
fn a_sink_can_mirror_the_mesh() {
    let model = model();
    let mut state = State::new(&model, Mirror::default());
    for camera in cameras(&model, 12) {
        adapt(&model, &ScreenError::new(&camera, 4.0), &Limits::NONE, &mut state);
        assert_eq!(state.sink.cells().unwrap(), cells_of(&model, &state.view.mesh));
    }
}

#[test]
fn rolling_back_the_log_undoes_everything() {
    let model = model();
    let mut state = State::new(&model, Mirror::default());
    let before = state.view.clone();
    for camera in cameras(&model, 5) {
        adapt(&model, &ScreenError::new(&camera, 3.0), &Limits::NONE, &mut state);
    }
    assert!(state.steps.len() > 100);
    state.roll_back(&model, 0);
    assert!(state.view == before && state.steps.is_empty());
}

#[test]
fn without_time_the_mesh_stays_legal_and_the_next_calls_finish() {
    let model = model();
    let criterion = UniformError { error_max: 0.0 };
    let (full, _) = extract(&model, &criterion, &Limits::NONE, Strategy::TopDown, ());
    let mut state = State::new(&model, ());
    let limits = Limits { cells: None, time: Some(Duration::ZERO) };
    let mut calls = 0;
    while !adapt(&model, &criterion, &limits, &mut state).complete {
        assert!(model.order().is_closed(state.front()));
        calls += 1;
        assert!(calls < 1000, "interrupted calls make no progress");
    }
    assert!(calls > 2, "the work was not interrupted");
    assert_eq!(state.front(), full.front());
}

#[test]
fn two_cameras_on_two_threads_share_one_model() {
    let model = model();
    let views = cameras(&model, 8);
    let walk = |from: usize| {
        let mut state = State::new(&model, ());
        let fronts = (0..8).map(|i| {
            adapt(&model, &ScreenError::new(&views[(from + i) % 8], 3.0), &Limits::NONE, &mut state);
            state.front().clone()
        });
        fronts.collect::<Vec<Front>>()
    };
    let (one, other) = std::thread::scope(|scope| {
        let (one, other) = (scope.spawn(|| walk(0)), scope.spawn(|| walk(4)));
        (one.join().unwrap(), other.join().unwrap())
    });
    // What a camera sees does not depend on where it came from.
    assert!((0..8).all(|i| one[i] == other[(i + 4) % 8]));
}

/// A model that does not know in advance what refining wins.
struct GainUnknown;

impl Answers for GainUnknown {
    fn gain(&self, _: &Explicit<3>, _: NodeId) -> Option<i32> {
        None
    }
}

#[test]
fn a_budget_is_kept_by_counting_or_by_rolling_back_alike() {
    let known = model();
    let unknown = Answering { model: known.clone(), answers: GainUnknown };
    for camera in cameras(&known, 6) {
        for cells in [4, 10, 101, 333, 2000] {
            let criterion = ScreenError::new(&camera, 0.0);
            let limits = Limits { cells: Some(cells), time: None };
            let (counted, one) = extract(&known, &criterion, &limits, Strategy::Priority, ());
            let (rolled_back, two) = extract(&unknown, &criterion, &limits, Strategy::Priority, ());
            assert!(counted.cell_count(&known) <= cells);
            assert_eq!(counted.front(), rolled_back.front());
            assert_eq!(one, two);
        }
    }
}

#[test]
fn a_view_dependent_mesh_is_smaller_than_a_uniform_one_and_conforms() {
    let model = model();
    let domain = check::conformity(&model).unwrap();
    let (low, high) = model.reference().bounding_box().unwrap();
    // Close to one side, and the far plane before the other: most of the sphere is out of sight.
    let eye = glam::Vec3::new(0.0, 0.0, high.z + 0.2);
    let camera = Camera {
        eye,
        target: eye - glam::Vec3::Z,
        near: 0.01,
        far: 1.0,
        fov_y_degrees: 20.0,
        ..Camera::around(low, high, glam::Vec3::Z)
    };
    let (seen, _) = extract(&model, &ScreenError::new(&camera, 1.0), &Limits::NONE, Strategy::TopDown, ());
    let corners: Vec<_> = cells_of(&model, &seen.view.mesh).into_iter().map(|(_, corners)| corners).collect();
    check::crack_free(&corners, model.positions(), &domain, &domain.boundary_at(seen.front())).unwrap();
    assert!(corners.len() * 2 < model.reference().cell_count(), "{} cells", corners.len());
}
