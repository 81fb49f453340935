//! A part of an explicit model: what lies between two of its fronts, on the cells that matter. Counterexamples are made
//! small by it.

use super::{Explicit, HistoryError, Recorder};
use crate::bits::Bits;
use crate::cell::Cell;
use crate::front::Front;
use crate::id::{CellId, NodeId, VertexId};
use crate::mesh::Mesh;
use crate::model::{MultiTessellation, Step, take};

impl<const N: usize> Explicit<N> {
    /// The model of what lies between two closed fronts: its input is the mesh of `high`, its base that of `low`, its
    /// nodes are those in `high` and not in `low`, in their order. Of the cells that no such node kills only those are
    /// there that `keep` names, and vertices that nothing uses are left out.
    ///
    /// Nodes are discovered under the nodes that they are discovered under here, as far as these are there, and have the same
    /// bounds, or larger ones where that is not so. Requires: both fronts closed, `low` within `high`. O(model).
    pub fn between(
        &self,
        low: &Front,
        high: &Front,
        keep: &dyn Fn(CellId) -> bool,
    ) -> Result<Explicit<N>, HistoryError> {
        let mut view = self.base_view();
        let coarsest_first: Vec<NodeId> = high.finest_first().collect();
        for &m in coarsest_first.iter().rev() {
            take(self, Step::refine(m), &mut view, &mut ());
        }
        let nodes: Vec<NodeId> = high.difference(low).collect();
        let mut killed = Bits::new(self.total_cell_count());
        nodes.iter().flat_map(|&m| self.fine_side(m)).for_each(|cell| _ = killed.insert(cell.0));
        let input: Vec<CellId> =
            view.mesh.iter().map(CellId).filter(|&cell| killed.contains(cell.0) || keep(cell)).collect();
        let (mesh, mut names) = self.mesh_of_cells(&input);
        let mut recorder = Recorder::new(&mesh)?;
        for &m in &nodes {
            self.fine_side(m).iter().try_for_each(|cell| recorder.kill(names.cells[cell.index()]))?;
            for cell in self.coarse_side(m) {
                let corners = names.corners(self, cell, |position| recorder.vertex(position))?;
                names.cells[cell.index()] = recorder.make(corners)?;
            }
            recorder.end(self.bound(m).error)?;
        }
        let part = recorder.finish(self.error_kind())?;
        Ok(self.bounded(part, &nodes))
    }

    /// A part with the bounds that its nodes have here, discovered under the nodes that they are discovered under here. One
    /// whose parent is not in the part gets another, and the bounds above grow by what comes under them.
    fn bounded(&self, part: Explicit<N>, nodes: &[NodeId]) -> Explicit<N> {
        let named = |parent: NodeId| nodes.binary_search(&parent).ok().map(NodeId::new);
        let mut parts = part.parts;
        parts.bounds = nodes.iter().map(|&m| self.bound(m)).collect();
        let mut grown = vec![false; nodes.len()];
        for (i, &m) in nodes.iter().enumerate() {
            let kept = self.parent(m).and_then(named);
            let parent = kept.unwrap_or(parts.parents[i]);
            parts.parents[i] = parent;
            if !parent.is_none() && (kept.is_none() || grown[i]) {
                let bound = parts.bounds[i];
                parts.bounds[parent.index()].include(&bound);
                grown[parent.index()] = true;
            }
        }
        Explicit::from_parts(parts).expect("what was recorded, with other bounds")
    }

    /// These cells as a mesh, and what vertices and cells are called there. Ids keep their order.
    fn mesh_of_cells(&self, input: &[CellId]) -> (Mesh<N>, Names) {
        let mut used = Bits::new(self.positions().len() as u32);
        input.iter().flat_map(|cell| self.corners(*cell)).for_each(|v| _ = used.insert(v.0));
        let mut names = Names {
            vertices: vec![VertexId::NONE; self.positions().len()],
            cells: vec![CellId(u32::MAX); self.total_cell_count() as usize],
        };
        let mut mesh = Mesh { positions: Vec::new(), cells: Vec::with_capacity(input.len()) };
        for v in used.iter() {
            names.vertices[v as usize] = VertexId::new(mesh.positions.len());
            mesh.positions.push(self.positions()[v as usize]);
        }
        for (i, &cell) in input.iter().enumerate() {
            names.cells[cell.index()] = CellId::new(i);
            mesh.cells.push(self.corners(cell).map(|v| names.vertices[v.index()]));
        }
        (mesh, names)
    }
}

/// What vertices and cells of the whole are called in the part; none where they have no name yet.
struct Names {
    vertices: Vec<VertexId>,
    cells: Vec<CellId>,
}

