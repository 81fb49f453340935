//! What an operator would do, before anything is done: a plan, or a refusal with its reason.

use crate::cell::{Cell, Facet, facets};
use crate::complex::{Complex, Slot};
use crate::id::VertexId;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A coarsening modification that has been found good: cells to kill, cells to make, vertices to add.
///
/// Operators fill one plan over and over, so planning allocates nothing once it is warm.
#[derive(Clone, Debug, Default)]
pub struct Plan<const N: usize> {
    /// The fine side, by slot.
    pub kills: Vec<Slot>,
    /// The coarse side. `makes[i]` takes the slot of `kills[i]`: keep corners in place where cells correspond.
    pub makes: Vec<Cell<N>>,
    /// Vertices whose whole star dies. A plan that merges vertices retires them in the order in which they are merged:
    /// into `kept`, or all of them into the one new vertex.
    pub retired: Vec<VertexId>,
    /// Positions of new vertices, which get the next free ids in this order.
    pub vertices: Vec<Vec3>,
    /// The vertex into which retired ones are merged, where one that was there before takes them.
    pub kept: Option<VertexId>,
    /// Error of the coarse side, in model units.
    pub error: f32,
    /// Where several vertices are retired one after the other into `kept` (a fan): the error after each of them, in the
    /// order of `retired`, not falling. Empty where one error is all there is.
    pub errors: Vec<f32>,
    /// Room for an operator's own work while it plans; means nothing afterwards.
    pub scratch: Vec<VertexId>,
}

impl<const N: usize> Plan<N> {
    /// Forgets the last plan, keeps the memory.
    pub fn clear(&mut self) {
        self.kills.clear();
        self.makes.clear();
        self.retired.clear();
        self.vertices.clear();
        self.kept = None;
        self.error = 0.0;
        self.errors.clear();
    }

    /// Both sides as cells of the complex that the plan was made for. O(patch).
    pub fn patch(&self, complex: &Complex<N>) -> Patch<N> {
        Patch { fine: self.kills.iter().map(|&slot| *complex.cell(slot)).collect(), coarse: self.makes.clone() }
    }
}

/// The two sides of a modification as cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Patch<const N: usize> {
    /// The side with more detail.
    pub fine: Vec<Cell<N>>,
    /// The side with less.
    pub coarse: Vec<Cell<N>>,
}

impl<const N: usize> Patch<N> {
    /// The facets in which the boundaries of the two sides differ: those of the fine side alone, and of the coarse
    /// side alone. A modification conforms when none of them is shared with a cell outside the patch. O(patch log patch).
    ///
    /// A boundary is what an odd number of cells has. Where the fine side is coherently oriented, a facet that one cell has
    /// counts with its orientation, so a patch turned inside out differs from itself.
    pub fn boundary_difference(&self) -> (Vec<Facet<N>>, Vec<Facet<N>>) {
        let oriented = is_coherent(&self.fine);
        let (fine, coarse) = (boundary_of(&self.fine, oriented), boundary_of(&self.coarse, oriented));
        let only = |a: &[(Facet<N>, bool)], b: &[(Facet<N>, bool)]| {
            a.iter().filter(|f| b.binary_search(f).is_err()).map(|f| f.0).collect::<Vec<_>>()
        };
        (only(&fine, &coarse), only(&coarse, &fine))
    }
}

/// Facets that an odd number of the cells has, ascending; each with its orientation where one cell has it and
/// orientation is to count.
fn boundary_of<const N: usize>(cells: &[Cell<N>], oriented: bool) -> Vec<(Facet<N>, bool)> {
    let mut all: Vec<_> = cells.iter().flat_map(facets).collect();
    all.sort_unstable();
    let odd = all.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() % 2 == 1);
    odd.map(|run| (run[0].0, oriented && run.len() == 1 && run[0].1)).collect()
}

