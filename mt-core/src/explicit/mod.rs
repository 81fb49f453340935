//! The explicit model: every cell and every arc is stored, for cells of any dimension and modifications of any kind.
//!
//! After `[DeFlorianiTutorial2002]`. Node `m` is the `m`-th modification of the
//! analysis, which coarsened; its coarse side is a run of cells, because they were
//! made together; its fine side is a list. A node needs those whose fine side has
//! a cell of its coarse side.
//!
//! Where the bytes go, per node of a full edge collapse of a closed triangle mesh (about one node and two triangles an
//! input vertex; `k` cells killed, about 9, `k - 2` made, `a` arcs, about 4):
//!
//! | what | bytes |
//! |---|---|
//! | corners of cells | 12 (2 + k - 2) |
//! | positions, of input and made vertices | 24 |
//! | fine sides | 4 k + 4 |
//! | starts of coarse sides | 4 |
//! | arcs, both directions | 8 a + 8 |
//! | bounds | 24 |
//! | discovery forest | 4 |

mod part;
mod parts;
mod recorder;

pub use parts::{Invalid, Parts};
pub use recorder::{HistoryError, Recorder};

use crate::bits::Bits;
use crate::bound::Bound;
use crate::cell::Cell;
use crate::id::{CellId, NodeId};
use crate::model::{Coarsen, MultiTessellation, Rule, Sink, View};
use crate::order::Order;
use crate::plan::Patch;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// What the errors of a model promise.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorKind {
    /// A number that ranks and approximates, such as a quadric's root mean square distance to planes.
    #[default]
    Estimate,
    /// The largest distance from the input vertices of the patch to its coarse side, measured.
    Measured,
}

/// A Multi-Tessellation with all its cells and arcs. Built by a [`Recorder`], immutable afterwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Explicit<const N: usize> {
    parts: Parts<N>,
    order: Order,
    base: Vec<CellId>,
    roots: Vec<NodeId>,
}

impl<const N: usize> Explicit<N> {
    /// The model's arrays, as a container stores them.
    pub fn parts(&self) -> &Parts<N> {
        &self.parts
    }

    /// The order on the modifications.
    pub fn order(&self) -> &Order {
        &self.order
    }

    /// What the errors promise.
    pub fn error_kind(&self) -> ErrorKind {
        self.parts.error_kind
    }

    /// Number of vertices of the input.
    pub fn input_vertex_count(&self) -> u32 {
        self.parts.input_vertex_count
    }

    /// Number of cells of the input, which are the first cells of the model.
    pub fn input_cell_count(&self) -> u32 {
        self.parts.coarse_start[0]
    }

    /// Number of cells of all meshes.
    pub fn total_cell_count(&self) -> u32 {
        self.parts.corners.len() as u32
    }

    /// The corners of a cell.
    #[inline]
    pub fn corners(&self, cell: CellId) -> &Cell<N> {
        &self.parts.corners[cell.index()]
    }

    /// The cells of the base mesh, ascending.
    pub fn base_cells(&self) -> &[CellId] {
        &self.base
    }

    /// The coarse side of `m`: the cells that refining kills, a run of ids.
    #[inline]
    pub fn coarse_side(&self, m: NodeId) -> impl Iterator<Item = CellId> + use<N> {
        (self.parts.coarse_start[m.index()]..self.parts.coarse_start[m.index() + 1]).map(CellId)
    }

    /// The fine side of `m`: the cells that refining makes.
    #[inline]
    pub fn fine_side(&self, m: NodeId) -> &[CellId] {
        let starts = &self.parts.fine_start;
        &self.parts.fine[starts[m.index()] as usize..starts[m.index() + 1] as usize]
    }

    /// Both sides of `m` as cells.
    pub fn patch(&self, m: NodeId) -> Patch<N> {
        Patch {
            fine: self.fine_side(m).iter().map(|&c| *self.corners(c)).collect(),
            coarse: self.coarse_side(m).map(|c| *self.corners(c)).collect(),
        }
    }

