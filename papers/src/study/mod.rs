//! The study: models built once by each operator, extracted along one camera path by every sensible combination of
//! criterion and strategy, measured against the input.
//!
//! Nothing here opens a file: results come back as data, text and PNG bytes.

mod build;
mod choices;
mod features;
mod observe;
mod path;
mod pictures;
mod quality;
mod report;
mod results;
mod tables;

pub(crate) use features::folds;

pub use build::{Cache, NoCache};
pub use choices::{CriterionKind, DependencyKind, StrategyKind, UnknownChoice};
pub use features::sharp_vertices;
pub use path::camera_path;
pub use report::page;
pub use results::{Built, Degrees, Observation, Ordered, Picture, Quality, Results};

use build::Pair;
use choices::Scene;
use mt_core::analysis::AnalysisError;
use mt_core::check::Breach;
use mt_core::hierarchy::HierarchyError;
use mt_core::{Mesh, generate};
use observe::Observe;
use operators::AnyOperator;
use std::time::Instant;

/// A mesh to study.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its name in tables and plots.
    pub name: String,
    /// The mesh, as repaired by loading.
    pub mesh: Mesh<3>,
}

/// What to study.
#[derive(Clone, Debug)]
pub struct Config {
    /// Operators; each sequence is built once.
    pub operators: Vec<AnyOperator>,
    /// What steps wait for.
    pub dependencies: Vec<DependencyKind>,
    /// What is asked for.
    pub criteria: Vec<CriterionKind>,
    /// In what sequence.
    pub strategies: Vec<StrategyKind>,
    /// Frames of the camera path.
    pub frames: u32,
    /// Largest error on the screen, in pixels.
    pub error_px: f32,
    /// Samples of each surface when distances are measured.
    pub samples: usize,
    /// Width and height of pictures; none are made without.
    pub picture_px: Option<(u32, u32)>,
}

impl Config {
    /// The operators of a study that names none.
    pub const OPERATORS: [&str; 3] = ["edge-collapse", "half-edge-collapse", "fan-merge"];
    /// The dependencies of a study that names none.
    pub const DEPENDENCIES: [&str; 5] = ["cells", "one-ring", "four-face", "dual-piece", "implicit-ids"];
    /// The criteria of a study that names none.
    pub const CRITERIA: [&str; 4] = ["uniform", "region", "screen", "budget"];
    /// The strategies of a study that names none.
    pub const STRATEGIES: [&str; 6] = ["top-down", "priority", "incremental", "dual", "dual-distance", "coarse"];
}

impl Default for Config {
    fn default() -> Self {
        Self {
            operators: named(&Self::OPERATORS),
            dependencies: named(&Self::DEPENDENCIES),
            criteria: named(&Self::CRITERIA),
            strategies: named(&Self::STRATEGIES),
            frames: 90,
            error_px: 1.0,
            samples: 20_000,
            picture_px: Some((960, 720)),
        }
    }
}

/// Choices by names of our own.
///
/// # Panics
/// Where a name is none, which is a slip in the lists above.
fn named<T: std::str::FromStr<Err: std::fmt::Debug>>(names: &[&str]) -> Vec<T> {
    names.iter().map(|name| name.parse().expect("a name of ours")).collect()
}

/// The subjects of a study that names none: a fractal terrain and a genus-2 surface with detail, about 20,000 triangles
/// each.
pub fn built_in() -> Vec<Subject> {
    let terrain = Subject { name: "terrain".into(), mesh: generate::terrain(100, 0.55, 7) };
    let genus2 = Subject { name: "genus-2".into(), mesh: generate::genus_surface(2, 14, 0.02, 7) };
    vec![terrain, genus2]
}

/// Why a study ended early.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// An operator could not take a mesh.
    #[error("{0}: {1}")]
    Analysis(String, AnalysisError),
    /// A sequence has no vertex hierarchy.
    #[error("{0}: {1}")]
    Hierarchy(String, HierarchyError),
    /// A model breaks a law, which is a fault of the program.
    #[error("{0}: {1}")]
    Law(String, Breach),
    /// A picture could not be drawn.
    #[error("the picture {0} cannot be drawn: {1}")]
    Picture(String, render::RenderError),
    /// Somebody asked to stop.
    #[error("interrupted; nothing was written")]
    Cancelled,
}

/// Studies the subjects. `watch` hears what is being done and how much of the whole is, and answers whether to go on.
pub fn run(
    subjects: &[Subject],
    config: &Config,
    cache: &mut dyn Cache,
    watch: &mut dyn FnMut(&str, f32) -> bool,
) -> Result<Results, StudyError> {
    let mut results = Results { frames: config.frames, error_px: config.error_px, ..Results::default() };
    let rounds = config.dependencies.len() + 2;
    let mut steps = Steps { watch, done: 0, all: subjects.len() * config.operators.len() * rounds };
    for subject in subjects {
        let scene = Scene::new(subject, config);
        for (i, operator) in config.operators.iter().enumerate() {
            let name = operator.name();
            steps.next(subject, &name, "building")?;
            let pair = match build::build(subject, operator, cache, &mut results, &mut steps) {
                // One model that has no hierarchy is no reason to lose the others.
                Err(error @ StudyError::Hierarchy(..)) => {
                    results.notes.push(format!("{error} ({name}); a model of such a scale wants to be scaled"));
                    steps.done += rounds - 1;
                    continue;
                }
                built => built?,
            };
            for &dependency in &config.dependencies {
                steps.next(subject, &name, dependency.name())?;
                observe(&scene, &name, &pair, dependency, &mut results, &mut steps)?;
            }
            steps.next(subject, &name, "measuring")?;
            quality::measure(subject, &name, &pair.explicit, config, &mut results);
            if let Some(size) = config.picture_px.filter(|_| i == 0) {
                // A picture that cannot be drawn is no reason to lose the numbers.
                if let Err(error) = pictures::draw(subject, &pair.explicit, config, size, &mut results) {
                    results.notes.push(error.to_string());
                }
            }
        }
    }
    Ok(results)
}

/// Observes one dependency. A scheme that does not take the sequence is noted, and the study goes on.
fn observe(
    scene: &Scene<'_>,
    operator: &str,
    pair: &Pair,
    dependency: DependencyKind,
    results: &mut Results,
    steps: &mut Steps<'_>,
) -> Result<(), StudyError> {
    let has_runs = !pair.replay.is_single();
    let begun = Instant::now();
    let observe = Observe { scene, operator, dependency, has_runs, begun, results: &mut *results, steps };
    let seen = match dependency {
        DependencyKind::Cells => return observe.model(&pair.explicit, pair.explicit.bytes()),
        DependencyKind::Scheme(scheme) => scheme.visit(&pair.replay, observe),
    };
    seen.unwrap_or_else(|error| {
        results.notes.push(format!("{}, {operator}: {error}", scene.subject.name));
        Ok(())
    })
}

/// How far a study is, and whom to tell.
struct Steps<'a> {
    watch: &'a mut dyn FnMut(&str, f32) -> bool,
    done: usize,
    all: usize,
}

impl Steps<'_> {
    /// The next step begins.
    fn next(&mut self, subject: &Subject, operator: &str, what: &str) -> Result<(), StudyError> {
        self.done += 1;
        self.go_on(&format!("{} {operator}: {what}", subject.name))
    }

    /// The step goes on, unless somebody asked to stop.
    fn go_on(&mut self, what: &str) -> Result<(), StudyError> {
        let share = (self.done.max(1) - 1) as f32 / self.all as f32;
        if (self.watch)(what, share) { Ok(()) } else { Err(StudyError::Cancelled) }
    }
}
