//! Numbering for speed: vertices of the input along the forest, triangles by the front at which they appear and along the
//! forest within it.
//!
//! What is near in space is then near in memory, and what a coarse front touches lies together however large the model is:
//! the triangles of a front of `n` nodes are among the first few `n`. A leaf's rank is its number, so ranks need not be
//! stored. It is the same model of the same mesh by other names.

use super::build::ranks_or_none;
use super::part::Story;
use super::replay::{Born, Replay};
use crate::cell::Cell;
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::Mesh;

/// New numbers for the vertices and triangles of an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Numbering {
    /// The new number of each vertex.
    vertices: Vec<u32>,
    /// The old numbers of the vertices in their new order.
    vertices_were: Vec<u32>,
    /// The new number of each triangle.
    cells: Vec<u32>,
    /// The old numbers of the triangles in their new order.
    cells_were: Vec<u32>,
}

impl Numbering {
    /// The new name of a vertex; merged ones keep theirs.
    fn vertex(&self, v: VertexId) -> VertexId {
        self.vertices.get(v.index()).map_or(v, |&number| VertexId(number))
    }

    fn cell(&self, cell: CellId) -> CellId {
        self.cells.get(cell.index()).map_or(cell, |&number| CellId(number))
    }

    fn corners<const N: usize>(&self, corners: &Cell<N>) -> Cell<N> {
        corners.map(|v| self.vertex(v))
    }

    /// The triangles in their new order, by the new names of their corners.
    fn mesh_cells(&self, cells: &[Cell<3>]) -> Vec<Cell<3>> {
        self.cells_were.iter().map(|&old| self.corners(&cells[old as usize])).collect()
    }

    fn in_order<T: Copy>(&self, of_vertices: &[T]) -> Vec<T> {
        self.vertices_were.iter().map(|&old| of_vertices[old as usize]).collect()
    }
}

/// Where each of these numbers is.
fn inverse(order: &[u32]) -> Vec<u32> {
    let mut places = vec![0; order.len()];
    order.iter().enumerate().for_each(|(place, &number)| places[number as usize] = place as u32);
    places
}

impl Replay {
    /// The numbering by which steps find what they need close together. O(triangles log triangles).
    pub fn numbering(&self) -> Numbering {
        let vertices: Vec<u32> = (0..self.leaf_count()).map(|v| self.rank(VertexId(v))).collect();
        let mut octave = vec![0u8; self.cells.len()];
        for m in 0..self.len() {
            let from_top = self.len() - m;
            self.born(NodeId(m)).iter().for_each(|cell| octave[cell.index()] = 1 + from_top.ilog2() as u8);
        }
        let place = |cell: &u32| {
            let ranks = self.cells[*cell as usize].map(|v| vertices[v.index()]);
            (octave[*cell as usize], ranks.into_iter().min().expect("three corners"), *cell)
        };
        let mut cells_were: Vec<u32> = (0..self.cells.len() as u32).collect();
        cells_were.sort_unstable_by_key(place);
        Numbering { vertices_were: inverse(&vertices), vertices, cells: inverse(&cells_were), cells_were }
    }

