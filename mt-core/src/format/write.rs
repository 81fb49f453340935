//! Writes meshes: OBJ and OFF as text, PLY and STL as little-endian bytes, GLB.
//!
//! Positions keep every bit in each format. STL has no shared vertices; a reader welds them again.

use super::Format;
use super::error::WriteError;
use crate::mesh::{Mesh, area_vector};
use serde_json::json;
use std::fmt::{self, Write};

/// Writes a mesh. OBJ, OFF, PLY and GLB keep the order of vertices and triangles, STL that of triangles.
///
/// Errors: glTF as JSON is not written (GLB is); a mesh without triangles, with a position that is
/// not finite, with a corner that is no vertex, or too large for the format. Cost: one pass; text
/// takes about 75 bytes a vertex, bytes 38 (PLY, GLB) or 100 (STL).
pub fn write(format: Format, mesh: &Mesh<3>) -> Result<Vec<u8>, WriteError> {
    check(mesh)?;
    match format {
        Format::Obj => Ok(write_obj(mesh)),
        Format::Off => Ok(write_off(mesh)),
        Format::Ply => write_ply(mesh),
        Format::Stl => write_stl(mesh),
        Format::Glb => write_glb(mesh),
        Format::Gltf => Err(WriteError::NotWritten(Format::Gltf, Format::Glb)),
    }
}

fn check(mesh: &Mesh<3>) -> Result<(), WriteError> {
    if mesh.cells.is_empty() {
        return Err(WriteError::NoTriangles);
    }
    if let Some(vertex) = mesh.positions.iter().position(|p| !p.is_finite()) {
        return Err(WriteError::NotFinite(vertex));
    }
    let outside = |cell: &[crate::VertexId; 3]| cell.iter().any(|v| v.index() >= mesh.positions.len());
    match mesh.cells.iter().position(outside) {
        Some(triangle) => Err(WriteError::IndexOutOfRange(triangle)),
        None => Ok(()),
    }
}

/// The shortest text that reads back as the same number, with an exponent where that is long.
struct Shortest(f32);

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-5..1e16).contains(&size) { self.0.fmt(f) } else { write!(f, "{:e}", self.0) }
    }
}

/// Writing to a string cannot fail, so its result is of no use.
fn line(text: &mut String, line: fmt::Arguments<'_>) {
    let _ = text.write_fmt(line);
}

fn write_obj(mesh: &Mesh<3>) -> Vec<u8> {
    let mut text = String::with_capacity(32 * mesh.positions.len() + 24 * mesh.cells.len());
    for p in &mesh.positions {
        line(&mut text, format_args!("v {} {} {}\n", Shortest(p.x), Shortest(p.y), Shortest(p.z)));
    }
    for cell in &mesh.cells {
        let [a, b, c] = cell.map(|v| u64::from(v.0) + 1);
        line(&mut text, format_args!("f {a} {b} {c}\n"));
    }
    text.into_bytes()
}

fn write_off(mesh: &Mesh<3>) -> Vec<u8> {
    let mut text = String::with_capacity(30 * mesh.positions.len() + 24 * mesh.cells.len());
    line(&mut text, format_args!("OFF\n{} {} 0\n", mesh.positions.len(), mesh.cells.len()));
    for p in &mesh.positions {
        line(&mut text, format_args!("{} {} {}\n", Shortest(p.x), Shortest(p.y), Shortest(p.z)));
    }
    for [a, b, c] in &mesh.cells {
        line(&mut text, format_args!("3 {a} {b} {c}\n"));
    }
    text.into_bytes()
}

fn write_ply(mesh: &Mesh<3>) -> Result<Vec<u8>, WriteError> {
    // Most programs read the indices as signed.
    if mesh.positions.len() > i32::MAX as usize {
        return Err(WriteError::TooLarge(Format::Ply));
    }
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.cells.len()
    );
    let mut bytes = Vec::with_capacity(header.len() + 12 * mesh.positions.len() + 13 * mesh.cells.len());
    bytes.extend_from_slice(header.as_bytes());
    push_positions(&mut bytes, mesh);
    for cell in &mesh.cells {
        bytes.push(3);
        cell.iter().for_each(|v| bytes.extend_from_slice(&v.0.to_le_bytes()));
    }
    Ok(bytes)
}

fn push_positions(bytes: &mut Vec<u8>, mesh: &Mesh<3>) {
    for coordinate in mesh.positions.iter().flat_map(|p| p.to_array()) {
        bytes.extend_from_slice(&coordinate.to_le_bytes());
    }
}

fn write_stl(mesh: &Mesh<3>) -> Result<Vec<u8>, WriteError> {
    let count = u32::try_from(mesh.cells.len()).map_err(|_| WriteError::TooLarge(Format::Stl))?;
    let mut bytes = Vec::with_capacity(84 + 50 * mesh.cells.len());
    // 80 bytes of header, which must not begin with "solid".
    bytes.extend_from_slice(b"binary STL");
    bytes.resize(80, b' ');
    bytes.extend_from_slice(&count.to_le_bytes());
    for cell in &mesh.cells {
        let corners = cell.map(|v| mesh.positions[v.index()]);
        let normal = area_vector(corners.map(|p| p.as_dvec3())).normalize_or_zero().as_vec3();
        for vector in [normal, corners[0], corners[1], corners[2]] {
            vector.to_array().iter().for_each(|x| bytes.extend_from_slice(&x.to_le_bytes()));
        }
        bytes.extend_from_slice(&[0, 0]);
    }
    Ok(bytes)
}

fn write_glb(mesh: &Mesh<3>) -> Result<Vec<u8>, WriteError> {
    let positions = 12 * mesh.positions.len();
    let total = positions + 12 * mesh.cells.len();
    let (low, high) = mesh.bounding_box().ok_or(WriteError::NoTriangles)?;
    let json = json!({
        "asset": { "version": "2.0", "generator": "multi-tessellation" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": mesh.positions.len(), "min": low.to_array(), "max": high.to_array() },
            { "bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": 3 * mesh.cells.len() },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": positions, "target": 34962 },
            { "buffer": 0, "byteOffset": positions, "byteLength": total - positions, "target": 34963 },
        ],
        "buffers": [{ "byteLength": total }],
    });
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + total;
    let word = |value: usize| u32::try_from(value).map(u32::to_le_bytes).map_err(|_| WriteError::TooLarge(Format::Glb));
    let mut bytes = Vec::with_capacity(length);
    bytes.extend_from_slice(b"glTF\x02\0\0\0");
    bytes.extend_from_slice(&word(length)?);
    bytes.extend_from_slice(&word(json.len())?);
    bytes.extend_from_slice(b"JSON");
    bytes.extend_from_slice(&json);
    bytes.extend_from_slice(&word(total)?);
    bytes.extend_from_slice(b"BIN\0");
    push_positions(&mut bytes, mesh);
    for v in mesh.cells.iter().flatten() {
        bytes.extend_from_slice(&v.0.to_le_bytes());
    }
    Ok(bytes)
}
