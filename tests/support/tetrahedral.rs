//! An operator on tetrahedra: an inner vertex goes into a neighbour, which shows that nothing in the core is about
//! triangles.

use glam::Vec3;
use mt_core::analysis::{Draft, Operator, Unfit};
use mt_core::mesh::volume_six;
use mt_core::{Plan, Refusal, VertexId};

/// Half-edge collapse of vertices inside a tetrahedral mesh, shortest edge first.
///
/// The star of an inner vertex is a ball; when every tetrahedron that remains keeps its volume's sign, the neighbour sees
/// the whole boundary of the ball, and the mesh stays embedded.
#[derive(Copy, Clone, Debug, Default)]
pub struct VertexIntoNeighbour;

/// An edge from an inner vertex, and the stamp of its star.
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pull {
    from: VertexId,
    into: VertexId,
}

impl Operator<4> for VertexIntoNeighbour {
    type Site = Pull;
    /// Whether each vertex is on the boundary.
    type Aux = Vec<bool>;

    fn name(&self) -> &'static str {
        "vertex-into-neighbour"
    }

    fn prepare(&self, draft: &Draft<4>, sites: &mut Vec<Pull>) -> Result<Vec<bool>, Unfit> {
        let mut outer = vec![false; draft.positions.len()];
        for facet in draft.complex.boundary() {
            facet.vertices().iter().for_each(|v| outer[v.index()] = true);
        }
        let mut around = Vec::new();
        for from in (0..draft.positions.len()).map(VertexId::new).filter(|v| !outer[v.index()]) {
            draft.complex.neighbours(from, &mut around);
            sites.extend(around.iter().map(|&into| Pull { from, into }));
        }
        Ok(outer)
    }

    fn price(&self, draft: &Draft<4>, _: &Vec<bool>, site: Pull) -> Option<f64> {
        let [from, into] = [site.from, site.into].map(|v| draft.positions[v.index()].as_dvec3());
        (draft.complex.edge_degree(site.from, site.into) > 0).then(|| from.distance(into))
    }

    fn plan(&self, draft: &Draft<4>, outer: &Vec<bool>, site: Pull, plan: &mut Plan<4>) -> Result<(), Refusal> {
        if outer[site.from.index()] {
            return Err(Refusal::Boundary);
        }
        let mut dying = Vec::new();
        for (slot, i) in draft.complex.star(site.from) {
            let mut cell = *draft.complex.cell(slot);
            if cell.contains(&site.into) {
                dying.push(slot);
                continue;
            }
            cell[i] = site.into;
            if volume_six(cell.map(|v: VertexId| draft.positions[v.index()].as_dvec3())) <= 1e-9 {
                return Err(Refusal::FoldOver);
            }
            plan.kills.push(slot);
            plan.makes.push(cell);
        }
        if dying.is_empty() {
            return Err(Refusal::Stale);
        }
        plan.kills.extend(dying);
        plan.retired.push(site.from);
        plan.kept = Some(site.into);
        let [from, into]: [Vec3; 2] = [site.from, site.into].map(|v| draft.positions[v.index()]);
        plan.error = from.distance(into);
        Ok(())
    }

    fn applied(&self, draft: &Draft<4>, outer: &mut Vec<bool>, plan: &Plan<4>, again: &mut Vec<Pull>) {
        let kept = plan.kept.expect("a vertex goes into another");
        let mut around = Vec::new();
        draft.complex.neighbours(kept, &mut around);
        for &other in around.iter().filter(|v| !outer[v.index()]) {
            again.push(Pull { from: other, into: kept });
        }
        if !outer[kept.index()] {
            again.extend(around.iter().map(|&into| Pull { from: kept, into }));
        }
    }
}
