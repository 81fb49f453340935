//! `mtess bench`: what building, keeping, stepping and following a camera costs, one process for each row.

use super::study::{chosen, name_of};
use super::{CommandError, print_json, print_text};
use crate::coarsening::{Coarsening, go_by_regions, use_threads, usual_regions};
use crate::files::{self, FileError, Model};
use crate::kept::Kept;
use crate::memory::{self, forget_peak, peak_bytes};
use crate::progress::{Clock, Progress, interrupted};
use clap::Args;
use mt_core::analysis::{Options, Regions};
use mt_core::container::{Meta, Storage};
use mt_core::format::LoadOptions;
use mt_core::hierarchy::Dependency;
use mt_core::{Bound, Hierarchy, Mesh, MultiTessellation, generate};
use operators::AnyOperator;
use operators::order::Visit;
use papers::bench::{self, Built, Row};
use papers::study::DependencyKind;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Duration;

#[derive(Args, Clone)]
pub struct Bench {
    /// Meshes to measure; without any, generated ones of the sizes of --triangles
    models: Vec<PathBuf>,
    /// About how many triangles generated models have
    #[arg(long, value_name = "N,M", value_delimiter = ',', default_values_t = [20_000, 200_000], value_parser = clap::value_parser!(u32).range(128..=1_000_000_000))]
    triangles: Vec<u32>,
    /// Generated models: terrain, genus-2, or all
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_value = "all")]
    shapes: Vec<String>,
    /// Operators, as in `mtess build`, or all
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_values = OPERATORS)]
    operators: Vec<String>,
    /// What is kept: cells, or the vertex hierarchy under a scheme, as in `mtess study`
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_values = ["cells", "dual-piece"])]
    dependencies: Vec<String>,
    /// Runs of each row; the middle one is told, with the least and the most
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    runs: u32,
    /// Vertices of the regions that a mesh is coarsened by, 0 for none; if not set, as `mtess build` does
    #[arg(long, value_name = "VERTICES", value_parser = parse_regions)]
    regions: Option<u32>,
    /// Threads that coarsen by regions, a row for each; 0 for as many as there are cores
    #[arg(long, value_name = "N,M", value_delimiter = ',', default_values_t = [0], value_parser = clap::value_parser!(u32).range(0..=1024))]
    threads: Vec<u32>,
    /// Frames of the camera path, 0 for none
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    frames: u32,
    /// Samples of each surface where distances are measured, 0 for none; not for models of more than two million triangles
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(0..=10_000_000))]
    samples: u32,
    /// Folder of the report
    #[arg(short, long, value_name = "DIR", default_value = "bench")]
    output: PathBuf,
    /// Measure one row in this process and print it
    #[arg(long, hide = true)]
    row: bool,
    /// Tell the rows as JSON
    #[arg(long)]
    json: bool,
}

const OPERATORS: [&str; 4] = ["edge-collapse", "half-edge-collapse", "edge-collapse/lindstrom-turk", "fan-merge"];
const SHAPES: [&str; 2] = ["terrain", "genus-2"];
/// How often to look whether a row has been measured.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// Distances from larger models take more memory than building them.
const MEASURED_MAX: usize = 2_000_000;

fn parse_regions(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(1..16) => Err("16 at least, 0 for none".into()),
        Ok(vertices) => Ok(vertices),
        Err(_) => Err("a number of vertices is wanted".into()),
    }
}

/// Each once.
fn distinct<T: Copy + PartialEq>(all: &[T]) -> Vec<T> {
    let mut once = Vec::new();
    all.iter().for_each(|&one| {
        if !once.contains(&one) {
            once.push(one);
        }
    });
    once
}

/// One row to be measured.
struct Task {
    model: Source,
    operator: AnyOperator,
    dependency: DependencyKind,
    threads: u32,
}

/// Where a mesh comes from.
enum Source {
    File(PathBuf),
    Generated { shape: Shape, triangles: u32 },
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    Terrain,
    Genus2,
}

impl std::str::FromStr for Shape {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "terrain" => Ok(Self::Terrain),
            "genus-2" => Ok(Self::Genus2),
            _ => Err(format!("there is no shape `{name}`; there are {}", SHAPES.join(", "))),
        }
    }
}

