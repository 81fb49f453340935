//! What can be wrong with a file, and where: one clear line each.

use super::Format;
use std::fmt;

/// Why a file was refused. Displays as `OBJ, line 12: vertex index 40 is out of range (8 vertices)`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{format}{place}: {problem}")]
pub struct ReadError {
    /// The format the file was read as.
    pub format: Format,
    /// Where in the file.
    pub place: Place,
    /// What is wrong there.
    pub problem: Problem,
}

/// A place in a file, in the terms its author would use. Lines count from 1, everything else from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line of a text file, from 1.
    Line(usize),
    /// An offset in bytes.
    Byte(usize),
    /// A face, from 0.
    Face(usize),
    /// A vertex, from 0.
    Vertex(usize),
    /// A numbered thing of glTF: kind and index.
    Item(&'static str, usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, ", line {line}"),
            Self::Byte(byte) => write!(f, ", byte {byte}"),
            Self::Face(face) => write!(f, ", face {face} (from 0)"),
            Self::Vertex(vertex) => write!(f, ", vertex {vertex} (from 0)"),
            Self::Item(kind, index) => write!(f, ", {kind} {index}"),
        }
    }
}

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// No bytes at all.
    #[error("the file is empty")]
    Empty,
    /// Readable, but nothing is left to work on.
    #[error("the file has no triangles ({vertices} vertices, {faces} faces, of which none is a proper triangle)")]
    NoTriangles {
        /// Vertices as written.
        vertices: usize,
        /// Faces as written.
        faces: usize,
    },
    /// Text in another encoding.
    #[error("the text is UTF-16 or binary; save it as UTF-8 or ASCII")]
    NotText,
    /// A position that is NaN or infinite, on a vertex that a face uses.
    #[error("a position is not finite: {0} {1} {2}")]
    NotFinite(f32, f32, f32),
    /// A face names a vertex that is not there.
    #[error("vertex index {index} is out of range ({count} vertices)")]
    IndexOutOfRange {
        /// The index as written.
        index: i64,
        /// Number of vertices.
        count: usize,
    },
    /// The header promises more than the bytes can hold.
    #[error("{declared} {what} are declared, more than {bytes} bytes can hold")]
    CountTooLarge {
        /// What is counted.
        what: String,
        /// The count as declared.
        declared: u64,
        /// Bytes in the file, or left in it.
        bytes: usize,
    },
    /// The bytes end too early.
    #[error("the file ends in the middle of {0}")]
    Truncated(String),
    /// A word that should be a number.
    #[error("{0:?} is not a number that can stand here")]
    NotANumber(String),
    /// Understood, but not read by this framework.
    #[error("{0} is not supported")]
    Unsupported(String),
    /// A buffer that the file names and nobody has.
    #[error("the file names {0:?}, which cannot be found")]
    MissingFile(String),
    /// More than 32-bit ids, or than instances of a small file may make of it.
    #[error("the model is too large: {0}")]
    TooLarge(String),
    /// Anything else.
    #[error("{0}")]
    Malformed(String),
}

/// A problem at a place; the format is added by [`super::read`].
#[derive(Debug)]
pub(super) struct Refusal {
    pub(super) place: Place,
    pub(super) problem: Problem,
}

impl Refusal {
    pub(super) fn new(place: Place, problem: Problem) -> Self {
        Self { place, problem }
    }

    pub(super) fn malformed(place: Place, what: impl Into<String>) -> Self {
        Self::new(place, Problem::Malformed(what.into()))
    }

    pub(super) fn of(self, format: Format) -> ReadError {
        ReadError { format, place: self.place, problem: self.problem }
    }
}

/// Why a mesh was not written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WriteError {
    /// The format is only read.
    #[error("{0} is read but not written; use {1}")]
    NotWritten(Format, Format),
    /// A mesh without triangles, which no reader would take back.
    #[error("the mesh has no triangles")]
    NoTriangles,
    /// A position that is NaN or infinite.
    #[error("vertex {0} is not finite")]
    NotFinite(usize),
    /// A corner without a vertex.
    #[error("triangle {0} names a vertex that is not there")]
    IndexOutOfRange(usize),
    /// The format counts with fewer bits.
    #[error("{0} cannot hold a mesh of this size")]
    TooLarge(Format),
}

/// At most the first 40 characters of a word from a file, for messages.
pub(super) fn excerpt(word: &[u8]) -> String {
    String::from_utf8_lossy(word).chars().take(40).collect()
}
