//! `mtess study`: the main job.

use super::{CommandError, print_text};
use crate::files::{self, FileError};
use crate::progress::{Progress, interrupted};
use clap::Args;
use mt_core::analysis::{AnalysisError, Unfit};
use mt_core::format::{LoadOptions, NonManifold};
use papers::study::{self, Config, Results, StudyError, Subject};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Args)]
pub struct Study {
    /// Meshes to study; without any, a generated terrain and a generated genus-2 surface
    models: Vec<PathBuf>,
    /// Folder of the report
    #[arg(short, long, value_name = "DIR", default_value = "study")]
    output: PathBuf,
    /// Frames of the camera path
    #[arg(long, value_name = "N", default_value_t = 90, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
    /// Largest error on the screen, in pixels
    #[arg(long, value_name = "PX", default_value_t = 1.0)]
    pixels: f32,
    /// Separate sheets where meshes are not manifold, instead of refusing them
    #[arg(long)]
    split_non_manifold: bool,
}

impl Study {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        if self.pixels.is_nan() || self.pixels < 0.0 {
            return Err(CommandError::Other("--pixels must be a number, 0 or more".into()));
        }
        let subjects = self.subjects()?;
        let new_folder = files::make_folder(&self.output)?;
        let results = self.observe(&subjects);
        if results.is_err() && new_folder {
            files::remove_empty_folder(&self.output);
        }
        let results = results?;
        self.write(&results)?;
        print_text(&summary(&results, &self.output));
        Ok(ExitCode::SUCCESS)
    }

    fn observe(&self, subjects: &[Subject]) -> Result<Results, CommandError> {
        let config = Config { frames: self.frames, error_px: self.pixels, ..Config::default() };
        let mut progress = Progress::new("studying", 1000);
        let results = study::run(subjects, &config, &mut |_, share| progress.at((share * 1000.0) as u64));
        drop(progress);
        match results {
            Err(StudyError::Cancelled) => Err(CommandError::Interrupted),
            Ok(_) if interrupted() => Err(CommandError::Interrupted),
            results => results.map_err(|error| self.explain(error)),
        }
    }

    /// Names the file at fault, and the way out where there is one.
    fn explain(&self, error: StudyError) -> CommandError {
        let way_out = match error {
            StudyError::Analysis(_, AnalysisError::Unfit(Unfit::NonManifold { .. })) => {
                "; --split-non-manifold separates the sheets"
            }
            _ => "",
        };
        let path = match &error {
            StudyError::Analysis(name, _) => self.models.iter().find(|path| name_of(path) == *name),
            _ => None,
        };
        match (error, path) {
            (StudyError::Analysis(_, error), Some(path)) => FileError::new(path, format!("{error}{way_out}")).into(),
            (error, _) => CommandError::Other(format!("{error}{way_out}")),
        }
    }

    fn subjects(&self) -> Result<Vec<Subject>, CommandError> {
        if self.models.is_empty() {
            return Ok(study::built_in());
        }
        let non_manifold = if self.split_non_manifold { NonManifold::Split } else { NonManifold::Keep };
        let mut subjects: Vec<Subject> = Vec::new();
        for path in &self.models {
            let (mesh, report) = files::load_mesh(path, &LoadOptions { non_manifold, ..LoadOptions::default() })?;
            eprint!("{report}");
            let name = name_of(path);
            if subjects.iter().any(|other| other.name == name) {
                return Err(FileError::new(path, "another model of the study has the same name").into());
            }
            subjects.push(Subject { name, mesh });
        }
        Ok(subjects)
    }

    fn write(&self, results: &Results) -> Result<(), CommandError> {
        let at = |name: &str| self.output.join(name);
        let json = serde_json::to_vec_pretty(results).map_err(|error| CommandError::Other(error.to_string()))?;
        files::write_bytes(&at("results.csv"), results.csv().as_bytes())?;
        files::write_bytes(&at("results.json"), &json)?;
        for picture in &results.pictures {
            files::write_bytes(&at(&picture.name), &picture.png)?;
        }
        // The page comes last: where it is, everything it tells of is.
        Ok(files::write_bytes(&at("index.html"), study::page(results).as_bytes())?)
    }
}

/// What a model is called in the study: its file without the ending.
fn name_of(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn summary(results: &Results, folder: &Path) -> String {
    let mut lines: Vec<String> = results
        .built
        .iter()
        .map(|b| {
            format!(
                "{:12} {:20} {:>7} triangles to {:>4} in {:.2} s, {:.0} bytes a vertex",
                b.model, b.operator, b.triangles_in, b.triangles_base, b.seconds, b.bytes_per_vertex
            )
        })
        .collect();
    if let Some(picture) = results.pictures.first() {
        lines.push(format!("{} pictures, drawn by {}", results.pictures.len(), picture.painter));
    }
    lines.push(format!("{} observations; read {}", results.observations.len(), folder.join("index.html").display()));
    lines.join("\n")
}
