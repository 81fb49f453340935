//! The Multi-Tessellation as a trait: what synthesis asks of a model, and what a view of it is.
//!
//! After `[DeFlorianiTutorial2002]`: a base mesh, conforming modifications and a
//! partial order. A model is immutable; all run-time state of a camera is its view.

use crate::cell::Cell;
use crate::front::Front;
use crate::id::{CellId, NodeId};
use glam::Vec3;

/// Which laws a model claims.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Rule {
    /// `needs` is the whole truth: fronts are closed sets, minimality and confluence hold.
    Static,
    /// Feasibility depends on the current mesh in other ways: the laws of order, closure and minimality are not claimed.
    Dynamic,
}

/// What stands in the way of coarsening a node.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Coarsen {
    /// Nothing.
    Now,
    /// The listed nodes must be coarsened first.
    After,
    /// A rule of the model; coarsening others may or may not help.
    Not,
}

/// Hears of the cells that steps kill and make. `()` hears nothing and costs nothing.
pub trait Sink<const N: usize> {
    /// `cell` is gone.
    fn kill(&mut self, cell: CellId);
    /// `cell` is there, with these corners.
    fn make(&mut self, cell: CellId, corners: Cell<N>);
    /// `cell` is the same cell with other corners (vertex hierarchies).
    fn relabel(&mut self, cell: CellId, corners: Cell<N>);
}

impl<const N: usize> Sink<N> for () {
    #[inline(always)]
    fn kill(&mut self, _: CellId) {}
    #[inline(always)]
    fn make(&mut self, _: CellId, _: Cell<N>) {}
    #[inline(always)]
    fn relabel(&mut self, _: CellId, _: Cell<N>) {}
}

impl<const N: usize, S: Sink<N>> Sink<N> for &mut S {
    fn kill(&mut self, cell: CellId) {
        (**self).kill(cell);
    }
    fn make(&mut self, cell: CellId, corners: Cell<N>) {
        (**self).make(cell, corners);
    }
    fn relabel(&mut self, cell: CellId, corners: Cell<N>) {
        (**self).relabel(cell, corners);
    }
}

/// A step of a view: a node and a direction. Eight bytes, and invertible.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The modification.
    pub node: NodeId,
    /// Whether it was refined, or else coarsened.
    pub refined: bool,
}

const _: () = assert!(size_of::<Step>() == 8);

/// One camera's state of a model: the front, and the current mesh in the form that the model works on.
#[derive(Clone, Debug, PartialEq)]
pub struct View<Mesh> {
    /// The refined nodes.
    pub front: Front,
    /// The current mesh.
    pub mesh: Mesh,
}

/// A generic Multi-Tessellation of cells with `N` corners.
///
/// Ids are a rank: `needs(m)` are all above `m`. Queries append to `out` and never clear it.
pub trait MultiTessellation<const N: usize>: Sync {
    /// Run-time state of one view: alive cells, corner table.
    type Mesh: Clone + PartialEq + Send;
    /// What a criterion judges a node by.
    type Bound: Copy;
    /// Which laws apply.
    const RULE: Rule;

    /// Number of modifications.
    fn len(&self) -> u32;
    /// Whether the base mesh is the reference mesh.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// The base mesh.
    fn base(&self) -> Self::Mesh;
    /// The base mesh under the empty front.
    fn base_view(&self) -> View<Self::Mesh> {
        View { front: Front::base(self.len()), mesh: self.base() }
    }
    /// Each cell of a current mesh. O(cells of the model / 64 + cells of the mesh).
    fn cells(&self, mesh: &Self::Mesh, each: impl FnMut(CellId, Cell<N>));
    /// Number of cells of a current mesh. O(1).
    fn cell_count(&self, mesh: &Self::Mesh) -> u32;
    /// Position of every vertex that any cell of the model uses, in model units.
    fn positions(&self) -> &[Vec3];

    /// Roots of the discovery forest.
    fn roots(&self, out: &mut Vec<NodeId>);
    /// Nodes discovered under `m`: each node but the roots is under exactly one that it needs.
    fn children(&self, m: NodeId, out: &mut Vec<NodeId>);
    /// Bound of `m`, saturated along the discovery forest.
    fn bound(&self, m: NodeId) -> Self::Bound;
    /// Cells won by refining `m`; `None` where that depends on the front.
    fn gain(&self, m: NodeId) -> Option<i32>;

