//! The recorder: any simplification becomes a Multi-Tessellation by telling which cells it kills and makes.

use super::parts::derive_order;
use super::{ErrorKind, Explicit, Invalid, Parts};
use crate::analysis::RegionListener;
use crate::bits::Bits;
use crate::bound::{Bound, cone_of_cells};
use crate::cell::{Cell, is_proper};
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::Mesh;
use crate::order::Order;
use glam::Vec3;
use rayon::prelude::*;

/// Listens to a coarsening history and makes an [`Explicit`] model of it.
///
/// Input cells are `0..cell_count`, in order; cells and vertices made later get the next ids. One modification is any
/// number of [`kill`](Self::kill), [`vertex`](Self::vertex) and [`make`](Self::make), then [`end`](Self::end).
/// Everything is appended to the model's final arrays. O(1) a call.
///
/// ```
/// use mt_core::{CellId, Mesh, Recorder, VertexId, ErrorKind, MultiTessellation};
/// use glam::Vec3;
/// // A square with a vertex in its middle loses that vertex.
/// let square = Mesh::from_indices(
///     vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, Vec3::new(0.5, 0.5, 0.1)],
///     &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
/// );
/// let mut recorder = Recorder::new(&square).unwrap();
/// for cell in 0..4 {
///     recorder.kill(CellId(cell)).unwrap();
/// }
/// recorder.make([0, 1, 2].map(VertexId)).unwrap();
/// recorder.make([0, 2, 3].map(VertexId)).unwrap();
/// recorder.end(0.1).unwrap();
/// let model = recorder.finish(ErrorKind::Measured).unwrap();
/// assert_eq!((model.len(), model.base_cells().len()), (1, 2));
/// ```
#[derive(Clone, Debug)]
pub struct Recorder<const N: usize> {
    positions: Vec<Vec3>,
    input_vertex_count: u32,
    corners: Vec<Cell<N>>,
    coarse_start: Vec<u32>,
    fine_start: Vec<u32>,
    fine: Vec<CellId>,
    errors: Vec<f32>,
    alive: Bits,
    /// Cells below this were there before the modification that is being told.
    settled: u32,
}

