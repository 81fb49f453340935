//! What the tests share: models of generated meshes, real files where there are any, and a tetrahedral operator.

pub mod chew;
mod shell;
mod tetrahedral;

pub use shell::real_files;
pub use tetrahedral::VertexIntoNeighbour;

use mt_core::analysis::{Operator, Options, analyse, simplify};
use mt_core::{Explicit, Mesh, Recorder, Replay, Sequence};
use operators::{AnyOperator, EdgeCollapse};
use std::sync::Arc;

/// The model of a mesh, coarsened to the end.
///
/// # Panics
/// Where the operator does not take the mesh.
pub fn model_of(mesh: &Mesh<3>, operator: &EdgeCollapse) -> Explicit<3> {
    simplify(mesh, operator, &Options::default(), &mut |_| true).expect("the mesh is a manifold").model
}

/// The explicit model and the replay of one sequence of merges.
///
/// # Panics
/// Where the operator does not take the mesh, or does not merge vertices.
pub fn both_of<O: Operator<3>>(mesh: &Mesh<3>, operator: &O) -> (Explicit<3>, Arc<Replay>) {
    let mut listener = (Recorder::new(mesh).expect("a mesh"), Sequence::new(mesh));
    analyse(mesh, operator, &Options::default(), &mut listener, &mut |_| true).expect("the operator takes the mesh");
    let model = listener.0.finish(Default::default()).expect("a history");
    (model, Arc::new(Replay::new(mesh, &[], &listener.1).expect("a sequence")))
}

/// The replay of an operator by name, with its links.
///
/// # Panics
/// Where there is no such operator, or it does not take the mesh.
pub fn replay_of(mesh: &Mesh<3>, operator: &AnyOperator) -> Arc<Replay> {
    let mut sequence = Sequence::new(mesh);
    operator.analyse(mesh, &Options::default(), &mut sequence, &mut |_| true).expect("the operator takes the mesh");
    Arc::new(Replay::new(mesh, &operator.links(mesh), &sequence).expect("a sequence"))
}
