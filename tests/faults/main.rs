//! The net holds: faults planted in every layer, each of which a law must see, and the same thing without the fault, which
//! must pass. What is planted and what caught it stands in `docs/faults.md`, written by these tests with `MT_BLESS=1`.
//!
//! `checkers` plants faults for single checkers of `mt_core::check`; the rest of the rooms are a layer each, judged by
//! what people call: `verify`, readers, the state machine.

mod catalogue;
mod cells;
mod checkers;
mod engine;
mod files;
mod operators;
mod pictures;
mod rules;
mod schemes;
mod steps;
