//! How long the work takes: building, loading, extracting, adapting along a camera path.
//!
//! `cargo bench` runs all of it on a generated terrain of a million triangles, in some minutes. A word after `--` chooses
//! what has it in its name: `cargo bench -- adapting`. Two variables say what it runs on:
//!
//! - `MT_BENCH_TRIANGLES`: about how many triangles the terrain has, 1000000 if not set; 0 leaves it out;
//! - `MT_BENCH_FILES`: meshes to run on as well, parted by colons; sheets are separated where they are not manifold.
//!
//! `MT_BENCH_TRIANGLES=20000 cargo test --bench speed` runs each once, to see that it works.

mod subjects;

use criterion::{BenchmarkGroup, Criterion, SamplingMode, Throughput, criterion_group, criterion_main, measurement};
use mt_core::analysis::{Options, simplify};
use mt_core::container;
use mt_core::{Explicit, MultiTessellation};
use operators::EdgeCollapse;
use papers::study::camera_path;
use selective::{Limits, ScreenError, State, Strategy, UniformError, Wish, adapt, extract};
use std::hint::black_box;
use std::time::Duration;
use subjects::{Subject, subjects};

/// Frames of the camera path, once around.
const FRAMES: u32 = 60;
/// Pixels of error on the screen.
const PIXELS: f32 = 1.0;

/// A group of few samples, each of one run: the work is long, and varies little.
fn group<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, measurement::WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(5));
    group
}

fn building(criterion: &mut Criterion) {
    for subject in subjects() {
        let mut group = group(criterion, &format!("building/{}", subject.name));
        group.throughput(Throughput::Elements(subject.mesh.cell_count() as u64));
        for (name, operator) in [("edge-collapse", EdgeCollapse::FULL), ("half-edge-collapse", EdgeCollapse::HALF)] {
            group.bench_function(name, |bencher| {
                bencher.iter_with_large_drop(|| simplify(&subject.mesh, &operator, &Options::default(), &mut |_| true));
            });
        }
    }
}

fn loading(criterion: &mut Criterion) {
    for subject in subjects() {
        let bytes = subject.container();
        let mut group = group(criterion, &format!("loading/{}", subject.name));
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function("mt", |bencher| {
            bencher.iter_with_large_drop(|| container::read::<3>(black_box(bytes)).expect("a model"));
        });
    }
}

/// What is asked of a model, by name: from the base mesh as it is, or the least error that a budget allows.
fn queries(subject: &Subject) -> [(&'static str, Wish, Limits); 3] {
    let camera = camera_path(&subject.mesh, FRAMES)[FRAMES as usize / 2];
    let error_max = subject.mesh.diagonal() as f32 * 2e-4;
    let cells = Some(subject.mesh.cell_count() as u32 / 10);
    let screen = |pixels| Wish::Screen(Box::new(ScreenError::new(&camera, pixels)));
    [
        ("uniform", Wish::Uniform(UniformError { error_max }), Limits::NONE),
        ("screen", screen(PIXELS), Limits::NONE),
        ("budget", screen(0.0), Limits { cells, time: None }),
    ]
}

fn extracting(criterion: &mut Criterion) {
    for subject in subjects() {
        let model = subject.model();
        let mut group = group(criterion, &format!("extracting/{}", subject.name));
        for (name, wish, limits) in queries(subject) {
            for (sequence, strategy) in [("top-down", Strategy::TopDown), ("priority", Strategy::Priority)] {
                // A budget is met by priority either way.
                if limits.cells.is_some() && strategy == Strategy::TopDown {
                    continue;
                }
                let (state, _) = extract(model, &wish, &limits, strategy, ());
                group.throughput(Throughput::Elements(u64::from(state.cell_count(model))));
                group.bench_function(format!("{name}/{sequence}"), |bencher| {
                    bencher.iter_with_large_drop(|| extract(model, &wish, &limits, strategy, ()));
                });
            }
        }
    }
}

/// Once around the model and back to where the path began, so that each run starts from the state it ends in.
fn around(model: &Explicit<3>, path: &[(Wish, Limits)], state: &mut State<3, Explicit<3>, ()>) -> u32 {
    let mut steps = 0;
    for (wish, limits) in path {
        state.steps.clear();
        let outcome = adapt(model, wish, limits, state);
        steps += outcome.refined + outcome.coarsened;
    }
    steps
}

fn adapting(criterion: &mut Criterion) {
    for subject in subjects() {
        let model = subject.model();
        let mut group = group(criterion, &format!("adapting/{}", subject.name));
        group.throughput(Throughput::Elements(u64::from(FRAMES)));
        let cells = Some(subject.mesh.cell_count() as u32 / 10);
        for (name, pixels, limits) in [("screen", PIXELS, Limits::NONE), ("budget", 0.0, Limits { cells, time: None })]
        {
            let wish = |camera| (Wish::Screen(Box::new(ScreenError::new(camera, pixels))), limits);
            let path: Vec<_> = camera_path(&subject.mesh, FRAMES).iter().map(wish).collect();
            group.bench_function(format!("{name}/{FRAMES}-frames"), |bencher| {
                let mut state = State::new(model, ());
                around(model, &path, &mut state);
                bencher.iter(|| around(model, &path, &mut state));
            });
        }
        debug_assert!(!model.is_empty());
    }
}

criterion_group!(speed, building, loading, extracting, adapting);
criterion_main!(speed);
