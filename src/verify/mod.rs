//! All the laws, on what anybody writes: one call, and a counterexample made small.
//!
//! | you wrote | call, in any `cargo test` | what it is judged on |
//! |---|---|---|
//! | an operator | [`operator`] | generated meshes; every mesh of its models, and its merges under every scheme |
//! | an order | [`order`] | generated sequences of merges: sound, or a witness |
//! | a Multi-Tessellation | [`models`] | your models of generated meshes |
//! | a criterion | [`criterion`] | generated models: monotone, and extract = adapt = least closure |
//! | a strategy | [`strategy`] | generated models and wishes: ends in the least closure by legal steps |
//!
//! Each draws cases by proptest, keeps seeds that failed beside the test (`*.proptest-regressions`), takes their number
//! from `PROPTEST_CASES`, and panics with a [`Finding`]: the law, the seed, the mesh and the history, made small and
//! written as OBJ, log and a test to paste. Behind them are plain functions on one thing that one has: [`explicit`] a
//! model of cells, [`hierarchy`] and [`scheme`] a vertex hierarchy, [`model`] anything that implements the trait,
//! [`operator_on`] an operator on a mesh of one's own. The checkers are `mt_core::check`; law 10 is checked here, because
//! it needs selective refinement.
//!
//! What is dynamic is judged by the weaker laws, and the summary lacks the others.

mod any;
mod counterexample;
mod explicit;
mod hierarchy;
mod keep;
mod meshes;
mod minimality;
mod operators;
mod orders;
mod reduce;
mod rules;
mod shrink;
mod specimen;
mod text;
mod trial;
mod watched;

pub use any::{Laws, model, models};
pub use counterexample::{Case, Counterexample, Found};
pub use explicit::{determinism, explicit};
pub use hierarchy::{hierarchy, scheme};
pub use minimality::{minimality, ties};
pub use operators::{operator, operator_in, operator_on};
pub use orders::{order, order_in, order_on};
pub use rules::{criterion, criterion_in, strategy, strategy_in};
pub use specimen::{Generated, Spec, Specimen, specimens};
pub use trial::{Finding, Tally, Trial};

use mt_core::check::Law;
use std::collections::BTreeMap;

/// How much to check, and what is claimed.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// Number of random fronts.
    pub fronts: u32,
    /// Seed of the fronts and of all other choices.
    pub seed: u64,
    /// What an explicit model claims; a hierarchy knows it by itself.
    pub topology: Topology,
}

impl Default for Options {
    fn default() -> Self {
        Self { fronts: 100, seed: 1, topology: Topology::Kept }
    }
}

/// What the modifications of an explicit model may do to the topology of its meshes.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Topology {
    /// Nothing: where the input is a manifold every mesh is one, oriented as the input is.
    #[default]
    Kept,
    /// Anything that vertex pairs do: sheets are laid onto each other and holes close. What is left of law 3 is the
    /// boundary: the facets with an odd number of cells are those that the modifications make of the input's.
    Coarsened,
}

/// How often each law was checked, and held.
pub type Summary = BTreeMap<Law, u64>;

fn held(summary: &mut Summary, law: Law) {
    *summary.entry(law).or_default() += 1;
}
