//! Law 3 on one mesh: it conforms, has its boundary where the domain has it, and nothing overlaps.

use super::conformity::{content, names};
use super::{Breach, Domain, Law, ensure};
use crate::cell::{Cell, Facet, facets};
use crate::id::VertexId;
use crate::mesh::{Mesh, area_vector};
use glam::{DVec3, Vec3};

/// Law 3: no crack, no facet with more than two cells where the input has none, one umbrella at each vertex (triangles),
/// orientation kept; planar and volume meshes also embed: every cell has the sign of the input's and, where boundaries
/// stay as they are, they sum to its content. O(cells log cells).
pub fn crack_free<const N: usize>(cells: &[Cell<N>], positions: &[Vec3], domain: &Domain<N>) -> Result<(), Breach> {
    let sides = sorted_sides(cells);
    for run in sides.chunk_by(|a, b| a.0 == b.0) {
        let facet = &run[0].0;
        let cracked = run.len() % 2 == 1 && !domain.boundary.contains(facet);
        ensure!(
            !cracked,
            Law::CrackFree,
            None,
            "facet {:?} has {} cells, but is not on the boundary",
            names(facet),
            run.len()
        );
        if domain.manifold {
            ensure!(
                run.len() <= 2,
                Law::CrackFree,
                None,
                "facet {:?} has {} cells, but the input is a manifold",
                names(facet),
                run.len()
            );
        }
        if domain.oriented && run.len() == 2 {
            ensure!(
                run[0].1 != run[1].1,
                Law::CrackFree,
                None,
                "the two cells of facet {:?} disagree in orientation",
                names(facet)
            );
        }
    }
    if domain.manifold
        && let Some(v) = second_umbrella(cells, positions.len())
    {
        return Err(Breach::new(
            Law::CrackFree,
            None,
            format!("the cells around vertex {v} fall into more than one umbrella"),
        ));
    }
    embedded(cells, positions, domain)
}

fn embedded<const N: usize>(cells: &[Cell<N>], positions: &[Vec3], domain: &Domain<N>) -> Result<(), Breach> {
    let Some(wanted) = domain.content else { return Ok(()) };
    let normal = plane_normal(cells, positions);
    let mut sum = 0.0;
    for cell in cells {
        let part = content(&cell.map(|v| positions[v.index()]), normal);
        ensure!(part > 0.0, Law::CrackFree, None, "cell {:?} is turned over or has no content", cell.map(|v| v.0));
        sum += part;
    }
    // Where boundaries are coarsened too, the domain itself changes.
    let close = !domain.boundary_fixed || (sum - wanted).abs() <= 1e-4 * wanted.abs();
    ensure!(close, Law::CrackFree, None, "the cells sum to {sum}, the domain to {wanted}");
    Ok(())
}

/// The domain of a mesh, as far as the mesh itself tells it.
pub(super) fn domain_of<const N: usize>(mesh: &Mesh<N>) -> Domain<N> {
    let sides = sorted_sides(&mesh.cells);
    let runs = || sides.chunk_by(|a, b| a.0 == b.0);
    let facets_manifold = runs().all(|run| run.len() <= 2);
    Domain {
        boundary: runs().filter(|run| run.len() % 2 == 1).map(|run| run[0].0).collect(),
        manifold: facets_manifold && second_umbrella(&mesh.cells, mesh.positions.len()).is_none(),
        boundary_fixed: true,
        oriented: runs().all(|run| run.len() != 2 || run[0].1 != run[1].1),
        content: embedded_content(mesh),
    }
}

/// The sum of the cells' contents where all are positive: in space, or in one plane.
fn embedded_content<const N: usize>(mesh: &Mesh<N>) -> Option<f64> {
    let normal = plane_normal(&mesh.cells, &mesh.positions);
    let planar = || {
        let on = mesh.cells.first()?[0];
        let height = |p: &Vec3| (p.as_dvec3() - mesh.positions[on.index()].as_dvec3()).dot(normal).abs();
        mesh.positions.iter().map(height).fold(0.0, f64::max).le(&(1e-7 * mesh.diagonal())).then_some(())
    };
    if N == 3 {
        planar()?;
    }
    let parts = mesh.cells.iter().map(|cell| content(&cell.map(|v| mesh.positions[v.index()]), normal));
    let mut sum = 0.0;
    for part in parts {
        if part <= 0.0 {
            return None;
        }
        sum += part;
    }
    (sum > 0.0).then_some(sum)
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
