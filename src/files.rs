//! The only room that opens files: readers and writers elsewhere work on bytes.

use crate::memory;
use crate::progress::spinning;
use mt_core::container::{self, Archive, Container, Meta};
use mt_core::format::{Format, LoadOptions, LoadReport};
use mt_core::{Explicit, Mesh, Replay};
use operators::order::Scheme;
use std::io::{self, BufWriter, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// What went wrong with a file, as one line.
#[derive(Debug, thiserror::Error)]
#[error("{}: {what}", path.display())]
pub struct FileError {
    path: PathBuf,
    what: String,
}

impl FileError {
    /// A fault of this file.
    pub fn new(path: &Path, what: impl std::fmt::Display) -> Self {
        Self { path: path.to_owned(), what: what.to_string() }
    }
}

/// Refuses what is no file that could be read: a folder, a device, nothing.
pub fn check_readable(path: &Path) -> Result<(), FileError> {
    let what = match path {
        _ if path.is_dir() => "is a folder, not a file",
        _ if !path.exists() => "no such file",
        _ if !path.is_file() => "is not a regular file",
        _ if std::fs::metadata(path).is_ok_and(|about| about.len() == 0) => "the file is empty",
        _ => return Ok(()),
    };
    Err(FileError::new(path, what))
}

/// All bytes of a file; a folder, a missing or an empty file is refused by name.
pub fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    check_readable(path)?;
    std::fs::read(path).map_err(|error| FileError::new(path, error))
}

/// Refuses to load what takes more memory than there is.
fn allow(path: &Path, bytes: u64) -> Result<(), FileError> {
    memory::allow("loading it", bytes).map_err(|error| FileError::new(path, error))
}

/// A mesh, by the file's ending, and what loading it found.
pub fn load_mesh(path: &Path, options: &LoadOptions) -> Result<(Mesh<3>, LoadReport), FileError> {
    if path.is_dir() {
        return Err(FileError::new(path, "is a folder, not a file"));
    }
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let Some(format) = Format::from_extension(ending) else {
        let what = if ending == "mt" {
            "is a model, not a mesh"
        } else {
            "the ending tells no format that can be read (obj, ply, stl, off, gltf, glb)"
        };
        return Err(if path.exists() { FileError::new(path, what) } else { FileError::new(path, "no such file") });
    };
    check_readable(path)?;
    allow(path, memory::of_loading_mesh(length(path)?))?;
    // A glTF file names its buffers relative to itself, and may come from anybody: it reads nothing from elsewhere.
    let beside = |name: &str| {
        let below = Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        let at = path.parent().unwrap_or(Path::new("")).join(name);
        // A link to a device would never end.
        if below && at.is_file() { std::fs::read(at).ok() } else { None }
    };
    spinning("loading", || {
        let bytes = read(path)?;
        mt_core::format::read(format, &bytes, options, &beside).map_err(|error| FileError::new(path, error))
    })
}

/// A model.
pub enum Model {
    /// Explicit, of triangles.
    Triangles(Box<Explicit<3>>),
    /// Explicit, of tetrahedra.
    Tetrahedra(Box<Explicit<4>>),
    /// A vertex hierarchy.
    Hierarchy {
        /// Its merges.
        replay: Arc<Replay>,
        /// What its steps wait for.
        scheme: Scheme,
    },
}

/// A model and what its file says about it.
pub fn load_model(path: &Path) -> Result<(Model, Meta), FileError> {
    let unpacked = open_archive(path)?.sections().map(|section| section.length).fold(0, u64::saturating_add);
    allow(path, memory::of_loading_model(length(path)?, unpacked))?;
    spinning("loading", || model_in(path))
}

fn model_in(path: &Path) -> Result<(Model, Meta), FileError> {
    let bytes = read(path)?;
    let wrong = |error| FileError::new(path, error);
    let container = container::open(&bytes).map_err(wrong)?;
    if let Some(name) = container.meta().dependency.clone() {
        return hierarchy(path, container, &name);
    }
    match container.meta().corners {
        4 => container.model::<4>().map(|(model, meta)| (Model::Tetrahedra(Box::new(model)), meta)).map_err(wrong),
        _ => container.model::<3>().map(|(model, meta)| (Model::Triangles(Box::new(model)), meta)).map_err(wrong),
    }
}

fn hierarchy(path: &Path, container: Container<'_>, scheme: &str) -> Result<(Model, Meta), FileError> {
    let scheme = scheme.parse().map_err(|error| FileError::new(path, format!("the file is not a model: {error}")))?;
    let (story, meta) = container.story().map_err(|error| FileError::new(path, error))?;
    let replay = story.replay().map_err(|error| FileError::new(path, format!("the file is not a model: {error}")))?;
    Ok((Model::Hierarchy { replay: Arc::new(replay), scheme }, meta))
}

/// Head and metadata of a model's file; its sections can be had one by one.
pub fn open_archive(path: &Path) -> Result<Archive<std::fs::File>, FileError> {
    check_readable(path)?;
    let file = std::fs::File::open(path).map_err(|error| FileError::new(path, error))?;
    Archive::open(file).map_err(|error| FileError::new(path, error))
}

/// Refuses a model of tetrahedra where triangles are wanted.
pub fn no_triangles(path: &Path) -> FileError {
    FileError::new(path, "is a model of tetrahedra; this command wants triangles")
}

