//! The arrays of an explicit model, and the check that makes one of them: no array points out of another.

use super::{ErrorKind, Explicit};
use crate::bits::Bits;
use crate::bound::Bound;
use crate::cell::{Cell, is_proper};
use crate::id::{CellId, NodeId};
use crate::order::{Order, OrderError, Rows};
use glam::Vec3;

/// The arrays of an explicit model; [`Explicit::from_parts`] makes a model of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts<const N: usize> {
    /// Input vertices, then those that modifications made.
    pub positions: Vec<Vec3>,
    /// How many of them are the input's.
    pub input_vertex_count: u32,
    /// Input cells, then the coarse sides of the modifications in their order.
    pub corners: Vec<Cell<N>>,
    /// Where the coarse side of each node starts in `corners`; one more entry than nodes.
    pub coarse_start: Vec<u32>,
    /// Where the fine side of each node starts in `fine`; one more entry than nodes.
    pub fine_start: Vec<u32>,
    /// Fine sides.
    pub fine: Vec<CellId>,
    /// The need under which each node is discovered; none for those that need nothing.
    pub parents: Vec<NodeId>,
    /// Bound of each node, saturated along the discovery forest.
    pub bounds: Vec<Bound>,
    /// What the errors promise.
    pub error_kind: ErrorKind,
}

