//! Extraction along the camera path, for every criterion and strategy.

use super::{Config, Observation, Results, Steps, StudyError, Subject, camera_path};
use mt_core::{Bits, Camera, Explicit, MultiTessellation};
use selective::{InRegion, Limits, Outcome, Region, ScreenError, State, Strategy, UniformError, Wish, adapt, extract};
use std::time::Instant;

/// A criterion and the limits it is asked under, for one frame.
struct Query {
    criterion: Wish,
    limits: Limits,
}

/// Criteria of a study by name. Each frame of the path makes a wish of each.
const CRITERIA: [&str; 4] = ["uniform", "region", "screen", "budget"];
/// Strategies of a study by name.
const STRATEGIES: [&str; 3] = ["top-down", "priority", "incremental"];

/// Observes every combination.
pub(super) fn observe(
    subject: &Subject,
    operator: &str,
    model: &Explicit<3>,
    config: &Config,
    results: &mut Results,
    steps: &mut Steps<'_>,
) -> Result<(), StudyError> {
    let cameras = camera_path(&subject.mesh, config.frames);
    let mut seen = Bits::new(model.positions().len() as u32);
    for criterion in CRITERIA {
        for strategy in STRATEGIES {
            // A budget is met by priority; depth first it would be the same computation under another name.
            if criterion == "budget" && strategy == "top-down" {
                continue;
            }
            steps.go_on(&subject.name)?;
            let mut state = State::new(model, ());
            for (frame, camera) in cameras.iter().enumerate() {
                let query = query(criterion, subject, config, camera, frame);
                let begun = Instant::now();
                let outcome = answer(model, &query, strategy, &mut state);
                let seconds = begun.elapsed().as_secs_f64();
                results.observations.push(Observation {
                    model: subject.name.clone(),
                    operator: operator.to_owned(),
                    dependency: "explicit",
                    criterion,
                    strategy,
                    frame: frame as u32,
                    vertices: vertex_count(model, &state, &mut seen),
                    triangles: state.cell_count(model),
                    refined: outcome.refined,
                    coarsened: outcome.coarsened,
                    forced: outcome.forced,
                    seconds,
                });
            }
        }
    }
    Ok(())
}

fn answer(model: &Explicit<3>, query: &Query, strategy: &str, state: &mut State<3, Explicit<3>, ()>) -> Outcome {
    state.steps.clear();
    let sequence = match strategy {
        "incremental" => return adapt(model, &query.criterion, &query.limits, state),
        "priority" => Strategy::Priority,
        _ => Strategy::TopDown,
    };
    let (fresh, outcome) = extract(model, &query.criterion, &query.limits, sequence, ());
    *state = fresh;
    outcome
}

fn query(criterion: &str, subject: &Subject, config: &Config, camera: &Camera, frame: usize) -> Query {
    let diagonal = subject.mesh.diagonal() as f32;
    let t = frame as f32 / config.frames.max(1) as f32;
    match criterion {
        // From coarse to fine, by the same factor each frame.
        "uniform" => {
            let error_max = diagonal * 0.02 * (0.005f32).powf(t);
            Query { criterion: Wish::Uniform(UniformError { error_max }), limits: Limits::NONE }
        }
        // A box of a quarter of the extent travels through the model.
        "region" => {
            let (low, high) = subject.mesh.bounding_box().unwrap_or_default();
            let half = (high - low) * 0.125;
            let at = low + half + (high - low - half * 2.0) * t;
            let region = Region { low: at - half, high: at + half };
            Query { criterion: Wish::Region(InRegion { region, error_max: diagonal * 2e-4 }), limits: Limits::NONE }
        }
        "screen" => {
            Query { criterion: Wish::Screen(Box::new(ScreenError::new(camera, config.error_px))), limits: Limits::NONE }
        }
        _ => {
            let cells = (subject.mesh.cell_count() / 10) as u32;
            let limits = Limits { cells: Some(cells), time: None };
            Query { criterion: Wish::Screen(Box::new(ScreenError::new(camera, 0.0))), limits }
        }
    }
}

fn vertex_count(model: &Explicit<3>, state: &State<3, Explicit<3>, ()>, seen: &mut Bits) -> usize {
    seen.clear();
    model.cells(&state.view.mesh, |_, corners| corners.iter().for_each(|v| _ = seen.insert(v.0)));
    seen.count() as usize
}