impl Bench {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        let tasks = self.tasks()?;
        if self.row {
            let [task] = tasks.as_slice() else {
                return Err(CommandError::Other(format!("--row is for one row, not for {}", tasks.len())));
            };
            let row = self.measure(task)?;
            print_json(&serde_json::to_value(row).map_err(|error| CommandError::Other(error.to_string()))?);
            return Ok(ExitCode::SUCCESS);
        }
        let new_folder = files::make_folder(&self.output)?;
        files::check_writable(&self.output)?;
        let measured = self.all_rows(&tasks).and_then(|(rows, notes)| match (rows.is_empty(), notes.as_slice()) {
            (true, [first, others @ ..]) => {
                let more = if others.is_empty() { String::new() } else { format!("; and {} rows more", others.len()) };
                Err(CommandError::Other(format!("nothing was measured: {first}{more}")))
            }
            _ => Ok((rows, notes)),
        });
        if measured.is_err() && new_folder {
            files::remove_empty_folder(&self.output);
        }
        let (rows, notes) = measured?;
        self.write(&rows, &notes)?;
        if self.json {
            print_json(&json!({ "made": made_by(), "rows": rows, "notes": notes }));
        } else {
            print_text(&bench::markdown(&rows));
            notes.iter().for_each(|note| print_text(note));
            print_text(&format!("read {}", self.output.join("index.html").display()));
        }
        Ok(ExitCode::SUCCESS)
    }

    fn tasks(&self) -> Result<Vec<Task>, CommandError> {
        let shapes: Vec<Shape> = chosen(&self.shapes, &SHAPES)?;
        let operators: Vec<AnyOperator> = chosen(&self.operators, &AnyOperator::NAMES)?;
        let kinds = DependencyKind::all().map(DependencyKind::name).collect::<Vec<_>>();
        let dependencies: Vec<DependencyKind> = chosen(&self.dependencies, &kinds)?;
        let mut tasks = Vec::new();
        for (i, path) in self.models.iter().enumerate() {
            files::check_readable(path)?;
            if self.models[..i].iter().any(|other| name_of(other) == name_of(path)) {
                return Err(FileError::new(path, "another model of the benchmark has the same name").into());
            }
        }
        let sources = || -> Vec<Source> {
            if !self.models.is_empty() {
                return self.models.iter().cloned().map(Source::File).collect();
            }
            let sizes = distinct(&self.triangles);
            let of = |shape| sizes.clone().into_iter().map(move |triangles| Source::Generated { shape, triangles });
            shapes.iter().copied().flat_map(of).collect()
        };
        for operator in &operators {
            for &dependency in &dependencies {
                for threads in distinct(&self.threads) {
                    let task = |model| Task { model, operator: operator.clone(), dependency, threads };
                    tasks.extend(sources().into_iter().map(task));
                }
            }
        }
        Ok(tasks)
    }

    /// Every row in a process of its own, so that none has the memory of another. What cannot be measured is noted.
    fn all_rows(&self, tasks: &[Task]) -> Result<(Vec<Row>, Vec<String>), CommandError> {
        let (mut rows, mut notes) = (Vec::new(), Vec::new());
        let mut progress = Progress::new("measuring", (tasks.len() * self.runs as usize) as u64);
        for task in tasks {
            for _ in 0..self.runs {
                if !progress.step() || interrupted() {
                    return Err(CommandError::Interrupted);
                }
                match self.in_process(task)? {
                    Ok(row) => rows.push(row),
                    Err(why) => {
                        let names = [task.model.name(), task.operator.name(), task.dependency.name().to_owned()];
                        let note = format!("{}: {why}", names.join(", "));
                        notes.push(note);
                        break;
                    }
                }
            }
        }
        Ok((rows, notes))
    }

    fn in_process(&self, task: &Task) -> Result<Result<Row, String>, CommandError> {
        let other = |error: &dyn std::fmt::Display| CommandError::Other(format!("no process to measure in: {error}"));
        let mut command = Command::new(std::env::current_exe().map_err(|error| other(&error))?);
        command.args(["bench", "--row", "--frames", &self.frames.to_string(), "--samples", &self.samples.to_string()]);
        command.args(["--operators", &task.operator.name(), "--dependencies", task.dependency.name()]);
        command.args(["--threads", &task.threads.to_string(), "-o"]).arg(&self.output);
        command.args(self.regions.iter().flat_map(|vertices| ["--regions".to_owned(), vertices.to_string()]));
        let limit = memory::told_limit().map(|bytes| ["--memory-limit".to_owned(), bytes.to_string()]);
        command.args(limit.into_iter().flatten());
        match &task.model {
            Source::File(path) => _ = command.arg("--").arg(path),
            Source::Generated { shape, triangles } => {
                command.args(["--shapes", shape.name(), "--triangles", &triangles.to_string()]);
            }
        }
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|error| other(&error))?;
        let file = self.row_file(child.id());
        // What a row prints fits into a pipe, so it can be read when the process has ended.
        while child.try_wait().map_err(|error| other(&error))?.is_none() {
            if interrupted() {
                _ = child.kill();
            }
            std::thread::sleep(LOOK_EVERY);
        }
        let done = child.wait_with_output();
        // Whatever became of the process, what it wrote is not to stay.
        files::remove(&file);
        let done = done.map_err(|error| other(&error))?;
        if interrupted() {
            return Err(CommandError::Interrupted);
        }
        if done.status.success() {
            return Ok(serde_json::from_slice(&done.stdout).map_err(|error| error.to_string()));
        }
        let told = String::from_utf8_lossy(&done.stderr);
        let why = told.lines().rev().find_map(|line| line.strip_prefix("error: ")).unwrap_or("it ended without a word");
        Ok(Err(format!("{why} ({})", done.status)))
    }

    /// Builds, writes, loads and measures one row in this process.
    fn measure(&self, task: &Task) -> Result<Row, CommandError> {
        use_threads(task.threads as usize)?;
        task.check_memory()?;
        let (mesh, name) = (task.model.load()?, task.model.name());
        let path = Path::new(&name);
        let coarsening = self.coarsening(&mesh, task);
        let counts = [mesh.vertex_count(), mesh.cell_count()];
        // What loading took is no part of what building takes.
        forget_peak();
        let clock = Clock::start();
        let kept = match task.dependency {
            DependencyKind::Cells => Kept::cells(path, &mesh, &coarsening)?.0,
            DependencyKind::Scheme(scheme) => Kept::merges(path, mesh, &coarsening, scheme, None)?.0,
        };
        let mut built = Built {
            threads: task.threads as usize,
            region_vertices: coarsening.regions.map_or(0, |regions| regions.vertices),
            wall_s: clock.wall(),
            cpu_s: clock.cpu(),
            peak_bytes: peak_bytes(),
            bytes: kept.bytes(),
            ..Built::default()
        };
        let base = kept.base();
        let file = self.row_file(std::process::id());
        let model = store(kept, &file, &mut built);
        files::remove(&file);
        let input = task.model.load()?;
        let visit = Measure { bench: self, input: &input };
        let (quality, steps, frames) = match model? {
            Model::Triangles(model) => visit.on(&*model),
            Model::Hierarchy { replay, scheme } => {
                scheme.visit(&replay, visit).map_err(|error| FileError::new(path, error))?
            }
            Model::Tetrahedra(_) => return Err(files::no_triangles(path).into()),
        };
        Ok(Row {
            model: name,
            shape: task.model.shape(),
            operator: task.operator.name(),
            dependency: task.dependency.name().to_owned(),
            vertices: counts[0],
            triangles: counts[1],
            base,
            built,
            quality,
            steps,
            frames,
        })
    }

    /// Where the model of a row is kept while it is measured.
    fn row_file(&self, process: u32) -> PathBuf {
        self.output.join(format!("row-{process}.mt"))
    }

    fn coarsening(&self, mesh: &Mesh<3>, task: &Task) -> Coarsening {
        let options = Options::default();
        let regions = match self.regions {
            Some(0) => None,
            Some(vertices) => {
                task.operator.works_by_regions().then_some(Regions { vertices, threads: task.threads as usize })
            }
            None => usual_regions(mesh, &task.operator, &options, task.threads as usize),
        };
        Coarsening { operator: task.operator.clone(), options, regions }
    }

    fn write(&self, rows: &[Row], notes: &[String]) -> Result<(), CommandError> {
        let at = |name: &str| self.output.join(name);
        let all = json!({ "made": made_by(), "rows": rows, "notes": notes });
        let json = serde_json::to_vec_pretty(&all).map_err(|error| CommandError::Other(error.to_string()))?;
        let text = [made_by(), bench::markdown(rows), notes.join("\n")].join("\n\n");
        files::write_bytes(&at("bench.csv"), bench::csv(rows).as_bytes())?;
        files::write_bytes(&at("bench.json"), &json)?;
        files::write_bytes(&at("bench.md"), text.as_bytes())?;
        // The page comes last: where it is, everything it tells of is.
        Ok(files::write_bytes(&at("index.html"), bench::page(rows, &made_by(), notes).as_bytes())?)
    }
}

