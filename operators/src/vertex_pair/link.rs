//! Which collapses of an edge keep the topology of a complex that need not be a manifold.

use mt_core::{Complex, VertexId};

/// What the triangles around a vertex look like.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Kind {
    /// A disk with the vertex inside.
    Inner,
    /// A disk with the vertex on its boundary.
    Boundary,
    /// Anything else: sheets that touch, an edge with three triangles, the same triangle twice.
    Singular,
}

/// The link of a vertex: the edge opposite it in each of its triangles, ascending within and among themselves.
struct Link {
    edges: Vec<[VertexId; 2]>,
}

impl Link {
    fn of(complex: &Complex<3>, vertex: VertexId) -> Self {
        let opposite = |(slot, i): (u32, usize)| {
            let cell = complex.cell(slot);
            let [u, v] = [cell[(i + 1) % 3], cell[(i + 2) % 3]];
            [u.min(v), u.max(v)]
        };
        let mut edges: Vec<_> = complex.star(vertex).map(opposite).collect();
        edges.sort_unstable();
        Self { edges }
    }

    /// How many triangles the edge to `w` has.
    fn degree(&self, w: VertexId) -> usize {
        self.edges.iter().filter(|edge| edge.contains(&w)).count()
    }

    fn vertices(&self) -> Vec<VertexId> {
        let mut vertices: Vec<_> = self.edges.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    fn kind(&self, vertices: &[VertexId]) -> Kind {
        let mut corners: Vec<_> = self.edges.iter().flatten().collect();
        corners.sort_unstable();
        let mut runs = corners.chunk_by(|a, b| a == b);
        let twice = self.edges.windows(2).any(|pair| pair[0] == pair[1]);
        if twice || runs.any(|run| run.len() > 2) || !self.is_connected(vertices) {
            return Kind::Singular;
        }
        // In one piece and without forks: a circle, or an arc with one vertex more than edges.
        if vertices.len() == self.edges.len() { Kind::Inner } else { Kind::Boundary }
    }

    /// Whether the link, which has these vertices, is one piece.
    fn is_connected(&self, vertices: &[VertexId]) -> bool {
        let mut parents: Vec<usize> = (0..vertices.len()).collect();
        let mut pieces = vertices.len();
        for edge in &self.edges {
            let [a, b] = edge.map(|w| {
                let mut at = vertices.binary_search(&w).expect("a vertex of the link");
                while parents[at] != at {
                    parents[at] = parents[parents[at]];
                    at = parents[at];
                }
                at
            });
            if a != b {
                parents[a.max(b)] = a.min(b);
                pieces -= 1;
            }
        }
        pieces == 1
    }
}

/// Whether merging the ends of an edge keeps the topology: the link condition for 2-complexes of `[DeyEdelsbrunner1999]`,
/// with a cone over what is not a manifold.
///
/// It errs on the strict side: a vertex where several sheets meet counts as one that must stay, so an edge between two
/// such vertices is never said to keep the topology. O(degree log degree) of both.
pub(super) fn keeps_topology(complex: &Complex<3>, [a, b]: [VertexId; 2]) -> bool {
    let links = [a, b].map(|v| Link::of(complex, v));
    let around = [links[0].vertices(), links[1].vertices()];
    let kinds = [links[0].kind(&around[0]), links[1].kind(&around[1])];
    let degree = links[0].degree(b);
    let boundary_edge = match kinds {
        [Kind::Singular, Kind::Singular] => return false,
        [Kind::Inner, _] | [_, Kind::Inner] => false,
        _ => true,
    };
    // An inner edge with both ends on a boundary is a neck, and the cone over the boundary sees it.
    if degree != if boundary_edge { 1 } else { 2 } {
        return false;
    }
    let common = || around[0].iter().filter(|w| around[1].binary_search(w).is_ok());
    if common().count() != degree {
        return false;
    }
    let shares_edge = links[0].edges.iter().any(|edge| links[1].edges.binary_search(edge).is_ok());
    // The cone's share: a boundary of three edges would close up.
    let closes = boundary_edge && common().any(|&w| links.iter().all(|link| is_open(link, w)));
    !shares_edge && !closes
}

/// Whether the edge from the link's vertex to `w` is no inner edge of a surface.
fn is_open(link: &Link, w: VertexId) -> bool {
    link.degree(w) != 2
}
