//! The `.mt` container: a model in one file, checked down to the last bit.
//!
//! All numbers are little-endian. The file is a head, a table and the sections it lists:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `89 4d 54 0d 0a 1a 0a 00`, so that text conversions show |
//! | 4 | version of the format, 1 or 2 |
//! | 4 | number of sections |
//! | 8 | length of the file |
//! | 24 or 40 each | name (4 letters), CRC-32, offset and length of a section; in version 2 also its length when unpacked, how it is packed (2 bytes) and zeros |
//! | 4 | CRC-32 of all the above |
//!
//! Sections start at multiples of 64, with zeros between. `META` is JSON ([`Meta`]), the others are arrays. Two kinds of models
//! are kept: [`Explicit`] ones, all of their cells and bounds ([`write()`]), and vertex hierarchies, as the input mesh and the
//! sequence of its merges ([`write_story`]; the command numbers the input anew, see [`crate::Replay::numbering`]). What follows from these is not stored: orders follow from cells, a replay from a
//! story. Loading copies the arrays once and checks all of them.
//!
//! Positions of a hierarchy on a grid are told in whole steps: of the input from one vertex to the next, of a merged vertex from
//! the centre of its merge, which is nearby.
//!
//! Each section is packed by itself or not at all ([`Storage`]), so any of them can be had without the others ([`Archive`]).

mod archive;
mod explicit;
mod layout;
mod pack;
mod story;

pub use archive::{Archive, SectionInfo};
pub use explicit::{write, write_as};
pub use story::write_story;

use crate::cell::Cell;
use crate::explicit::{ErrorKind, Explicit, Invalid};
use crate::hierarchy::Story;
use crate::id::VertexId;
use bytemuck::{Pod, Zeroable};
use layout::{Entry, Section};
use pack::{Filter, Packing};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;

/// The newest version that this code reads and writes. Files that need nothing of it are written as version 1.
pub const VERSION: u32 = 2;

/// How the sections of a file are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Storage {
    /// As in memory: fast to read, and the arrays can be mapped.
    #[default]
    Plain,
    /// Packed without loss: about half the bytes (`[ColletKucherawy2021]`).
    Packed,
}

/// What a container says about its model besides the arrays.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Meta {
    /// Corners of a cell.
    pub corners: u32,
    /// Vertices of the input.
    pub input_vertices: u32,
    /// Cells of the input.
    pub input_cells: u32,
    /// Modifications.
    pub modifications: u32,
    /// What the errors promise.
    pub error_kind: ErrorKind,
    /// The operator that made the history, or where it came from.
    pub operator: String,
    /// Of a vertex hierarchy: the dependency scheme it is to be read under. Nothing for explicit models.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dependency: Option<String>,
    /// Of a vertex hierarchy on a grid: its step, in model units (see [`crate::hierarchy::grid_step`]).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid_step: Option<f32>,
    /// Name of the input.
    pub source: String,
    /// Why analysis ended.
    pub stopped: String,
    /// Where it went region by region: how many vertices each had. 0 where it took the mesh as a whole.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub region_vertices: u32,
    /// Refused plans by reason.
    pub refusals: BTreeMap<String, u64>,
    /// What loading the input found and repaired, line by line.
    pub load_report: Vec<String>,
}

fn is_zero(count: &u32) -> bool {
    *count == 0
}

/// Why bytes are not a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContainerError {
    /// Something else.
    #[error("not a .mt file")]
    NotAModel,
    /// Made by a newer version.
    #[error(
        "format version {0} is newer than {VERSION}, the newest that this program reads; use the program that wrote it"
    )]
    Newer(u32),
    /// The end is missing.
    #[error("the file is truncated: {expected} bytes expected, {found} found")]
    Truncated {
        /// Length that the head gives, or the least that could be.
        expected: u64,
        /// Length of the bytes.
        found: u64,
    },
    /// A checksum does not fit.
    #[error("the file is damaged: {0} does not match its checksum")]
    Altered(String),
    /// The table of sections cannot be.
    #[error("the file is damaged: {0}")]
    Layout(String),
    /// The model is of another dimension.
    #[error("the model's cells have {found} corners, not {wanted}")]
    Corners {
        /// As the file says.
        found: u32,
        /// As asked for.
        wanted: u32,
    },
    /// The model is of the other kind.
    #[error("the file holds {0}")]
    Kind(&'static str),
    /// The system does not give the bytes.
    #[error("{0}")]
    Unreadable(String),
    /// Checksums fit, but the arrays are not a model.
    #[error("the file is not a model: {0}")]
    Invalid(#[from] Invalid),
}

/// A container whose every byte has been checked, but whose arrays have not been looked at.
pub struct Container<'a> {
    sections: Vec<(Entry, &'a [u8])>,
    meta: Meta,
}

/// Opens a container. Refuses what is truncated, altered or newer; never panics. O(file).
pub fn open(bytes: &[u8]) -> Result<Container<'_>, ContainerError> {
    let sections = layout::read(bytes)?;
    let found = sections.iter().find(|(entry, _)| entry.name == *b"META");
    let (entry, stored) = found.ok_or_else(|| missing(b"META"))?;
    entry.check_meta()?;
    let meta = meta_of(&entry.unpacked(stored)?)?;
    Ok(Container { sections, meta })
}

