//! The needs of each static scheme, by one sweep: the sequence is replayed on the input, and at each node the mesh
//! around it is what it was at analysis. Those of dual-piece follow from the forest alone, node by node.

use super::lowest::Lowest;
use mt_core::hierarchy::HierarchyError;
use mt_core::{CellId, NodeId, Replay};
use rayon::prelude::*;

type Entries = Vec<(NodeId, NodeId)>;

/// Every vertex around the merged one is there or refined, across links as well.
pub(super) fn one_ring(replay: &Replay) -> Entries {
    let mut entries = Vec::new();
    let mut ring = Vec::new();
    replay.sweep(|m, view| {
        let ends = replay.ends(m);
        ring.clear();
        ring.extend(ends.into_iter().flat_map(|end| view.mesh.ring(end)).filter(|w| !ends.contains(w)));
        ring.sort_unstable();
        ring.dedup();
        let made = ring.iter().map(|&w| replay.next(w, &view.front));
        entries.extend(made.filter(|node| !node.is_none()).map(|node| (m, node)));
    });
    entries
}

/// A node needs those that replaced a cell it had made. A merge that keeps its centre changes the child's cells alone.
pub(super) fn explicit(replay: &Replay) -> Entries {
    let mut entries = Vec::new();
    let mut maker = vec![NodeId::NONE; replay.cells().len()];
    replay.sweep(|m, view| {
        let ends = replay.ends(m);
        let changed = if replay.keeps_center(replay.merge_of(m)) { &ends[1..] } else { &ends[..] };
        for (slot, _) in changed.iter().flat_map(|&end| view.mesh.faces.star(end)) {
            let made = std::mem::replace(&mut maker[slot as usize], m);
            if !made.is_none() && made != m {
                entries.push((made, m));
            }
        }
    });
    entries
}

/// The vertices opposite the edge are there or refined.
pub(super) fn cut_pair(replay: &Replay) -> Entries {
    let mut entries = Vec::new();
    replay.sweep(|m, view| {
        let ends = replay.ends(m);
        for cell in replay.born(m) {
            let opposite = view.mesh.faces.cell(cell.0).iter().find(|w| !ends.contains(w));
            let made = opposite.map(|&w| replay.next(w, &view.front)).filter(|node| !node.is_none());
            entries.extend(made.map(|node| (m, node)));
        }
    });
    entries
}

/// The triangles beside those that die, across the edges that do not, are there.
pub(super) fn four_face(replay: &Replay) -> Entries {
    let mut death = vec![NodeId::NONE; replay.cells().len()];
    for m in (0..replay.len()).map(NodeId) {
        replay.born(m).iter().for_each(|cell| death[cell.index()] = m);
    }
    let mut entries = Vec::new();
    replay.sweep(|m, view| {
        let ends = replay.ends(m);
        let faces = &view.mesh.faces;
        for cell in replay.born(m) {
            let Some(&apex) = faces.cell(cell.0).iter().find(|w| !ends.contains(w)) else { continue };
            for end in ends {
                let beside = faces.star(end).find(|&(slot, _)| slot != cell.0 && faces.cell(slot).contains(&apex));
                let node = beside.map(|(slot, _)| death[slot as usize]).filter(|node| !node.is_none());
                entries.extend(node.map(|node| (m, node)));
            }
        }
    });
    entries
}

/// The lowest common ancestor of the fundamental cut vertices: the third corners, in the input, of the two triangles
/// that die. At a boundary there is one, which cannot coincide with another.
pub(super) fn dual_piece(replay: &Replay) -> Entries {
    let lowest = Lowest::new(replay);
    let need = |m: u32| {
        let m = NodeId(m);
        let &[first, second] = replay.born(m) else { return None };
        let own = replay.span_at(m);
        // The third corner is the one that is not under the node. Chosen without a jump: processors guess half of them wrong.
        let third = |cell: CellId| {
            let [a, b, c] = replay.cells()[cell.index()].map(|leaf| replay.rank(leaf));
            let rest = if own.contains(b) { c } else { b };
            if own.contains(a) { rest } else { a }
        };
        let (left, right) = (third(first), third(second));
        // Nearly always the forest implies it, and then it need not be carried further: what is above leaves on either side of
        // the node is above the node.
        if (left < own.first) != (right < own.first) {
            return None;
        }
        lowest.of(left, right).filter(|&node| !replay.is_ancestor(node, m)).map(|node| (m, node))
    };
    (0..replay.len()).into_par_iter().filter_map(need).collect()
}

/// Schemes that cut a vertex along two edges take manifolds that stay manifolds alone.
pub(super) fn require_manifold(replay: &Replay, scheme: &'static str) -> Result<(), HierarchyError> {
    let sewn = replay.sewn();
    let why = if !replay.links().is_empty() {
        "it merges pairs, which need not share a triangle"
    } else if !sewn.is_empty() {
        "it has merges that sew sheets together or pinch them"
    } else if !replay.is_manifold() {
        "the input is not a manifold"
    } else {
        return Ok(());
    };
    let first: Vec<String> = sewn.iter().take(5).map(NodeId::to_string).collect();
    let places = match sewn.len() {
        0 => String::new(),
        count => format!("; {count} nodes sew or pinch, the first: {}", first.join(", ")),
    };
    Err(HierarchyError::Unfit { scheme, why: format!("{why}{places}") })
}

/// The least and the largest id around each merged vertex at analysis.
pub(super) fn one_ring_ids(replay: &Replay) -> Vec<[u32; 2]> {
    let mut ranges = Vec::with_capacity(replay.len() as usize);
    replay.sweep(|m, view| {
        let ends = replay.ends(m);
        let ring = ends.into_iter().flat_map(|end| view.mesh.ring(end)).filter(|w| !ends.contains(w));
        let ids = ring.map(|w| super::implicit::id_of(replay, w, view));
        ranges.push(ids.fold([u32::MAX, 0], |[least, most], id| [least.min(id), most.max(id)]));
    });
    ranges
}
