//! Measuring a model that has been built.

use super::row::{Frames, Quality, Steps};
use crate::distance::{Sampling, Surface};
use crate::study::camera_path;
use mt_core::model::{Step, mesh_of, take};
use mt_core::{Bound, Camera, Cell, CellId, Coarsen, Mesh, MultiTessellation, NodeId, Sink};
use selective::{Facing, Limits, ScreenError, State, Strategy, UniformError, adapt, extract};
use std::hint::black_box;
use std::time::Instant;

/// The clock of the process: CPU seconds of all its threads.
pub type Meter<'a> = &'a dyn Fn() -> f64;

/// Shares of the input's triangles at which distances are measured.
const SHARES: [f64; 3] = [0.5, 0.1, 0.01];
/// Rounds of which the fastest counts.
const ROUNDS: u32 = 3;
/// Nodes of the front of which a hundredth changes.
const FRONT: u32 = 20_000;
/// Adaptations to a small change that are timed.
const CHANGES: u32 = 20;
/// Largest error on the screen along the path.
const PIXELS: f32 = 1.0;

/// Measures steps and frames of a model, and where samples are asked for its distances from the input.
pub fn measure<M: MultiTessellation<3, Bound = Bound>>(
    model: &M,
    input: &Mesh<3>,
    frames: u32,
    samples: usize,
    meter: Meter<'_>,
) -> (Vec<Quality>, Option<Steps>, Option<Frames>) {
    let steps = (!model.is_empty()).then(|| steps(model, meter));
    let frames = (frames > 0 && !model.is_empty()).then(|| follow(model, input, frames, meter));
    let quality = if samples > 0 { qualities(model, input, samples) } else { Vec::new() };
    (quality, steps, frames)
}

/// Sums up what it hears, so that hearing costs what the least of listeners costs.
#[derive(Default)]
struct Heard(u64);

impl Sink<3> for Heard {
    #[inline]
    fn kill(&mut self, cell: CellId) {
        self.0 = self.0.wrapping_add(u64::from(cell.0));
    }
    #[inline]
    fn make(&mut self, cell: CellId, corners: Cell<3>) {
        self.relabel(cell, corners);
    }
    #[inline]
    fn relabel(&mut self, cell: CellId, [a, b, c]: Cell<3>) {
        self.0 = self.0.wrapping_add(u64::from(cell.0 ^ a.0 ^ b.0 ^ c.0));
    }
}

/// Steps of a model by this clock, the fastest of a few rounds.
pub(crate) fn steps<M: MultiTessellation<3, Bound = Bound>>(model: &M, meter: Meter<'_>) -> Steps {
    let mut best = Steps { ns: f64::INFINITY, ns_with_cells: f64::INFINITY, ..Steps::default() };
    for _ in 0..ROUNDS {
        let [refine, coarsen] = all_steps(model, &mut (), meter);
        let mut heard = Heard::default();
        let with_cells = all_steps(model, &mut heard, meter);
        black_box(heard.0);
        best.refine_per_s = best.refine_per_s.max(refine.per_second());
        best.coarsen_per_s = best.coarsen_per_s.max(coarsen.per_second());
        best.ns = best.ns.min(nanoseconds(&[refine, coarsen]));
        best.ns_with_cells = best.ns_with_cells.min(nanoseconds(&with_cells));
    }
    best
}

/// Steps that were timed.
#[derive(Clone, Copy)]
struct Timed {
    steps: u32,
    seconds: f64,
}

impl Timed {
    fn per_second(self) -> f64 {
        f64::from(self.steps) / self.seconds.max(1e-9)
    }
}

fn nanoseconds(of: &[Timed]) -> f64 {
    let steps: u32 = of.iter().map(|timed| timed.steps).sum();
    of.iter().map(|timed| timed.seconds).sum::<f64>() * 1e9 / f64::from(steps.max(1))
}

/// Nanoseconds of a step by this clock, in seconds: everything refined by rank and coarsened again, checks included.
pub(crate) fn nanoseconds_a_step<M: MultiTessellation<3>>(model: &M, meter: Meter<'_>) -> f64 {
    nanoseconds(&all_steps(model, &mut (), meter))
}

/// Refines everything and coarsens it again, by rank. Steps that a rule refuses are asked for and not counted.
fn all_steps<M: MultiTessellation<3>>(model: &M, sink: &mut impl Sink<3>, meter: Meter<'_>) -> [Timed; 2] {
    let mut view = model.base_view();
    let mut out = Vec::new();
    let mut steps = 0;
    let begun = meter();
    for m in (0..model.len()).rev().map(NodeId) {
        out.clear();
        model.prerequisites(m, &view, &mut out);
        if out.is_empty() {
            take(model, Step::refine(m), &mut view, sink);
            steps += 1;
        }
    }
    let refine = Timed { steps, seconds: meter() - begun };
    let mut steps = 0;
    let begun = meter();
    for m in (0..model.len()).map(NodeId) {
        out.clear();
        if view.front.is_refined(m) && model.obstacles(m, &view, &mut out) == Coarsen::Now {
            take(model, Step::coarsen(m), &mut view, sink);
            steps += 1;
        }
    }
    [refine, Timed { steps, seconds: meter() - begun }]
}

