//! A sequence of merges of vertices, as analysis tells it: all that a vertex hierarchy is made of.

use crate::analysis::{Draft, Listener, RegionListener};
use crate::bits::Bits;
use crate::complex::Slot;
use crate::explicit::HistoryError;
use crate::id::{CellId, VertexId};
use crate::mesh::Mesh;
use crate::plan::Plan;
use glam::Vec3;

/// Merges of vertices in the order in which they were made. A [`Listener`] of any analysis whose plans merge vertices.
///
/// Merge `f` takes its centre and then its children, one after the other, into vertex `input vertices + f`. An edge
/// collapse has one child, a fan as many as the link of its centre. Each child is one node of the hierarchy; so the
/// nodes of a merge are a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sequence {
    /// Number of vertices of the input.
    pub input_vertex_count: u32,
    /// Of each merge: the vertex that the children join.
    pub centers: Vec<VertexId>,
    /// Of each merge: where the merged vertex is.
    pub positions: Vec<Vec3>,
    /// Of each merge: its first node; one more entry than merges.
    pub starts: Vec<u32>,
    /// Of each node: the vertex that joins.
    pub children: Vec<VertexId>,
    /// Of each node: the error afterwards, in model units.
    pub errors: Vec<f32>,
    /// The merges that leave the centre where it is and its own cells alone (half-edge collapses and fans).
    pub kept: Bits,
    /// The current names of the draft's vertices, while an analysis is being heard; empty before.
    names: Vec<VertexId>,
}

impl Sequence {
    /// No merges of this mesh yet.
    pub fn new(mesh: &Mesh<3>) -> Self {
        Self::with_input(mesh.vertex_count() as u32)
    }

    /// No merges yet of a mesh of so many vertices.
    pub fn with_input(input_vertex_count: u32) -> Self {
        Self { input_vertex_count, starts: vec![0], ..Self::default() }
    }

    /// Number of merges.
    pub fn merge_count(&self) -> u32 {
        self.centers.len() as u32
    }

    /// Number of nodes: of vertices that were merged into others.
    pub fn node_count(&self) -> u32 {
        self.children.len() as u32
    }

    /// Appends a merge; gives the merged vertex.
    ///
    /// Requires: as many errors as children, at least one, and none of the vertices merged before (which
    /// [`super::Replay::new`] checks).
    pub fn push(
        &mut self,
        center: VertexId,
        children: impl IntoIterator<Item = VertexId>,
        errors: impl IntoIterator<Item = f32>,
        position: Vec3,
        kept: bool,
    ) -> VertexId {
        let merge = self.merge_count();
        self.centers.push(center);
        self.positions.push(position);
        self.children.extend(children);
        self.errors.extend(errors);
        self.starts.push(self.node_count());
        if kept {
            self.mark_kept(merge);
        }
        VertexId(self.input_vertex_count + merge)
    }

    fn mark_kept(&mut self, merge: u32) {
        if merge >= self.kept.capacity() {
            let mut grown = Bits::new((merge + 1).max(self.kept.capacity().saturating_mul(2)));
            self.kept.iter().for_each(|f| _ = grown.insert(f));
            self.kept = grown;
        }
        self.kept.insert(merge);
    }
}

impl Listener<3> for Sequence {
    fn applying(&mut self, draft: &Draft<3>, plan: &Plan<3>) -> Result<(), HistoryError> {
        if self.names.is_empty() {
            self.names.extend((0..self.input_vertex_count).map(VertexId));
        }
        let (center, others, position) = match (plan.kept, plan.vertices.as_slice(), plan.retired.as_slice()) {
            (Some(kept), [], others @ [_, ..]) => (kept, others, draft.positions[kept.index()]),
            (None, &[position], [first, others @ ..]) if !others.is_empty() => (*first, others, position),
            _ => return Err(HistoryError::NotMerge),
        };
        let errors: &[f32] = if plan.errors.len() == others.len() { &plan.errors } else { &[] };
        if errors.iter().chain([&plan.error]).any(|error| !(error.is_finite() && *error >= 0.0)) {
            return Err(HistoryError::NotFinite("an error"));
        }
        let errors = (0..others.len()).map(|i| errors.get(i).copied().unwrap_or(plan.error));
        // Out of the way of `push`, which needs none of them.
        let names = std::mem::take(&mut self.names);
        let children = others.iter().map(|v| names[v.index()]);
        let merged = self.push(names[center.index()], children, errors, position, plan.kept.is_some());
        self.names = names;
        match plan.kept {
            Some(kept) => self.names[kept.index()] = merged,
            None => self.names.push(merged),
        }
        Ok(())
    }

    fn applied(&mut self, _: &mut Draft<3>, _: &Plan<3>, _: &[Slot]) -> Result<(), HistoryError> {
        Ok(())
    }
}

impl RegionListener<3> for Sequence {
    fn of_region(region: &Mesh<3>) -> Result<Self, HistoryError> {
        Ok(Self::new(region))
    }

    fn append(
        &mut self,
        part: Self,
        vertices: &[VertexId],
        cells: &[CellId],
    ) -> Result<(Vec<VertexId>, Vec<CellId>), HistoryError> {
        let (merges, nodes) = (self.merge_count(), self.node_count());
        if u64::from(self.input_vertex_count) + u64::from(merges) + u64::from(part.merge_count()) >= u64::from(u32::MAX)
        {
            return Err(HistoryError::TooLarge);
        }
        let made = self.input_vertex_count + merges;
        let name = |v: &VertexId| match vertices.get(v.index()) {
            Some(&known) => known,
            None => VertexId(made + (v.0 - part.input_vertex_count)),
        };
        self.centers.extend(part.centers.iter().map(name));
        self.children.extend(part.children.iter().map(name));
        self.positions.extend_from_slice(&part.positions);
        self.errors.extend_from_slice(&part.errors);
        self.starts.extend(part.starts[1..].iter().map(|start| nodes + start));
        part.kept
            .iter()
            .take_while(|&merge| merge < part.merge_count())
            .for_each(|merge| self.mark_kept(merges + merge));
        // Where nothing was merged nobody was named.
        let names = if part.names.is_empty() { vertices.to_vec() } else { part.names.iter().map(name).collect() };
        // Merges move the corners of cells; each stays what it was.
        Ok((names, cells.to_vec()))
    }
}
