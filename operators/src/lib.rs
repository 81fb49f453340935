//! Operators of analysis, one folder each, and the metrics beside them.
//!
//! An operator says where a mesh may be coarsened, at what price, and into what: it is an
//! [`Operator`](mt_core::analysis::Operator), and [`simplify`](mt_core::analysis::simplify) drives it. It plans purely;
//! a plan is applied only once it is good, and a refusal has its reason. What it did is recorded as a model, so engines
//! and renderers never hear of operators, and a further one is a folder here and a line below.
//!
//! | operator | what it does |
//! |---|---|
//! | [`EdgeCollapse::FULL`] | an edge becomes a new vertex, where the metric likes it best |
//! | [`EdgeCollapse::HALF`] | an edge becomes one of its ends; no vertex is made |
//! | [`FanMerge::PARTIAL`] | all vertices around one, or as many as can go, are merged into it |
//! | [`VertexPair`] | two vertices become a new one, joined by an edge or not: topology is coarsened too |
//!
//! | metric | what it measures |
//! |---|---|
//! | [`metric::Quadrics`] | weighted squared distances to planes |
//! | [`metric::QuadricAttributes`] | the same, with attributes of the vertices such as normals |
//! | [`metric::LindstromTurk`] | volumes and boundary areas that one step sweeps, nothing remembered |
//! | [`metric::EdgeLength`] | how long the edge is |
//!
//! Any operator that makes two vertices one takes any metric: `EdgeCollapse::HALF.with(metric::EdgeLength)`, or by name
//! `EdgeCollapse::FULL.with("lindstrom-turk".parse::<metric::AnyMetric>()?)`.
//!
//! ```
//! use mt_core::analysis::{Options, simplify};
//! use mt_core::{MultiTessellation, generate};
//! use mt_operators::EdgeCollapse;
//!
//! let torus = generate::torus(16, 8);
//! let analysis = simplify(&torus, &EdgeCollapse::FULL, &Options::default(), &mut |_| true)?;
//! let model = analysis.model;
//! assert!(model.len() > 100 && model.base_cells().len() < torus.cell_count() / 4);
//! assert_eq!(model.reference(), torus);
//! # Ok::<(), mt_core::analysis::AnalysisError>(())
//! ```

mod catalogue;
pub mod edge_collapse;
pub mod fan_merge;
pub mod metric;
pub mod order;
pub mod vertex_pair;

pub use catalogue::{AnyOperator, UnknownOperator, Yours};
pub use edge_collapse::EdgeCollapse;
pub use fan_merge::FanMerge;
pub use vertex_pair::VertexPair;
