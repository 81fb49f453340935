//! A simplicial complex that changes: cells, and the star of each vertex. No position is in sight.
//!
//! The star of a vertex is a list threaded through the corners of its cells, so a
//! cell of three corners costs 32 bytes and a vertex 4, nothing is allocated while cells come
//! and go, and a complex need not be a manifold.

use crate::cell::{Cell, Facet, facet};
use crate::id::{CellId, VertexId};
use crate::plan::Plan;
use rayon::prelude::*;

/// The place of a live cell in a [`Complex`]. Places are reused; names of cells in a model are [`crate::CellId`]s.
pub type Slot = u32;

const NONE: u32 = u32::MAX;
/// Fewer cells than this are nothing to share among threads.
const CELLS_MIN: usize = 1 << 16;

/// A cell, of each of its corners the next corner (as `slot * N + i`) at the same vertex, and the cell's name. Side by
/// side, because a walk around a vertex reads both; 32 bytes for triangles, so that none lies across two cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Place<const N: usize> {
    corners: Cell<N>,
    next: [u32; N],
    name: CellId,
}

impl<const N: usize> Place<N> {
    const FREE: Self = Self { corners: [VertexId::NONE; N], next: [NONE; N], name: CellId::NONE };
}

/// Cells of `N` corners with the star of each vertex.
#[derive(Clone, Debug)]
pub struct Complex<const N: usize> {
    cells: Vec<Place<N>>,
    /// Of each vertex: its first corner.
    first: Vec<u32>,
    /// Slots that plans have emptied.
    free: Vec<Slot>,
    live: u32,
}

/// The same cells in the same slots, whatever the order in which stars are threaded.
impl<const N: usize> PartialEq for Complex<N> {
    fn eq(&self, other: &Self) -> bool {
        self.live == other.live && self.cells().eq(other.cells())
    }
}

impl<const N: usize> Complex<N> {
    /// The complex of these cells; slot `i` holds cell `i`. O(cells).
    ///
    /// Requires: corners below `vertex_count`, and different within a cell.
    pub fn new(vertex_count: usize, cells: &[Cell<N>]) -> Self {
        let place = |(i, &corners)| Place { corners, name: CellId::new(i), ..Place::FREE };
        let mut complex = Self {
            // Memory that is written for the first time is what takes long in a large complex, so threads share in it.
            cells: cells.par_iter().enumerate().with_min_len(CELLS_MIN).map(place).collect(),
            first: vec![NONE; vertex_count],
            free: Vec::new(),
            live: cells.len() as u32,
        };
        for slot in (0..cells.len() as u32).rev() {
            for i in 0..N {
                complex.link_corner(slot, i);
            }
        }
        complex
    }

    /// A complex of empty slots, for cells that come and go by name: see [`Self::put`].
    pub fn vacant(vertex_count: usize, slot_count: usize) -> Self {
        let cells = vec![Place::FREE; slot_count];
        Self { cells, first: vec![NONE; vertex_count], free: Vec::new(), live: 0 }
    }

    /// Number of live cells.
    #[inline]
    pub fn cell_count(&self) -> usize {
        self.live as usize
    }

    /// Number of vertices ever made, live or not.
    pub fn vertex_count(&self) -> usize {
        self.first.len()
    }

    /// Upper bound of all slots.
    pub fn slot_count(&self) -> usize {
        self.cells.len()
    }

    /// The corners of the cell in `slot`; all [`VertexId::NONE`] where there is none.
    #[inline]
    pub fn cell(&self, slot: Slot) -> &Cell<N> {
        &self.cells[slot as usize].corners
    }

    /// The name that a cell was given; input cells are named by their slots.
    #[inline]
    pub fn name(&self, slot: Slot) -> CellId {
        self.cells[slot as usize].name
    }

    /// Names the cell in `slot`.
    #[inline]
    pub fn set_name(&mut self, slot: Slot, name: CellId) {
        self.cells[slot as usize].name = name;
    }

    /// Whether a cell is in `slot`.
    pub fn is_live(&self, slot: Slot) -> bool {
        !self.cell(slot)[0].is_none()
    }

    /// The live cells and their slots.
    pub fn cells(&self) -> impl Iterator<Item = (Slot, &Cell<N>)> {
        let live = self.cells.iter().enumerate().filter(|(_, place)| !place.corners[0].is_none());
        live.map(|(slot, place)| (slot as u32, &place.corners))
    }

    /// Whether any cell uses `v`.
    #[inline]
    pub fn has_star(&self, v: VertexId) -> bool {
        self.first[v.index()] != NONE
    }

