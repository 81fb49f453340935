//! What the tests share: models of generated meshes, real files where there are any, operators and models to plant faults
//! in, what models are by their definition, what readers are held to, and a state machine.

mod answers;
mod careless;
pub mod chew;
pub mod machine;
mod shell;
mod tetrahedral;
pub mod truth;

pub use answers::{Answering, Answers};
pub use careless::Careless;
pub use shell::real_files;
pub use tetrahedral::VertexIntoNeighbour;

use mt_core::analysis::{Operator, Options, analyse, simplify};
use mt_core::{Cell, Explicit, Mesh, Recorder, Replay, Sequence};
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

/// An analysis, heard in both ways.
#[derive(Clone, Debug)]
pub struct History {
    /// The input.
    pub mesh: Mesh<3>,
    /// The edges by which vertices are neighbours besides triangles.
    pub links: Vec<Cell<2>>,
    /// The merges.
    pub sequence: Sequence,
    /// The cells.
    pub explicit: Explicit<3>,
}

impl History {
    /// Coarsens `mesh`, if the operator takes it.
    pub fn new(mesh: &Mesh<3>, operator: &AnyOperator, options: &Options) -> Option<Self> {
        let mut listener = (Recorder::new(mesh).ok()?, Sequence::new(mesh));
        operator.analyse(mesh, options, &mut listener, &mut |_| true).ok()?;
        let explicit = listener.0.finish(options.error_kind).ok()?;
        Some(Self { mesh: mesh.clone(), links: operator.links(mesh), sequence: listener.1, explicit })
    }

    /// The replay of the merges.
    ///
    /// # Panics
    /// Where they are none, which analysis does not tell.
    pub fn replay(&self) -> Arc<Replay> {
        Arc::new(Replay::new(&self.mesh, &self.links, &self.sequence).expect("a sequence"))
    }
}
