//! Dual pieces over an input mesh, as a scene.

use crate::ramp::Rgba;
use crate::scene::{Corner, Scene, Segment};
use glam::Vec3;
use mt_core::mesh::area_vector;
use mt_core::{Mesh, VertexId};

/// Where two dual pieces meet.
const BORDER: Rgba = [40, 40, 44, 255];

/// More pieces than that have no lines around them: where they are no larger than lines are wide, colours have to do.
const MOST_OUTLINED: usize = 20_000;
/// More pieces than that have thin ones, which hide less of them.
const MOST_BOLD: usize = 1000;

/// The dual pieces of `[KimLee2001]` over an input mesh: around each vertex a third of each of its triangles, in the colour of
/// `piece`, and lines where two of not too many pieces meet, relative to `origin`. A triangle within a piece stays one, others
/// become five or six.
pub fn dual_pieces(mesh: &Mesh<3>, origin: Vec3, piece: impl Fn(VertexId) -> VertexId) -> Scene {
    let piece: Vec<VertexId> = (0..mesh.positions.len()).map(|v| piece(VertexId::new(v))).collect();
    let mut all = piece.clone();
    all.sort_unstable();
    all.dedup();
    let lines = all.len() <= MOST_OUTLINED;
    let width_px = if all.len() > MOST_BOLD { 0.5 } else { 1.2 };
    let mut scene = Scene { origin, ..Scene::default() };
    for cell in &mesh.cells {
        let at = cell.map(|v| mesh.positions[v.index()] - origin);
        let normal = area_vector(at.map(Vec3::as_dvec3)).normalize_or_zero().as_vec3().to_array();
        let middle = (at[0] + at[1] + at[2]) / 3.0;
        let pieces = cell.map(|v| piece[v.index()]);
        let corner = |p: Vec3, of: VertexId| Corner { position: p.to_array(), normal, colour: colour_of(of) };
        if pieces.iter().all(|&one| one == pieces[0]) {
            scene.corners.extend(at.map(|p| corner(p, pieces[0])));
            continue;
        }
        for i in 0..3 {
            let next = (i + 1) % 3;
            let mut part = |corners: [Vec3; 3], of: VertexId| scene.corners.extend(corners.map(|p| corner(p, of)));
            // Edges within a piece are whole on both of their sides, the others in halves, so that nothing shines through.
            if pieces[i] == pieces[next] {
                part([at[i], at[next], middle], pieces[i]);
                continue;
            }
            let halfway = (at[i] + at[next]) * 0.5;
            part([at[i], halfway, middle], pieces[i]);
            part([halfway, at[next], middle], pieces[next]);
            if lines {
                let (from, to) = (halfway.to_array(), middle.to_array());
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

#[cfg(test)]
mod tests {
    use super::*;
    use mt_core::generate;

    /// The area of a scene's triangles by colour.
    fn areas(scene: &Scene) -> std::collections::BTreeMap<Rgba, f32> {
        let mut areas = std::collections::BTreeMap::new();
        for [a, b, c] in scene.corners.as_chunks::<3>().0 {
            let [p, q, r] = [a, b, c].map(|corner| Vec3::from(corner.position));
            *areas.entry(a.colour).or_insert(0.0) += (q - p).cross(r - p).length() * 0.5;
        }
        areas
    }

    #[test]
    fn a_corner_has_a_third_of_its_triangles_and_what_is_within_a_piece_stays_whole() {
        let mesh = generate::grid(4, 4);
        let scene = |piece: &dyn Fn(VertexId) -> VertexId| dual_pieces(&mesh, Vec3::ZERO, piece);
        let whole = scene(&|_| VertexId(0));
        assert_eq!((whole.corners.len(), whole.marks.len()), (3 * mesh.cell_count(), 0));
        let each = scene(&|v| v);
        assert_eq!((each.corners.len(), each.marks.len()), (18 * mesh.cell_count(), 3 * mesh.cell_count()));
        let halves = scene(&|v| VertexId(u32::from(mesh.positions[v.index()].x > mesh.positions[12].x)));
        assert!(halves.corners.len() < each.corners.len() && !halves.marks.is_empty());
        let area = areas(&whole).into_values().sum::<f32>();
        for scene in [&each, &halves] {
            assert!((areas(scene).into_values().sum::<f32>() - area).abs() < 1e-4 * area);
        }
        // What a piece has is what its vertices have.
        let is_right = |v: VertexId| mesh.positions[v.index()].x > mesh.positions[12].x;
        let third =
            |cell: &[VertexId; 3]| area_vector(cell.map(|v| mesh.positions[v.index()].as_dvec3())).length() / 6.0;
        let of_right = mesh.cells.iter().map(|cell| third(cell) * cell.iter().filter(|v| is_right(**v)).count() as f64);
        let right = areas(&halves)[&colour_of(VertexId(1))];
        assert!((f64::from(right) - of_right.sum::<f64>()).abs() < 1e-4);
    }
}