/// Arrays that are not a model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Invalid {
    /// Two arrays that go together differ in length, or one does not ascend.
    #[error("the array of {0} does not fit the others")]
    Shape(&'static str),
    /// A cell has a corner that is no vertex, or one twice.
    #[error("cell {0} has a corner that is no vertex, or one corner twice")]
    Corners(CellId),
    /// A fine side has a cell that is made later than it is killed, or not at all.
    #[error("node {node} kills cell {cell}, which is not made before it")]
    Kill {
        /// The modification.
        node: NodeId,
        /// The cell.
        cell: CellId,
    },
    /// The bound of a modification has a cone of normals that is none.
    #[error("the cone of normals of node {0} is none")]
    Cone(NodeId),
    /// Two modifications kill the same cell.
    #[error("cell {cell} is killed twice, the second time by node {node}")]
    KilledTwice {
        /// The second modification.
        node: NodeId,
        /// The cell.
        cell: CellId,
    },
    /// A position, radius or error is infinite, negative or not a number.
    #[error("{what} {index} is not finite")]
    NotFinite {
        /// "vertex" or "bound".
        what: &'static str,
        /// Which.
        index: u32,
    },
    /// The discovery forest hangs a node under one that it does not need.
    #[error("node {node} is discovered under node {parent}, which it does not need")]
    Parent {
        /// The modification.
        node: NodeId,
        /// What it is said to hang under.
        parent: NodeId,
    },
    /// The derived order is not one.
    #[error(transparent)]
    Order(#[from] OrderError),
}

impl<const N: usize> Parts<N> {
    /// Number of nodes.
    pub fn node_count(&self) -> u32 {
        self.bounds.len() as u32
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        12 * self.positions.len()
            + 4 * N * self.corners.len()
            + 4 * (self.coarse_start.len() + self.fine_start.len() + self.fine.len() + self.parents.len())
            + size_of::<Bound>() * self.bounds.len()
    }

    fn check(&self) -> Result<(), Invalid> {
        check_starts("coarse sides", &self.coarse_start, self.bounds.len(), self.corners.len(), None)?;
        check_starts("fine sides", &self.fine_start, self.bounds.len(), self.fine.len(), Some(0))?;
        if self.input_vertex_count as usize > self.positions.len() {
            return Err(Invalid::Shape("positions"));
        }
        let bad = |p: &Vec3| !p.is_finite();
        if let Some(index) = self.positions.iter().position(bad) {
            return Err(Invalid::NotFinite { what: "vertex", index: index as u32 });
        }
        self.check_bounds()?;
        let inputs = self.coarse_start[0] as usize;
        let good = |(i, cell): &(usize, &Cell<N>)| {
            let vertices = if *i < inputs { self.input_vertex_count as usize } else { self.positions.len() };
            cell.iter().all(|v| v.index() < vertices) && is_proper(cell)
        };
        match self.corners.iter().enumerate().find(|cell| !good(cell)) {
            Some((index, _)) => Err(Invalid::Corners(CellId::new(index))),
            None => Ok(()),
        }
    }

    /// Bounds are finite, which those of coordinates near the largest float are not, and have cones that are cones.
    pub(super) fn check_bounds(&self) -> Result<(), Invalid> {
        let bad = |b: &Bound| {
            !(b.center.is_finite() && b.radius >= 0.0 && b.radius.is_finite() && b.error >= 0.0 && b.error.is_finite())
        };
        if let Some(index) = self.bounds.iter().position(bad) {
            return Err(Invalid::NotFinite { what: "bound", index: index as u32 });
        }
        if let Some(index) = self.bounds.iter().position(|b| !b.cone.is_valid()) {
            return Err(Invalid::Cone(NodeId::new(index)));
        }
        Ok(())
    }

    pub(super) fn fine_side(&self, m: usize) -> &[CellId] {
        &self.fine[self.fine_start[m] as usize..self.fine_start[m + 1] as usize]
    }
}

fn check_starts(
    what: &'static str,
    starts: &[u32],
    rows: usize,
    end: usize,
    first: Option<u32>,
) -> Result<(), Invalid> {
    let shape = starts.len() == rows + 1 && starts.is_sorted() && starts.last().map(|&e| e as usize) == Some(end);
    let begins = first.is_none_or(|first| starts.first() == Some(&first));
    if shape && begins { Ok(()) } else { Err(Invalid::Shape(what)) }
}

impl<const N: usize> Explicit<N> {
    /// The model of these arrays, with the order and the base mesh derived from the cells.
    ///
    /// Refuses arrays that point out of each other or kill a cell twice. Whether the modifications conform is for
    /// [`crate::check`] to say. O(cells + arcs).
    pub fn from_parts(parts: Parts<N>) -> Result<Self, Invalid> {
        parts.check()?;
        let order = derive_order(&parts)?;
        Self::from_checked(parts, order)
    }

    /// The model of checked arrays and the order derived from them.
    pub(super) fn from_checked(parts: Parts<N>, order: Order) -> Result<Self, Invalid> {
        check_forest(&parts, &order)?;
        let mut killed = Bits::new(parts.corners.len() as u32);
        for cell in &parts.fine {
            killed.insert(cell.0);
        }
        let base = (0..parts.corners.len() as u32).filter(|&c| !killed.contains(c)).map(CellId).collect();
        let roots = order.roots().collect();
        Ok(Self { parts, order, base, roots })
    }
}

fn check_forest<const N: usize>(parts: &Parts<N>, order: &Order) -> Result<(), Invalid> {
    if parts.parents.len() != parts.bounds.len() {
        return Err(Invalid::Shape("parents"));
    }
    for (m, &parent) in parts.parents.iter().enumerate() {
        let node = NodeId::new(m);
        let needs = order.needs(node);
        let good = if parent.is_none() { needs.is_empty() } else { needs.binary_search(&parent).is_ok() };
        if !good {
            return Err(Invalid::Parent { node, parent });
        }
    }
    Ok(())
}

/// Node `m` needs `p` when `p` killed a cell that `m` had made.
pub(super) fn derive_order<const N: usize>(parts: &Parts<N>) -> Result<Order, Invalid> {
    let makers = makers_of(parts);
    let mut killed = Bits::new(parts.corners.len() as u32);
    let mut dependents = Rows::with_capacity(parts.bounds.len(), 6 * parts.bounds.len());
    let mut row = Vec::new();
    for m in 0..parts.bounds.len() {
        row.clear();
        for &cell in parts.fine_side(m) {
            let node = NodeId::new(m);
            if cell.0 >= parts.coarse_start[m] {
                return Err(Invalid::Kill { node, cell });
            }
            if !killed.insert(cell.0) {
                return Err(Invalid::KilledTwice { node, cell });
            }
            let maker = makers[cell.index()];
            if !maker.is_none() {
                row.push(maker);
            }
        }
        row.sort_unstable();
        row.dedup();
        dependents.push(row.iter().copied());
    }
    Ok(Order::from_dependents(dependents)?)
}

/// The node whose coarse side has each cell; none for cells of the input.
fn makers_of<const N: usize>(parts: &Parts<N>) -> Vec<NodeId> {
    let mut makers = vec![NodeId::NONE; parts.corners.len()];
    for m in 0..parts.bounds.len() {
        makers[parts.coarse_start[m] as usize..parts.coarse_start[m + 1] as usize].fill(NodeId::new(m));
    }
    makers
}
