//! Operators of analysis, one folder each, and the metrics beside them.

pub mod edge_collapse;
pub mod metric;

pub use edge_collapse::EdgeCollapse;
