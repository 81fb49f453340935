//! Explicit models in a container: the arrays of [`Parts`] as they are.

use super::{Container, ContainerError, Meta, Shape, Storage, TEXT, ids, numbers, write_sections};
use crate::explicit::{Explicit, Parts};
use crate::id::{CellId, VertexId};
use crate::model::MultiTessellation;
use std::io::{self, Write};

fn shapes(corners: usize) -> [Shape; 8] {
    [
        TEXT,
        numbers(b"POSI", 3),
        ids(b"CORN", corners as u8),
        ids(b"CSTA", 1),
        ids(b"FSTA", 1),
        ids(b"FINE", 1),
        ids(b"PARE", 1),
        numbers(b"BNDS", 6),
    ]
}

/// Writes a model as it is in memory. Nothing is copied; the arrays are read twice, for checksums and for writing.
///
/// `meta` is completed with what the model itself knows.
pub fn write<const N: usize>(model: &Explicit<N>, meta: &Meta, out: &mut impl Write) -> io::Result<()> {
    write_as(model, meta, Storage::Plain, out)
}

/// Writes a model in the storage that is asked for; what is packed is in memory until it is written.
pub fn write_as<const N: usize>(
    model: &Explicit<N>,
    meta: &Meta,
    storage: Storage,
    out: &mut impl Write,
) -> io::Result<()> {
    let meta = Meta {
        corners: N as u32,
        input_vertices: model.input_vertex_count(),
        input_cells: model.input_cell_count(),
        modifications: model.len(),
        error_kind: model.error_kind(),
        dependency: None,
        grid_step: None,
        ..meta.clone()
    };
    let json = serde_json::to_vec(&meta)?;
    let parts = model.parts();
    let corners: &[VertexId] = parts.corners.as_flattened();
    let bytes: [&[u8]; 8] = [
        &json,
        bytemuck::cast_slice(&parts.positions),
        bytemuck::cast_slice(corners),
        bytemuck::cast_slice(&parts.coarse_start),
        bytemuck::cast_slice(&parts.fine_start),
        bytemuck::cast_slice(&parts.fine),
        bytemuck::cast_slice(&parts.parents),
        bytemuck::cast_slice(&parts.bounds),
    ];
    write_sections(&shapes(N), &bytes, (storage, 1), out)
}

pub(super) fn read<const N: usize>(container: &Container<'_>) -> Result<Explicit<N>, ContainerError> {
    let meta = &container.meta;
    if meta.dependency.is_some() {
        return Err(ContainerError::Kind("a vertex hierarchy, not an explicit model"));
    }
    container.expect(&shapes(N))?;
    if meta.corners != N as u32 {
        return Err(ContainerError::Corners { found: meta.corners, wanted: N as u32 });
    }
    let parts = Parts {
        positions: container.array(b"POSI")?,
        input_vertex_count: meta.input_vertices,
        corners: container.cells(b"CORN")?,
        coarse_start: container.array(b"CSTA")?,
        fine_start: container.array(b"FSTA")?,
        fine: container.array::<CellId>(b"FINE")?,
        parents: container.array(b"PARE")?,
        bounds: container.array(b"BNDS")?,
        error_kind: meta.error_kind,
    };
    let model = Explicit::from_parts(parts)?;
    let fits = model.len() == meta.modifications && model.input_cell_count() == meta.input_cells;
    if fits { Ok(model) } else { Err(ContainerError::Layout("metadata and arrays disagree in counts".into())) }
}
