//! `mtess view`: a window on one model or two.

use super::{CommandError, print_text};
use crate::coarsening::{Coarsening, replay_of};
use crate::files::{self, FileError, Model};
use crate::kept::Kept;
use crate::progress::interrupted;
use crate::selection;
use crate::subject::{Sheets, is_mesh, usual_scheme};
use clap::Args;
use glam::Vec3;
use mt_core::log::Log;
use mt_core::{Explicit, Mesh, Replay};
use operators::AnyOperator;
use papers::study::{DependencyKind, built_in};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use viewer::{AnyView, Ask, Choice, Extent, File, Make, Opening, Pane, ViewFrom, Viewer, view_of};

#[derive(Args)]
pub struct View {
    /// The model, or a mesh: mt, obj, ply, stl, off, gltf or glb; two of them side by side. If none is named, a generated one
    #[arg(num_args = 0..=2)]
    models: Vec<PathBuf>,
    /// Of meshes: what coarsens them, as in `mtess build` [default: edge-collapse]
    #[arg(long, value_name = "NAME[/METRIC]")]
    operator: Option<AnyOperator>,
    /// Of meshes: what to do with edges and vertices where several sheets meet
    #[arg(long, value_enum, default_value_t = Sheets::Refuse)]
    non_manifold: Sheets,
    /// What steps wait for: cells, or a scheme as in `mtess build` [default: dual-piece for a mesh, one-ring if its topology is
    /// coarsened, else as the model was built]
    #[arg(long, value_name = "NAME")]
    dependency: Option<DependencyKind>,
    /// A second pane of the same model, under this dependency
    #[arg(long, value_name = "NAME")]
    beside: Option<DependencyKind>,
    /// A camera path to follow: a JSON list of cameras, as studies and movies take it
    #[arg(long, value_name = "FILE.json")]
    cameras: Option<PathBuf>,
    /// A log to walk along, as `mtess bisect` and `mtess verify` write it; it begins at its first step
    #[arg(long, value_name = "FILE.steps")]
    log: Option<PathBuf>,
    /// Largest error on the screen, in pixels
    #[arg(long, value_name = "PX", default_value_t = 1.0)]
    pixels: f32,
    /// Folder of what is saved
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    output: PathBuf,
    /// Destroy the device after so many frames, to see that the window comes back
    #[arg(long, value_name = "N", hide = true)]
    lose_device_after: Option<u32>,
}

impl View {
    pub fn run(self) -> Result<ExitCode, CommandError> {
        if !Ask::PIXELS.contains(&self.pixels) {
            let (least, most) = (Ask::PIXELS.start(), Ask::PIXELS.end());
            return Err(CommandError::Other(format!("--pixels must be a number from {least} to {most}")));
        }
        if self.beside.is_some() && self.models.len() == 2 {
            return Err(CommandError::Other("there are two panes: two models, or one with --beside".into()));
        }
        files::make_folder(&self.output)?;
        files::check_writable(&self.output)?;
        let path = self.cameras.as_deref().map(|path| selection::cameras(Some(path), 0, &[])).transpose()?;
        let sources = Arc::new(self.sources()?);
        let kept = Arc::clone(&sources);
        let make: Make = Arc::new(move |model, choice| kept[model].view(choice).map_err(|error| error.to_string()));
        let mut panes = Vec::new();
        for (i, source) in sources.iter().enumerate() {
            let dependencies = [Some(source.came.dependency), self.beside];
            for dependency in dependencies.into_iter().flatten() {
                let choice = Choice { dependency, ..source.came.clone() };
                let view = source.view(&choice)?;
                panes.push(Pane::new(i, choice, view));
            }
        }
        if let Some(path) = &self.log {
            let wrong = |error| FileError::new(path, error);
            let log = Log::read(files::open_lines(path)?).map_err(wrong)?;
            for pane in &mut panes {
                pane.take_log(log.clone()).map_err(wrong)?;
            }
        }
        let subjects = (0..sources.len()).map(|i| subject(&sources, i)).collect();
        let mut viewer = Viewer::new(subjects, panes, make, path.unwrap_or_default());
        viewer.ask.error_px = self.pixels;
        let folder = self.output;
        let save = Box::new(move |model: usize, what: &str, files: &[File]| {
            let stem = sources[model].path.file_stem().unwrap_or_default().to_string_lossy();
            written(&folder, &stem, what, files)
        });
        let opening = Opening { save, is_to_close: interrupted, lose_after: self.lose_device_after };
        let viewer = viewer::open(viewer, opening).map_err(|error| {
            CommandError::Other(format!("{error}; mtess render and mtess movie make pictures without a window"))
        })?;
        print_text(&closing(&viewer));
        Ok(ExitCode::SUCCESS)
    }

