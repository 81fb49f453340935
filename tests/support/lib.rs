//! What the tests share: models of generated meshes, real files where there are any, and a tetrahedral operator.

mod shell;
mod tetrahedral;

pub use shell::real_files;
pub use tetrahedral::VertexIntoNeighbour;

use mt_core::analysis::{Options, simplify};
use mt_core::{Explicit, Mesh};
use operators::EdgeCollapse;

/// The model of a mesh, coarsened to the end.
///
/// # Panics
/// Where the operator does not take the mesh.
pub fn model_of(mesh: &Mesh<3>, operator: &EdgeCollapse) -> Explicit<3> {
    simplify(mesh, operator, &Options::default(), &mut |_| true).expect("the mesh is a manifold").model
}