/// A value from a JSON file.
pub fn load_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, FileError> {
    serde_json::from_slice(&read(path)?).map_err(|error| FileError::new(path, error))
}

/// A file to read line by line.
pub fn open_lines(path: &Path) -> Result<io::BufReader<std::fs::File>, FileError> {
    if path.is_dir() {
        return Err(FileError::new(path, "is a folder, not a file"));
    }
    let missing = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound => FileError::new(path, "no such file"),
        _ => FileError::new(path, error),
    };
    Ok(io::BufReader::new(std::fs::File::open(path).map_err(missing)?))
}

/// Refuses what cannot become a file: a folder, or a place in a folder that does not exist. Commands ask before the work
/// starts, not after.
pub fn check_place(path: &Path) -> Result<(), FileError> {
    if path.is_dir() {
        return Err(FileError::new(path, "is a folder, not a file"));
    }
    if folder_of(path).is_dir() { Ok(()) } else { Err(FileError::new(path, "the folder does not exist")) }
}

/// [`check_place`], and that the ending is the one of such files. So a slip of the hand replaces no input.
pub fn check_output(path: &Path, what: &str, ending: &str) -> Result<(), FileError> {
    if path.extension().and_then(|e| e.to_str()) != Some(ending) {
        return Err(FileError::new(path, format!("{what} is written with the ending {ending}")));
    }
    check_place(path)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The temporary file that is being written, for whoever ends the process.
static PART: Mutex<Option<PathBuf>> = Mutex::new(None);

fn part() -> MutexGuard<'static, Option<PathBuf>> {
    PART.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes what is half-written. As long as the guard lives no other file is begun, and none takes its name.
pub fn discard_part() -> impl Drop {
    let mut part = part();
    if let Some(path) = part.take() {
        _ = std::fs::remove_file(path);
    }
    part
}

fn begin_part(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".mtess-").suffix(".part");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut part = part();
    let file = builder.tempfile_in(folder)?;
    *part = Some(file.path().to_owned());
    Ok(file)
}

/// Writes a file whole or not at all: into a temporary file beside it, which then takes its name.
pub fn write(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FileError> {
    let wrong = |error: io::Error| FileError::new(path, format!("cannot be written: {error}"));
    check_place(path)?;
    let mut file = begin_part(folder_of(path)).map_err(wrong)?;
    let mut buffer = BufWriter::with_capacity(1 << 20, file.as_file_mut());
    let filled = fill(&mut buffer).and_then(|()| buffer.flush());
    drop(buffer);
    let filled = filled.and_then(|()| file.as_file().sync_all());
    let mut part = part();
    *part = None;
    filled.map_err(wrong)?;
    file.persist(path).map_err(|error| wrong(error.error))?;
    Ok(())
}

/// Writes bytes whole or not at all.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    write(path, |out| out.write_all(bytes))
}

/// Writes a mesh in the format of the file's ending.
pub fn write_mesh(path: &Path, mesh: &Mesh<3>) -> Result<(), FileError> {
    let format = mesh_format(path)?;
    let bytes = mt_core::format::write(format, mesh).map_err(|error| FileError::new(path, error))?;
    write_bytes(path, &bytes)
}

/// The format that a mesh would be written in, by the file's ending.
pub fn mesh_format(path: &Path) -> Result<Format, FileError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    Format::from_extension(ending)
        .filter(|format| format.is_writable())
        .ok_or_else(|| FileError::new(path, "the ending tells no format that can be written (obj, ply, stl, off, glb)"))
}

/// Makes a folder and those above it; whether it was not there before.
pub fn make_folder(path: &Path) -> Result<bool, FileError> {
    let new = !path.exists();
    std::fs::create_dir_all(path).map_err(|error| FileError::new(path, format!("cannot be made: {error}")))?;
    Ok(new)
}

/// Refuses a folder in which no file can be made.
pub fn check_writable(folder: &Path) -> Result<(), FileError> {
    let probe = tempfile::Builder::new().prefix(".mtess-").suffix(".part").tempfile_in(folder);
    probe.map(|_| ()).map_err(|error| FileError::new(folder, format!("no file can be written there: {error}")))
}

/// Something that changes when this program is built anew: its size and the time it was written. Empty where nobody knows.
pub fn program_mark() -> String {
    let about = std::env::current_exe().and_then(std::fs::metadata);
    let time = |about: &std::fs::Metadata| {
        let since = about.modified().ok()?.duration_since(std::time::UNIX_EPOCH).ok()?;
        Some(since.as_nanos())
    };
    about.ok().map_or(String::new(), |about| format!("{:x}{:x}", about.len(), time(&about).unwrap_or(0)))
}

/// Refuses what is no folder.
pub fn check_folder(path: &Path) -> Result<(), FileError> {
    if path.is_dir() { Ok(()) } else { Err(FileError::new(path, "is no folder")) }
}

/// Bytes of a file.
pub fn length(path: &Path) -> Result<u64, FileError> {
    std::fs::metadata(path).map(|about| about.len()).map_err(|error| FileError::new(path, error))
}

/// Takes a file of our own away.
pub fn remove(path: &Path) {
    _ = std::fs::remove_file(path);
}

/// Takes a folder away in which nothing has been put.
pub fn remove_empty_folder(path: &Path) {
    _ = std::fs::remove_dir(path);
}
