//! A mesh that changes: the triangles of a view as they lie in a vertex buffer, changed one by one by what a sink hears.
//!
//! Each triangle has a place of its own, and places of triangles that are gone are taken again. So what has to be sent to a
//! device after some steps is what these steps touched, whatever the size of the mesh or of the model.

use crate::ramp::Rgba;
use crate::scene::Corner;
use bytemuck::Zeroable;
use glam::Vec3;
use mt_core::mesh::area_vector;
use mt_core::{Bits, Cell, CellId, Sink, VertexId};
use std::ops::Range;

/// No place.
const NONE: u32 = u32::MAX;
/// Places that lie so near to each other are sent at once: a call costs more than a few triangles.
const GAP: u32 = 8;

/// A triangle of the model, where it has a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placed {
    /// Its cell; none where the place is free.
    pub cell: CellId,
    /// Its corners.
    pub corners: Cell<3>,
}

const FREE: Placed = Placed { cell: CellId::NONE, corners: [VertexId(0); 3] };

/// Triangles in places, and which places changed. 100 bytes a place, and 4 a cell of the model.
#[derive(Debug, Default)]
pub struct Places {
    origin: Vec3,
    material: Rgba,
    /// The place of each cell of the model, if it is there.
    place_of: Vec<u32>,
    /// Places of triangles that are gone.
    free: Vec<u32>,
    corners: Vec<[Corner; 3]>,
    placed: Vec<Placed>,
    /// Places that changed since somebody asked.
    changed: Vec<u32>,
    is_changed: Bits,
}

/// The triangles of one view in places, as the sink of its [`mt_core::Step`]s.
///
/// A triangle of which a position is not finite has a place and covers nothing.
#[derive(Debug)]
pub struct LiveMesh<P> {
    /// Of the model's vertices: a slice, or whatever keeps one.
    positions: P,
    /// The triangles.
    pub places: Places,
}

impl<P: AsRef<[Vec3]>> LiveMesh<P> {
    /// No triangles yet, of a model with these positions and so many cells at most; drawn relative to `origin`.
    pub fn new(positions: P, cells: u32, origin: Vec3, material: Rgba) -> Self {
        let places = Places {
            origin,
            material,
            place_of: vec![NONE; cells as usize],
            free: Vec::new(),
            corners: Vec::new(),
            placed: Vec::new(),
            changed: Vec::new(),
            // There are never more places than cells.
            is_changed: Bits::new(cells),
        };
        Self { positions, places }
    }

    fn at(&self, corners: Cell<3>) -> [Vec3; 3] {
        let positions = self.positions.as_ref();
        corners.map(|v| positions[v.index()])
    }
}

impl Places {
    /// The point that coordinates are relative to.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// All places, as they lie in a vertex buffer; free ones have three corners in one point.
    pub fn corners(&self) -> &[Corner] {
        self.corners.as_flattened()
    }

    /// The triangles that are there, with their corners as drawn. O(places).
    pub fn triangles(&self) -> impl Iterator<Item = (Placed, &[Corner; 3])> {
        self.placed.iter().copied().zip(&self.corners).filter(|(placed, _)| !placed.cell.is_none())
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

    /// Gives each triangle the colour that `of` tells; what has it already is not changed. O(places).
    pub fn recolour(&mut self, mut of: impl FnMut(Placed) -> Rgba) {
        for place in 0..self.corners.len() {
            let placed = self.placed[place];
            // A triangle that covers nothing has no colour.
            if placed.cell.is_none() || self.corners[place] == [Corner::zeroed(); 3] {
                continue;
            }
            let colour = of(placed);
            if self.corners[place][0].colour != colour {
                let corners = self.corners[place].map(|corner| Corner { colour, ..corner });
                self.put(place as u32, placed, corners);
            }
        }
    }

    fn put(&mut self, place: u32, placed: Placed, corners: [Corner; 3]) {
        (self.placed[place as usize], self.corners[place as usize]) = (placed, corners);
        if self.is_changed.insert(place) {
            self.changed.push(place);
        }
    }

    /// A triangle as it lies in the buffer.
    fn triangle(&self, at: [Vec3; 3]) -> [Corner; 3] {
        if !at.iter().all(|p| p.is_finite()) {
            return [Corner::zeroed(); 3];
        }
        let normal = area_vector(at.map(Vec3::as_dvec3)).normalize_or_zero().as_vec3().to_array();
        at.map(|p| Corner { position: (p - self.origin).to_array(), normal, colour: self.material })
    }
}

impl<P: AsRef<[Vec3]>> Sink<3> for LiveMesh<P> {
    fn kill(&mut self, cell: CellId) {
        let place = std::mem::replace(&mut self.places.place_of[cell.index()], NONE);
        self.places.put(place, FREE, [Corner::zeroed(); 3]);
        self.places.free.push(place);
    }

