//! `mtess study`: the main job.

use super::{CommandError, print_text};
use crate::files::{self, FileError};
use crate::memory;
use crate::progress::{Progress, interrupted};
use clap::Args;
use mt_core::analysis::{AnalysisError, Unfit};
use mt_core::format::{LoadOptions, NonManifold};
use operators::AnyOperator;
use papers::study::{self, Config, CriterionKind, DependencyKind, Results, StrategyKind, StudyError, Subject};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Args)]
pub struct Study {
    /// Meshes to study; without any, a generated terrain and a generated genus-2 surface
    models: Vec<PathBuf>,
    /// Folder of the report
    #[arg(short, long, value_name = "DIR", default_value = "study")]
    output: PathBuf,
    /// Operators: edge-collapse, half-edge-collapse, vertex-pair, fan-merge, or all; collapses also with a metric
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_values = Config::OPERATORS)]
    operators: Vec<String>,
    /// What steps wait for: cells (the explicit model), explicit, one-ring, cut-pair, four-face, dual-piece,
    /// implicit-ids, implicit-ids-stored, dual-piece-free, or all
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_values = Config::DEPENDENCIES)]
    dependencies: Vec<String>,
    /// Criteria: uniform, region, screen, facing, silhouette, moving, features, visual, budget, or all
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_values = Config::CRITERIA)]
    criteria: Vec<String>,
    /// Strategies: top-down, priority, incremental, hysteresis, dual, dual-distance, coarse,
    /// or all; the last three are for hierarchies of fans
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_values = Config::STRATEGIES)]
    strategies: Vec<String>,
    /// Build everything anew, also what an earlier run into the same folder has built
    #[arg(long)]
    no_cache: bool,
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
        let config = self.config()?;
        let mut names: Vec<String> = Vec::new();
        for name in config.operators.iter().map(AnyOperator::name) {
            if names.contains(&name) {
                return Err(CommandError::Other(format!("--operators names {name} twice")));
            }
            names.push(name);
        }
        let subjects = self.subjects()?;
        let new_folder = files::make_folder(&self.output)?;
        // Hours of work are not to end at a place that cannot be written.
        for name in ["results.csv", "results.json", "index.html"] {
            files::check_place(&self.output.join(name))?;
        }
        files::check_writable(&self.output)?;
        let results = self.observe(&subjects, &config);
        if results.is_err() && new_folder {
            files::remove_empty_folder(&self.output);
        }
        let mut results = results?;
        self.name_meshes(&subjects, &mut results)?;
        if results.observations.is_empty() {
            let told = results.notes.first().map_or(String::new(), |note| format!(": {note}"));
            return Err(CommandError::Other(format!(
                "nothing was observed{told}; dual, dual-distance and coarse are for fan-merge on a hierarchy, and a budget \
                 is not met top-down"
            )));
        }
        self.write(&results)?;
        print_text(&summary(&results, &self.output));
        Ok(ExitCode::SUCCESS)
    }

    fn config(&self) -> Result<Config, CommandError> {
        Ok(Config {
            operators: chosen(&self.operators, &AnyOperator::NAMES)?,
            dependencies: chosen(
                &self.dependencies,
                &DependencyKind::all().map(DependencyKind::name).collect::<Vec<_>>(),
            )?,
            criteria: chosen(&self.criteria, &CriterionKind::ALL.iter().map(|c| c.name()).collect::<Vec<_>>())?,
            strategies: chosen(&self.strategies, &StrategyKind::ALL.iter().map(|s| s.name()).collect::<Vec<_>>())?,
            frames: self.frames,
            error_px: self.pixels,
            ..Config::default()
        })
    }

    fn observe(&self, subjects: &[Subject], config: &Config) -> Result<Results, CommandError> {
        let mut progress = Progress::new("studying", 1000);
        let mut cache: Box<dyn study::Cache> =
            if self.no_cache { Box::new(study::NoCache) } else { Box::new(Folder::new(self.output.join("built"))) };
        let results = study::run(subjects, config, &mut *cache, &mut |_, share| progress.at((share * 1000.0) as u64));
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
                "; --split-non-manifold separates the sheets, --operators vertex-pair takes the mesh as it is"
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
            let bytes = memory::of_study(mesh.cell_count());
            memory::allow("studying it", bytes).map_err(|error| FileError::new(path, error))?;
            subjects.push(Subject { name, mesh });
        }
        Ok(subjects)
    }

    /// Puts the files of meshes into the commands of pictures; generated meshes get one beside the report.
    fn name_meshes(&self, subjects: &[Subject], results: &mut Results) -> Result<(), CommandError> {
        for subject in subjects {
            let of_file = self.models.iter().find(|path| name_of(path) == subject.name);
            let mesh = match of_file {
                Some(path) => std::path::absolute(path).unwrap_or_else(|_| path.clone()),
                None => {
                    let name = format!("{}.ply", subject.name);
                    files::write_mesh(&self.output.join(&name), &subject.mesh)?;
                    name.into()
                }
            };
            let split = if self.split_non_manifold { " --non-manifold split" } else { "" };
            let mesh = format!("{}{split}", quoted(&mesh.display().to_string()));
            for picture in results.pictures.iter_mut().filter(|picture| picture.model == subject.name) {
                picture.command = picture.command.replacen("MESH", &mesh, 1);
            }
        }
        Ok(())
    }

    fn write(&self, results: &Results) -> Result<(), CommandError> {
        let at = |name: &str| self.output.join(name);
        let json = serde_json::to_vec_pretty(results).map_err(|error| CommandError::Other(error.to_string()))?;
        files::write_bytes(&at("results.csv"), results.csv().as_bytes())?;
        files::write_bytes(&at("results.json"), &json)?;
        for picture in &results.pictures {
            files::write_bytes(&at(&picture.name), &picture.png)?;
            let camera =
                serde_json::to_vec_pretty(&picture.camera).map_err(|error| CommandError::Other(error.to_string()))?;
            files::write_bytes(&at(&picture.name).with_extension("json"), &camera)?;
        }
        // The page comes last: where it is, everything it tells of is.
        Ok(files::write_bytes(&at("index.html"), study::page(results).as_bytes())?)
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = word.chars().all(|c| c.is_alphanumeric() || "/._-".contains(c));
    if is_plain { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

/// Choices by name, each once; `all` stands for all of them.
pub(super) fn chosen<T>(names: &[String], all: &[&str]) -> Result<Vec<T>, CommandError>
where
    T: std::str::FromStr,
    T::Err: std::fmt::Display,
{
    let mut seen: Vec<&str> = Vec::new();
    for name in names.iter().map(|name| name.trim()) {
        let more = if name == "all" { all.to_vec() } else { vec![name] };
        more.into_iter().for_each(|name| {
            if !seen.contains(&name) {
                seen.push(name)
            }
        });
    }
    let parse = |name: &&str| name.parse().map_err(|error: T::Err| CommandError::Other(error.to_string()));
    seen.iter().map(parse).collect()
}

/// Built models of earlier runs of this very program, a file each: another build may coarsen otherwise.
struct Folder {
    path: PathBuf,
    program: String,
}

impl Folder {
    fn new(path: PathBuf) -> Self {
        Self { path, program: files::program_mark() }
    }

    fn place(&self, key: &str) -> PathBuf {
        self.path.join(format!("{key}-{}.built", self.program))
    }
}

impl study::Cache for Folder {
    fn load(&mut self, key: &str) -> Option<Vec<u8>> {
        files::read(&self.place(key)).ok()
    }

    fn store(&mut self, key: &str, bytes: &[u8]) {
        // What cannot be kept is built again the next time; the study itself loses nothing.
        let kept = files::make_folder(&self.path).and_then(|_| files::write_bytes(&self.place(key), bytes));
        if let Err(error) = kept {
            eprintln!("warning: the model is not kept for the next run: {error}");
        }
    }
}

/// What a model is called in the study: its file without the ending.
pub(super) fn name_of(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn summary(results: &Results, folder: &Path) -> String {
    let mut lines: Vec<String> = results
        .built
        .iter()
        .map(|b| {
            let built = if b.from_cache { " (built before)" } else { "" };
            format!(
                "{:12} {:20} {:>7} triangles to {:>4} in {:.2} s, {:.0} bytes a vertex{built}",
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