/// Writes the model and loads it again.
fn store(kept: Kept, file: &Path, built: &mut Built) -> Result<Model, FileError> {
    let clock = Clock::start();
    files::write(file, |out| kept.write(&Meta::default(), Storage::Plain, out))?;
    built.write_s = clock.wall();
    drop(kept);
    built.file_bytes = files::length(file)?;
    let clock = Clock::start();
    let (model, _) = files::load_model(file)?;
    built.load_s = clock.wall();
    Ok(model)
}

/// Measures a model, whatever its dependencies.
struct Measure<'a> {
    bench: &'a Bench,
    input: &'a Mesh<3>,
}

/// What [`bench::measure`] gives.
type Measured = (Vec<bench::Quality>, Option<bench::Steps>, Option<bench::Frames>);

impl Measure<'_> {
    fn on<M: MultiTessellation<3, Bound = Bound>>(self, model: &M) -> Measured {
        let clock = Clock::start();
        let samples = if self.input.cell_count() > MEASURED_MAX { 0 } else { self.bench.samples as usize };
        bench::measure(model, self.input, self.bench.frames, samples, &|| clock.cpu())
    }
}

impl Visit for Measure<'_> {
    type Output = Measured;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> Measured {
        self.on(model)
    }
}

impl Task {
    /// Refuses to generate what is expected not to fit. What is loaded is looked at as it is loaded.
    fn check_memory(&self) -> Result<(), CommandError> {
        let Source::Generated { triangles, .. } = self.model else { return Ok(()) };
        let by_regions = go_by_regions(&self.operator, triangles as usize);
        let bytes = memory::of_coarsening(triangles as usize, by_regions, self.dependency == DependencyKind::Cells);
        memory::allow(&self.model.name(), bytes).map_err(|error| CommandError::Other(error.to_string()))
    }
}

