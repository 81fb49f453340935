//! Vertex hierarchies in a container: the input, its links, and the sequence of merges. All else follows from these.

use super::{Container, ContainerError, Meta, Shape, Storage, TEXT, ids, numbers, write_sections};
use crate::cell::Cell;
use crate::explicit::ErrorKind;
use crate::hierarchy::{Sequence, Story};
use crate::id::VertexId;
use crate::mesh::Mesh;
use std::io::{self, Write};

const SHAPES: [Shape; 10] = [
    TEXT,
    numbers(b"POSI", 3),
    ids(b"CELL", 3),
    ids(b"LINK", 2),
    ids(b"CENT", 1),
    numbers(b"MPOS", 3),
    ids(b"STAR", 1),
    ids(b"CHIL", 1),
    numbers(b"ERRS", 1),
    ids(b"KEPT", 1),
];

/// Writes a story, to be read under the dependency scheme of this name.
///
/// `meta` is completed with what the story itself knows.
pub fn write_story(
    story: &Story,
    dependency: &str,
    meta: &Meta,
    storage: Storage,
    out: &mut impl Write,
) -> io::Result<()> {
    let Story { mesh, links, sequence } = story;
    let meta = Meta {
        corners: 3,
        error_kind: ErrorKind::Estimate,
        input_vertices: mesh.vertex_count() as u32,
        input_cells: mesh.cell_count() as u32,
        modifications: sequence.node_count(),
        dependency: Some(dependency.to_owned()),
        ..meta.clone()
    };
    let json = serde_json::to_vec(&meta)?;
    let (cells, links): (&[VertexId], &[VertexId]) = (mesh.cells.as_flattened(), links.as_flattened());
    let kept: Vec<u32> = sequence.kept.iter().collect();
    // Where every merge has one node, they begin as they are numbered.
    let starts: &[u32] = if sequence.node_count() == sequence.merge_count() { &[] } else { &sequence.starts };
    let bytes: [&[u8]; 10] = [
        &json,
        bytemuck::cast_slice(&mesh.positions),
        bytemuck::cast_slice(cells),
        bytemuck::cast_slice(links),
        bytemuck::cast_slice(&sequence.centers),
        bytemuck::cast_slice(&sequence.positions),
        bytemuck::cast_slice(starts),
        bytemuck::cast_slice(&sequence.children),
        bytemuck::cast_slice(&sequence.errors),
        bytemuck::cast_slice(&kept),
    ];
    write_sections(&SHAPES, &bytes, (storage, 2), out)
}

pub(super) fn read(container: &Container<'_>) -> Result<Story, ContainerError> {
    if container.meta.dependency.is_none() {
        return Err(ContainerError::Kind("an explicit model, not a vertex hierarchy"));
    }
    container.expect(&SHAPES)?;
    let meta = &container.meta;
    if meta.corners != 3 {
        return Err(ContainerError::Corners { found: meta.corners, wanted: 3 });
    }
    if meta.error_kind != ErrorKind::Estimate {
        return Err(ContainerError::Layout("a hierarchy keeps no measured errors".into()));
    }
    let cells: Vec<[VertexId; 3]> = cells_of(container, b"CELL")?;
    let mesh = Mesh { positions: container.array(b"POSI")?, cells };
    let mut sequence = Sequence::with_input(mesh.vertex_count() as u32);
    sequence.centers = container.array(b"CENT")?;
    sequence.positions = container.array(b"MPOS")?;
    sequence.children = container.array(b"CHIL")?;
    sequence.errors = container.array(b"ERRS")?;
    let starts: Vec<u32> = container.array(b"STAR")?;
    sequence.starts = if starts.is_empty() { (0..=sequence.merge_count()).collect() } else { starts };
    let kept = container.array::<u32>(b"KEPT")?;
    sequence.keep(&kept).map_err(|error| ContainerError::Layout(error.to_string()))?;
    let fits = sequence.node_count() == meta.modifications
        && (mesh.vertex_count(), mesh.cell_count()) == (meta.input_vertices as usize, meta.input_cells as usize);
    if !fits {
        return Err(ContainerError::Layout("metadata and arrays disagree in counts".into()));
    }
    Ok(Story { mesh, links: cells_of(container, b"LINK")?, sequence })
}

fn cells_of<const N: usize>(container: &Container<'_>, name: &[u8; 4]) -> Result<Vec<Cell<N>>, ContainerError> {
    let corners: Vec<VertexId> = container.array(name)?;
    let (cells, rest) = corners.as_chunks::<N>();
    if rest.is_empty() { Ok(cells.to_vec()) } else { Err(ContainerError::Layout("the cells are cut short".into())) }
}
