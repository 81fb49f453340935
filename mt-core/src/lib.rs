//! The generic Multi-Tessellation.
pub mod analysis;
pub mod bits;
pub mod bound;
pub mod camera;
pub mod cell;
pub mod complex;
pub mod explicit;
pub mod format;
pub mod front;
pub mod id;
pub mod mesh;
pub mod model;
pub mod order;
pub mod plan;

pub use bits::Bits;
pub use bound::{Bound, Cone};
pub use camera::Camera;
pub use cell::{Cell, Facet};
pub use complex::{Complex, Slot};
pub use explicit::{ErrorKind, Explicit, HistoryError, Recorder};
pub use front::Front;
pub use id::{CellId, NodeId, VertexId};
pub use mesh::Mesh;
pub use model::{Coarsen, MultiTessellation, Rule, Sink, Step, View};
pub use order::Order;
pub use plan::{Patch, Plan, Refusal, RefusalCounts};
