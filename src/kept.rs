//! What a build keeps of an analysis: all cells as an explicit model, or the merges of vertices.

use crate::coarsening::{Coarsening, explain};
use crate::commands::CommandError;
use crate::files::FileError;
use crate::progress::spinning;
use mt_core::analysis::Ended;
use mt_core::container::{self, Meta, Storage};
use mt_core::hierarchy::{Dependency, HierarchyError, Story, grid_step};
use mt_core::{ErrorKind, Explicit, Hierarchy, Mesh, MultiTessellation, Recorder, Sequence, VertexId, generate};
use operators::order::{Scheme, Visit};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

/// A model, in the form in which it is written.
pub enum Kept {
    /// All cells.
    Cells(Box<Explicit<3>>),
    /// The merges, and what there is to tell of the hierarchy.
    Merges { story: Box<Story>, scheme: Scheme, facts: MergeFacts },
}

/// What there is to tell of a hierarchy.
pub struct MergeFacts {
    grid_step: Option<f32>,
    base: usize,
    bytes: usize,
}

impl Kept {
    /// Coarsens the mesh of this file and keeps all cells.
    pub fn cells(path: &Path, mesh: &Mesh<3>, coarsening: &Coarsening) -> Result<(Self, Ended), CommandError> {
        coarsening.check_memory(path, mesh, true)?;
        let mut recorder = Recorder::new(mesh).map_err(|error| explain(path, error.into()))?;
        let ended = coarsening.run(path, mesh, &mut recorder)?;
        let model = spinning("ordering", || recorder.finish(coarsening.options.error_kind));
        Ok((Self::Cells(Box::new(model.map_err(|error| explain(path, error.into()))?)), ended))
    }

    /// Coarsens the mesh of this file and keeps the merges, on a grid of so many bits if that is wanted, once it is sure that a hierarchy under the scheme follows; with
    /// the input numbered as steps find it fastest.
    pub fn merges(
        path: &Path,
        mesh: Mesh<3>,
        coarsening: &Coarsening,
        scheme: Scheme,
        grid_bits: Option<u32>,
    ) -> Result<(Self, Ended), CommandError> {
        coarsening.check_memory(path, &mesh, false)?;
        let links = coarsening.operator.links(&mesh);
        let wrong = |error: &dyn std::fmt::Display| CommandError::File(FileError::new(path, error));
        if !links.is_empty() {
            // Whether the scheme takes links at all is known before any work is done.
            let edge = Story {
                mesh: generate::triangle(),
                links: vec![[0, 1].map(VertexId)],
                sequence: Sequence::with_input(3),
            };
            ordered(edge, scheme, None).map_err(|error| wrong(&error))?;
        }
        let step = grid_bits.map(|bits| {
            let none = "the mesh has no extent, or is too far from the origin, for a grid";
            grid_step(&mesh.positions, bits).ok_or_else(|| wrong(&none))
        });
        let step = step.transpose()?;
        let mut sequence = Sequence::new(&mesh);
        let ended = coarsening.run(path, &mesh, &mut sequence)?;
        let story = Story { mesh, links, sequence };
        let (story, facts) = spinning("replaying", || ordered(story, scheme, step)).map_err(|error| wrong(&error))?;
        Ok((Self::Merges { story, scheme, facts }, ended))
    }

    /// Writes the model.
    pub fn write(&self, meta: &Meta, storage: Storage, mut out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Cells(model) => container::write_as(model, meta, storage, &mut out),
            Self::Merges { story, scheme, .. } => container::write_story(story, scheme.name(), meta, storage, &mut out),
        }
    }

    /// Number of modifications.
    pub fn len(&self) -> u32 {
        match self {
            Self::Cells(model) => model.len(),
            Self::Merges { story, .. } => story.sequence.node_count(),
        }
    }

    /// Cells of the base mesh.
    pub fn base(&self) -> usize {
        match self {
            Self::Cells(model) => model.base_cells().len(),
            Self::Merges { facts, .. } => facts.base,
        }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Cells(model) => model.bytes(),
            Self::Merges { facts, .. } => facts.bytes,
        }
    }

    /// The step of the grid that it is on.
    pub fn grid_step(&self) -> Option<f32> {
        match self {
            Self::Cells(_) => None,
            Self::Merges { facts, .. } => facts.grid_step,
        }
    }

    /// What the errors promise.
    pub fn error_kind(&self) -> ErrorKind {
        match self {
            Self::Cells(model) => model.error_kind(),
            Self::Merges { .. } => ErrorKind::Estimate,
        }
    }
}

/// The story numbered for speed, and what there is to tell of its hierarchy.
fn ordered(story: Story, scheme: Scheme, grid_step: Option<f32>) -> Result<(Box<Story>, MergeFacts), HierarchyError> {
    let story = match grid_step {
        Some(step) => story.on_grid(step),
        None => story,
    };
    let replay = story.replay()?;
    let numbering = replay.numbering();
    let facts = scheme.visit(&Arc::new(replay.renumbered(&numbering)), Count)?;
    let facts = MergeFacts { grid_step, ..facts };
    Ok((Box::new(story.renumbered(&numbering)), facts))
}

/// Counts the base mesh and the bytes of a hierarchy, whatever its dependencies.
struct Count;

impl Visit for Count {
    type Output = MergeFacts;
    fn visit<D: Dependency + Send>(self, model: &Hierarchy<D>) -> MergeFacts {
        MergeFacts { grid_step: None, base: model.cell_count(&model.base()) as usize, bytes: model.bytes() }
    }
}
