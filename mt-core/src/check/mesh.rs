//! Law 3 on one mesh: it conforms, has its boundary where the domain has it, and nothing overlaps.

use super::conformity::{Content, content, names};
use super::{Breach, Domain, Law, ensure};
use crate::cell::{Cell, Facet, facets};
use crate::id::VertexId;
use crate::mesh::{Mesh, area_vector};
use glam::{DVec3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

/// Law 3: the boundary is exactly `boundary` (see [`Domain::boundary_at`]), no facet has more than two cells where the
/// input has none such, one umbrella at each vertex (triangles), orientation kept; planar and volume meshes also embed:
/// every cell has the sign of the input's and, where boundaries stay as they are, they sum to its content. That no
/// closed component is lost is for [`super::set_algebra`] to see. O(cells log cells).
pub fn crack_free<const N: usize>(
    cells: &[Cell<N>],
    positions: &[Vec3],
    domain: &Domain<N>,
    boundary: &FxHashSet<Facet<N>>,
) -> Result<(), Breach> {
    let sides = sorted_sides(cells);
    let mut open = 0;
    for run in sides.chunk_by(|a, b| a.0 == b.0) {
        open += usize::from(run.len() % 2 == 1);
        judge_facet(run, domain, boundary)?;
    }
    let missing = boundary.len() - open;
    ensure!(missing == 0, Law::CrackFree, None, "{missing} facets of the boundary are not there");
    if domain.manifold
        && let Some(v) = second_umbrella(cells, positions.len())
    {
        let what = format!("the cells around vertex {v} fall into more than one umbrella");
        return Err(Breach::new(Law::CrackFree, None, what));
    }
    embedded(cells, positions, domain)
}

/// One facet, given as the sides of all its cells.
fn judge_facet<const N: usize>(
    sides: &[(Facet<N>, bool)],
    domain: &Domain<N>,
    boundary: &FxHashSet<Facet<N>>,
) -> Result<(), Breach> {
    let (facet, cells) = (&sides[0].0, sides.len());
    let at = names(facet);
    let cracked = cells % 2 == 1 && !boundary.contains(facet);
    ensure!(!cracked, Law::CrackFree, None, "facet {at:?} has {cells} cells, but is not on the boundary");
    let crowded = domain.manifold && cells > 2;
    ensure!(!crowded, Law::CrackFree, None, "facet {at:?} has {cells} cells, but the input is a manifold");
    let twisted = domain.oriented && cells == 2 && sides[0].1 == sides[1].1;
    ensure!(!twisted, Law::CrackFree, None, "the two cells of facet {at:?} disagree in orientation");
    Ok(())
}

fn embedded<const N: usize>(cells: &[Cell<N>], positions: &[Vec3], domain: &Domain<N>) -> Result<(), Breach> {
    let Some(wanted) = domain.content else { return Ok(()) };
    let mut sum = 0.0;
    for cell in cells {
        let part = wanted.sign * content(&cell.map(|v| positions[v.index()]), wanted.normal);
        ensure!(part > 0.0, Law::CrackFree, None, "cell {:?} is turned over or has no content", cell.map(|v| v.0));
        sum += part;
    }
    // Where boundaries are coarsened too, the domain itself changes.
    let close = !domain.boundary_fixed || (sum - wanted.sum).abs() <= 1e-4 * wanted.sum;
    ensure!(close, Law::CrackFree, None, "the cells sum to {sum}, the domain to {}", wanted.sum);
    Ok(())
}

/// The domain of a mesh, as far as the mesh itself tells it.
pub(super) fn domain_of<const N: usize>(mesh: &Mesh<N>) -> Domain<N> {
    let sides = sorted_sides(&mesh.cells);
    let runs = || sides.chunk_by(|a, b| a.0 == b.0);
    let facets_manifold = runs().all(|run| run.len() <= 2);
    Domain {
        base_boundary: runs().filter(|run| run.len() % 2 == 1).map(|run| run[0].0).collect(),
        moves: FxHashMap::default(),
        manifold: facets_manifold && second_umbrella(&mesh.cells, mesh.positions.len()).is_none(),
        boundary_fixed: true,
        oriented: runs().all(|run| run.len() != 2 || run[0].1 != run[1].1),
        content: embedded_content(mesh),
    }
}

/// The content of a mesh in space, or in one plane, whose cells all have the same sign.
fn embedded_content<const N: usize>(mesh: &Mesh<N>) -> Option<Content> {
    let normal = plane_normal(&mesh.cells, &mesh.positions);
    let first = *mesh.cells.first()?;
    if N == 3 {
        let on = mesh.positions[first[0].index()].as_dvec3();
        let height = |p: &Vec3| (p.as_dvec3() - on).dot(normal).abs();
        let off_plane = mesh.positions.iter().map(height).fold(0.0, f64::max);
        if off_plane > 1e-7 * mesh.diagonal() {
            return None;
        }
    }
    let part = |cell: &Cell<N>| content(&cell.map(|v| mesh.positions[v.index()]), normal);
    let sign = part(&first).signum();
    let parts = mesh.cells.iter().map(|cell| sign * part(cell));
    let sum = parts.clone().all(|part| part > 0.0).then(|| parts.sum::<f64>())?;
    Some(Content { sum, normal, sign })
}

/// The unit normal of the plane that triangles lie in, if they lie in one.
fn plane_normal<const N: usize>(cells: &[Cell<N>], positions: &[Vec3]) -> DVec3 {
    if N != 3 {
        return DVec3::ZERO;
    }
    let vector = |cell: &Cell<N>| area_vector([0, 1, 2].map(|i| positions[cell[i].index()].as_dvec3()));
    cells.iter().map(vector).sum::<DVec3>().normalize_or_zero()
}

/// The facets that an odd number of cells has.
pub(super) fn boundary_of<const N: usize>(cells: &[Cell<N>]) -> Vec<Facet<N>> {
    let sides = sorted_sides(cells);
    sides.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() % 2 == 1).map(|run| run[0].0).collect()
}

