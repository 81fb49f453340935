//! The generic Multi-Tessellation.
pub mod camera;
pub mod format;
pub mod id;
pub mod mesh;

pub use camera::Camera;
pub use id::{CellId, NodeId, VertexId};
pub use mesh::Mesh;