    fn sources(&self) -> Result<Vec<Source>, CommandError> {
        if self.models.is_empty() {
            let subject = built_in().swap_remove(0);
            return Ok(vec![self.of_mesh(Path::new(&subject.name), subject.mesh, Loaded::Generated)?]);
        }
        self.models.iter().map(|path| self.source(path)).collect()
    }

    fn source(&self, path: &Path) -> Result<Source, CommandError> {
        if is_mesh(path) {
            let (mesh, report) = files::load_mesh(path, &self.non_manifold.options())?;
            eprint!("{report}");
            return self.of_mesh(path, mesh, Loaded::Mesh);
        }
        let (model, meta) = files::load_model(path)?;
        let (loaded, mesh, dependency) = match model {
            Model::Triangles(model) => {
                let mesh = model.reference();
                (Loaded::Cells(Arc::new(*model)), mesh, DependencyKind::Cells)
            }
            Model::Hierarchy { replay, scheme } => {
                let mesh = replay.reference();
                (Loaded::Merges(replay), mesh, DependencyKind::Scheme(scheme))
            }
            Model::Tetrahedra(_) => return Err(files::no_triangles(path).into()),
        };
        let operator = self.operator.as_ref().map(AnyOperator::name);
        let came = Choice { operator, dependency: self.dependency.unwrap_or(dependency) };
        Ok(Source::new(path, mesh, loaded, came, meta.operator))
    }

    fn of_mesh(&self, path: &Path, mesh: Mesh<3>, loaded: Loaded) -> Result<Source, CommandError> {
        let operator = crate::subject::operator_or_usual(self.operator.as_ref())?;
        let dependency = self.dependency.unwrap_or_else(|| DependencyKind::Scheme(usual_scheme(&operator)));
        let came = Choice { operator: None, dependency };
        Ok(Source { sheets: self.non_manifold, ..Source::new(path, mesh, loaded, came, operator.name()) })
    }
}

/// What a file held.
enum Loaded {
    /// Nothing: the mesh is generated.
    Generated,
    Mesh,
    Cells(Arc<Explicit<3>>),
    Merges(Arc<Replay>),
}

/// A model to look at, and what was made of its input since.
struct Source {
    path: PathBuf,
    mesh: Mesh<3>,
    extent: Extent,
    loaded: Loaded,
    came: Choice,
    made_by: String,
    sheets: Sheets,
    /// By operator.
    cells: Shelf<Arc<Explicit<3>>>,
    replays: Shelf<Arc<Replay>>,
}

impl Source {
    fn new(path: &Path, mesh: Mesh<3>, loaded: Loaded, came: Choice, made_by: String) -> Self {
        let extent = Extent::of(&mesh);
        let (cells, replays) = Default::default();
        Self { path: path.to_owned(), mesh, extent, loaded, came, made_by, sheets: Sheets::Refuse, cells, replays }
    }

    /// The words by which other commands load it under a choice.
    fn words(&self, choice: &Choice) -> Option<String> {
        let path = quoted(&self.path.to_string_lossy());
        let as_it_came = choice.operator.is_none();
        let operator = choice.operator.as_ref().unwrap_or(&self.made_by);
        match (&self.loaded, choice.dependency) {
            (Loaded::Generated, _) => None,
            (Loaded::Mesh, DependencyKind::Scheme(scheme)) => {
                let split = if self.sheets == Sheets::Split { " --non-manifold split" } else { "" };
                Some(format!("{path} --operator {operator} --dependency {scheme}{split}"))
            }
            (Loaded::Cells(_), DependencyKind::Cells) if as_it_came => Some(path),
            (Loaded::Merges(_), DependencyKind::Scheme(scheme)) if as_it_came => {
                Some(format!("{path} --dependency {scheme}"))
            }
            _ => None,
        }
    }

