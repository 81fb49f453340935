//! The tests that judge mutants, in one program, since that is built anew for each mutant (docs/mutants.md).

#[path = "../budgets.rs"]
mod budgets;
#[path = "../faults/checkers.rs"]
mod checkers;
#[path = "../container.rs"]
mod container;
#[path = "../engine.rs"]
mod engine;
#[path = "../formats.rs"]
mod formats;
#[path = "../hierarchies.rs"]
mod hierarchies;
#[path = "../histories.rs"]
mod histories;
#[path = "../laws.rs"]
mod laws;
#[path = "../paths.rs"]
mod paths;