    /// The star of `v`: each cell around it, and which of its corners `v` is. O(star).
    #[inline]
    pub fn star(&self, v: VertexId) -> Star<'_, N> {
        Star { complex: self, corner: self.first[v.index()] }
    }

    /// The link of `v`: the facet opposite `v` in each cell of its star.
    pub fn link(&self, v: VertexId) -> impl Iterator<Item = Facet<N>> + '_ {
        self.star(v).map(|(slot, i)| facet(self.cell(slot), i).0)
    }

    /// The vertices that share a cell with `v`, ascending, written over `out`.
    pub fn neighbours(&self, v: VertexId, out: &mut Vec<VertexId>) {
        out.clear();
        for (slot, i) in self.star(v) {
            out.extend(self.cell(slot).iter().enumerate().filter(|(k, _)| *k != i).map(|(_, &w)| w));
        }
        out.sort_unstable();
        out.dedup();
    }

    /// How many cells have both `u` and `v`. O(star of `u`).
    pub fn edge_degree(&self, u: VertexId, v: VertexId) -> usize {
        self.star(u).filter(|&(slot, _)| self.cell(slot).contains(&v)).count()
    }

    /// The facets that belong to exactly one cell. O(cells log cells).
    pub fn boundary(&self) -> Vec<Facet<N>> {
        let mut all: Vec<_> = self.cells().flat_map(|(_, cell)| (0..N).map(move |i| facet(cell, i).0)).collect();
        all.sort_unstable();
        all.chunk_by(|a, b| a == b).filter(|run| run.len() == 1).map(|run| run[0]).collect()
    }

    /// Adds a vertex without cells.
    pub fn add_vertex(&mut self) -> VertexId {
        self.first.push(NONE);
        VertexId::new(self.first.len() - 1)
    }

    /// Applies a plan: makes its vertices, kills and makes its cells. O(stars of the patch's vertices).
    ///
    /// `makes[i]` takes the slot of `kills[i]`, so corners that stay cost nothing; the slots that cells beyond
    /// these take are written to `slots`. Requires: a plan made for this complex as it is.
    pub fn apply(&mut self, plan: &Plan<N>, slots: &mut Vec<Slot>) {
        slots.clear();
        for _ in &plan.vertices {
            self.add_vertex();
        }
        for v in &plan.retired {
            debug_assert!(self.star(*v).all(|(slot, _)| plan.kills.contains(&slot)), "a retired vertex keeps a cell");
            self.first[v.index()] = NONE;
        }
        for (i, &slot) in plan.kills.iter().enumerate() {
            match plan.makes.get(i) {
                Some(cell) => {
                    self.replace(slot, cell, &plan.retired);
                    slots.push(slot);
                }
                None => {
                    self.replace(slot, &[VertexId::NONE; N], &plan.retired);
                    self.free.push(slot);
                    self.live -= 1;
                }
            }
        }
        for cell in plan.makes.iter().skip(plan.kills.len()) {
            slots.push(self.insert(cell));
        }
    }

    fn insert(&mut self, cell: &Cell<N>) -> Slot {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.cells.push(Place::FREE);
            self.cells.len() as u32 - 1
        });
        self.replace(slot, cell, &[]);
        self.live += 1;
        slot
    }

    /// Puts a cell into an empty slot. O(1). For complexes whose slots are names; plans may not be applied to these.
    #[inline]
    pub fn put(&mut self, slot: Slot, corners: Cell<N>) {
        debug_assert!(!self.is_live(slot), "slot {slot} is taken");
        debug_assert!(self.free.is_empty(), "plans deal in slots, so a cell by name may not");
        self.cells[slot as usize].corners = corners;
        for i in 0..N {
            self.link_corner(slot, i);
        }
        self.live += 1;
    }

    /// Empties a slot. O(stars of its corners).
    #[inline]
    pub fn remove(&mut self, slot: Slot) {
        debug_assert!(self.is_live(slot), "slot {slot} is empty");
        for i in 0..N {
            self.unlink_corner(slot, i);
        }
        self.cells[slot as usize].corners = [VertexId::NONE; N];
        self.live -= 1;
    }

    /// The star of `from` becomes that of `to`: each cell around `from` gets `to` for that corner, which is told with the
    /// cell to `each`; a cell that has `to` already is emptied, and told with `from` where it was, and a no. O(star of `from`),
    /// and for each cell that dies the stars of its other corners.
    #[inline]
    pub fn join_star(&mut self, from: VertexId, to: VertexId, mut each: impl FnMut(Slot, usize, &Cell<N>, bool)) {
        let mut corner = std::mem::replace(&mut self.first[from.index()], NONE);
        while corner != NONE {
            let (slot, i) = (corner / N as u32, corner as usize % N);
            let place = &mut self.cells[slot as usize];
            let after = place.next[i];
            if place.corners.contains(&to) {
                each(slot, i, &place.corners, false);
                for k in (0..N).filter(|&k| k != i) {
                    self.unlink_corner(slot, k);
                }
                self.cells[slot as usize].corners = [VertexId::NONE; N];
                self.live -= 1;
            } else {
                place.corners[i] = to;
                place.next[i] = std::mem::replace(&mut self.first[to.index()], corner);
                each(slot, i, &place.corners, true);
            }
            corner = after;
        }
    }

    /// Deals out the star of `from`: each cell around it gets what `choose` says for that corner, which may be `from`
    /// itself; the others are told to `moved`. O(star of `from`).
    #[inline]
    pub fn part_star(
        &mut self,
        from: VertexId,
        mut choose: impl FnMut(Slot, usize) -> VertexId,
        mut moved: impl FnMut(Slot, &Cell<N>),
    ) {
        let mut corner = std::mem::replace(&mut self.first[from.index()], NONE);
        while corner != NONE {
            let (slot, i) = (corner / N as u32, corner as usize % N);
            let to = choose(slot, i);
            let place = &mut self.cells[slot as usize];
            let after = place.next[i];
            place.corners[i] = to;
            place.next[i] = std::mem::replace(&mut self.first[to.index()], corner);
            if to != from {
                moved(slot, &place.corners);
            }
            corner = after;
        }
    }

    #[inline]
    fn replace(&mut self, slot: Slot, new: &Cell<N>, retired: &[VertexId]) {
        for i in 0..N {
            let old = self.cell(slot)[i];
            if old == new[i] {
                continue;
            }
            if !old.is_none() && !retired.contains(&old) {
                self.unlink_corner(slot, i);
            }
            self.cells[slot as usize].corners[i] = new[i];
            if !new[i].is_none() {
                self.link_corner(slot, i);
            }
        }
    }

    #[inline]
    fn link_corner(&mut self, slot: Slot, i: usize) {
        let place = &mut self.cells[slot as usize];
        let first = &mut self.first[place.corners[i].index()];
        place.next[i] = std::mem::replace(first, slot * N as u32 + i as u32);
    }

    fn unlink_corner(&mut self, slot: Slot, i: usize) {
        let corner = slot * N as u32 + i as u32;
        let v = self.cell(slot)[i].index();
        let after = self.cells[slot as usize].next[i];
        if self.first[v] == corner {
            self.first[v] = after;
            return;
        }
        let mut at = self.first[v];
        loop {
            let next = &mut self.cells[at as usize / N].next[at as usize % N];
            if *next == corner {
                *next = after;
                return;
            }
            at = *next;
        }
    }
}

