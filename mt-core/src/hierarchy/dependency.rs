//! A replay and what its steps wait for, together a Multi-Tessellation.

use super::mesh::VertexMesh;
use super::replay::Replay;
use crate::bound::Bound;
use crate::cell::Cell;
use crate::id::{CellId, NodeId};
use crate::model::{Coarsen, MultiTessellation, Rule, Sink, View};
use glam::Vec3;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// When a node of a vertex hierarchy may be refined or coarsened, besides what the forest asks for.
///
/// Asked at every step, so answers should cost no more than the star of a vertex, and allocate nothing but in `out`. What
/// `prerequisites` name must have larger ids than `m`, what `obstacles` name smaller ones.
pub trait Dependency: Sync {
    /// Which laws the scheme claims.
    const RULE: Rule;

    /// What `m` needs besides its parent in the forest. For dynamic rules: what it always needs.
    fn needs(&self, replay: &Replay, m: NodeId, out: &mut Vec<NodeId>);

    /// What must be refined before `m`, besides its parent. A dynamic rule is asked only when the parent is refined.
    fn prerequisites(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>);

    /// What must be coarsened before `m`, besides the nodes under it. A dynamic rule is asked only when those are coarse.
    fn obstacles(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) -> Coarsen;

    /// Bytes stored.
    fn bytes(&self) -> usize;
}

/// A vertex hierarchy under a dependency scheme. Hierarchies of one sequence share the replay.
#[derive(Clone, Debug)]
pub struct Hierarchy<D> {
    /// The mechanics of the mesh.
    pub replay: Arc<Replay>,
    /// When a step is legal.
    pub dependency: D,
}

impl<D: Dependency> Hierarchy<D> {
    /// Bytes of the hierarchy, without the input mesh.
    pub fn bytes(&self) -> usize {
        self.replay.bytes() + self.dependency.bytes()
    }
}

impl<D: Dependency> MultiTessellation<3> for Hierarchy<D>
where
    D: Send,
{
    type Mesh = VertexMesh;
    type Bound = Bound;
    const RULE: Rule = D::RULE;

    fn len(&self) -> u32 {
        self.replay.len()
    }

    fn base(&self) -> VertexMesh {
        VertexMesh::of_base(&self.replay)
    }

    fn cells(&self, mesh: &VertexMesh, mut each: impl FnMut(CellId, Cell<3>)) {
        mesh.faces.cells().for_each(|(slot, corners)| each(CellId(slot), *corners));
    }

    fn cell_count(&self, mesh: &VertexMesh) -> u32 {
        mesh.faces.cell_count() as u32
    }

    fn positions(&self) -> &[Vec3] {
        self.replay.positions()
    }

    fn roots(&self, out: &mut Vec<NodeId>) {
        out.extend_from_slice(self.replay.roots());
    }

    fn children(&self, m: NodeId, out: &mut Vec<NodeId>) {
        out.extend(self.replay.children(m));
    }

    fn bound(&self, m: NodeId) -> Bound {
        self.replay.bound(m)
    }

    fn gain(&self, m: NodeId) -> Option<i32> {
        Some(self.replay.born(m).len() as i32)
    }

    fn needs(&self, m: NodeId, out: &mut Vec<NodeId>) {
        out.extend(self.replay.parent(m));
        self.dependency.needs(&self.replay, m, out);
    }

    fn prerequisites(&self, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) {
        let unmet = self.replay.parent(m).filter(|&parent| !view.front.is_refined(parent));
        out.extend(unmet);
        if unmet.is_none() || D::RULE == Rule::Static {
            self.dependency.prerequisites(&self.replay, m, view, out);
        }
    }

    fn obstacles(&self, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) -> Coarsen {
        let before = out.len();
        out.extend(self.replay.children(m).filter(|&child| view.front.is_refined(child)));
        if out.len() > before && D::RULE == Rule::Dynamic {
            return Coarsen::After;
        }
        match self.dependency.obstacles(&self.replay, m, view, out) {
            Coarsen::Now if out.len() > before => Coarsen::After,
            answer => answer,
        }
    }

    fn run(&self, m: NodeId) -> RangeInclusive<NodeId> {
        self.replay.run_of(self.replay.merge_of(m))
    }

    fn refine(&self, m: NodeId, mesh: &mut VertexMesh, sink: &mut impl Sink<3>) {
        self.replay.refine(m, mesh, sink);
    }

    fn coarsen(&self, m: NodeId, mesh: &mut VertexMesh, sink: &mut impl Sink<3>) {
        self.replay.coarsen(m, mesh, sink);
    }
}
