//! Vertex hierarchies: a sequence of merges replayed on the input, with no cell stored.
//!
//! Every scheme of the literature for selective refinement of collapse sequences shares the forest of vertices and the
//! mechanics of the mesh, and differs in what a split must wait for. So there are two parts: a [`Replay`], which
//! changes the current mesh, and a [`Dependency`], which says when; a [`Hierarchy`] is both.
//!
//! The mesh of a front is the *quotient* of the input: each triangle with its corners relabelled by their active
//! ancestors, as long as these are three (`[KimLee2001]`, section 4.2). A triangle dies at the first merge that gives
//! two of its corners one ancestor, whatever else is refined; so each node has a fixed list of triangles that appear
//! when it is refined, and nothing else needs storing. Leaves are numbered along the forest, so a vertex is a span of
//! leaf ranks and an ancestor test two comparisons, however deep the forest is.
//!
//! A cell keeps its id and its corners' places through all relabelling. Merged vertices get ids after the input's, also
//! where the merged vertex stands where its centre stood: the same position under another id.
//!
//! Where the bytes go, per input vertex (a closed mesh, two triangles a vertex, coarsened to a few): see
//! [`Replay::bytes_table`].

mod build;
mod codec;
mod dependency;
mod grid;
mod lives;
mod mesh;
mod numbering;
mod part;
mod portions;
mod replay;
mod sequence;
#[cfg(test)]
mod tests;
mod umbrellas;

pub use build::{HierarchyError, InvalidSequence};
pub use codec::SequenceError;
pub use dependency::{Dependency, Hierarchy};
pub use grid::{grid_step, place_at, steps_to};
pub use mesh::VertexMesh;
pub use numbering::Numbering;
pub use part::Story;
pub use replay::{Merge, Node, Replay, Span};
pub use sequence::Sequence;