fn sorted_sides<const N: usize>(cells: &[Cell<N>]) -> Vec<(Facet<N>, bool)> {
    let mut sides: Vec<_> = cells.iter().flat_map(facets).collect();
    sides.sort_unstable();
    sides
}

/// A vertex whose triangles are not linked across edges into one piece. Always `None` for other cells.
fn second_umbrella<const N: usize>(cells: &[Cell<N>], vertex_count: usize) -> Option<VertexId> {
    if N != 3 {
        return None;
    }
    let mut start = vec![0u32; vertex_count + 1];
    for v in cells.iter().flatten() {
        start[v.index() + 1] += 1;
    }
    for v in 0..vertex_count {
        start[v + 1] += start[v];
    }
    let mut opposite = vec![[VertexId::NONE; 2]; 3 * cells.len()];
    let mut fill = start.clone();
    for cell in cells {
        for i in 0..3 {
            let at = &mut fill[cell[i].index()];
            opposite[*at as usize] = [cell[(i + 1) % 3], cell[(i + 2) % 3]];
            *at += 1;
        }
    }
    (0..vertex_count)
        .find(|&v| !is_one_chain(&mut opposite[start[v] as usize..start[v + 1] as usize]))
        .map(VertexId::new)
}

/// Whether the edges form one connected piece; sorts them as it goes.
fn is_one_chain(edges: &mut [[VertexId; 2]]) -> bool {
    let mut reached = 1;
    let mut at = 0;
    while at < reached.min(edges.len()) {
        let [a, b] = edges[at];
        at += 1;
        let mut other = reached;
        while other < edges.len() {
            if edges[other].contains(&a) || edges[other].contains(&b) {
                edges.swap(reached, other);
                reached += 1;
            }
            other += 1;
        }
    }
    reached >= edges.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::generate;

    #[test]
    fn a_mesh_tells_its_domain() {
        let sheet = domain_of(&generate::grid(3, 2));
        assert!(sheet.manifold && sheet.oriented && sheet.boundary_fixed);
        assert_eq!(sheet.base_boundary.len(), 10);
        let content = sheet.content.expect("a flat mesh has an area");
        assert!((content.sum - 12.0).abs() < 1e-9, "twice the area: {}", content.sum);
        let band = domain_of(&generate::moebius(12));
        assert!(band.manifold && !band.oriented && band.content.is_none());
        assert!(!domain_of(&generate::fan3()).manifold && !domain_of(&generate::hourglass()).manifold);
        assert!(domain_of(&generate::torus(5, 4)).base_boundary.is_empty());
    }
}