    /// The same replay of the renumbered input. O(model).
    pub fn renumbered(mut self, numbering: &Numbering) -> Self {
        let leaves = self.leaf_count() as usize;
        self.cells = numbering.mesh_cells(&self.cells);
        self.links.iter_mut().for_each(|link| *link = numbering.corners(link));
        let ordered = numbering.in_order(&self.positions[..leaves]);
        self.positions[..leaves].copy_from_slice(&ordered);
        let merged = numbering.in_order(&self.merged_at[..leaves]);
        self.merged_at[..leaves].copy_from_slice(&merged);
        let ranks: Vec<u32> = (0..self.leaf_count()).map(|v| self.rank(VertexId(v))).collect();
        self.ranks = ranks_or_none(numbering.in_order(&ranks));
        self.merges.iter_mut().for_each(|merge| merge.center = numbering.vertex(merge.center));
        self.nodes.iter_mut().for_each(|node| node.child = numbering.vertex(node.child));
        match &mut self.born {
            Born::Pairs(pairs) => pairs.iter_mut().for_each(|pair| {
                *pair = pair.map(|cell| numbering.cell(cell));
                pair.sort_unstable();
            }),
            Born::Rows(starts, cells) => {
                cells.iter_mut().for_each(|cell| *cell = numbering.cell(*cell));
                starts.windows(2).for_each(|row| cells[row[0] as usize..row[1] as usize].sort_unstable());
            }
        }
        let base = self.base_cells.iter().map(|(cell, corners)| (numbering.cell(*cell), numbering.corners(corners)));
        self.base_cells = base.collect();
        self.base_cells.sort_unstable();
        self.base_links.iter_mut().for_each(|(_, ends)| *ends = numbering.corners(ends));
        self
    }
}

impl Story {
    /// The same story of the renumbered input. O(story).
    pub fn renumbered(&self, numbering: &Numbering) -> Self {
        let mesh =
            Mesh { positions: numbering.in_order(&self.mesh.positions), cells: numbering.mesh_cells(&self.mesh.cells) };
        let mut sequence = self.sequence.clone();
        sequence.centers.iter_mut().chain(&mut sequence.children).for_each(|v| *v = numbering.vertex(*v));
        Self { mesh, links: self.links.iter().map(|link| numbering.corners(link)).collect(), sequence }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hierarchy::Sequence;
    use crate::{check, front::Front, generate};

    /// A torus of which the first vertices of some triangles have been merged, in no order in space.
    fn story() -> Story {
        let mesh = generate::torus(12, 8);
        let mut sequence = Sequence::new(&mesh);
        let mut taken = vec![false; mesh.vertex_count()];
        for cell in mesh.cells.iter().rev().step_by(7) {
            let [a, b, _] = *cell;
            if !taken[a.index()] && !taken[b.index()] {
                (taken[a.index()], taken[b.index()]) = (true, true);
                sequence.push(a, [b], [0.1], mesh.positions[a.index()], true);
            }
        }
        Story { mesh, links: vec![[VertexId(3), VertexId(40)]], sequence }
    }

    #[test]
    fn a_renumbered_replay_is_that_of_the_renumbered_story() {
        let story = story();
        let replay = story.replay().unwrap();
        let numbering = replay.numbering();
        let again = story.renumbered(&numbering).replay().unwrap();
        let renumbered = replay.clone().renumbered(&numbering);
        assert!(again == renumbered);
        assert!(again.ranks.is_empty() && !replay.ranks.is_empty());
        assert_eq!(again.bytes() + 4 * replay.ranks.len(), replay.bytes());
        // Ordered once, it is in order.
        assert_eq!(again.numbering().vertices, (0..again.leaf_count()).collect::<Vec<_>>());
        assert_eq!(again.numbering().cells, (0..again.cells().len() as u32).collect::<Vec<_>>());
        for front in [Front::base(replay.len()), Front::reference(replay.len())] {
            let mut old: Vec<_> = check::quotient(&replay, &front)
                .into_iter()
                .map(|(cell, corners)| (numbering.cell(cell), numbering.corners(&corners)))
                .collect();
            old.sort_unstable();
            assert_eq!(old, check::quotient(&renumbered, &front));
        }
    }

    #[test]
    fn what_appears_first_comes_first() {
        let replay = story().replay().unwrap();
        let replay = replay.clone().renumbered(&replay.numbering());
        let base: Vec<u32> = replay.base_cells.iter().map(|(cell, _)| cell.0).collect();
        assert_eq!(base, (0..base.len() as u32).collect::<Vec<_>>());
        let last = replay.born(NodeId(replay.len() - 1)).iter().map(|cell| cell.index()).max().unwrap();
        assert!(last < base.len() + 2, "{last} {}", base.len());
    }
}
