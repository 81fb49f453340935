//! The study: models built once by each operator, extracted along one camera path by every sensible combination of
//! criterion and strategy, measured against the input.
//!
//! Nothing here opens a file: results come back as data, text and PNG bytes.

mod frames;
mod path;
mod pictures;
mod quality;
mod report;
mod results;

pub use path::camera_path;
pub use pictures::{cell_errors, cell_levels};
pub use report::page;
pub use results::{Built, Observation, Picture, Quality, Results};

use mt_core::analysis::{AnalysisError, Options, Stopped, simplify};
use mt_core::{Explicit, Mesh, MultiTessellation, generate};
use operators::EdgeCollapse;
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
    /// Operators by name, each built once.
    pub operators: Vec<(&'static str, EdgeCollapse)>,
    /// Frames of the camera path.
    pub frames: u32,
    /// Largest error on the screen, in pixels.
    pub error_px: f32,
    /// Samples of each surface when distances are measured.
    pub samples: usize,
    /// Width and height of pictures; none are made without.
    pub picture_px: Option<(u32, u32)>,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            operators: vec![("edge-collapse", EdgeCollapse::FULL), ("half-edge-collapse", EdgeCollapse::HALF)],
            frames: 90,
            error_px: 1.0,
            samples: 20_000,
            picture_px: Some((960, 720)),
        }
    }
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
    watch: &mut dyn FnMut(&str, f32) -> bool,
) -> Result<Results, StudyError> {
    let mut results = Results { frames: config.frames, error_px: config.error_px, ..Results::default() };
    let mut steps = Steps { watch, done: 0, all: subjects.len() * config.operators.len() * 3 };
    for subject in subjects {
        for (i, (operator, collapse)) in config.operators.iter().enumerate() {
            steps.next(subject, operator, "building")?;
            let model = build(subject, operator, collapse, &mut results, &mut steps)?;
            steps.next(subject, operator, "extracting")?;
            frames::observe(subject, operator, &model, config, &mut results, &mut steps)?;
            steps.next(subject, operator, "measuring")?;
            quality::measure(subject, operator, &model, config, &mut results);
            if let Some(size) = config.picture_px.filter(|_| i == 0) {
                // A picture that cannot be drawn is no reason to lose the numbers.
                if let Err(error) = pictures::draw(subject, &model, config, size, &mut results) {
                    results.notes.push(error.to_string());
                }
            }
        }
    }
    Ok(results)
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

fn build(
    subject: &Subject,
    operator: &str,
    collapse: &EdgeCollapse,
    results: &mut Results,
    steps: &mut Steps<'_>,
) -> Result<Explicit<3>, StudyError> {
    let begun = Instant::now();
    let analysis = simplify(&subject.mesh, collapse, &Options::default(), &mut |_| steps.go_on(&subject.name).is_ok())
        .map_err(|error| StudyError::Analysis(subject.name.clone(), error))?;
    let seconds = begun.elapsed().as_secs_f64();
    if analysis.stopped == Stopped::Cancelled {
        return Err(StudyError::Cancelled);
    }
    let model = analysis.model;
    results.built.push(Built {
        model: subject.name.clone(),
        operator: operator.to_owned(),
        vertices_in: subject.mesh.vertex_count(),
        triangles_in: subject.mesh.cell_count(),
        triangles_base: model.base_cells().len(),
        modifications: model.len(),
        arcs: model.order().arc_count(),
        depth: model.order().depth(),
        bytes_per_vertex: model.bytes() as f64 / subject.mesh.vertex_count().max(1) as f64,
        refusals: analysis.refusals.iter().map(|(reason, count)| (reason.name().to_owned(), count)).collect(),
        seconds,
    });
    Ok(model)
}