    /// What `m` needs directly: the order itself.
    fn needs(&self, m: NodeId, out: &mut Vec<NodeId>);
    /// What must be refined before `m` and is not yet. Asked again after each step.
    fn prerequisites(&self, m: NodeId, view: &View<Self::Mesh>, out: &mut Vec<NodeId>);
    /// What must be coarsened before `m`, for a refined `m`.
    fn obstacles(&self, m: NodeId, view: &View<Self::Mesh>, out: &mut Vec<NodeId>) -> Coarsen;

    /// The nodes that a coarse step makes at once: a contiguous run that ends in the node of highest rank and holds `m`.
    /// A fan's merges are one run; everywhere else a node is a run of its own.
    fn run(&self, m: NodeId) -> std::ops::RangeInclusive<NodeId> {
        m..=m
    }

    /// Replaces the coarse side of `m` by its fine side. Requires: no prerequisites, and `m` not refined.
    /// The front is the caller's to change: see [`take`].
    fn refine(&self, m: NodeId, mesh: &mut Self::Mesh, sink: &mut impl Sink<N>);
    /// Replaces the fine side of `m` by its coarse side. Requires: obstacles says Now, and `m` refined.
    fn coarsen(&self, m: NodeId, mesh: &mut Self::Mesh, sink: &mut impl Sink<N>);
}

/// Takes a legal step on a view, mesh and front together.
pub fn take<const N: usize, M: MultiTessellation<N>>(
    model: &M,
    step: Step,
    view: &mut View<M::Mesh>,
    sink: &mut impl Sink<N>,
) {
    if step.refined {
        model.refine(step.node, &mut view.mesh, sink);
    } else {
        model.coarsen(step.node, &mut view.mesh, sink);
    }
    let changed = view.front.set(step.node, step.refined);
    debug_assert!(changed, "{step:?} was taken already");
}

impl Step {
    /// Refines `node`.
    pub fn refine(node: NodeId) -> Self {
        Self { node, refined: true }
    }

    /// Coarsens `node`.
    pub fn coarsen(node: NodeId) -> Self {
        Self { node, refined: false }
    }

    /// The step that undoes this one.
    pub fn inverse(self) -> Self {
        Self { refined: !self.refined, ..self }
    }
}

/// The cells of a view's mesh, in the model's order of cells.
pub fn cells_of<const N: usize, M: MultiTessellation<N>>(model: &M, mesh: &M::Mesh) -> Vec<(CellId, Cell<N>)> {
    let mut cells = Vec::with_capacity(model.cell_count(mesh) as usize);
    model.cells(mesh, |id, corners| cells.push((id, corners)));
    cells
}

/// The mesh of a view by itself: cells in the model's order, vertices without a cell dropped. O(vertices of the model).
pub fn mesh_of<const N: usize, M: MultiTessellation<N>>(model: &M, mesh: &M::Mesh) -> crate::Mesh<N> {
    let cells = cells_of(model, mesh).into_iter().map(|(_, corners)| corners).collect();
    crate::Mesh { positions: model.positions().to_vec(), cells }.compact()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Heard(Vec<(char, u32)>);

    impl Sink<3> for Heard {
        fn kill(&mut self, cell: CellId) {
            self.0.push(('k', cell.0));
        }
        fn make(&mut self, cell: CellId, _: Cell<3>) {
            self.0.push(('m', cell.0));
        }
        fn relabel(&mut self, cell: CellId, _: Cell<3>) {
            self.0.push(('r', cell.0));
        }
    }

    #[test]
    fn a_borrowed_sink_hears_all() {
        fn tell(mut sink: impl Sink<3>) {
            let corners = [0, 1, 2].map(crate::VertexId);
            sink.make(CellId(1), corners);
            sink.relabel(CellId(2), corners);
            sink.kill(CellId(3));
        }
        let mut heard = Heard::default();
        tell(&mut heard);
        assert_eq!(heard.0, [('m', 1), ('r', 2), ('k', 3)]);
    }
}
