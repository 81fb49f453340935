//! Edges that say something of a mesh: boundaries, edges of more than two triangles, the outline for an eye.

use crate::ramp::Rgba;
use crate::scene::{Scene, Segment};
use glam::Vec3;
use mt_core::mesh::area_vector;
use mt_core::{Cell, VertexId};
use std::collections::HashSet;

/// What edges are drawn, and in which colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edges<'a> {
    /// Those of one triangle in blue, those of more than two in violet.
    Boundary,
    /// The same, and in red those of one triangle that are not where the boundary must be: cracks, if there ever is one.
    /// Pairs of vertices in ascending order.
    Cracks(&'a HashSet<[VertexId; 2]>),
    /// Those between a triangle that faces an eye and one that does not, and boundaries; black.
    Outline(Vec3),
}

const OPEN: Rgba = [30, 90, 200, 255];
const SEWN: Rgba = [140, 50, 190, 255];
const CRACK: Rgba = [220, 30, 40, 255];
const OUTLINE: Rgba = [10, 10, 12, 255];

impl Scene {
    /// Adds edges of a mesh, which is the one of this scene, as lines. Gives how many. O(cells log cells).
    pub fn add_edges(&mut self, positions: &[Vec3], cells: &[Cell<3>], which: Edges<'_>) -> usize {
        let before = self.marks.len();
        let mut sides: Vec<([VertexId; 2], u32)> = Vec::with_capacity(3 * cells.len());
        for (i, cell) in cells.iter().enumerate() {
            sides.extend((0..3).map(|k| {
                let (a, b) = (cell[k], cell[(k + 1) % 3]);
                ([a.min(b), a.max(b)], i as u32)
            }));
        }
        sides.sort_unstable();
        for run in sides.chunk_by(|a, b| a.0 == b.0) {
            let Some((colour, width_px)) = style(positions, cells, run, which) else { continue };
            let [from, to] = run[0].0.map(|v| (positions[v.index()] - self.origin).to_array());
            self.marks.push(Segment { from, to, colour, width_px });
        }
        self.marks.len() - before
    }
}

/// How an edge of these triangles is drawn, if it is.
fn style(positions: &[Vec3], cells: &[Cell<3>], run: &[([VertexId; 2], u32)], which: Edges<'_>) -> Option<(Rgba, f32)> {
    match (which, run.len()) {
        (Edges::Cracks(boundary), 1) if !boundary.contains(&run[0].0) => Some((CRACK, 5.0)),
        (Edges::Boundary | Edges::Cracks(_), 1) => Some((OPEN, 2.5)),
        (Edges::Boundary | Edges::Cracks(_), 2) => None,
        (Edges::Boundary | Edges::Cracks(_), _) => Some((SEWN, 3.5)),
        (Edges::Outline(_), 1) => Some((OUTLINE, 2.0)),
        (Edges::Outline(eye), _) => {
            let towards = |&(_, cell): &([VertexId; 2], u32)| {
                let corners = cells[cell as usize].map(|v| positions[v.index()].as_dvec3());
                area_vector(corners).dot(eye.as_dvec3() - corners[0]) > 0.0
            };
            let first = towards(&run[0]);
            run.iter().any(|side| towards(side) != first).then_some((OUTLINE, 2.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Look, encode};
    use mt_core::Mesh;
    use mt_core::generate::{cylinder, fan3, sphere};

    fn count(mesh: &Mesh<3>, which: Edges<'_>) -> usize {
        encode(mesh, &Look::default()).add_edges(&mesh.positions, &mesh.cells, which)
    }

    #[test]
    fn boundaries_and_sewn_edges_are_found() {
        assert_eq!(count(&cylinder(8, 3), Edges::Boundary), 16);
        assert_eq!(count(&sphere(2), Edges::Boundary), 0);
        // Three triangles about one edge: six open sides and one with too many.
        let fan = fan3();
        let mut scene = encode(&fan, &Look::default());
        assert_eq!(scene.add_edges(&fan.positions, &fan.cells, Edges::Boundary), 7);
        assert_eq!(scene.marks.iter().filter(|segment| segment.colour == SEWN).count(), 1);
        // Where one of the open sides is no boundary it is a crack.
        let cell = fan.cells[0];
        let is_spine = |v: &&VertexId| fan.cells.iter().all(|cell| cell.contains(v));
        let outer = *cell.iter().find(|v| !is_spine(v)).unwrap();
        let sides: HashSet<_> = fan.cells[1..]
            .iter()
            .chain([&cell])
            .flat_map(|cell| [[cell[0], cell[1]], [cell[1], cell[2]], [cell[2], cell[0]]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .filter(|side| !side.contains(&outer))
            .collect();
        let mut scene = encode(&fan, &Look::default());
        scene.add_edges(&fan.positions, &fan.cells, Edges::Cracks(&sides));
        assert_eq!(scene.marks.iter().filter(|segment| segment.colour == CRACK).count(), 2);
    }

    #[test]
    fn the_outline_of_a_sphere_is_a_ring() {
        let mesh = sphere(3);
        let eye = Vec3::new(0.3, 0.2, 9.0);
        let mut scene = encode(&mesh, &Look::default());
        let count = scene.add_edges(&mesh.positions, &mesh.cells, Edges::Outline(eye));
        assert!(count > 20 && count < 120, "{count}");
        // Each of its vertices is on two edges of it: a closed line.
        let mut ends: Vec<[u32; 3]> =
            scene.marks.iter().flat_map(|s| [s.from, s.to]).map(|p| p.map(f32::to_bits)).collect();
        ends.sort_unstable();
        assert!(ends.chunk_by(|a, b| a == b).all(|run| run.len() % 2 == 0));
    }
}
