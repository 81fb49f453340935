//! The study engine and the reproduced papers, with what they measure and draw with.
//!
//! A study builds the model of each subject by each operator, sends one camera around it, extracts along the way by
//! every sensible combination of criterion and strategy, measures what comes out against the input, and tells it on one
//! page. Here the three crates beside each other meet: operators build, the engine extracts, the renderer draws. Nothing
//! here opens a file; results are data, text and the bytes of pictures.
//!
//! | module | what is there |
//! |---|---|
//! | [`study`] | subjects, the camera path, the matrix of runs, results as tidy rows, the report |
//! | [`mod@bench`] | what models cost, row by row, and the tables of it |
//! | [`ledger`] | the papers, one module each: published against measured, item by item |
//! | [`distance`] | how far two meshes are from one another: samples against exact nearest points |
//! | [`plot`] | lines and bars as SVG that takes its colours from the page |
//! | [`mod@table`] | tables as data, as Markdown and as CSV |
//! | [`html`] | one page that needs no other file |
//!
//! Citations here and in all crates are keys of `refs.bib`, beside this crate's manifest.
//!
//! ```
//! use mt_core::generate;
//! use mt_papers::distance::{Sampling, distance};
//!
//! let [coarse, fine] = [generate::sphere(1), generate::sphere(4)];
//! let sampling = Sampling { count: 2000, seed: 1 };
//! let apart = distance(&coarse, &fine, sampling)?;
//! assert!(apart.rms() > 0.0 && apart.rms() < apart.maximum());
//! assert!(distance(&coarse, &coarse, sampling)?.maximum() < 1e-12);
//! # Ok::<(), mt_papers::distance::DistanceError>(())
//! ```

pub mod bench;
pub mod distance;
mod fan_hierarchy;
mod generalized;
pub mod html;
pub mod ledger;
mod multi_tessellation;
pub mod plot;
mod strips;
pub mod study;
pub mod table;
mod truly_selective;
