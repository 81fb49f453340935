//! Analysis: an operator coarsens a mesh, the recorder listens, a model comes out.
//!
//! [`analyse`] = price, take, plan, apply, record, price again. An operator plans purely; nothing is changed before the
//! plan is good.

mod listener;
mod measure;
mod queue;
mod regions;
mod simplify;

pub use listener::Listener;
pub use regions::{RegionListener, RegionOperator, Regions, analyse_by_regions};
pub use simplify::{Analysis, AnalysisError, Ended, Options, Progress, Stopped, analyse, simplify};

use crate::complex::Complex;
use crate::mesh::Mesh;
use crate::plan::{Plan, Refusal};
use glam::Vec3;

/// The mesh that is being coarsened: its complex, and positions of all vertices ever made.
#[derive(Clone, Debug)]
pub struct Draft<const N: usize> {
    /// Cells and stars.
    pub complex: Complex<N>,
    /// Position of each vertex, in model units.
    pub positions: Vec<Vec3>,
}

impl<const N: usize> Draft<N> {
    /// The draft of a mesh. O(cells).
    pub fn new(mesh: &Mesh<N>) -> Self {
        Self { complex: Complex::new(mesh.positions.len(), &mesh.cells), positions: mesh.positions.clone() }
    }

    /// Applies a plan; `slots` gets the slot of each made cell.
    pub fn apply(&mut self, plan: &Plan<N>, slots: &mut Vec<u32>) {
        self.complex.apply(plan, slots);
        self.positions.extend_from_slice(&plan.vertices);
    }
}

/// An operator of analysis: what may be coarsened, at what price, into what.
///
/// A site is a place where the operator may act, such as an edge. A site whose price changes must become another site
/// (carry a stamp in it), so that what waits in the queue is either current or stale and never half right.
pub trait Operator<const N: usize> {
    /// A place to act. Sites of nearly the same price take turns in the sequence in which they are named, so name
    /// them in a fixed one.
    type Site: Copy;
    /// What the operator keeps beside the mesh: quadrics, boundary flags, stamps.
    type Aux;

    /// The operator's name in reports.
    fn name(&self) -> &'static str;

    /// Looks at the whole mesh before anything is done: refuses what the operator cannot take, else gives its
    /// auxiliary data and, in `sites`, where it may act.
    fn prepare(&self, draft: &Draft<N>, sites: &mut Vec<Self::Site>) -> Result<Self::Aux, Unfit>;

    /// The price by which sites are taken, lowest first; `None` when the site is stale. Not below 0.
    fn price(&self, draft: &Draft<N>, aux: &Self::Aux, site: Self::Site) -> Option<f64>;

    /// Fills a cleared `plan`, or says why not.
    fn plan(&self, draft: &Draft<N>, aux: &Self::Aux, site: Self::Site, plan: &mut Plan<N>) -> Result<(), Refusal>;

    /// Another way to act where this one was refused, at a price of its own.
    fn alternative(&self, _site: Self::Site, _refusal: Refusal) -> Option<Self::Site> {
        None
    }

    /// Whether a refused site is tried again once the others are done; another way to act need not be, where the first
    /// leads to it anew.
    fn waits(&self, _site: Self::Site) -> bool {
        true
    }

    /// Hears that `plan` was applied to `draft`, and adds the sites that are new or have a new price.
    fn applied(&self, draft: &Draft<N>, aux: &mut Self::Aux, plan: &Plan<N>, again: &mut Vec<Self::Site>);
}

/// A mesh that an operator cannot take.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unfit {
    /// The operator wants a manifold.
    #[error(
        "not a manifold: {edges} edges with more than two triangles{edge_places}, {vertices} vertices where several sheets touch{vertex_places}"
    )]
    NonManifold {
        /// Number of non-manifold edges.
        edges: usize,
        /// The first few, as text that begins with a space.
        edge_places: String,
        /// Number of non-manifold vertices that are not on such an edge.
        vertices: usize,
        /// The first few.
        vertex_places: String,
    },
    /// Another reason.
    #[error("{0}")]
    Other(String),
}