impl Complex<3> {
    /// The link of `v` as edges: of each triangle around it the two other corners, in the triangle's turn; written over
    /// `out`.
    #[inline]
    pub fn link_edges(&self, v: VertexId, out: &mut Vec<[VertexId; 2]>) {
        out.clear();
        out.extend(self.star(v).map(|(slot, i)| {
            let cell = self.cell(slot);
            [cell[(i + 1) % 3], cell[(i + 2) % 3]]
        }));
    }
}

/// Iterator over the star of a vertex: the slot of each cell and the corner at which the vertex is.
#[derive(Clone, Debug)]
pub struct Star<'a, const N: usize> {
    complex: &'a Complex<N>,
    corner: u32,
}

impl<const N: usize> Iterator for Star<'_, N> {
    type Item = (Slot, usize);

    #[inline]
    fn next(&mut self) -> Option<(Slot, usize)> {
        if self.corner == NONE {
            return None;
        }
        let (slot, i) = (self.corner / N as u32, self.corner as usize % N);
        self.corner = self.complex.cells[slot as usize].next[i];
        Some((slot, i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(all: &[[u32; 3]]) -> Vec<Cell<3>> {
        all.iter().map(|cell| cell.map(VertexId)).collect()
    }

    #[test]
    fn a_link_is_what_is_opposite() {
        let complex = Complex::new(4, &cells(&[[0, 1, 2], [0, 2, 3]]));
        let link: Vec<Vec<u32>> =
            complex.link(VertexId(0)).map(|facet| facet.vertices().iter().map(|v| v.0).collect()).collect();
        assert_eq!(link.len(), 2);
        assert!(link.contains(&vec![1, 2]) && link.contains(&vec![2, 3]));
        assert_eq!(complex.boundary().len(), 4);
    }

    #[test]
    fn cells_beyond_those_killed_take_free_slots_and_then_new_ones() {
        let mut complex = Complex::new(6, &cells(&[[0, 1, 2], [0, 2, 3]]));
        let mut slots = Vec::new();
        let plan =
            |kills: &[u32], makes: &[[u32; 3]]| Plan { kills: kills.to_vec(), makes: cells(makes), ..Plan::default() };
        complex.apply(&plan(&[0], &[[0, 1, 4], [1, 2, 4], [2, 0, 4]]), &mut slots);
        assert_eq!((slots.as_slice(), complex.cell_count(), complex.slot_count()), ([0, 2, 3].as_slice(), 4, 4));
        complex.apply(&plan(&[2, 3], &[]), &mut slots);
        assert_eq!((slots.len(), complex.cell_count()), (0, 2));
        complex.apply(&plan(&[1], &[[0, 2, 5], [2, 3, 5]]), &mut slots);
        assert_eq!((slots.as_slice(), complex.slot_count()), ([1, 3].as_slice(), 4));
        let star: Vec<u32> = complex.star(VertexId(5)).map(|(slot, _)| slot).collect();
        assert!(star.len() == 2 && star.contains(&1) && star.contains(&3));
        assert_eq!(complex.edge_degree(VertexId(2), VertexId(5)), 2);
    }
}
