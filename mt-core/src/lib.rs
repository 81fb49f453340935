//! The generic Multi-Tessellation: what every operator, engine, renderer and format here speaks of.
//!
//! # The model in words
//!
//! A [`Mesh`] is made of [`Cell`]s with `N` corners: triangles for `N = 3`, tetrahedra for `N = 4`. A **modification**
//! is two patches of cells with the same boundary, a coarse side and a fine side, either of which may stand in place of
//! the other. Coarsen a mesh by modifications for as long as it goes: what is left is the **base mesh**, what it began
//! with the **reference mesh**, and each modification is a **node** of the model. A node *needs* those nodes that make
//! cells of its coarse side when they are refined; needing is the partial [`Order`]. A [`Front`] is a set of nodes
//! closed under needs, and every front gives one conforming mesh: the base mesh with the nodes of the front refined, in
//! any sequence that the order allows. The empty front is the base mesh and the full one the reference mesh; all others
//! are fine in one place and coarse in another. This is the model of `[DeFlorianiMagilloPuppo1997]`, told in full by
//! `[DeFlorianiTutorial2002]`.
//!
//! Order and front never look at a cell. A scheme of refinement is its rows of needs: here those that explicit cells
//! have; on a hierarchy of vertices others, the fewest of them in truly selective refinement, `[KimLee2001]`.
//!
//! # How data flows
//!
//! ```text
//! bytes ─ format ─▶ Mesh ─ analysis::simplify(operator) ─▶ Recorder ─▶ Explicit: cells, order, bounds
//!                                                                         │  immutable, shared
//!                                          View: front and current mesh ──┤  one per camera, changed by steps
//!                                                                         ▼
//!                                            Sink hears of cells · check judges · container keeps
//! ```
//!
//! # The modules
//!
//! | module | what is there |
//! |---|---|
//! | [`id`] | names of vertices, cells and nodes: `u32` newtypes |
//! | [`mesh`], [`cell`] | plain meshes; cells, their facets and orientation |
//! | [`complex`] | cells that come and go, with the star of each vertex; no position in sight |
//! | [`plan`] | what an operator would do: a plan, or a refusal with its reason |
//! | [`analysis`] | an operator coarsens a mesh, the recorder listens |
//! | [`explicit`] | the recorder of any history, and the model with all its cells and arcs |
//! | [`history`] | a history as text, so that any program's simplification becomes a model |
//! | [`order`], [`front`] | what needs what, also as a petgraph; which nodes are refined |
//! | [`model`] | the trait [`MultiTessellation`], which is all that engines see; views and steps |
//! | [`bound`] | spheres, errors and cones of normals, saturated |
//! | [`check`] | the laws as functions that anyone can call, and slow oracles |
//! | [`guide`] | the laws, with drawings; how to write an operator; how to read a counterexample |
//! | [`mod@format`], [`container`] | OBJ, OFF, PLY, STL and glTF over bytes; a model in one file |
//! | [`generate`] | seeded meshes made from nothing |
//! | [`camera`], [`bits`], [`random`] | a camera; sets of ids; randomness whose sequence never changes |
//!
//! # An example
//!
//! A square with a vertex in its middle loses that vertex. That is one modification, so the model has two fronts.
//!
//! ```
//! use glam::Vec3;
//! use mt_core::model::{mesh_of, take};
//! use mt_core::{CellId, ErrorKind, Mesh, MultiTessellation, Recorder, Step, VertexId, check};
//!
//! let square = Mesh::from_indices(
//!     vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, Vec3::new(0.5, 0.5, 0.1)],
//!     &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
//! );
//! let mut recorder = Recorder::new(&square)?;
//! for cell in 0..4 {
//!     recorder.kill(CellId(cell))?;
//! }
//! recorder.make([0, 1, 2].map(VertexId))?;
//! recorder.make([0, 2, 3].map(VertexId))?;
//! let node = recorder.end(0.1)?;
//! let model = recorder.finish(ErrorKind::Measured)?;
//!
//! let mut view = model.base_view();
//! assert_eq!(mesh_of(&model, &view.mesh).cell_count(), 2);
//! take(&model, Step::refine(node), &mut view, &mut ());
//! assert_eq!(mesh_of(&model, &view.mesh).cell_count(), 4);
//! assert!(view.front.is_refined(node) && model.order().is_closed(&view.front));
//! check::ends(&model, &square).unwrap();
//! # Ok::<(), mt_core::HistoryError>(())
//! ```

pub mod analysis;
mod bins;
pub mod bits;
pub mod bound;
pub mod camera;
pub mod cell;
pub mod check;
pub mod complex;
pub mod container;
pub mod explicit;
pub mod format;
pub mod front;
pub mod generate;
pub mod guide;
pub mod hierarchy;
pub mod history;
pub mod id;
pub mod log;
pub mod mesh;
pub mod model;
pub mod order;
pub mod plan;
pub mod random;

pub use bits::Bits;
pub use bound::{Bound, Cone};
pub use camera::Camera;
pub use cell::{Cell, Facet};
pub use complex::{Complex, Slot};
pub use explicit::{ErrorKind, Explicit, HistoryError, Recorder};
pub use front::Front;
pub use hierarchy::{Hierarchy, Replay, Sequence};
pub use id::{CellId, NodeId, VertexId};
pub use mesh::Mesh;
pub use model::{Coarsen, MultiTessellation, Rule, Sink, Step, View};
pub use order::Order;
pub use plan::{Patch, Plan, Refusal, RefusalCounts};
