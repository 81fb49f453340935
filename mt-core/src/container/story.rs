//! Vertex hierarchies in a container: the input, its links, and the sequence of merges. All else follows from these.

use super::{Container, ContainerError, Meta, Shape, Storage, TEXT, ids, numbers, steps, write_sections};
use crate::explicit::ErrorKind;
use crate::hierarchy::{Sequence, Story, place_at, steps_to};
use crate::id::VertexId;
use crate::mesh::Mesh;
use glam::Vec3;
use std::io::{self, Write};

fn shapes(on_grid: bool) -> [Shape; 10] {
    [
        TEXT,
        if on_grid { ids(b"POSI", 3) } else { numbers(b"POSI", 3) },
        ids(b"CELL", 3),
        ids(b"LINK", 2),
        ids(b"CENT", 1),
        if on_grid { steps(b"MPOS", 3) } else { numbers(b"MPOS", 3) },
        ids(b"STAR", 1),
        ids(b"CHIL", 1),
        numbers(b"ERRS", 1),
        ids(b"KEPT", 1),
    ]
}

/// The positions of a story on a grid in steps.
struct Steps {
    /// Of the input's vertices, from the origin.
    places: Vec<[i32; 3]>,
    /// Of merged vertices, from the centre of the merge.
    merged: Vec<[i32; 3]>,
}

impl Steps {
    fn of(story: &Story, step: f32) -> io::Result<Self> {
        let on_grid = |&p: &Vec3| {
            let steps = steps_to(p, step);
            (place_at(steps, step) == p).then_some(steps).ok_or_else(|| io::Error::other("a vertex is not on the grid"))
        };
        let mut all: Vec<[i32; 3]> = story.mesh.positions.iter().map(on_grid).collect::<io::Result<_>>()?;
        let leaves = all.len();
        all.extend(story.sequence.positions.iter().map(on_grid).collect::<io::Result<Vec<_>>>()?);
        let centers = story.sequence.centers.iter().map(|center| all.get(center.index()).copied().unwrap_or_default());
        let from =
            |([x, y, z], [a, b, c]): (&[i32; 3], [i32; 3])| [x.wrapping_sub(a), y.wrapping_sub(b), z.wrapping_sub(c)];
        let merged = all[leaves..].iter().zip(centers).map(from).collect();
        all.truncate(leaves);
        Ok(Self { places: all, merged })
    }

    /// The positions, where each merge takes a centre that was there before it.
    fn positions(self, centers: &[VertexId], step: f32) -> Result<[Vec<Vec3>; 2], ContainerError> {
        let leaves = self.places.len();
        let mut all = self.places;
        for (from, center) in self.merged.iter().zip(centers) {
            let &[x, y, z] = all
                .get(center.index())
                .ok_or_else(|| ContainerError::Layout("a merge takes a centre that comes later".into()))?;
            all.push([x.wrapping_add(from[0]), y.wrapping_add(from[1]), z.wrapping_add(from[2])]);
        }
        // As far as a grid may go: see `grid_step`.
        if all.as_flattened().iter().any(|count| count.unsigned_abs() > i32::MAX as u32 / 2) {
            return Err(ContainerError::Layout("a place is too far away on its grid".into()));
        }
        let mut places: Vec<Vec3> = all.into_iter().map(|steps| place_at(steps, step)).collect();
        let merged = places.split_off(leaves);
        Ok([places, merged])
    }
}

/// Writes a story, to be read under the dependency scheme of this name.
///
/// `meta` is completed with what the story itself knows; a grid that it names is one on which all vertices are, or nothing is
/// written.
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
    let steps = meta.grid_step.map(|step| Steps::of(story, step)).transpose()?;
    let [places, merged]: [&[u8]; 2] = match &steps {
        Some(steps) => [bytemuck::cast_slice(&steps.places), bytemuck::cast_slice(&steps.merged)],
        None => [bytemuck::cast_slice(&mesh.positions), bytemuck::cast_slice(&sequence.positions)],
    };
    let bytes: [&[u8]; 10] = [
        &json,
        places,
        bytemuck::cast_slice(cells),
        bytemuck::cast_slice(links),
        bytemuck::cast_slice(&sequence.centers),
        merged,
        bytemuck::cast_slice(starts),
        bytemuck::cast_slice(&sequence.children),
        bytemuck::cast_slice(&sequence.errors),
        bytemuck::cast_slice(&kept),
    ];
    write_sections(&shapes(meta.grid_step.is_some()), &bytes, (storage, 2), out)
}

pub(super) fn read(container: &Container<'_>) -> Result<Story, ContainerError> {
    if container.meta.dependency.is_none() {
        return Err(ContainerError::Kind("an explicit model, not a vertex hierarchy"));
    }
    let on_grid = container.meta.grid_step;
    if on_grid.is_some_and(|step| !(step.is_normal() && step > 0.0)) {
        return Err(ContainerError::Layout("there is no such grid".into()));
    }
    container.expect(&shapes(on_grid.is_some()))?;
    let meta = &container.meta;
    if meta.corners != 3 {
        return Err(ContainerError::Corners { found: meta.corners, wanted: 3 });
    }
    if meta.error_kind != ErrorKind::Estimate {
        return Err(ContainerError::Layout("a hierarchy keeps no measured errors".into()));
    }
    let centers: Vec<VertexId> = container.array(b"CENT")?;
    let [positions, merged] = match on_grid {
        Some(step) => {
            Steps { places: container.array(b"POSI")?, merged: container.array(b"MPOS")? }.positions(&centers, step)?
        }
        None => [container.array(b"POSI")?, container.array(b"MPOS")?],
    };
    let mesh = Mesh { positions, cells: container.cells(b"CELL")? };
    let mut sequence = Sequence::with_input(mesh.vertex_count() as u32);
    (sequence.centers, sequence.positions) = (centers, merged);
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
    Ok(Story { mesh, links: container.cells(b"LINK")?, sequence })
}