/// Whether the two cells of every inner facet pass it in opposite directions.
fn is_coherent<const N: usize>(cells: &[Cell<N>]) -> bool {
    let mut all: Vec<_> = cells.iter().flat_map(facets).collect();
    all.sort_unstable();
    all.chunk_by(|a, b| a.0 == b.0).all(|run| run.len() != 2 || run[0].1 != run[1].1)
}

/// Why an operator would not touch a site.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Refusal {
    /// The site is gone or has changed since it was queued. Not counted as a refusal.
    Stale,
    /// The link condition fails: the mesh would stop being a manifold, or change its topology.
    Link,
    /// An inner edge with both ends on the boundary: the surface would be pinched.
    Pinch,
    /// The boundary rule forbids it.
    Boundary,
    /// A cell would turn over, or nearly so.
    FoldOver,
    /// A cell would get no area or volume.
    Degenerate,
    /// A number left the range in which it means something.
    NotFinite,
    /// A limit of the data structure (degree, count).
    Limit,
    /// The user's own reason.
    Other,
}

impl Refusal {
    /// All reasons, in the order of [`RefusalCounts`].
    pub const ALL: [Refusal; 9] = [
        Refusal::Stale,
        Refusal::Link,
        Refusal::Pinch,
        Refusal::Boundary,
        Refusal::FoldOver,
        Refusal::Degenerate,
        Refusal::NotFinite,
        Refusal::Limit,
        Refusal::Other,
    ];

    /// The reason as a word.
    pub fn name(self) -> &'static str {
        match self {
            Refusal::Stale => "stale",
            Refusal::Link => "link",
            Refusal::Pinch => "pinch",
            Refusal::Boundary => "boundary",
            Refusal::FoldOver => "fold-over",
            Refusal::Degenerate => "degenerate",
            Refusal::NotFinite => "not-finite",
            Refusal::Limit => "limit",
            Refusal::Other => "other",
        }
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// Refusals counted by reason.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct RefusalCounts([u64; 9]);

impl RefusalCounts {
    /// Counts one.
    pub fn add(&mut self, refusal: Refusal) {
        self.0[refusal as usize] += 1;
    }

    /// Adds what somebody else has counted.
    pub fn add_all(&mut self, other: &Self) {
        self.0.iter_mut().zip(other.0).for_each(|(mine, theirs)| *mine += theirs);
    }

    /// How often this reason was given.
    pub fn of(&self, refusal: Refusal) -> u64 {
        self.0[refusal as usize]
    }

    /// The reasons that were given, with their counts; stale sites are not refusals.
    pub fn iter(&self) -> impl Iterator<Item = (Refusal, u64)> + '_ {
        Refusal::ALL.into_iter().skip(1).map(|r| (r, self.of(r))).filter(|(_, count)| *count > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_patch_turned_over_differs_from_itself() {
        let ids = |cell: [u32; 3]| cell.map(VertexId);
        let patch = |fine: &[[u32; 3]], coarse: &[[u32; 3]]| {
            let sides = [fine, coarse].map(|cells| cells.iter().map(|&cell| ids(cell)).collect::<Vec<_>>());
            let [fine, coarse] = sides;
            Patch { fine, coarse }.boundary_difference()
        };
        let square = [[0, 1, 2], [0, 2, 3]];
        let none = (Vec::new(), Vec::new());
        assert_eq!(patch(&square, &[[0, 1, 3], [1, 2, 3]]), none);
        let turned = patch(&square, &[[0, 3, 1], [1, 3, 2]]);
        assert_eq!((turned.0.len(), turned.1.len()), (4, 4));
        // Where the fine side is of two minds, orientation says nothing.
        assert_eq!(patch(&[[0, 1, 2], [0, 3, 2]], &[[0, 1, 3], [1, 2, 3]]), none);
        // Three at an edge are a boundary there, whichever comes first.
        assert_eq!(patch(&[[0, 1, 2], [3, 1, 0], [0, 1, 4]], &[[3, 1, 0], [0, 1, 4], [0, 1, 2]]), none);
    }
}
