//! Laws on an explicit model as a whole: conformity of each modification, cells, saturation.

use super::{Breach, Law, ensure};
use crate::bound::Bound;
use crate::cell::{Facet, facets};
use crate::complex::Complex;
use crate::explicit::Explicit;
use crate::front::Front;
use crate::id::NodeId;
use crate::mesh::{area_vector, volume_six};
use crate::model::MultiTessellation;
use crate::plan::Plan;
use rustc_hash::{FxHashMap, FxHashSet};

/// What every mesh of a model is compared with: the domain of its reference mesh.
#[derive(Clone, Debug, Default)]
pub struct Domain<const N: usize> {
    /// Boundary facets of the base mesh.
    pub base_boundary: FxHashSet<Facet<N>>,
    /// How refining each node moves the boundary, for those that do: facets that it takes away, and that it adds.
    pub moves: FxHashMap<NodeId, Moved<N>>,
    /// Whether the reference mesh is a manifold in facets (at most two cells) and vertices (one umbrella).
    pub manifold: bool,
    /// Whether every inner facet of the reference has opposite orientations in its two cells.
    pub oriented: bool,
    /// Whether all meshes have the same boundary facets, so that the domain is the same point set at every level.
    pub boundary_fixed: bool,
    /// Where the reference is embedded in a plane or in space without a cell turned over.
    pub content: Option<Content>,
}

/// Boundary facets that refining a node takes away, and those that it adds.
pub type Moved<const N: usize> = (Vec<Facet<N>>, Vec<Facet<N>>);

/// The content of an embedded mesh, and which way its cells are oriented.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Content {
    /// Twice the area, or six times the volume, of the whole; above 0.
    pub sum: f64,
    /// The unit normal of the plane, for triangles.
    pub normal: glam::DVec3,
    /// The sign of the cells' contents.
    pub sign: f64,
}

impl<const N: usize> Domain<N> {
    /// The domain of a mesh, as far as the mesh itself tells it; nothing moves its boundary. O(cells log cells).
    pub fn of_mesh(mesh: &crate::Mesh<N>) -> Self {
        super::mesh::domain_of(mesh)
    }

    /// The boundary of the mesh of a closed front. O(boundary + nodes of the front).
    pub fn boundary_at(&self, front: &Front) -> FxHashSet<Facet<N>> {
        let mut boundary = self.base_boundary.clone();
        if self.moves.is_empty() {
            return boundary;
        }
        // Finest last: a facet that a node adds may be taken away by one that builds on it.
        let mut nodes: Vec<NodeId> = front.finest_first().filter(|m| self.moves.contains_key(m)).collect();
        nodes.reverse();
        for m in nodes {
            let (away, added) = &self.moves[&m];
            away.iter().for_each(|facet| _ = boundary.remove(facet));
            boundary.extend(added);
        }
        boundary
    }
}

/// Law 1: every modification keeps the combinatorial boundary of its patch towards the rest.
///
/// The facets in which the boundaries of the two sides differ must be shared with no other cell, at the time of the
/// modification in the sequence from base to reference: they are boundary of the domain. Where the input is a manifold, no
/// facet has more than two cells on the way. Gives the domain.
/// O(cells of all meshes).
pub fn conformity<const N: usize>(model: &Explicit<N>) -> Result<Domain<N>, Breach> {
    conformity_on(model, super::mesh::domain_of(&model.reference()))
}

/// [`conformity`] for a model whose modifications may change the topology, as vertex-pair collapses do: they lay any
/// number of cells onto a facet, and cells of any orientation side by side. What is left of the law is the boundary: a
/// facet with an odd number of cells is boundary of the reference, or of what the modifications make of that.
pub fn conformity_of_quotient<const N: usize>(model: &Explicit<N>) -> Result<Domain<N>, Breach> {
    let domain = super::mesh::domain_of(&model.reference());
    conformity_on(model, Domain { manifold: false, oriented: false, ..domain })
}

