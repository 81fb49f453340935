//! File formats over bytes: read a triangle mesh and say what was found, or write one.
//!
//! No file is opened here. A reader turns bytes into faces ([`Format`] by format); one repair for all
//! of them welds, drops what is no triangle and refuses what has no place; one [`census`] says what
//! the surface is like. Everything found, repaired or left out is in the [`LoadReport`].

mod census;
mod error;
mod gltf;
mod obj;
mod off;
mod ply;
mod repair;
mod report;
mod sets;
mod soup;
mod split;
mod stl;
mod words;
mod write;

pub use census::{Census, census};
pub use error::{Place, Problem, ReadError, WriteError};
pub use report::{Dropped, Finding, Left, LoadReport, Spot};
pub use split::{SplitCounts, split_non_manifold};
pub use write::write;

use crate::mesh::Mesh;
use error::Refusal;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A file format for triangle meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, text and binary.
    Ply,
    /// Stereolithography, text and binary.
    Stl,
    /// Geomview's object file format, text.
    Off,
    /// glTF 2.0 as JSON, with its buffers inside or beside it.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
}

impl Format {
    /// All formats, in the order of their declaration.
    pub const ALL: [Self; 6] = [Self::Obj, Self::Ply, Self::Stl, Self::Off, Self::Gltf, Self::Glb];

    /// The format that a file's extension names, in whatever case and without the dot.
    pub fn from_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.extension().eq_ignore_ascii_case(extension))
    }

    /// The usual extension, without the dot.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Off => "off",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
        }
    }

    /// Whether meshes can be written in it; the others are only read.
    pub const fn is_writable(self) -> bool {
        !matches!(self, Self::Gltf)
    }

    /// The name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Off => "OFF",
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// What to do where the surface is not manifold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NonManifold {
    /// Keep it as it is; the report says where.
    #[default]
    Keep,
    /// Separate the umbrellas, see [`split_non_manifold`].
    Split,
}

/// How a file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LoadOptions {
    /// Merge vertices at exactly the same position (with -0 = 0). Without it STL falls into single
    /// triangles and glTF comes apart along its seams.
    pub weld: bool,
    /// What to do where the surface is not manifold.
    pub non_manifold: NonManifold,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self { weld: true, non_manifold: NonManifold::Keep }
    }
}

/// Reads a mesh: every vertex finite and used, every triangle of three vertices and no two of the same.
///
/// Vertices and triangles keep the order of the file. `resolve` finds a glTF buffer that lies in a
/// file of its own, by its name as the model gives it (percent signs decoded); `&|_| None` where
/// there is none. The name comes from the file: whoever opens it must stay in the model's folder.
///
/// Errors: see [`Problem`]; a file with no triangle left is one. Never panics. O(n log n) in time,
/// and in memory a few times the file and its mesh.
pub fn read(
    format: Format,
    bytes: &[u8],
    options: &LoadOptions,
    resolve: &dyn Fn(&str) -> Option<Vec<u8>>,
) -> Result<(Mesh<3>, LoadReport), ReadError> {
    read_soup(format, bytes, resolve)
        .and_then(|soup| finish(format, soup, options))
        .map_err(|refusal| refusal.of(format))
}

fn read_soup(format: Format, bytes: &[u8], resolve: &dyn Fn(&str) -> Option<Vec<u8>>) -> Result<soup::Soup, Refusal> {
    if bytes.is_empty() {
        return Err(Refusal::new(Place::File, Problem::Empty));
    }
    match format {
        Format::Obj => obj::read(bytes),
        Format::Ply => ply::read(bytes),
        Format::Stl => stl::read(bytes),
        Format::Off => off::read(bytes),
        Format::Gltf | Format::Glb => gltf::read(bytes, resolve),
    }
}

fn finish(format: Format, mut soup: soup::Soup, options: &LoadOptions) -> Result<(Mesh<3>, LoadReport), Refusal> {
    soup.check_indices()?;
    soup.check_positions()?;
    soup.turn_doubled_quads();
    let notes = std::mem::take(&mut soup.notes);
    let (vertices_written, faces_written) = (soup.positions.len(), soup.faces);
    let (polygons_triangulated, left_out) = (soup.polygons, soup.left);
    let (mut mesh, repairs) = repair::repair(soup, options.weld);
    if mesh.cells.is_empty() {
        let problem = Problem::NoTriangles { vertices: vertices_written, faces: faces_written };
        return Err(Refusal::new(Place::File, problem));
    }
    let split = (options.non_manifold == NonManifold::Split).then(|| split_non_manifold(&mut mesh));
    let report = LoadReport {
        format,
        vertices_written,
        faces_written,
        polygons_triangulated,
        left_out,
        welded_vertices: repairs.welded,
        degenerate_triangles: repairs.degenerate,
        duplicate_triangles: repairs.duplicate,
        unused_vertices: repairs.unused,
        unused_not_finite: repairs.unused_not_finite,
        split,
        census: census(&mesh),
        notes,
    };
    Ok((mesh, report))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_formats_but_one_are_written_and_all_are_known_by_their_endings() {
        for format in Format::ALL {
            assert_eq!(Format::from_extension(format.extension()), Some(format));
            assert_eq!(format.is_writable(), format != Format::Gltf);
        }
        assert_eq!(Format::from_extension("mt"), None);
    }
}
