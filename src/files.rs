//! The only room that opens files: readers and writers elsewhere work on bytes.

use mt_core::container::{self, Meta};
use mt_core::format::{Format, LoadOptions, LoadReport};
use mt_core::{Explicit, Mesh};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

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

/// All bytes of a file; a folder, a missing or an empty file is refused by name.
pub fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    if path.is_dir() {
        return Err(FileError::new(path, "is a folder, not a file"));
    }
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => FileError::new(path, "no such file"),
        _ => FileError::new(path, error),
    })?;
    if bytes.is_empty() { Err(FileError::new(path, "the file is empty")) } else { Ok(bytes) }
}

/// A mesh, by the file's ending, and what loading it found.
pub fn load_mesh(path: &Path, options: &LoadOptions) -> Result<(Mesh<3>, LoadReport), FileError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let Some(format) = Format::from_extension(ending) else {
        let what = if ending == "mt" {
            "is a model, not a mesh"
        } else {
            "the ending tells no format that can be read (obj, ply, stl, off, gltf, glb)"
        };
        return Err(if path.exists() { FileError::new(path, what) } else { FileError::new(path, "no such file") });
    };
    let bytes = read(path)?;
    // A glTF file names its buffers relative to itself.
    let beside = |name: &str| std::fs::read(path.parent().unwrap_or(Path::new("")).join(name)).ok();
    mt_core::format::read(format, &bytes, options, &beside).map_err(|error| FileError::new(path, error))
}

/// A model of either dimension.
pub enum Model {
    /// Of triangles.
    Triangles(Box<Explicit<3>>),
    /// Of tetrahedra.
    Tetrahedra(Box<Explicit<4>>),
}

/// A model and what its file says about it.
pub fn load_model(path: &Path) -> Result<(Model, Meta), FileError> {
    let bytes = read(path)?;
    let wrong = |error| FileError::new(path, error);
    let meta = container::read_meta(&bytes).map_err(wrong)?;
    match meta.corners {
        4 => {
            container::read::<4>(&bytes).map(|(model, meta)| (Model::Tetrahedra(Box::new(model)), meta)).map_err(wrong)
        }
        _ => container::read::<3>(&bytes).map(|(model, meta)| (Model::Triangles(Box::new(model)), meta)).map_err(wrong),
    }
}

/// A model of triangles.
pub fn load_triangles(path: &Path) -> Result<(Explicit<3>, Meta), FileError> {
    match load_model(path)? {
        (Model::Triangles(model), meta) => Ok((*model, meta)),
        (Model::Tetrahedra(_), _) => {
            Err(FileError::new(path, "is a model of tetrahedra; this command wants triangles"))
        }
    }
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

/// Writes a file whole or not at all: into a temporary file beside it, which then takes its name.
pub fn write(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FileError> {
    let wrong = |error: io::Error| FileError::new(path, format!("cannot be written: {error}"));
    if path.is_dir() {
        return Err(FileError::new(path, "is a folder, not a file"));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(FileError::new(path, "the folder does not exist"));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".mtess-").suffix(".part");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder).map_err(wrong)?;
    let mut buffer = BufWriter::with_capacity(1 << 20, file.as_file_mut());
    fill(&mut buffer).and_then(|()| buffer.flush()).map_err(wrong)?;
    drop(buffer);
    file.as_file().sync_all().map_err(wrong)?;
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
        .ok_or_else(|| FileError::new(path, "the ending tells no format that can be written (obj, ply, stl, glb)"))
}

/// Makes a folder and those above it.
pub fn make_folder(path: &Path) -> Result<(), FileError> {
    std::fs::create_dir_all(path).map_err(|error| FileError::new(path, format!("cannot be made: {error}")))
}
