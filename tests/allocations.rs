//! The steady state allocates nothing: a camera path is followed twice, and the second time is counted.

use mt_core::hierarchy::Dependency;
use mt_core::{Camera, Hierarchy, MultiTessellation, generate};
use mt_tests::{both_of, replay_of};
use operators::EdgeCollapse;
use operators::order::{DualPieceFree, ImplicitIds, Stored};
use selective::{Limits, ScreenError, State, adapt};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn cameras() -> Vec<Camera> {
    let turn = |i: u32| i as f32 / 40.0 * std::f32::consts::TAU;
    let from = |i: u32| glam::Vec3::new(turn(i).sin(), 0.3, turn(i).cos());
    (0..40).map(|i| Camera { near: 0.05, ..Camera::around(-glam::Vec3::ONE, glam::Vec3::ONE, from(i)) }).collect()
}

fn follows_without_allocating<M: MultiTessellation<3, Bound = mt_core::Bound>>(name: &str, model: &M) {
    follows_within(&Limits::NONE, name, model);
    follows_within(&Limits { cells: Some(2000), time: None }, &format!("{name}, budget"), model);
}

fn follows_within<M: MultiTessellation<3, Bound = mt_core::Bound>>(limits: &Limits, name: &str, model: &M) {
    let mut state = State::new(model, ());
    let mut lap = |steps: &mut usize| {
        for camera in cameras() {
            adapt(model, &ScreenError::new(&camera, 0.3), limits, &mut state);
            *steps += state.steps.len();
            state.steps.clear();
        }
    };
    let mut steps = 0;
    // Two laps warm up: the first begins at the base mesh.
    (0..2).for_each(|_| lap(&mut steps));
    let cameras_cost = {
        let region = Region::new(COUNTED);
        drop(cameras());
        region.change().allocations
    };
    steps = 0;
    let region = Region::new(COUNTED);
    lap(&mut steps);
    let change = region.change();
    assert!(steps > 100, "{name}: {steps} steps are no test");
    let allocations = change.allocations + change.reallocations - cameras_cost;
    assert_eq!(allocations, 0, "{name}: {allocations} allocations in {steps} steps");
}

fn hierarchy<D: Dependency + Send>(name: &str, replay: &std::sync::Arc<mt_core::Replay>, dependency: D) {
    follows_without_allocating(name, &Hierarchy { replay: std::sync::Arc::clone(replay), dependency });
}

// One test, since the allocator counts for the whole process.
#[test]
fn following_a_camera_allocates_nothing() {
    let mesh = generate::bumpy_sphere(5, 0.1, 3);
    let (explicit, replay) = both_of(&mesh, &EdgeCollapse::FULL);
    follows_without_allocating("cells", &explicit);
    hierarchy("dual-piece", &replay, Stored::dual_piece(&replay).unwrap());
    hierarchy("four-face", &replay, Stored::four_face(&replay).unwrap());
    hierarchy("implicit-ids", &replay, ImplicitIds);
    hierarchy("dual-piece-free", &replay, DualPieceFree::new(&replay).unwrap());
    let fans = replay_of(&mesh, &"fan-merge".parse().unwrap());
    hierarchy("fans", &fans, Stored::dual_piece(&fans).unwrap());
}