fn seen_by(camera: &Camera) -> Facing<ScreenError> {
    Facing { eye: camera.eye, criterion: ScreenError::new(camera, PIXELS) }
}

fn follow<M: MultiTessellation<3, Bound = Bound>>(model: &M, input: &Mesh<3>, count: u32, meter: Meter<'_>) -> Frames {
    let cameras = camera_path(input, count + 1);
    let mut state = State::new(model, ());
    let (mut milliseconds, mut steps, mut triangles) = (Vec::new(), 0u64, 0u64);
    // The first frame makes everything; the path begins with the second.
    adapt(model, &seen_by(&cameras[0]), &Limits::NONE, &mut state);
    for camera in &cameras[1..] {
        state.steps.clear();
        let begun = meter();
        let outcome = adapt(model, &seen_by(camera), &Limits::NONE, &mut state);
        milliseconds.push((meter() - begun) * 1e3);
        steps += u64::from(outcome.refined + outcome.coarsened);
        triangles += u64::from(state.cell_count(model));
    }
    milliseconds.sort_by(f64::total_cmp);
    let frames = milliseconds.len();
    let (small_change_us, small_change_front) = small_change(model, meter);
    Frames {
        count,
        median_ms: milliseconds[frames / 2],
        p95_ms: milliseconds[(frames - 1) * 95 / 100],
        steps: steps as f64 / frames as f64,
        triangles: triangles as f64 / frames as f64,
        two_views: two_views(model, &cameras),
        small_change_us,
        small_change_front,
    }
}

/// Two cameras that share the model: one after the other, and at once.
fn two_views<M: MultiTessellation<3, Bound = Bound>>(model: &M, cameras: &[Camera]) -> f64 {
    let half = cameras.len().div_ceil(2);
    let view = |cameras: &[Camera]| {
        let mut state = State::new(model, ());
        for camera in cameras {
            state.steps.clear();
            adapt(model, &seen_by(camera), &Limits::NONE, &mut state);
        }
        black_box(state.cell_count(model));
    };
    let halves = [&cameras[..half], &cameras[cameras.len() - half..]];
    let begun = Instant::now();
    halves.into_iter().for_each(view);
    let one_by_one = begun.elapsed();
    let begun = Instant::now();
    std::thread::scope(|scope| {
        scope.spawn(|| view(halves[0]));
        view(halves[1]);
    });
    one_by_one.as_secs_f64() / begun.elapsed().as_secs_f64().max(1e-9)
}

/// Goes to and fro between two errors whose fronts differ in a hundredth of the nodes.
fn small_change<M: MultiTessellation<3, Bound = Bound>>(model: &M, meter: Meter<'_>) -> (Option<f64>, u32) {
    let mut errors: Vec<f32> = (0..model.len()).map(|m| model.bound(NodeId(m)).error).collect();
    errors.sort_by(|a, b| b.total_cmp(a));
    // Of a small model a half, so that there is a hundredth more to be had.
    let wanted = FRONT.min(model.len() / 2) as usize;
    let [fewer, more] = [wanted, wanted + wanted / 100].map(|at| UniformError { error_max: errors[at] });
    let (mut state, _) = extract(model, &fewer, &Limits::NONE, Strategy::TopDown, ());
    // Once to and fro, so that all memory is there.
    for _ in 0..2 {
        adapt(model, &more, &Limits::NONE, &mut state);
        adapt(model, &fewer, &Limits::NONE, &mut state);
        state.steps.clear();
    }
    let front = state.front().len();
    if extract(model, &more, &Limits::NONE, Strategy::TopDown, ()).0.front().len() == front {
        return (None, front);
    }
    let begun = meter();
    for _ in 0..CHANGES / 2 {
        adapt(model, &more, &Limits::NONE, &mut state);
        adapt(model, &fewer, &Limits::NONE, &mut state);
        state.steps.clear();
    }
    (Some((meter() - begun) * 1e6 / f64::from(CHANGES)), front)
}

fn qualities<M: MultiTessellation<3, Bound = Bound>>(model: &M, input: &Mesh<3>, samples: usize) -> Vec<Quality> {
    let diagonal = input.diagonal().max(f64::MIN_POSITIVE);
    // A mesh without triangles has nothing to measure to.
    let Ok(surface) = Surface::new(input) else { return Vec::new() };
    let base = model.cell_count(&model.base());
    let at = |share: f64| {
        let cells = (input.cell_count() as f64 * share) as u32;
        if cells < base {
            return None;
        }
        let limits = Limits { cells: Some(cells), time: None };
        // Below 0, so that what costs no error fills the budget too.
        let (state, _) = extract(model, &UniformError { error_max: -1.0 }, &limits, Strategy::Priority, ());
        let apart = Surface::new(&mesh_of(model, &state.view.mesh))
            .ok()?
            .distance(&surface, Sampling { count: samples, seed: 1 });
        Some(Quality { share, rms: apart.rms() / diagonal, maximum: apart.maximum() / diagonal })
    };
    SHARES.into_iter().filter_map(at).collect()
}