    fn make(&mut self, cell: CellId, corners: Cell<3>) {
        let triangle = self.places.triangle(self.at(corners));
        let places = &mut self.places;
        let place = places.free.pop().unwrap_or_else(|| {
            places.corners.push([Corner::zeroed(); 3]);
            places.placed.push(FREE);
            places.corners.len() as u32 - 1
        });
        places.place_of[cell.index()] = place;
        places.put(place, Placed { cell, corners }, triangle);
    }

    fn relabel(&mut self, cell: CellId, corners: Cell<3>) {
        let triangle = self.places.triangle(self.at(corners));
        self.places.put(self.places.place_of[cell.index()], Placed { cell, corners }, triangle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(corners: [u32; 3]) -> Cell<3> {
        corners.map(VertexId)
    }

    #[test]
    fn places_are_taken_again_and_changes_told_once() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN];
        let mut mesh = LiveMesh::new(positions, 100, Vec3::ZERO, [9; 4]);
        (0..40).for_each(|i| mesh.make(CellId(i), cell([0, 1, 2])));
        assert_eq!(mesh.places.take_changes().as_slice(), std::slice::from_ref(&(0..40)));
        assert!(mesh.places.take_changes().is_empty());
        mesh.kill(CellId(7));
        mesh.kill(CellId(30));
        mesh.relabel(CellId(31), cell([1, 2, 0]));
        assert_eq!(mesh.places.triangle_count(), 38);
        assert!(mesh.places.corners()[21..24].iter().all(|corner| *corner == Corner::zeroed()));
        mesh.make(CellId(99), cell([2, 0, 1]));
        assert_eq!(mesh.places.take_changes(), [7..8, 30..32]);
        assert_eq!((mesh.places.place_count(), mesh.places.triangle_count()), (40, 39));
        assert_eq!(mesh.places.corners()[90].position, [0.0, 1.0, 0.0]);
        mesh.relabel(CellId(99), cell([0, 1, 3]));
        assert_eq!(mesh.places.corners()[90], Corner::zeroed());
    }

    #[test]
    fn colours_change_where_they_differ() {
        let mut mesh = LiveMesh::new([Vec3::ZERO, Vec3::X, Vec3::Y], 10, Vec3::ZERO, [9; 4]);
        (0..6).for_each(|i| mesh.make(CellId(i), cell([0, 1, 2])));
        mesh.kill(CellId(2));
        _ = mesh.places.take_changes();
        let red = |placed: Placed| if placed.cell.0 < 4 { [200, 0, 0, 255] } else { [9; 4] };
        mesh.places.recolour(red);
        // Places 0, 1 and 3: near enough to go at once.
        assert_eq!(mesh.places.take_changes().as_slice(), std::slice::from_ref(&(0..4)));
        mesh.places.recolour(red);
        assert!(mesh.places.take_changes().is_empty());
        assert_eq!(mesh.places.triangles().filter(|(_, at)| at[2].colour == [200, 0, 0, 255]).count(), 3);
        mesh.places.recolour(|_| [9; 4]);
        assert!(mesh.places.corners().iter().all(|corner| corner.colour == [9; 4] || *corner == Corner::zeroed()));
    }
}
