//! Cells and their facets: orientation and nothing about space.

use crate::id::VertexId;

/// The corners of a cell: 3 of a triangle, 4 of a tetrahedron. Their order up to even permutations is the orientation.
pub type Cell<const N: usize> = [VertexId; N];

/// A facet of a cell with `N` corners: its `N - 1` vertices ascending, then [`VertexId::NONE`].
#[derive(Copy, Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Facet<const N: usize>(pub [VertexId; N]);

impl<const N: usize> Facet<N> {
    /// The vertices of the facet, ascending.
    pub fn vertices(&self) -> &[VertexId] {
        &self.0[..N - 1]
    }
}

/// The facet opposite corner `i`, and whether the orientation it inherits is that of its ascending vertices.
///
/// The boundary of `[v0, ..]` is the sum of `(-1)^i [.. without vi ..]`.
pub fn facet<const N: usize>(cell: &Cell<N>, i: usize) -> (Facet<N>, bool) {
    let mut corners = [VertexId::NONE; N];
    let mut positive = i.is_multiple_of(2);
    for (length, &v) in cell[..i].iter().chain(&cell[i + 1..]).enumerate() {
        let mut at = length;
        while at > 0 && corners[at - 1] > v {
            corners[at] = corners[at - 1];
            at -= 1;
            positive = !positive;
        }
        corners[at] = v;
    }
    (Facet(corners), positive)
}

/// All facets of a cell with their inherited orientations.
pub fn facets<const N: usize>(cell: &Cell<N>) -> impl Iterator<Item = (Facet<N>, bool)> + '_ {
    (0..N).map(move |i| facet(cell, i))
}

/// The corners of a triangle after corner `i`, in its turn.
#[inline]
pub fn sides(cell: &Cell<3>, i: usize) -> [VertexId; 2] {
    match i {
        0 => [cell[1], cell[2]],
        1 => [cell[2], cell[0]],
        _ => [cell[0], cell[1]],
    }
}

/// Whether all corners differ.
pub fn is_proper<const N: usize>(cell: &Cell<N>) -> bool {
    (1..N).all(|i| !cell[..i].contains(&cell[i]))
}

/// The same oriented cell with its smallest corner first, for comparing cells as geometry rather than by id.
///
/// Two cells have the same canonical form exactly when an even permutation of corners takes one to the other.
pub fn canonical<const N: usize>(cell: &Cell<N>) -> Cell<N> {
    let mut sorted = *cell;
    let mut even = true;
    for i in 1..N {
        let mut at = i;
        while at > 0 && sorted[at - 1] > sorted[at] {
            sorted.swap(at - 1, at);
            even = !even;
            at -= 1;
        }
    }
    if !even {
        sorted.swap(N - 2, N - 1);
    }
    sorted
}

/// Links of at most so many edges are walked by searching through all of them.
const SHORT: usize = 24;

/// A quick yes: these edges of a link are one closed walk around a vertex, in which each begins where just one other ends.
/// A no says nothing: the link may be long, open, or of triangles that do not agree on their sides. O(edges²), at most 24².
pub fn is_short_cycle(edges: &[[VertexId; 2]]) -> bool {
    if !(3..=SHORT).contains(&edges.len()) {
        return false;
    }
    // A walk that first comes back after as many steps as there are edges has taken each of them, from another vertex each.
    let [start, mut at] = edges[0];
    for _ in 1..edges.len() {
        if at == start {
            return false;
        }
        let Some(&[_, next]) = edges.iter().find(|edge| edge[0] == at) else { return false };
        at = next;
    }
    at == start
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids<const N: usize>(corners: [u32; N]) -> Cell<N> {
        corners.map(VertexId)
    }

    #[test]
    fn the_boundary_of_a_boundary_vanishes() {
        // Facets of a tetrahedron, oriented as inherited, meet along each edge in opposite directions.
        let cell = ids([7, 2, 9, 4]);
        let mut edges = std::collections::BTreeMap::<_, i32>::new();
        for (face, positive) in facets(&cell) {
            let mut corners = [face.0[0], face.0[1], face.0[2]];
            if !positive {
                corners.swap(0, 1);
            }
            for (edge, sign) in facets(&corners) {
                *edges.entry(edge).or_default() += if sign { 1 } else { -1 };
            }
        }
        assert_eq!(edges.len(), 6);
        assert!(edges.values().all(|&sum| sum == 0));
    }

    #[test]
    fn canonical_form_keeps_orientation() {
        assert_eq!(canonical(&ids([3, 1, 2])), ids([1, 2, 3]));
        assert_eq!(canonical(&ids([1, 3, 2])), canonical(&ids([2, 1, 3])));
        assert_ne!(canonical(&ids([1, 3, 2])), canonical(&ids([1, 2, 3])));
        assert_eq!(canonical(&ids([2, 1, 4, 3])), ids([1, 2, 3, 4]));
    }

    #[test]
    fn the_vertices_of_a_facet_are_all_but_the_place_of_the_last() {
        let [a, b, c, d] = [4, 9, 2, 7].map(VertexId);
        assert_eq!(facet(&[a, b, c], 1).0.vertices(), [c, a]);
        assert_eq!(facet(&[a, b, c, d], 0).0.vertices(), [c, d, b]);
    }

    #[test]
    fn a_short_cycle_takes_in_all_edges_once() {
        let is = |edges: &[[u32; 2]]| is_short_cycle(&edges.iter().map(|edge| edge.map(VertexId)).collect::<Vec<_>>());
        assert!(is(&[[5, 7], [9, 5], [7, 9]]));
        assert!(is(&[[1, 2], [3, 4], [2, 3], [4, 1]]));
        // Two edges, an open walk, two cycles, a turn the other way, a vertex passed twice, a tail into a cycle.
        assert!(!is(&[[1, 2], [2, 1]]));
        assert!(!is(&[[1, 2], [2, 3], [3, 4]]));
        assert!(!is(&[[1, 2], [2, 3], [3, 1], [4, 5], [5, 6], [6, 4]]));
        assert!(!is(&[[1, 2], [2, 3], [1, 3]]));
        assert!(!is(&[[1, 2], [2, 3], [3, 1], [1, 4], [4, 5], [5, 1]]));
        assert!(!is(&[[0, 1], [1, 2], [2, 3], [3, 1]]));
        let long: Vec<[u32; 2]> = (0..25).map(|i| [i, (i + 1) % 25]).collect();
        assert!(!is(&long) && is(&(0..24).map(|i| [i, (i + 1) % 24]).collect::<Vec<_>>()));
    }
}