impl Names {
    /// The corners of a cell, by their names; those that have none are given one.
    fn corners<const N: usize>(
        &mut self,
        model: &Explicit<N>,
        cell: CellId,
        mut name: impl FnMut(glam::Vec3) -> Result<VertexId, HistoryError>,
    ) -> Result<Cell<N>, HistoryError> {
        let corners = *model.corners(cell);
        for v in corners {
            if self.vertices[v.index()].is_none() {
                self.vertices[v.index()] = name(model.positions()[v.index()])?;
            }
        }
        Ok(corners.map(|v| self.vertices[v.index()]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check;
    use crate::check::Random;
    use crate::model::{cells_of, mesh_of};

    /// A closed model of fans round and round a strip: each node drops the ear of what is left.
    fn ears(count: usize) -> Explicit<3> {
        let mesh = crate::generate::strip(count);
        let mut recorder = Recorder::new(&mesh).unwrap();
        for cell in 0..count as u32 - 2 {
            // The ear and the triangle behind it go; a triangle over the far edge stands for both.
            let behind = if cell == 0 { 1 } else { count as u32 + cell - 1 };
            let ear = if cell == 0 { 0 } else { cell + 1 };
            recorder.kill(CellId(ear)).unwrap();
            recorder.kill(CellId(behind)).unwrap();
            recorder.make(mesh.cells[cell as usize + 2]).unwrap();
            recorder.end(cell as f32).unwrap();
        }
        recorder.finish(Default::default()).unwrap()
    }

    #[test]
    fn the_part_between_base_and_reference_is_the_model() {
        let model = ears(9);
        let (low, high) = (Front::base(model.len()), Front::reference(model.len()));
        assert_eq!(model.between(&low, &high, &|_| true).unwrap(), model);
    }

    #[test]
    fn a_part_has_the_meshes_of_the_whole() {
        let model = ears(12);
        let mut random = Random::new(3);
        for _ in 0..50 {
            let one = check::random_front(model.order(), &mut random);
            let other = check::random_front(model.order(), &mut random);
            let low = Front::from_nodes(model.len(), one.finest_first().filter(|&m| other.is_refined(m)));
            let high = Front::from_nodes(model.len(), one.finest_first().chain(other.finest_first()));
            let part = model.between(&low, &high, &|_| true).unwrap();
            assert_eq!(part.len(), high.len() - low.len());
            check::ends(&part, &part.reference()).unwrap();
            let mut view = model.base_view();
            let nodes: Vec<_> = low.finest_first().collect();
            nodes.iter().rev().for_each(|&m| take(&model, Step::refine(m), &mut view, &mut ()));
            let (whole, base) = (mesh_of(&model, &view.mesh), mesh_of(&part, &part.base()));
            let places = |mesh: &Mesh<3>| {
                let mut cells: Vec<_> = mesh
                    .cells
                    .iter()
                    .map(|cell| cell.map(|v| mesh.positions[v.index()].to_array().map(f32::to_bits)))
                    .collect();
                cells.sort_unstable();
                cells
            };
            assert_eq!(places(&whole), places(&base));
        }
    }

    #[test]
    fn cells_that_nothing_kills_can_be_left_out() {
        let model = ears(12);
        // The last modification alone, on the two cells that it kills.
        let last = NodeId(model.len() - 1);
        let (low, high) = (Front::base(model.len()), Front::from_nodes(model.len(), [last]));
        let whole = model.between(&low, &high, &|_| true).unwrap();
        let part = model.between(&low, &high, &|_| false).unwrap();
        assert_eq!((part.len(), part.reference().cell_count()), (1, 2));
        assert_eq!(part.reference().cell_count(), whole.reference().cell_count() - (whole.base_cells().len() - 1));
        assert_eq!(cells_of(&part, &part.base()).len(), 1);
    }

    #[test]
    fn bytes_are_those_of_the_arrays() {
        let model = ears(9);
        let roots = (0..model.len()).map(NodeId).filter(|&m| model.parent(m).is_none()).count();
        let own = 4 * (model.base_cells().len() + roots);
        assert_eq!(model.bytes(), model.parts().bytes() + model.order().bytes() + own);
        let parts = model.parts();
        let ids = [parts.coarse_start.len(), parts.fine_start.len(), parts.fine.len(), parts.parents.len()];
        let held = 12 * parts.positions.len() + 12 * parts.corners.len() + 24 * parts.bounds.len();
        assert_eq!(parts.bytes(), held + 4 * ids.iter().sum::<usize>());
        // Rows both ways: where each begins, one more than nodes, and every arc.
        let (nodes, arcs) = (model.len() as usize, model.order().arc_count());
        assert_eq!(model.order().bytes(), 2 * 4 * (nodes + 1 + arcs));
    }

    /// No reader lets these through, so they are planted behind its back.
    #[test]
    fn the_law_on_cells_sees_what_no_reader_lets_through() {
        let good = ears(9);
        check::cells(&good).unwrap();
        let says = |plant: fn(&mut Explicit<3>)| {
            let mut model = ears(9);
            plant(&mut model);
            let breach = check::cells(&model).unwrap_err();
            assert_eq!(breach.law, check::Law::Cells);
            breach.what
        };
        assert!(says(|model| model.parts.fine[3] = model.parts.fine[0]).contains("a second time"));
        assert!(says(|model| model.parts.fine[0] = CellId(model.total_cell_count() - 1)).contains("before it is made"));
        assert!(says(|model| model.base.clear()).contains("the base mesh"));
        assert!(says(|model| model.parts.coarse_start[1] -= 1).contains("before it is made"));
        assert!(says(|model| model.parts.corners.push(model.parts.corners[0])).contains("base mesh"));
        let never = says(|model| {
            model.parts.corners.push(model.parts.corners[0]);
            model.base.push(CellId::new(model.parts.corners.len() - 1));
        });
        assert!(never.contains("never made"), "{never}");
    }
}