    /// A view under a choice, of what is there or what is made now.
    fn view(&self, choice: &Choice) -> Result<Box<dyn AnyView>, CommandError> {
        let origin: Vec3 = (self.extent.low + self.extent.high) * 0.5;
        let as_it_came = choice.operator.is_none();
        let name = choice.operator.clone().unwrap_or_else(|| self.made_by.clone());
        let wrong = |error: &dyn std::fmt::Display| CommandError::File(FileError::new(&self.path, error));
        match (choice.dependency, &self.loaded) {
            (DependencyKind::Cells, Loaded::Cells(model)) if as_it_came => Ok(view_of(Arc::clone(model), origin)),
            (DependencyKind::Cells, _) => Ok(view_of(kept(&self.cells, &name, || self.coarsened(&name))?, origin)),
            (DependencyKind::Scheme(scheme), loaded) => {
                let replay = match loaded {
                    Loaded::Merges(replay) if as_it_came => Arc::clone(replay),
                    _ => kept(&self.replays, &name, || {
                        replay_of(&self.path, &self.mesh, &self.operator(&name)?).map(Arc::new)
                    })?,
                };
                scheme.visit(&replay, ViewFrom(origin)).map_err(|error| wrong(&error))
            }
        }
    }

    /// The operator of this name; a file may name one that is not known.
    fn operator(&self, name: &str) -> Result<AnyOperator, CommandError> {
        let unknown = |error| FileError::new(&self.path, format!("{error}; choose one"));
        AnyOperator::from_str(name).map_err(|error| unknown(error).into())
    }

    fn coarsened(&self, name: &str) -> Result<Arc<Explicit<3>>, CommandError> {
        let coarsening = Coarsening::usual(&self.mesh, &self.operator(name)?);
        match Kept::cells(&self.path, &self.mesh, &coarsening)?.0 {
            Kept::Cells(model) => Ok(Arc::new(*model)),
            Kept::Merges { .. } => Err(CommandError::Other("merges were kept where cells were asked for".into())),
        }
    }
}

/// What was made, by name. What is being made is locked by itself.
type Shelf<T> = Mutex<HashMap<String, Arc<Mutex<Option<T>>>>>;

/// What is kept under a name, or is made now; others may make other things meanwhile.
fn kept<T: Clone>(
    shelf: &Shelf<T>,
    name: &str,
    make: impl FnOnce() -> Result<T, CommandError>,
) -> Result<T, CommandError> {
    let place = Arc::clone(locked(shelf).entry(name.to_owned()).or_default());
    let mut place = locked(&place);
    if let Some(there) = &*place {
        return Ok(there.clone());
    }
    Ok(place.insert(make()?).clone())
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the window tells of a model.
fn subject(sources: &Arc<Vec<Source>>, i: usize) -> viewer::Subject {
    let (source, all) = (&sources[i], Arc::clone(sources));
    viewer::Subject {
        name: source.path.to_string_lossy().into_owned(),
        extent: source.extent.clone(),
        made_by: source.made_by.clone(),
        words: Arc::new(move |choice| all[i].words(choice)),
    }
}

/// A file's name as a shell takes it.
fn quoted(name: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-+".contains(c);
    if name.chars().all(plain) { name.to_owned() } else { format!("'{}'", name.replace('\'', "'\\''")) }
}

/// Writes files under the first free name: `bunny-picture-001.png` and so on; in texts that is what `NAME` comes to.
fn written(folder: &Path, stem: &str, what: &str, files: &[File]) -> Result<String, String> {
    let name = |number: u32| format!("{stem}-{what}-{number:03}");
    let is_free =
        |number: &u32| files.iter().all(|(ending, _)| !folder.join(format!("{}.{ending}", name(*number))).exists());
    let number = (1..100_000).find(is_free).ok_or("the folder is full of pictures")?;
    let stem_of_all = folder.join(name(number)).display().to_string();
    for (ending, bytes) in files {
        let path = folder.join(format!("{}.{ending}", name(number)));
        let bytes = match std::str::from_utf8(bytes) {
            Ok(text) if *ending == "json" => text.replace("NAME.", &format!("{stem_of_all}.")).into_bytes(),
            _ => bytes.clone(),
        };
        files::write_bytes(&path, &bytes).map_err(|error| error.to_string())?;
    }
    Ok(stem_of_all)
}

/// A line on what was seen last.
fn closing(viewer: &Viewer) -> String {
    let times = viewer.records.iter().map(|record| record.whole.as_secs_f64() * 1e3);
    let mut times: Vec<f64> = times.filter(|&time| time > 0.0).collect();
    times.sort_by(f64::total_cmp);
    let triangles = viewer.panes[0].view.places().triangle_count();
    match times.get(times.len() / 2) {
        Some(median) => format!(
            "closed at {triangles} triangles; the last {} frames in motion took {median:.1} ms each, as median",
            times.len()
        ),
        None => format!("closed at {triangles} triangles"),
    }
}