fn conformity_on<const N: usize>(model: &Explicit<N>, mut domain: Domain<N>) -> Result<Domain<N>, Breach> {
    let reference = model.reference();
    let mut count: FxHashMap<Facet<N>, i32> = FxHashMap::default();
    for &cell in model.base_cells() {
        for (facet, _) in facets(model.corners(cell)) {
            *count.entry(facet).or_default() += 1;
        }
    }
    let crowd = count.iter().filter(|(_, n)| domain.manifold && **n > 2).map(|(facet, n)| (names(facet), *n)).min();
    if let Some((facet, cells)) = crowd {
        let what = format!("facet {facet:?} of the base mesh has {cells} cells, but the input is a manifold");
        return Err(Breach::new(Law::CrackFree, None, what));
    }
    domain.base_boundary = count.iter().filter(|(_, n)| **n % 2 == 1).map(|(facet, _)| *facet).collect();
    for m in (0..model.len()).rev().map(NodeId) {
        let patch = model.patch(m);
        let (fine, coarse) = patch.boundary_difference();
        let torn = fine.is_empty() && !coarse.is_empty();
        ensure!(!torn, Law::Conformity, m, "the coarse side of node {m} has a boundary that its fine side has not");
        for facet in &coarse {
            let inside = patch.coarse.iter().flat_map(facets).filter(|(f, _)| f == facet).count() as i32;
            let others = count.get(facet).copied().unwrap_or(0) - inside;
            let at = names(facet);
            ensure!(others == 0, Law::Conformity, m, "node {m} opens facet {at:?}, which {others} other cells share");
        }
        for (facet, _) in patch.coarse.iter().flat_map(facets) {
            *count.entry(facet).or_default() -= 1;
        }
        for facet in &fine {
            let others = count.get(facet).copied().unwrap_or(0);
            let at = names(facet);
            ensure!(others == 0, Law::Conformity, m, "node {m} lays boundary facet {at:?} onto {others} other cells");
        }
        if !(fine.is_empty() && coarse.is_empty()) {
            domain.moves.insert(m, (coarse.clone(), fine.clone()));
        }
        for (facet, _) in patch.fine.iter().flat_map(facets) {
            let cells = count.entry(facet).or_default();
            *cells += 1;
            let crowded = domain.manifold && *cells > 2;
            ensure!(
                !crowded,
                Law::CrackFree,
                m,
                "node {m} gives facet {:?} a third cell, but the input is a manifold",
                names(&facet)
            );
        }
    }
    domain.boundary_fixed = domain.moves.is_empty();
    let input: FxHashSet<Facet<N>> = super::mesh::boundary_of(&reference.cells).into_iter().collect();
    let reached = domain.boundary_at(&Front::reference(model.len()));
    let lost = reached.symmetric_difference(&input).next();
    ensure!(
        lost.is_none(),
        Law::Conformity,
        None,
        "facet {:?} is boundary of the input or of what the modifications make of the base mesh, not of both",
        lost.map(names)
    );
    Ok(domain)
}

pub(super) fn names<const N: usize>(facet: &Facet<N>) -> Vec<u32> {
    facet.vertices().iter().map(|v| v.0).collect()
}

/// Law 2: each cell is made once and killed at most once, by a later modification than made it. O(cells).
pub fn cells<const N: usize>(model: &Explicit<N>) -> Result<(), Breach> {
    let mut made = vec![0u8; model.total_cell_count() as usize];
    let mut killed = made.clone();
    made[..model.input_cell_count() as usize].fill(1);
    for m in (0..model.len()).map(NodeId) {
        for &cell in model.fine_side(m) {
            ensure!(made[cell.index()] == 1, Law::Cells, m, "node {m} kills cell {cell} before it is made");
            ensure!(killed[cell.index()] == 0, Law::Cells, m, "node {m} kills cell {cell} a second time");
            killed[cell.index()] = 1;
        }
        for cell in model.coarse_side(m) {
            ensure!(made[cell.index()] == 0, Law::Cells, m, "node {m} makes cell {cell} a second time");
            made[cell.index()] = 1;
        }
    }
    let base: Vec<bool> = killed.iter().map(|&k| k == 0).collect();
    let told = model.base_cells().iter().map(|c| c.index());
    let counted = base.iter().enumerate().filter(|(_, b)| **b).map(|(c, _)| c);
    ensure!(told.eq(counted), Law::Cells, None, "the base mesh is not what no modification kills");
    match made.iter().position(|&m| m == 0) {
        Some(cell) => Err(Breach::new(Law::Cells, None, format!("cell {cell} is never made"))),
        None => Ok(()),
    }
}

