//! A research framework over a generic Multi-Tessellation.
//!
//! A multiresolution model is a base mesh, a set of local, conforming
//! modifications, and a partial order on them. Five parts vary and are freely
//! combined: **operator** and **metric** (analysis), **order**, **criterion** and **strategy** (synthesis).
//!
//! A tour: coarsen a mesh and keep every step, ask for detail in one place, and
//! have the laws checked.
//!
//! ```
//! use multi_tessellation::mt_core::analysis::{Options, simplify};
//! use multi_tessellation::mt_core::{Mesh, MultiTessellation, generate};
//! use multi_tessellation::operators::EdgeCollapse;
//! use multi_tessellation::selective::{InRegion, Limits, Region, Strategy, extract};
//! use multi_tessellation::verify;
//!
//! let mesh: Mesh<3> = generate::bumpy_sphere(3, 0.1, 7);
//! let analysis = simplify(&mesh, &EdgeCollapse::FULL, &Options::default(), &mut |_| true)?;
//! let model = analysis.model;
//!
//! // All detail in the octant with positive coordinates, none outside.
//! let region = Region { low: glam::Vec3::ZERO, high: glam::Vec3::splat(2.0) };
//! let wish = InRegion { region, error_max: 0.0 };
//! let (state, outcome) = extract(&model, &wish, &Limits::NONE, Strategy::TopDown, ());
//! assert!(outcome.complete && state.cell_count(&model) < mesh.cell_count() as u32);
//!
//! // Every law, at ten random fronts.
//! verify::explicit(&model, &verify::Options { fronts: 10, seed: 1, ..verify::Options::default() }, &mut |_| true).unwrap();
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod verify;

pub use mt_core;
pub use operators;
#[cfg(feature = "study")]
pub use papers;
#[cfg(feature = "render")]
pub use render;
pub use selective;