impl Source {
    fn name(&self) -> String {
        match self {
            Self::File(path) => name_of(path),
            Self::Generated { shape, triangles } => format!("{}-{triangles}", shape.name()),
        }
    }

    fn shape(&self) -> Option<String> {
        match self {
            Self::File(_) => None,
            Self::Generated { shape, .. } => Some(shape.name().to_owned()),
        }
    }

    fn load(&self) -> Result<Mesh<3>, CommandError> {
        match self {
            Self::File(path) => {
                // What is no manifold is refused by who cannot take it, and noted.
                Ok(files::load_mesh(path, &LoadOptions::default())?.0)
            }
            Self::Generated { shape, triangles } => Ok(shape.generate(*triangles)),
        }
    }
}

impl Shape {
    fn name(self) -> &'static str {
        match self {
            Self::Terrain => SHAPES[0],
            Self::Genus2 => SHAPES[1],
        }
    }

    /// A mesh of about so many triangles.
    fn generate(self, triangles: u32) -> Mesh<3> {
        let triangles = f64::from(triangles.max(128));
        match self {
            Self::Terrain => generate::terrain((triangles / 2.0).sqrt().round() as usize, 0.55, 7),
            // A surface on a grid of n has about 100 n² triangles.
            Self::Genus2 => generate::genus_surface(2, (triangles / 100.0).sqrt().round().max(4.0) as usize, 0.05, 7),
        }
    }
}

/// What the figures were measured on, and by which command.
fn made_by() -> String {
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
    let command: Vec<String> = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let (system, version) = (std::env::consts::OS, env!("CARGO_PKG_VERSION"));
    format!("mtess {version} on {system} {}, {cores} cores: mtess {}", std::env::consts::ARCH, command.join(" "))
}