    /// The node whose coarse side has `cell`, which is the one that refines it. `None` for cells of the input.
    pub fn refined_by(&self, cell: CellId) -> Option<NodeId> {
        let after = self.parts.coarse_start.partition_point(|&start| start <= cell.0);
        after.checked_sub(1).map(NodeId::new)
    }

    /// The input, bit for bit.
    pub fn reference(&self) -> crate::Mesh<N> {
        crate::Mesh {
            positions: self.parts.positions[..self.parts.input_vertex_count as usize].to_vec(),
            cells: self.parts.corners[..self.input_cell_count() as usize].to_vec(),
        }
    }

    /// The node under which `m` is discovered; `None` for roots.
    pub fn parent(&self, m: NodeId) -> Option<NodeId> {
        Some(self.parts.parents[m.index()]).filter(|parent| !parent.is_none())
    }

    /// Bytes of the model in memory, all arrays.
    pub fn bytes(&self) -> usize {
        self.parts.bytes() + self.order.bytes() + 4 * (self.base.len() + self.roots.len())
    }

    fn gain_of(&self, m: NodeId) -> i32 {
        self.fine_side(m).len() as i32 - self.coarse_side(m).count() as i32
    }
}

/// The cells of a current mesh: one bit for each cell of the model.
pub type Alive = Bits;

impl<const N: usize> MultiTessellation<N> for Explicit<N> {
    type Mesh = Alive;
    type Bound = Bound;
    const RULE: Rule = Rule::Static;

    fn len(&self) -> u32 {
        self.order.len()
    }

    fn base(&self) -> Alive {
        let mut alive = Bits::new(self.total_cell_count());
        for cell in &self.base {
            alive.insert(cell.0);
        }
        alive
    }

    fn cells(&self, alive: &Alive, mut each: impl FnMut(CellId, Cell<N>)) {
        for cell in alive.iter().map(CellId) {
            each(cell, *self.corners(cell));
        }
    }

    fn cell_count(&self, alive: &Alive) -> u32 {
        alive.count()
    }

    fn positions(&self) -> &[Vec3] {
        &self.parts.positions
    }

    fn roots(&self, out: &mut Vec<NodeId>) {
        out.extend_from_slice(&self.roots);
    }

    fn children(&self, m: NodeId, out: &mut Vec<NodeId>) {
        let parents = &self.parts.parents;
        out.extend(self.order.dependents(m).iter().copied().filter(|child| parents[child.index()] == m));
    }

    fn bound(&self, m: NodeId) -> Bound {
        self.parts.bounds[m.index()]
    }

    fn gain(&self, m: NodeId) -> Option<i32> {
        Some(self.gain_of(m))
    }

    fn needs(&self, m: NodeId, out: &mut Vec<NodeId>) {
        out.extend_from_slice(self.order.needs(m));
    }

    fn prerequisites(&self, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) {
        out.extend(self.order.needs(m).iter().copied().filter(|&need| !view.front.is_refined(need)));
    }

    fn obstacles(&self, m: NodeId, view: &View<Alive>, out: &mut Vec<NodeId>) -> Coarsen {
        let before = out.len();
        out.extend(self.order.dependents(m).iter().copied().filter(|&dependent| view.front.is_refined(dependent)));
        if out.len() == before { Coarsen::Now } else { Coarsen::After }
    }

    fn refine(&self, m: NodeId, alive: &mut Alive, sink: &mut impl Sink<N>) {
        for cell in self.coarse_side(m) {
            alive.remove(cell.0);
            sink.kill(cell);
        }
        for &cell in self.fine_side(m) {
            alive.insert(cell.0);
            sink.make(cell, *self.corners(cell));
        }
    }

    fn coarsen(&self, m: NodeId, alive: &mut Alive, sink: &mut impl Sink<N>) {
        for &cell in self.fine_side(m) {
            alive.remove(cell.0);
            sink.kill(cell);
        }
        for cell in self.coarse_side(m) {
            alive.insert(cell.0);
            sink.make(cell, *self.corners(cell));
        }
    }
}
