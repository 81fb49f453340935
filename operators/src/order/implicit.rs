//! The implicit rules of `[ElSanaVarshney1999]`: legality is read off the ids of the current neighbours.
//!
//! Deviation from `[DeFlorianiTutorial2002]`: its slide lets a pair merge when the parent's id is below the ids of the
//! neighbours. Ids grow with the merges, so that forbids every merge in the state in which all were made. What is meant
//! are the neighbours' parents: a merge is legal when every neighbour will be merged later than this pair.

use super::derive::one_ring_ids;
use mt_core::hierarchy::{Dependency, HierarchyError, VertexMesh};
use mt_core::{Coarsen, NodeId, Replay, Rule, VertexId, View};

/// Nothing is stored: a split is legal when its id is above those of all neighbours, a merge when the parent's id is below
/// those of all the neighbours' parents. Neighbours are those across triangles and across links.
///
/// A vertex of a fan that is merged in part counts by what it is now, not by its whole fan.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct ImplicitIds;

impl Dependency for ImplicitIds {
    const RULE: Rule = Rule::Dynamic;

    fn needs(&self, _: &Replay, _: NodeId, _: &mut Vec<NodeId>) {}

    #[inline]
    fn prerequisites(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) {
        let ring = view.mesh.ring(replay.vertex(m));
        out.extend(ring.filter_map(|w| replay.latest(w, &view.front)).filter(|&node| node > m));
    }

    #[inline]
    fn obstacles(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) -> Coarsen {
        let before = out.len();
        let ends = replay.ends(m);
        let ring = ends.into_iter().flat_map(|end| view.mesh.ring(end)).filter(|w| !ends.contains(w));
        out.extend(ring.map(|w| replay.next(w, &view.front)).filter(|&node| node < m));
        if out.len() == before { Coarsen::Now } else { Coarsen::After }
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// The other reading, that of `[KimLee2001]`: each node stores the least and the largest id among its neighbours at
/// analysis, and is split or merged while its current neighbours' ids are within.
///
/// For merges this is weaker than [`ImplicitIds`]: a neighbour may have been refined and its id still be in the range.
/// So a neighbour may also be merged before its time; what is around it then waits until it is split again, or what
/// merges could not be split. **It is unsound**: within a thousand random fronts of a sharp model an edge gets four
/// triangles (`mtess verify fandisk.obj --dependency implicit-ids-stored --fronts 1000`), so the ids of current neighbours
/// are what the scheme is meant to be. Fans are refused: merged in part they have ids that no neighbour had at analysis, and
/// meshes break on small models already. 8 bytes a node.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredIds {
    ranges: Vec<[u32; 2]>,
}

impl StoredIds {
    /// The ranges of the ids around each merged vertex. O(stars of all merges).
    pub fn new(replay: &Replay) -> Result<Self, HierarchyError> {
        if !replay.is_single() {
            let why = "it has fans, which merged in part have ids that nothing had at analysis".to_owned();
            return Err(HierarchyError::Unfit { scheme: "implicit-ids-stored", why });
        }
        Ok(Self { ranges: one_ring_ids(replay) })
    }
}

/// The id of a vertex in the sequence: input vertices first, then nodes.
#[inline]
pub(super) fn id_of(replay: &Replay, v: VertexId, view: &View<VertexMesh>) -> u32 {
    replay.latest(v, &view.front).map_or(v.0, |node| replay.leaf_count() + node.0)
}

impl Dependency for StoredIds {
    const RULE: Rule = Rule::Dynamic;

    fn needs(&self, _: &Replay, _: NodeId, _: &mut Vec<NodeId>) {}

    fn prerequisites(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) {
        let [_, most] = self.ranges[m.index()];
        let larger = view.mesh.ring(replay.vertex(m)).filter(|&w| id_of(replay, w, view) > most);
        // A larger id than any input vertex has is a node's, and a later one than this node's.
        out.extend(larger.filter_map(|w| replay.latest(w, &view.front)).filter(|&node| node > m));
    }

    fn obstacles(&self, replay: &Replay, m: NodeId, view: &View<VertexMesh>, out: &mut Vec<NodeId>) -> Coarsen {
        let before = out.len();
        let [least, most] = self.ranges[m.index()];
        let ends = replay.ends(m);
        let ring = || ends.into_iter().flat_map(|end| view.mesh.ring(end)).filter(|w| !ends.contains(w));
        out.extend(ring().filter(|&w| id_of(replay, w, view) < least).map(|w| replay.next(w, &view.front)));
        let late = out[before..].iter().any(|&node| node >= m);
        if ring().any(|w| id_of(replay, w, view) > most) {
            out.truncate(before);
            return Coarsen::Not;
        }
        match (out.len() == before, late) {
            (true, _) => Coarsen::Now,
            (false, false) => Coarsen::After,
            (false, true) => {
                out.truncate(before);
                Coarsen::Not
            }
        }
    }

    fn bytes(&self) -> usize {
        8 * self.ranges.len()
    }
}
