//! A part of a replay: what lies between two of its fronts, on the triangles that matter. Counterexamples are made small
//! by it.

use super::build::InvalidSequence;
use super::replay::Replay;
use super::sequence::Sequence;
use crate::cell::{Cell, is_proper};
use crate::check::{active_ancestors, quotient};
use crate::front::Front;
use crate::id::{CellId, VertexId};
use crate::mesh::Mesh;

/// A mesh, the links by which its vertices are neighbours besides triangles, and a sequence of its merges: all that a
/// [`Replay`] is made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Story {
    /// The input.
    pub mesh: Mesh<3>,
    /// Its links.
    pub links: Vec<Cell<2>>,
    /// Merges of its vertices.
    pub sequence: Sequence,
}

impl Story {
    /// The replay of this story.
    pub fn replay(&self) -> Result<Replay, InvalidSequence> {
        Replay::new(&self.mesh, &self.links, &self.sequence)
    }
}

impl Replay {
    /// The story of what lies between two fronts: its input is the mesh of `high`, the merges are those of the nodes in
    /// `high` and not in `low`, in their order. Of the triangles of that mesh those are there that `keep` names, and
    /// vertices that neither triangles nor merges use are left out.
    ///
    /// Errors are the saturated ones. Requires: both fronts cuts of the forest, `low` within `high`. O(model).
    pub fn between(&self, low: &Front, high: &Front, keep: &dyn Fn(CellId) -> bool) -> Story {
        let merges = self.merges_between(low, high);
        let cells: Vec<Cell<3>> =
            quotient(self, high).into_iter().filter(|(cell, _)| keep(*cell)).map(|(_, corners)| corners).collect();
        let above = active_ancestors(self, high);
        let mut links: Vec<Cell<2>> = self
            .links()
            .iter()
            .map(|link| link.map(|leaf| above[leaf.index()]))
            .filter(is_proper)
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        links.sort_unstable();
        links.dedup();
        let mut used = vec![false; self.vertex_count() as usize];
        let named = merges.iter().flat_map(|merge| merge.joined.iter().chain([&merge.center]));
        cells.iter().flatten().chain(named).for_each(|v| used[v.index()] = true);
        links.retain(|link| link.iter().all(|v| used[v.index()]));
        // Vertices that merges make have their names from the merges.
        merges.iter().filter(|merge| !merge.goes_on).for_each(|merge| used[merge.made.index()] = false);
        let mut names = vec![VertexId::NONE; used.len()];
        let mut mesh = Mesh { positions: Vec::new(), cells: Vec::new() };
        for v in (0..used.len()).filter(|&v| used[v]) {
            names[v] = VertexId::new(mesh.positions.len());
            mesh.positions.push(self.positions()[v]);
        }
        mesh.cells = cells.iter().map(|cell| cell.map(|v| names[v.index()])).collect();
        let links = links.iter().map(|link| link.map(|v| names[v.index()])).collect();
        let mut sequence = Sequence::new(&mesh);
        for merge in merges {
            let joined: Vec<VertexId> = merge.joined.iter().map(|v| names[v.index()]).collect();
            let place = self.positions()[merge.made.index()];
            let kept = merge.goes_on || self.keeps_center(merge.number);
            let made = sequence.push(names[merge.center.index()], joined, merge.errors, place, kept);
            names[merge.made.index()] = made;
        }
        Story { mesh, links, sequence }
    }

    /// The merges between two fronts, as far as they are between them: of a fan, a stretch of its nodes.
    fn merges_between(&self, low: &Front, high: &Front) -> Vec<Stretch> {
        let mut merges: Vec<Stretch> = Vec::new();
        for m in high.difference(low) {
            let number = self.merge_of(m);
            let node = self.node(m);
            let error = self.bound(m).error;
            match merges.last_mut().filter(|stretch| stretch.number == number) {
                Some(stretch) => {
                    stretch.joined.push(node.child);
                    stretch.errors.push(error);
                }
                None => {
                    let goes_on = *self.run_of(number).start() != m;
                    let made = self.vertex(m);
                    let center = if goes_on { made } else { self.merge(number).center };
                    let (joined, errors) = (vec![node.child], vec![error]);
                    merges.push(Stretch { number, made, center, joined, errors, goes_on });
                }
            }
        }
        merges
    }
}

/// A stretch of the nodes of one merge.
struct Stretch {
    number: u32,
    made: VertexId,
    center: VertexId,
    joined: Vec<VertexId>,
    errors: Vec<f32>,
    /// Whether a part of the merge was done before the stretch: then its vertex is there, and is its own centre.
    goes_on: bool,
}
