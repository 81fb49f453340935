//! A state machine: random operations on two views of a model, each followed by a comparison with what must be.
//!
//! The reference is [`crate::truth`] (set algebra, the quotient, the orders by their definitions) and `expect` (closures,
//! and the search under a budget). After every operation: the front is the reference's set, the mesh the reference's, the
//! sink knows that mesh, cells are counted right, the log holds every step, each step of it was legal, its inverse leads
//! back, and a front that was met before has the same mesh again. Dynamic rules claim less: what is asked for is refined
//! by legal steps, and budgets hold.

mod asking;
mod cases;
mod engine;
mod expect;
mod hunt;
mod ops;
mod rig;

pub use cases::{OPERATORS, on_cells, on_ids_as_one_ring, on_merges, on_tetrahedra, small_mesh};
pub use engine::{Engine, Fault};
pub use hunt::found;
pub use ops::{Act, Op, ops};
