//! Metrics: what a modification costs, and where its vertex goes.

mod quadric;

pub use quadric::Quadric;