impl Container<'_> {
    /// What the file says about its model, such as the `N` to read it with.
    pub fn meta(&self) -> &Meta {
        &self.meta
    }

    /// The explicit model. Refuses arrays that are none; never panics. O(file).
    pub fn model<const N: usize>(self) -> Result<(Explicit<N>, Meta), ContainerError> {
        let model = explicit::read(&self)?;
        Ok((model, self.meta))
    }

    /// The story of a vertex hierarchy. Its arrays fit the counts; whether they are a sequence of merges of the mesh is for
    /// [`Story::replay`] to find out. Never panics. O(file).
    pub fn story(self) -> Result<(Story, Meta), ContainerError> {
        let story = story::read(&self)?;
        Ok((story, self.meta))
    }

    /// Refuses sections other than these, each once and in this order.
    fn expect(&self, shapes: &[Shape]) -> Result<(), ContainerError> {
        let are_those = self.sections.iter().map(|(entry, _)| entry.name).eq(shapes.iter().map(|shape| shape.name));
        if are_those { Ok(()) } else { Err(ContainerError::Layout("the sections are not those of a model".into())) }
    }

    /// Cells of `N` corners.
    fn cells<const N: usize>(&self, name: &[u8; 4]) -> Result<Vec<Cell<N>>, ContainerError> {
        let corners: Vec<VertexId> = self.array(name)?;
        let (cells, rest) = corners.as_chunks::<N>();
        if rest.is_empty() { Ok(cells.to_vec()) } else { Err(ContainerError::Layout("the cells are cut short".into())) }
    }

    fn array<T: Pod + Zeroable>(&self, name: &[u8; 4]) -> Result<Vec<T>, ContainerError> {
        let found = self.sections.iter().find(|(entry, _)| entry.name == *name);
        let (entry, stored) = found.ok_or_else(|| missing(name))?;
        let bytes = entry.unpacked(stored)?;
        let size = size_of::<T>();
        if !bytes.len().is_multiple_of(size) {
            return Err(ContainerError::Layout(format!("{} is cut short", entry.title())));
        }
        let mut values = vec![T::zeroed(); bytes.len() / size];
        bytemuck::cast_slice_mut(&mut values).copy_from_slice(&bytes);
        Ok(values)
    }
}

/// Opens a container and reads its explicit model.
pub fn read<const N: usize>(bytes: &[u8]) -> Result<(Explicit<N>, Meta), ContainerError> {
    open(bytes)?.model()
}

/// A section's name, and how its bytes are packed where they are.
struct Shape {
    name: [u8; 4],
    packing: Packing,
}

/// Records of so many words, of which those that follow each other are alike.
const fn ids(name: &[u8; 4], columns: u8) -> Shape {
    Shape { name: *name, packing: Packing::Words { columns, filter: Filter::Differences } }
}

/// Records of so many words that share no more than their upper bytes.
const fn numbers(name: &[u8; 4], columns: u8) -> Shape {
    Shape { name: *name, packing: Packing::Words { columns, filter: Filter::None } }
}

/// Records of so many small whole numbers of either sign.
const fn steps(name: &[u8; 4], columns: u8) -> Shape {
    Shape { name: *name, packing: Packing::Words { columns, filter: Filter::Signed } }
}

const TEXT: Shape = Shape { name: *b"META", packing: Packing::Text };

/// Writes these bytes as sections of these shapes, which version `since` of the format knows.
fn write_sections(
    shapes: &[Shape],
    bytes: &[&[u8]],
    (storage, since): (Storage, u32),
    out: &mut impl io::Write,
) -> io::Result<()> {
    debug_assert_eq!(shapes.len(), bytes.len());
    let sections = shapes.par_iter().zip(bytes).map(|(shape, bytes)| section(shape, bytes, storage));
    layout::write(&sections.collect::<io::Result<Vec<_>>>()?, since, out)
}

fn section<'a>(shape: &Shape, bytes: &'a [u8], storage: Storage) -> io::Result<Section<'a>> {
    let (name, length) = (shape.name, bytes.len() as u64);
    Ok(match storage {
        Storage::Plain => Section { name, bytes: Cow::Borrowed(bytes), packing: Packing::Plain, length },
        Storage::Packed => {
            Section { name, bytes: Cow::Owned(pack::pack(bytes, shape.packing)?), packing: shape.packing, length }
        }
    })
}

fn missing(name: &[u8; 4]) -> ContainerError {
    ContainerError::Layout(format!("section {} is missing", String::from_utf8_lossy(name)))
}

fn meta_of(bytes: &[u8]) -> Result<Meta, ContainerError> {
    serde_json::from_slice(bytes).map_err(|error| ContainerError::Layout(format!("metadata: {error}")))
}

#[cfg(target_endian = "big")]
compile_error!("the container's arrays are little-endian and are copied as they are");