/// Bounds contain their patch and the bounds of what is discovered under them; errors are not negative. Since
/// containment of spheres and order of errors do not depend on a camera, this holds for all of them. O(cells).
pub fn saturation<const N: usize>(model: &Explicit<N>) -> Result<(), Breach> {
    for m in (0..model.len()).map(NodeId) {
        let bound = model.bound(m);
        let patch = model.patch(m);
        for v in patch.fine.iter().chain(&patch.coarse).flatten() {
            let apart = model.positions()[v.index()].as_dvec3().distance(bound.center.as_dvec3());
            ensure!(
                apart <= f64::from(bound.radius),
                Law::Saturation,
                m,
                "vertex {v} of node {m} is outside its sphere"
            );
        }
    }
    forest_saturation(model)
}

/// Saturation along the discovery forest of any model with bounds: errors are numbers, and the bound of each node contains
/// those of the nodes discovered under it. O(nodes).
pub fn forest_saturation<const N: usize, M: MultiTessellation<N, Bound = Bound>>(model: &M) -> Result<(), Breach> {
    let mut children = Vec::new();
    for m in (0..model.len()).map(NodeId) {
        let bound = model.bound(m);
        let numbers = bound.error >= 0.0 && bound.radius >= 0.0 && bound.center.is_finite();
        ensure!(numbers, Law::Saturation, m, "the bound of node {m} is none: {bound:?}");
        children.clear();
        model.children(m, &mut children);
        for &child in &children {
            ensure!(
                bound.contains(&model.bound(child)),
                Law::Saturation,
                m,
                "the bound of node {m} does not contain that of node {child} under it"
            );
        }
    }
    Ok(())
}

/// Signed content of a cell of a planar or volume mesh: twice the area in the plane of `normal`, six times the volume.
pub(super) fn content<const N: usize>(corners: &[glam::Vec3; N], normal: glam::DVec3) -> f64 {
    let p = |i: usize| corners[i].as_dvec3();
    if N == 3 { area_vector([p(0), p(1), p(2)]).dot(normal) } else { volume_six([p(0), p(1), p(2), p(3)]) }
}

/// Law 1 for a plan before it is applied: the facets in which the boundaries of its two sides differ are shared with no
/// cell outside the patch. Debug builds call it on every plan. O(patch log patch).
pub fn plan<const N: usize>(complex: &Complex<N>, plan: &Plan<N>) -> Result<(), Breach> {
    let (fine, coarse) = plan.patch(complex).boundary_difference();
    for facet in fine.iter().chain(&coarse) {
        let vertices = facet.vertices();
        // A vertex that the plan is about to make has no cell yet.
        let old = vertices.iter().all(|v| v.index() < complex.vertex_count());
        let mut around = old.then(|| complex.star(vertices[0])).into_iter().flatten();
        let outside = around
            .find(|(slot, _)| vertices.iter().all(|v| complex.cell(*slot).contains(v)) && !plan.kills.contains(slot));
        if let Some((slot, _)) = outside {
            let what = format!("the plan changes facet {:?}, which the cell in slot {slot} shares", names(facet));
            return Err(Breach::new(Law::Conformity, None, what));
        }
    }
    Ok(())
}
