//! The `.mt` container: a model in one file, checked down to the last bit.
//!
//! All numbers are little-endian. The file is a head, a table and the sections it lists:
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `89 4d 54 0d 0a 1a 0a 00`, so that text conversions show |
//! | 4 | version of the format, now 1 |
//! | 4 | number of sections |
//! | 8 | length of the file |
//! | 24 each | name (4 letters), CRC-32, offset and length of a section |
//! | 4 | CRC-32 of all the above |
//!
//! Sections start at multiples of 64, with zeros between. `META` is JSON ([`Meta`]), the others are arrays of
//! [`crate::explicit::Parts`] as they are in memory: `POSI`, `CORN`, `CSTA`, `FSTA`, `FINE`, `PARE`,
//! `BNDS`. The order is not
//! stored, it follows from the cells. Loading copies the arrays once and checks all of them.

mod layout;

use crate::cell::Cell;
use crate::explicit::{ErrorKind, Explicit, Invalid, Parts};
use crate::id::{CellId, VertexId};
use crate::model::MultiTessellation;
use bytemuck::{Pod, Zeroable};
use layout::Section;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::Write;

/// The version that this code writes, and the newest that it reads.
pub const VERSION: u32 = 1;

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
    /// Checksums fit, but the arrays are not a model.
    #[error("the file is not a model: {0}")]
    Invalid(#[from] Invalid),
}

/// Writes a model. Nothing is copied; the arrays are read twice, for checksums and for writing.
///
/// `meta` is completed with what the model itself knows.
pub fn write<const N: usize>(model: &Explicit<N>, meta: &Meta, out: &mut impl Write) -> std::io::Result<()> {
    let meta = Meta {
        corners: N as u32,
        input_vertices: model.input_vertex_count(),
        input_cells: model.input_cell_count(),
        modifications: model.len(),
        error_kind: model.error_kind(),
        ..meta.clone()
    };
    let json = serde_json::to_vec(&meta)?;
    let parts = model.parts();
    let corners: &[VertexId] = parts.corners.as_flattened();
    layout::write(
        &[
            Section { name: *b"META", bytes: &json },
            Section { name: *b"POSI", bytes: bytemuck::cast_slice(&parts.positions) },
            Section { name: *b"CORN", bytes: bytemuck::cast_slice(corners) },
            Section { name: *b"CSTA", bytes: bytemuck::cast_slice(&parts.coarse_start) },
            Section { name: *b"FSTA", bytes: bytemuck::cast_slice(&parts.fine_start) },
            Section { name: *b"FINE", bytes: bytemuck::cast_slice(&parts.fine) },
            Section { name: *b"PARE", bytes: bytemuck::cast_slice(&parts.parents) },
            Section { name: *b"BNDS", bytes: bytemuck::cast_slice(&parts.bounds) },
        ],
        out,
    )
}

/// A container whose every byte has been checked, but whose arrays have not been looked at.
pub struct Container<'a> {
    sections: Vec<Section<'a>>,
    meta: Meta,
}

/// Opens a container. Refuses what is truncated, altered or newer; never panics. O(file).
pub fn open(bytes: &[u8]) -> Result<Container<'_>, ContainerError> {
    let sections = layout::read(bytes)?;
    let meta = meta_of(&sections)?;
    Ok(Container { sections, meta })
}

impl Container<'_> {
    /// What the file says about its model, such as the `N` to read it with.
    pub fn meta(&self) -> &Meta {
        &self.meta
    }

    /// The model. Refuses arrays that are none; never panics. O(file).
    pub fn model<const N: usize>(self) -> Result<(Explicit<N>, Meta), ContainerError> {
        let model = model_of(&self.sections, &self.meta)?;
        Ok((model, self.meta))
    }
}

/// Opens a container and reads its model.
pub fn read<const N: usize>(bytes: &[u8]) -> Result<(Explicit<N>, Meta), ContainerError> {
    open(bytes)?.model()
}

/// The sections of version 1, each of which is there once.
const SECTIONS: [&[u8; 4]; 8] = [b"META", b"POSI", b"CORN", b"CSTA", b"FSTA", b"FINE", b"PARE", b"BNDS"];

fn model_of<const N: usize>(sections: &[Section<'_>], meta: &Meta) -> Result<Explicit<N>, ContainerError> {
    if !sections.iter().map(|section| &section.name).eq(SECTIONS) {
        return Err(ContainerError::Layout("the sections are not those of a model".into()));
    }
    if meta.corners != N as u32 {
        return Err(ContainerError::Corners { found: meta.corners, wanted: N as u32 });
    }
    let corners: Vec<VertexId> = array(sections, b"CORN")?;
    let (cells, rest) = corners.as_chunks::<N>();
    if !rest.is_empty() {
        return Err(ContainerError::Layout("the cells are cut short".into()));
    }
    let cells: Vec<Cell<N>> = cells.to_vec();
    drop(corners);
    let parts = Parts {
        positions: array(sections, b"POSI")?,
        input_vertex_count: meta.input_vertices,
        corners: cells,
        coarse_start: array(sections, b"CSTA")?,
        fine_start: array(sections, b"FSTA")?,
        fine: array::<CellId>(sections, b"FINE")?,
        parents: array(sections, b"PARE")?,
        bounds: array(sections, b"BNDS")?,
        error_kind: meta.error_kind,
    };
    let model = Explicit::from_parts(parts)?;
    let fits = model.len() == meta.modifications && model.input_cell_count() == meta.input_cells;
    if fits { Ok(model) } else { Err(ContainerError::Layout("metadata and arrays disagree in counts".into())) }
}

fn meta_of(sections: &[Section<'_>]) -> Result<Meta, ContainerError> {
    let bytes = layout::find(sections, b"META")?;
    serde_json::from_slice(bytes).map_err(|error| ContainerError::Layout(format!("metadata: {error}")))
}

fn array<T: Pod + Zeroable>(sections: &[Section<'_>], name: &[u8; 4]) -> Result<Vec<T>, ContainerError> {
    let bytes = layout::find(sections, name)?;
    let size = size_of::<T>();
    if !bytes.len().is_multiple_of(size) {
        return Err(ContainerError::Layout(format!("section {} is cut short", String::from_utf8_lossy(name))));
    }
    let mut values = vec![T::zeroed(); bytes.len() / size];
    bytemuck::cast_slice_mut(&mut values).copy_from_slice(bytes);
    Ok(values)
}

#[cfg(target_endian = "big")]
compile_error!("the container's arrays are little-endian and are copied as they are");
