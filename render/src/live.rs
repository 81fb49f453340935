//! A mesh that changes: the triangles of a view as they lie in a vertex buffer, changed one by one by what a sink hears.
//!
//! Each triangle has a place of its own, and places of triangles that are gone are taken again. So what has to be sent to a
//! device after some steps is what these steps touched, whatever the size of the mesh or of the model.

use crate::ramp::Rgba;
use crate::scene::Corner;
use bytemuck::Zeroable;
use glam::Vec3;
use mt_core::mesh::area_vector;
use mt_core::{Bits, Cell, CellId, Sink};
use std::ops::Range;

/// No place.
const NONE: u32 = u32::MAX;
/// Places that lie so near to each other are sent at once: a call costs more than a few triangles.
const GAP: u32 = 8;

/// The triangles of one view in places, as the sink of its [`mt_core::Step`]s. 84 bytes a place, and 4 a cell of the model.
///
/// A triangle of which a position is not finite has a place and covers nothing.
pub struct LiveMesh<'a> {
    positions: &'a [Vec3],
    origin: Vec3,
    material: Rgba,
    /// The place of each cell of the model, if it is there.
    place_of: Vec<u32>,
    /// Places of triangles that are gone.
    free: Vec<u32>,
    corners: Vec<[Corner; 3]>,
    /// Places that changed since somebody asked.
    changed: Vec<u32>,
    is_changed: Bits,
}

impl<'a> LiveMesh<'a> {
    /// No triangles yet, of a model with these positions and so many cells at most; drawn relative to `origin`.
    pub fn new(positions: &'a [Vec3], cells: u32, origin: Vec3, material: Rgba) -> Self {
        Self {
            positions,
            origin,
            material,
            place_of: vec![NONE; cells as usize],
            free: Vec::new(),
            corners: Vec::new(),
            changed: Vec::new(),
            // There are never more places than cells.
            is_changed: Bits::new(cells),
        }
    }

    /// The point that coordinates are relative to.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// All places, as they lie in a vertex buffer; free ones have three corners in one point.
    pub fn corners(&self) -> &[Corner] {
        self.corners.as_flattened()
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.corners.len() - self.free.len()
    }

    /// Number of places, free ones among them: the most triangles there ever were at once.
    pub fn place_count(&self) -> u32 {
        self.corners.len() as u32
    }

    /// The places that changed since the last call, in ascending ranges. O(changes log changes).
    pub fn take_changes(&mut self) -> Vec<Range<u32>> {
        self.changed.sort_unstable();
        let mut ranges: Vec<Range<u32>> = Vec::new();
        for &place in &self.changed {
            _ = self.is_changed.remove(place);
            match ranges.last_mut() {
                Some(range) if place - range.end <= GAP => range.end = place + 1,
                _ => ranges.push(place..place + 1),
            }
        }
        self.changed.clear();
        ranges
    }

    fn put(&mut self, place: u32, corners: [Corner; 3]) {
        self.corners[place as usize] = corners;
        if self.is_changed.insert(place) {
            self.changed.push(place);
        }
    }

    /// A triangle as it lies in the buffer.
    fn triangle(&self, cell: Cell<3>) -> [Corner; 3] {
        let at = cell.map(|v| self.positions[v.index()]);
        if !at.iter().all(|p| p.is_finite()) {
            return [Corner::zeroed(); 3];
        }
        let normal = area_vector(at.map(Vec3::as_dvec3)).normalize_or_zero().as_vec3().to_array();
        at.map(|p| Corner { position: (p - self.origin).to_array(), normal, colour: self.material })
    }
}

impl Sink<3> for LiveMesh<'_> {
    fn kill(&mut self, cell: CellId) {
        let place = std::mem::replace(&mut self.place_of[cell.index()], NONE);
        self.put(place, [Corner::zeroed(); 3]);
        self.free.push(place);
    }

    fn make(&mut self, cell: CellId, corners: Cell<3>) {
        let place = self.free.pop().unwrap_or_else(|| {
            self.corners.push([Corner::zeroed(); 3]);
            self.corners.len() as u32 - 1
        });
        self.place_of[cell.index()] = place;
        self.put(place, self.triangle(corners));
    }

    fn relabel(&mut self, cell: CellId, corners: Cell<3>) {
        self.put(self.place_of[cell.index()], self.triangle(corners));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mt_core::VertexId;

    fn cell(corners: [u32; 3]) -> Cell<3> {
        corners.map(VertexId)
    }

    #[test]
    fn places_are_taken_again_and_changes_told_once() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN];
        let mut mesh = LiveMesh::new(&positions, 100, Vec3::ZERO, [9; 4]);
        (0..40).for_each(|i| mesh.make(CellId(i), cell([0, 1, 2])));
        assert_eq!(mesh.take_changes().as_slice(), std::slice::from_ref(&(0..40)));
        assert!(mesh.take_changes().is_empty());
        mesh.kill(CellId(7));
        mesh.kill(CellId(30));
        mesh.relabel(CellId(31), cell([1, 2, 0]));
        assert_eq!(mesh.triangle_count(), 38);
        assert!(mesh.corners()[21..24].iter().all(|corner| *corner == Corner::zeroed()));
        mesh.make(CellId(99), cell([2, 0, 1]));
        assert_eq!(mesh.take_changes(), [7..8, 30..32]);
        assert_eq!((mesh.place_count(), mesh.triangle_count()), (40, 39));
        assert_eq!(mesh.corners()[90].position, [0.0, 1.0, 0.0]);
        mesh.relabel(CellId(99), cell([0, 1, 3]));
        assert_eq!(mesh.corners()[90], Corner::zeroed());
    }
}
