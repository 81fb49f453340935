//! The rules of `[KimLee2001]` as the paper has them: free of any order, and of its laws.

use super::derive::require_manifold;
use mt_core::hierarchy::{Dependency, HierarchyError, VertexMesh};
use mt_core::{CellId, Coarsen, NodeId, Replay, Rule, VertexId, View};

/// A split waits only while its two cut vertices are one, which is then split first, and so on; a merge is put off while
/// its ends have a common neighbour besides the cut vertices (section 4.4).
///
/// This reaches more meshes than the static order, and gives up that fronts are confluent and answers least. Nothing is
/// stored: the fundamental cut vertices are the third corners, in the input, of the triangles that a split makes.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct DualPieceFree(());

impl DualPieceFree {
    /// The rules on a sequence of edge collapses of a manifold; others are refused.
    pub fn new(replay: &Replay) -> Result<Self, HierarchyError> {
        require_manifold(replay, "dual-piece-free").map(|()| Self(()))
    }
}

/// Which vertex around `near` stands for the corner of `cell` that is not under the vertex of `m`.
fn cut_vertex(replay: &Replay, m: NodeId, view: &View<VertexMesh>, cell: CellId) -> Option<VertexId> {
    let own = replay.span_at(m);
    let leaf = *replay.cells()[cell.index()].iter().find(|&&leaf| !own.contains(replay.rank(leaf)))?;
    Some(view.mesh.above_near(replay, leaf, &[replay.vertex(m)]))
}

impl Dependency for DualPieceFree {
    const RULE: Rule = Rule::Dynamic;

    fn needs(&self, _: &Replay, _: NodeId, _: &mut Vec<NodeId>) {}

    fn prerequisites(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) {
        if let [left, right] = *replay.born(m) {
            let cuts = [left, right].map(|cell| cut_vertex(replay, m, view, cell));
            if cuts[0] == cuts[1] {
                out.extend(cuts[0].and_then(|v| replay.latest(v, &view.front)));
            }
        }
    }

    fn obstacles(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, _: &mut Vec<NodeId>) -> Coarsen {
        let [center, child] = replay.ends(m);
        let cells = || replay.born(m).iter().map(|cell| view.mesh.faces.cell(cell.0));
        let is_cut = |w: VertexId| cells().any(|corners| corners.contains(&w));
        let mut extra = view.mesh.ring(child).filter(|&w| !is_cut(w));
        if extra.any(|w| view.mesh.ring(center).any(|x| x == w)) { Coarsen::Not } else { Coarsen::Now }
    }

    fn bytes(&self) -> usize {
        0
    }
}
