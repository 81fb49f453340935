//! A broken law with the smallest case found: what is verified as it was found, and what is left of it.

use super::{Options, text};
use mt_core::check::Breach;
use mt_core::hierarchy::Story;
use mt_core::{Explicit, Front, Mesh, NodeId};

/// A broken law with the smallest case found.
#[derive(Clone)]
pub struct Counterexample<const N: usize> {
    /// The law, and what is wrong, in the ids of the case.
    pub breach: Breach,
    /// What it was before it was made small.
    pub found: Found,
    /// The model that is left.
    pub case: Case<N>,
    /// The front at which the law is broken: of the case, or where that is whole, of what was verified.
    pub front: Front,
    /// The mesh of that front.
    pub mesh: Mesh<N>,
    /// Both sides of the modification concerned, where there is one.
    pub patch: Option<(NodeId, mt_core::Patch<N>)>,
}

impl<const N: usize> Counterexample<N> {
    /// The mesh at which the law is broken, as OBJ; of tetrahedra all their faces.
    pub fn obj(&self) -> String {
        text::obj(&self.mesh)
    }

    /// All there is to say: what is wrong, how small it was made, the input, its history, the front.
    pub fn story(&self) -> String {
        text::story(self)
    }

    /// How large it was found, and how large it is, in words.
    pub fn sizes(&self) -> String {
        text::sizes(self)
    }

    /// A test to paste, that judges what is left. `dependency` is a statement that makes `let dependency` of a `replay`,
    /// for what is left of merges.
    pub fn test(&self, name: &str, dependency: &str, options: &Options) -> String {
        let judged = format!(
            "{dependency}\n    use multi_tessellation::mt_core::Hierarchy;\n    \
             verify::hierarchy(&Hierarchy {{ replay, dependency }}, &OPTIONS, &mut |_| true).unwrap();"
        );
        text::case_test(name, self, &judged, options)
    }
}

/// The breach and how small it was made, since that is what `unwrap` shows; for the rest see [`Counterexample::story`].
impl<const N: usize> std::fmt::Debug for Counterexample<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", self.breach, self.sizes())
    }
}

/// A breach as it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// In the ids of what was verified.
    pub breach: Breach,
    /// Number of nodes of what was verified.
    pub nodes: u32,
    /// Number of cells of its input.
    pub cells: usize,
    /// Number of nodes of the front at which it was found.
    pub front: u32,
}

/// What is left of a model.
#[derive(Clone, Debug)]
pub enum Case<const N: usize> {
    /// A history of cells: a part of the one that was verified.
    Cells(Box<Explicit<N>>),
    /// Merges of vertices: a part of those that were verified.
    Merges(Box<Story>),
    /// All that was verified. It could not be cut, or the law holds again on every part that was tried.
    Whole,
}

impl<const N: usize> Case<N> {
    /// Number of nodes, unless it is whole.
    pub(super) fn node_count(&self) -> Option<u32> {
        match self {
            Case::Cells(model) => Some(model.order().len()),
            Case::Merges(story) => Some(story.sequence.node_count()),
            Case::Whole => None,
        }
    }

    /// Number of cells of the input, unless it is whole.
    pub(super) fn cell_count(&self) -> Option<usize> {
        match self {
            Case::Cells(model) => Some(model.input_cell_count() as usize),
            Case::Merges(story) => Some(story.mesh.cell_count()),
            Case::Whole => None,
        }
    }

    /// The input as a mesh, unless it is whole.
    pub(super) fn input(&self) -> Option<Mesh<N>> {
        match self {
            Case::Cells(model) => Some(model.reference()),
            Case::Merges(story) => {
                let cells = story.mesh.cells.iter().filter_map(|cell| cell.as_slice().try_into().ok());
                Some(Mesh { positions: story.mesh.positions.clone(), cells: cells.collect() })
            }
            Case::Whole => None,
        }
    }
}
