//! The benchmark: what a model costs to build, to keep, to step and to follow a camera with, and how good its meshes are.
//! A row for each operator, model and form; rows as text, CSV and a page.
//!
//! Times are CPU seconds of a clock that the caller brings, since the machines that people measure on are shared. What
//! depends on files and processes (peak memory, loading) is measured by the caller as well.

mod measure;
mod row;
mod tables;

pub use measure::{Meter, measure};
pub(crate) use measure::{nanoseconds_a_step, steps};
pub use row::{Built, Frames, Quality, Row, Steps};
pub use tables::{csv, markdown, page};
