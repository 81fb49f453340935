//! A history as text, one modification a line, so that any program's simplification becomes a Multi-Tessellation.
//!
//! JSON lines. The first says what it is a history of:
//!
//! ```text
//! {"history":1,"corners":3,"vertices":5,"cells":4,"error_kind":"measured"}
//! ```
//!
//! and every other is a coarsening modification of the mesh as it is by then:
//!
//! ```text
//! {"kill":[0,1,2,3],"vertices":[[5,0.5,0.5,0.0]],"make":[[4,0,1,2],[5,0,2,3]],"error":0.1}
//! ```
//!
//! `kill` names cells by id. Input cells are `0..cells` in the order of the input (as loading repaired it; extract with
//! `--reference` to see it), and made cells take the next ids in order: `[id, corner, corner, corner]`. So do made
//! vertices: `[id, x, y, z]`; the key may be left out. The same corners may be made twice under two ids. `error` is that
//! of the coarse side, in model units. Blank lines are passed over.

use crate::explicit::{ErrorKind, Explicit, HistoryError, Recorder};
use crate::id::{CellId, VertexId};
use crate::mesh::Mesh;
use crate::model::MultiTessellation;
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Write};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    history: u32,
    corners: u32,
    vertices: u32,
    cells: u32,
    error_kind: ErrorKind,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    kill: Vec<CellId>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    vertices: Vec<(VertexId, f32, f32, f32)>,
    make: Vec<Vec<u32>>,
    error: f32,
}

/// Why text is not a history of a mesh.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// A line cannot be read or understood.
    #[error("line {line}: {what}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// A modification cannot be.
    #[error("line {line}: {source}")]
    History {
        /// Counted from 1.
        line: usize,
        /// What is wrong.
        source: HistoryError,
    },
    /// The first line does not fit the mesh.
    #[error("it is a history of a mesh with {0}, but this mesh has {1}")]
    OtherMesh(String, String),
    /// The whole does not make a model.
    #[error(transparent)]
    Model(#[from] HistoryError),
}

/// Writes the history of a model. Errors are the saturated ones, so reading it back gives the same model.
pub fn write<const N: usize>(model: &Explicit<N>, out: &mut impl Write) -> std::io::Result<()> {
    let head = Head {
        history: 1,
        corners: N as u32,
        vertices: model.input_vertex_count(),
        cells: model.input_cell_count(),
        error_kind: model.error_kind(),
    };
    serde_json::to_writer(&mut *out, &head)?;
    let mut vertices = model.input_vertex_count();
    for m in (0..model.len()).map(crate::NodeId) {
        let make: Vec<Vec<u32>> = model
            .coarse_side(m)
            .map(|cell| std::iter::once(cell.0).chain(model.corners(cell).iter().map(|v| v.0)).collect())
            .collect();
        // A vertex is told with the first modification that uses it.
        let top = model.coarse_side(m).flat_map(|cell| *model.corners(cell)).map(|v| v.0 + 1).max().unwrap_or(0);
        let made = (vertices..top.max(vertices)).map(|v| {
            let p = model.positions()[v as usize];
            (VertexId(v), p.x, p.y, p.z)
        });
        let line =
            Line { kill: model.fine_side(m).to_vec(), vertices: made.collect(), make, error: model.bound(m).error };
        vertices = vertices.max(top);
        out.write_all(b"\n")?;
        serde_json::to_writer(&mut *out, &line)?;
    }
    out.write_all(b"\n")
}

/// Reads a history of `mesh` and makes the model, checking every line. O(text).
pub fn read<const N: usize>(mesh: &Mesh<N>, text: impl BufRead) -> Result<Explicit<N>, ReadError> {
    let mut recorder = Recorder::new(mesh)?;
    let mut head: Option<Head> = None;
    for (i, line) in text.lines().enumerate() {
        let at = |what: String| ReadError::Line { line: i + 1, what };
        let line = line.map_err(|error| at(error.to_string()))?;
        if line.trim().is_empty() {
            continue;
        }
        if head.is_none() {
            let told = serde_json::from_str(&line)
                .map_err(|error| at(format!("the first line must say what the history is of: {error}")))?;
            head = Some(
                check_head::<N>(told, mesh)
                    .map_err(|error| if let ReadError::Line { what, .. } = error { at(what) } else { error })?,
            );
            continue;
        }
        let line: Line = serde_json::from_str(&line).map_err(|error| at(error.to_string()))?;
        tell(&mut recorder, &line).map_err(|error| match error {
            Told::Wrong(what) => at(what),
            Told::Impossible(source) => ReadError::History { line: i + 1, source },
        })?;
    }
    let head = head.ok_or_else(|| ReadError::Line { line: 1, what: "the history is empty".into() })?;
    Ok(recorder.finish(head.error_kind)?)
}

fn check_head<const N: usize>(head: Head, mesh: &Mesh<N>) -> Result<Head, ReadError> {
    if head.history != 1 {
        return Err(ReadError::Line {
            line: 1,
            what: format!("version {} of the history text is not known, only 1", head.history),
        });
    }
    let wanted = (head.corners as usize, head.vertices as usize, head.cells as usize);
    let has = (N, mesh.positions.len(), mesh.cells.len());
    let say = |(n, v, c): (usize, usize, usize)| format!("{v} vertices and {c} cells of {n} corners");
    if wanted == has { Ok(head) } else { Err(ReadError::OtherMesh(say(wanted), say(has))) }
}

enum Told {
    Wrong(String),
    Impossible(HistoryError),
}

impl From<HistoryError> for Told {
    fn from(error: HistoryError) -> Self {
        Told::Impossible(error)
    }
}

fn tell<const N: usize>(recorder: &mut Recorder<N>, line: &Line) -> Result<(), Told> {
    for &cell in &line.kill {
        recorder.kill(cell)?;
    }
    for &(id, x, y, z) in &line.vertices {
        let next = recorder.vertex_count();
        if id.index() != next {
            return Err(Told::Wrong(format!("vertex {id} is told, but the next id is {next}")));
        }
        recorder.vertex(Vec3::new(x, y, z))?;
    }
    for cell in &line.make {
        let next = recorder.cell_count();
        let Some((&id, corners)) = cell.split_first() else { return Err(Told::Wrong("a made cell is empty".into())) };
        let corners: [u32; N] =
            corners.try_into().map_err(|_| Told::Wrong(format!("cell {id} has {} corners, not {N}", corners.len())))?;
        if id as usize != next {
            return Err(Told::Wrong(format!("cell {id} is made, but the next id is {next}")));
        }
        recorder.make(corners.map(VertexId))?;
    }
    recorder.end(line.error)?;
    Ok(())
}
