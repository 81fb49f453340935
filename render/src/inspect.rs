//! What a triangle of a view has to do with the nodes of the model, for pictures that tell it and for whoever points at one.

use mt_core::check::{Domain, active_ancestors, boundary_chain};
use mt_core::hierarchy::Dependency;
use mt_core::{Bound, CellId, Explicit, Facet, Front, Hierarchy, Mesh, MultiTessellation, NodeId, VertexId};
use std::collections::HashSet;
use std::sync::OnceLock;

/// What a fan has come to at a vertex, where merges are made in runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fan {
    /// The vertex comes of no run of several merges.
    None,
    /// All merges of its run are made.
    Whole,
    /// Some of them: the fan is partial.
    Partial,
}

/// A model of triangles that can be asked how its cells hang together with its nodes.
pub trait Inspect: MultiTessellation<3, Bound = Bound> {
    /// What the answers need besides the model.
    type Own: Send;

    /// Makes it. O(model).
    fn own_index(&self) -> Self::Own;
    /// Cells are numbered below this.
    fn cell_capacity(&self) -> u32;
    /// The input.
    fn input(&self) -> Mesh<3>;
    /// The coarse node that refines a cell of the current mesh, at one of its corners; `None` where nothing is finer.
    fn refined_by(&self, cell: CellId, corner: VertexId, front: &Front) -> Option<NodeId>;
    /// The refined node that a cell came with, at one of its corners; `None` of what is in the base mesh.
    fn came_with(&self, own: &Self::Own, cell: CellId, corner: VertexId, front: &Front) -> Option<NodeId>;
    /// What the fan at a corner has come to.
    fn fan(&self, _corner: VertexId, _front: &Front) -> Fan {
        Fan::None
    }
    /// What stands above each vertex of the input, where vertices are merged: the pieces of the input.
    fn pieces(&self, _front: &Front) -> Option<Vec<VertexId>> {
        None
    }
    /// The boundary that the mesh of a front must have, as pairs of vertices in ascending order; what is open elsewhere is a
    /// crack. O(input) or more. Where the model does not conform there is nothing to say.
    fn boundary_at(&self, own: &Self::Own, front: &Front) -> Option<HashSet<[VertexId; 2]>>;
}

/// What is looked up of a model again and again, beside it.
pub struct Index<M: Inspect> {
    pub(crate) own: M::Own,
    levels: OnceLock<Vec<u32>>,
}

impl<M: Inspect> Index<M> {
    /// Of a model. O(model).
    pub fn of(model: &M) -> Self {
        Self { own: model.own_index(), levels: OnceLock::new() }
    }

    /// The refined node that a cell came with, at one of its corners; `None` of what is in the base mesh.
    pub fn came_with(&self, model: &M, cell: CellId, corner: VertexId, front: &Front) -> Option<NodeId> {
        model.came_with(&self.own, cell, corner, front)
    }

    /// [`Inspect::boundary_at`].
    pub fn boundary_at(&self, model: &M, front: &Front) -> Option<HashSet<[VertexId; 2]>> {
        model.boundary_at(&self.own, front)
    }

    /// Of each node the number of nodes on the longest chain of needs from it up, itself included. Found when it is first
    /// asked for, in O(nodes + arcs).
    pub fn levels(&self, model: &M) -> &[u32] {
        self.levels.get_or_init(|| {
            let mut levels = vec![0u32; model.len() as usize];
            let mut needs = Vec::new();
            // What a node needs has a larger id.
            for m in (0..model.len()).rev().map(NodeId) {
                needs.clear();
                model.needs(m, &mut needs);
                levels[m.index()] = 1 + needs.iter().map(|need| levels[need.index()]).max().unwrap_or(0);
            }
            levels
        })
    }
}

/// Where the cells of an explicit model come from, and its boundary.
pub struct ExplicitIndex {
    /// Of each cell the node on whose fine side it is.
    came_with: Vec<NodeId>,
    /// Found when it is first asked for: that looks at every modification.
    domain: OnceLock<Option<Domain<3>>>,
}

impl Inspect for Explicit<3> {
    type Own = ExplicitIndex;

    fn own_index(&self) -> ExplicitIndex {
        let mut came_with = vec![NodeId::NONE; self.total_cell_count() as usize];
        for m in (0..self.len()).map(NodeId) {
            self.fine_side(m).iter().for_each(|cell| came_with[cell.index()] = m);
        }
        ExplicitIndex { came_with, domain: OnceLock::new() }
    }

    fn cell_capacity(&self) -> u32 {
        self.total_cell_count()
    }

    fn input(&self) -> Mesh<3> {
        self.reference()
    }

    fn refined_by(&self, cell: CellId, _: VertexId, _: &Front) -> Option<NodeId> {
        self.refined_by(cell)
    }

    fn came_with(&self, own: &ExplicitIndex, cell: CellId, _: VertexId, _: &Front) -> Option<NodeId> {
        Some(own.came_with[cell.index()]).filter(|m| !m.is_none())
    }

    fn boundary_at(&self, own: &ExplicitIndex, front: &Front) -> Option<HashSet<[VertexId; 2]>> {
        let domain = own.domain.get_or_init(|| mt_core::check::conformity(self).ok()).as_ref()?;
        Some(domain.boundary_at(front).iter().map(ends_of).collect())
    }
}

impl<D: Dependency + Send> Inspect for Hierarchy<D> {
    type Own = ();

    fn own_index(&self) {}

    fn cell_capacity(&self) -> u32 {
        self.replay.cells().len() as u32
    }

    fn input(&self) -> Mesh<3> {
        self.replay.reference()
    }

    fn refined_by(&self, _: CellId, corner: VertexId, front: &Front) -> Option<NodeId> {
        self.replay.latest(corner, front)
    }

    fn came_with(&self, (): &(), _: CellId, corner: VertexId, front: &Front) -> Option<NodeId> {
        Some(self.replay.next(corner, front)).filter(|m| !m.is_none())
    }

    fn fan(&self, corner: VertexId, front: &Front) -> Fan {
        let Some(merge) = self.replay.merge_making(corner) else { return Fan::None };
        let run = self.replay.run_of(merge);
        match self.replay.latest(corner, front) {
            _ if run.start() == run.end() => Fan::None,
            Some(latest) if latest == *run.end() => Fan::Whole,
            _ => Fan::Partial,
        }
    }

    fn pieces(&self, front: &Front) -> Option<Vec<VertexId>> {
        Some(active_ancestors(&self.replay, front))
    }

    fn boundary_at(&self, (): &(), front: &Front) -> Option<HashSet<[VertexId; 2]>> {
        Some(boundary_chain(&self.replay, front).iter().map(ends_of).collect())
    }
}

/// The two vertices, ascending.
fn ends_of(facet: &Facet<3>) -> [VertexId; 2] {
    [facet.vertices()[0], facet.vertices()[1]]
}
