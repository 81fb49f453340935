//! Dual pieces over an input mesh, as a scene.

use crate::ramp::Rgba;
use crate::scene::{Corner, Scene, Segment};
use glam::Vec3;
use mt_core::mesh::area_vector;
use mt_core::{Mesh, VertexId};
use std::collections::HashSet;

/// Where two dual pieces meet.
const BORDER: Rgba = [40, 40, 44, 255];

/// More pieces than that have no lines around them.
const MOST_OUTLINED: usize = 20_000;

/// The dual pieces of `[KimLee2001]` over an input mesh: around each vertex the part of its triangles that is nearer to it, in the colour of
/// `piece`, and lines where two of not too many pieces meet, relative to `origin`. 6 times the triangles.
pub fn dual_pieces(mesh: &Mesh<3>, origin: Vec3, piece: impl Fn(VertexId) -> VertexId) -> Scene {
    let pieces: HashSet<VertexId> = (0..mesh.positions.len()).map(|v| piece(VertexId::new(v))).collect();
    // Where pieces are no larger than lines are wide, colours have to do.
    let lines = pieces.len() <= MOST_OUTLINED;
    // Lines as wide as pieces would hide them.
    let width_px = if pieces.len() > 1000 { 0.5 } else { 1.2 };
    let mut scene = Scene { origin, ..Scene::default() };
    for cell in &mesh.cells {
        let at = cell.map(|v| mesh.positions[v.index()] - origin);
        let normal = area_vector(at.map(Vec3::as_dvec3)).normalize_or_zero().as_vec3().to_array();
        let middle = (at[0] + at[1] + at[2]) / 3.0;
        let pieces = cell.map(&piece);
        for i in 0..3 {
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            let (after, before) = ((at[i] + at[next]) * 0.5, (at[i] + at[last]) * 0.5);
            let colour = colour_of(pieces[i]);
            for p in [at[i], after, middle, at[i], middle, before] {
                scene.corners.push(Corner { position: p.to_array(), normal, colour });
            }
            if lines && pieces[i] != pieces[next] {
                let (from, to) = (after.to_array(), middle.to_array());
                scene.marks.push(Segment { from, to, colour: BORDER, width_px });
            }
        }
    }
    scene
}

/// A light colour that differs from one vertex to the next.
fn colour_of(v: VertexId) -> Rgba {
    let hash = (v.0 ^ (v.0 >> 7)).wrapping_mul(0x9e37_79b9);
    let channel = |shift: u32| 150 + ((hash >> shift) % 97) as u8;
    [channel(4), channel(12), channel(20), 255]
}