/// A history that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HistoryError {
    /// The cell is not there to be killed.
    #[error("cell {0} is not alive: it was killed before, or never made")]
    NotAlive(CellId),
    /// A modification kills a cell that it has made itself.
    #[error("cell {0} is killed by the modification that makes it")]
    OwnCell(CellId),
    /// A corner is no vertex, or occurs twice.
    #[error("a cell's corners {0:?} are not different vertices below {1}")]
    Corners(Vec<u32>, usize),
    /// The error or a position is negative, infinite or not a number.
    #[error("{0} is not a finite number in range")]
    NotFinite(&'static str),
    /// The modification kills nothing.
    #[error("a modification must kill at least one cell")]
    Empty,
    /// The model would have 2^32 - 1 cells or vertices, or more.
    #[error("more cells or vertices than 32-bit ids can name")]
    TooLarge,
    /// Calls after the last `end` are not part of any modification.
    #[error("the last modification was not ended")]
    Unfinished,
    /// A modification that is not a merge of vertices into one; there is no vertex hierarchy of such.
    #[error("the modification does not merge vertices into one, as a vertex hierarchy needs")]
    NotMerge,
    /// The arrays do not make a model.
    #[error(transparent)]
    Invalid(#[from] Invalid),
}

impl<const N: usize> Recorder<N> {
    /// A recorder of the coarsening of `mesh`. Refuses cells whose corners are not different vertices.
    pub fn new(mesh: &Mesh<N>) -> Result<Self, HistoryError> {
        let count = mesh.cells.len();
        if count >= u32::MAX as usize || mesh.positions.len() >= u32::MAX as usize {
            return Err(HistoryError::TooLarge);
        }
        if mesh.positions.iter().any(|p| !p.is_finite()) {
            return Err(HistoryError::NotFinite("a position of the input"));
        }
        for cell in &mesh.cells {
            check_corners(cell, mesh.positions.len())?;
        }
        // A full edge collapse of a closed mesh makes about four cells for each input cell.
        let mut corners = Vec::with_capacity(5 * count);
        corners.extend_from_slice(&mesh.cells);
        let mut positions = Vec::with_capacity(2 * mesh.positions.len());
        positions.extend_from_slice(&mesh.positions);
        Ok(Self {
            positions,
            input_vertex_count: mesh.positions.len() as u32,
            corners,
            coarse_start: vec![count as u32],
            fine_start: vec![0],
            fine: Vec::with_capacity(5 * count),
            errors: Vec::with_capacity(count / 2),
            alive: Bits::full(count as u32),
            settled: count as u32,
        })
    }

    /// Kills a cell of the current mesh.
    pub fn kill(&mut self, cell: CellId) -> Result<(), HistoryError> {
        if cell.0 >= self.settled {
            let made = cell.index() < self.corners.len();
            return Err(if made { HistoryError::OwnCell(cell) } else { HistoryError::NotAlive(cell) });
        }
        if !self.alive.contains(cell.0) {
            return Err(HistoryError::NotAlive(cell));
        }
        self.alive.remove(cell.0);
        self.fine.push(cell);
        Ok(())
    }

    /// Adds a vertex; its id is the next.
    pub fn vertex(&mut self, position: Vec3) -> Result<VertexId, HistoryError> {
        if !position.is_finite() {
            return Err(HistoryError::NotFinite("a position"));
        }
        if self.positions.len() + 1 >= u32::MAX as usize {
            return Err(HistoryError::TooLarge);
        }
        self.positions.push(position);
        Ok(VertexId::new(self.positions.len() - 1))
    }

    /// Makes a cell; its id is the next.
    pub fn make(&mut self, corners: Cell<N>) -> Result<CellId, HistoryError> {
        check_corners(&corners, self.positions.len())?;
        if self.corners.len() + 1 >= u32::MAX as usize {
            return Err(HistoryError::TooLarge);
        }
        self.corners.push(corners);
        Ok(CellId::new(self.corners.len() - 1))
    }

    /// Ends a modification whose coarse side has this error, in model units.
    pub fn end(&mut self, error: f32) -> Result<NodeId, HistoryError> {
        if !(error.is_finite() && error >= 0.0) {
            return Err(HistoryError::NotFinite("an error"));
        }
        if self.fine.len() as u32 == *self.fine_start.last().expect("starts begin with 0") {
            return Err(HistoryError::Empty);
        }
        self.grow_alive();
        self.fine_start.push(self.fine.len() as u32);
        self.coarse_start.push(self.corners.len() as u32);
        self.errors.push(error);
        Ok(NodeId::new(self.errors.len() - 1))
    }

    /// Number of vertices so far, those of the input included.
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Number of cells so far, killed or not.
    pub fn cell_count(&self) -> usize {
        self.corners.len()
    }

    /// The position of a vertex.
    pub fn position(&self, v: VertexId) -> Vec3 {
        self.positions[v.index()]
    }

    /// The model. Derives the order, saturates the bounds. O(cells + arcs). Patches are measured by the threads of the rayon
    /// pool that this is called in; the model is the same for any number of them.
    pub fn finish(self, error_kind: ErrorKind) -> Result<Explicit<N>, HistoryError> {
        let ended = *self.coarse_start.last().expect("starts are never empty") as usize == self.corners.len()
            && *self.fine_start.last().expect("starts are never empty") as usize == self.fine.len();
        if !ended {
            return Err(HistoryError::Unfinished);
        }
        let mut parts = Parts {
            positions: self.positions,
            input_vertex_count: self.input_vertex_count,
            corners: self.corners,
            coarse_start: self.coarse_start,
            fine_start: self.fine_start,
            fine: self.fine,
            parents: vec![NodeId::NONE; self.errors.len()],
            bounds: vec![Bound::default(); self.errors.len()],
            error_kind,
        };
        parts.positions.shrink_to_fit();
        parts.corners.shrink_to_fit();
        parts.fine.shrink_to_fit();
        let order = derive_order(&parts)?;
        parts.bounds = patch_bounds(&parts, &self.errors);
        grow_forest(&order, &mut parts.bounds, &mut parts.parents);
        parts.check_bounds()?;
        Ok(Explicit::from_checked(parts, order)?)
    }

    fn grow_alive(&mut self) {
        // The set grows by doubling, so that telling it of new cells is O(1) each.
        let count = self.corners.len() as u32;
        if count > self.alive.capacity() {
            let mut grown = Bits::new(count.max(self.alive.capacity().saturating_mul(2)));
            self.alive.iter().for_each(|cell| _ = grown.insert(cell));
            self.alive = grown;
        }
        for cell in self.settled..count {
            self.alive.insert(cell);
        }
        self.settled = count;
    }
}

impl<const N: usize> RegionListener<N> for Recorder<N> {
    fn of_region(region: &Mesh<N>) -> Result<Self, HistoryError> {
        Self::new(region)
    }

    /// O(part).
    fn append(
        &mut self,
        part: Self,
        vertices: &[VertexId],
        cells: &[CellId],
    ) -> Result<(Vec<VertexId>, Vec<CellId>), HistoryError> {
        let named = |known: usize, own: usize, all: usize| (0..own - known).map(move |i| (all + i) as u32);
        let (vertex_sum, cell_sum) =
            (self.positions.len() + part.positions.len(), self.corners.len() + part.corners.len());
        if vertex_sum >= u32::MAX as usize || cell_sum >= u32::MAX as usize {
            return Err(HistoryError::TooLarge);
        }
        if let Some(&dead) = cells.iter().find(|cell| !self.alive.contains(cell.0)) {
            return Err(HistoryError::NotAlive(dead));
        }
        let mut vertex_names = vertices.to_vec();
        vertex_names.extend(named(vertices.len(), part.positions.len(), self.positions.len()).map(VertexId));
        let mut cell_names = cells.to_vec();
        cell_names.extend(named(cells.len(), part.corners.len(), self.corners.len()).map(CellId));
        let (fine, made) = (self.fine.len() as u32, self.corners.len() as u32);
        self.positions.extend_from_slice(&part.positions[vertices.len()..]);
        let corners = |cell: &Cell<N>| cell.map(|v| vertex_names[v.index()]);
        self.corners.extend(part.corners[cells.len()..].iter().map(corners));
        self.fine.extend(part.fine.iter().map(|cell| cell_names[cell.index()]));
        self.fine_start.extend(part.fine_start[1..].iter().map(|start| fine + start));
        self.coarse_start.extend(part.coarse_start[1..].iter().map(|start| made + (start - cells.len() as u32)));
        self.errors.extend_from_slice(&part.errors);
        self.grow_alive();
        for (at, name) in cell_names.iter().enumerate() {
            if !part.alive.contains(at as u32) {
                self.alive.remove(name.0);
            }
        }
        Ok((vertex_names, cell_names))
    }
}

fn check_corners<const N: usize>(corners: &Cell<N>, vertex_count: usize) -> Result<(), HistoryError> {
    let good = corners.iter().all(|v| v.index() < vertex_count) && is_proper(corners);
    if good { Ok(()) } else { Err(HistoryError::Corners(corners.map(|v| v.0).to_vec(), vertex_count)) }
}

/// So many patches are measured by one thread at a time.
const PATCHES: usize = 4096;

/// Bounds of the patches by themselves.
fn patch_bounds<const N: usize>(parts: &Parts<N>, errors: &[f32]) -> Vec<Bound> {
    let bounds_from = |(run, errors): (usize, &[f32])| {
        let (mut points, mut vectors) = (Vec::new(), Vec::new());
        let bound = |(i, &error): (usize, &f32)| {
            let m = run * PATCHES + i;
            let made = &parts.corners[parts.coarse_start[m] as usize..parts.coarse_start[m + 1] as usize];
            let cells = parts.fine_side(m).iter().map(|cell| &parts.corners[cell.index()]).chain(made);
            // A vertex comes once for each of its cells; sorting them out would cost more than measuring them again.
            points.clear();
            points.extend(cells.flatten().map(|v| parts.positions[v.index()]));
            let cone = cone_of_cells(points.as_chunks::<N>().0, &mut vectors);
            Bound::of_patch(&points, error, cone)
        };
        errors.iter().enumerate().map(bound).collect::<Vec<_>>()
    };
    errors.par_chunks(PATCHES).enumerate().flat_map_iter(bounds_from).collect()
}

/// Hangs each node under that of its needs whose sphere grows least by it, and grows the bound there.
///
/// One sweep: what is discovered under a node has a smaller id, so a node's own bound is final when its turn comes.
/// Spheres end up 1.1 to 1.3 times those of the patches on scans; under the need that comes first they were up to 2.5 times.
fn grow_forest(order: &Order, bounds: &mut [Bound], parents: &mut [NodeId]) {
    for m in (0..order.len()).map(NodeId) {
        let child = bounds[m.index()];
        let growth = |need: &NodeId| {
            let radius = bounds[need.index()].radius;
            (bounds[need.index()].radius_with(&child) - radius, radius)
        };
        let order_of = |a: &(f32, f32), b: &(f32, f32)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1));
        let measured = order.needs(m).iter().map(|need| (growth(need), *need));
        if let Some((_, parent)) = measured.min_by(|a, b| order_of(&a.0, &b.0)) {
            parents[m.index()] = parent;
            bounds[parent.index()].include(&child);
        }
    }
}
