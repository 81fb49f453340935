//! Making a mesh manifold by giving each umbrella its own copy of the vertex.
//!
//! Cutting, as Guéziec, Taubin, Lazarus and Horn do in "Cutting and Stitching" (2001): triangles are glued across the edges that have
//! exactly two of them and nowhere else; a vertex of the result is a class of corners under the gluing.
//!
//! One pass is enough. A corner has two sides, each glued at most once, so the classes around a
//! vertex are paths and cycles. An edge of more than two triangles is glued nowhere, so it ends a
//! path at both its vertices; a path has two ends, hence at most two of its triangles keep the same
//! copy of a vertex, and no edge of the result has more than two. Where it has exactly two, both
//! ends of one path meet on it, which closes the path into one umbrella.

use super::census::Edges;
use super::sets::Sets;
use crate::id::VertexId;
use crate::mesh::Mesh;
use serde::Serialize;

/// What [`split_non_manifold`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SplitCounts {
    /// Vertices that had more than one class of corners.
    pub vertices: usize,
    /// Copies appended at the end of the mesh.
    pub copies: usize,
    /// Edges that had more than two triangles.
    pub edges: usize,
}

/// Separates the umbrellas of a mesh, so that every edge has at most two triangles and every vertex one umbrella.
///
/// The class that holds a vertex's first corner keeps its id; the others get copies at the end, in
/// the order of their first corners. A manifold mesh is left as it is. Cost and requirements as
/// [`super::census::census`]; besides, no triangle repeats a vertex. 16 bytes a corner at the peak.
pub fn split_non_manifold(mesh: &mut Mesh<3>) -> SplitCounts {
    let mut counts = SplitCounts::default();
    let mut classes = glue(mesh, &mut counts);
    let mut copy = vec![VertexId::NONE; 3 * mesh.cells.len()];
    let mut uses = vec![0u32; mesh.positions.len()];
    for corner in 0..copy.len() {
        let vertex = mesh.cells[corner / 3][corner % 3];
        let class = classes.find(corner as u32) as usize;
        // A class is named by its smallest corner, which is met first.
        if class == corner {
            let first = uses[vertex.index()] == 0;
            copy[class] = if first { vertex } else { VertexId::new(mesh.positions.len()) };
            if !first {
                mesh.positions.push(mesh.positions[vertex.index()]);
                counts.copies += 1;
            }
            uses[vertex.index()] += 1;
        }
        mesh.cells[corner / 3][corner % 3] = copy[class];
    }
    counts.vertices = uses.iter().filter(|uses| **uses > 1).count();
    counts
}

fn glue(mesh: &Mesh<3>, counts: &mut SplitCounts) -> Sets {
    let edges = Edges::new(mesh);
    let mut classes = Sets::new(3 * mesh.cells.len());
    for edge in edges.iter() {
        let mut sides = edge.sides();
        match (sides.next(), sides.next(), sides.next()) {
            (Some(a), Some(b), None) => {
                let (a, b) = (edges.corners(&edge, a), edges.corners(&edge, b));
                classes.join(a[0], b[0]);
                classes.join(a[1], b[1]);
            }
            (_, _, Some(_)) => counts.edges += 1,
            _ => {}
        }
    }
    classes
}
