//! What is left of a region, without what is gone.

use super::partition::Remnant;
use crate::analysis::Draft;
use crate::bits::Bits;
use crate::cell::Cell;
use crate::id::{CellId, VertexId};
use glam::Vec3;

/// The live vertices and cells of a region's draft, numbered anew.
pub(super) struct Residue<const N: usize, M> {
    /// The draft's numbers of the vertices that are left.
    vertices: Vec<VertexId>,
    positions: Vec<Vec3>,
    memories: Vec<M>,
    /// With corners as places in `vertices`.
    pub(super) cells: Vec<Cell<N>>,
    /// The draft's names of these.
    names: Vec<CellId>,
}

impl<const N: usize, M: Copy + Send + Sync> Residue<N, M> {
    /// What is left of a draft: vertices with a cell, and those that are frozen, whose cells may be elsewhere.
    pub(super) fn of(draft: &Draft<N>, recall: impl Fn(VertexId) -> M, frozen: &Bits) -> Self {
        let is_frozen = |v: VertexId| v.0 < frozen.capacity() && frozen.contains(v.0);
        let is_left = |v: &VertexId| draft.complex.has_star(*v) || is_frozen(*v);
        let vertices: Vec<VertexId> = (0..draft.positions.len()).map(VertexId::new).filter(is_left).collect();
        let mut number = vec![VertexId::NONE; draft.positions.len()];
        vertices.iter().enumerate().for_each(|(i, v)| number[v.index()] = VertexId::new(i));
        let count = draft.complex.cell_count();
        let (mut cells, mut names) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (slot, cell) in draft.complex.cells() {
            cells.push(cell.map(|v| number[v.index()]));
            names.push(draft.complex.name(slot));
        }
        Self {
            positions: vertices.iter().map(|v| draft.positions[v.index()]).collect(),
            memories: vertices.iter().map(|&v| recall(v)).collect(),
            vertices,
            cells,
            names,
        }
    }

    /// Moves in with what is left of other regions, under the listener's names. `number` gets the new numbers of the
    /// region's vertices of old.
    pub(super) fn settle(
        self,
        (vertex_names, cell_names): &(Vec<VertexId>, Vec<CellId>),
        left: &mut Remnant<N, M>,
        number: &mut [VertexId],
    ) {
        let before = left.positions.len();
        for (i, v) in self.vertices.iter().enumerate() {
            if let Some(place) = number.get_mut(v.index()) {
                *place = VertexId::new(before + i);
            }
        }
        left.names.extend(self.vertices.iter().map(|v| vertex_names[v.index()]));
        left.positions.extend(self.positions);
        left.memories.extend(self.memories);
        left.cells.extend(self.cells.iter().map(|cell| cell.map(|v| VertexId::new(before + v.index()))));
        left.cell_names.extend(self.names.iter().map(|name| cell_names[name.index()]));
    }
}
