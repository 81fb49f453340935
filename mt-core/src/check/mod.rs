//! The laws as checkers that anyone can call: tests and `mtess verify` call the same functions, and
//! debug builds check every plan before it is applied.
//!
//! A checker says nothing or returns a [`Breach`]: the law, what is wrong, and the place. The slow oracles are here
//! too; none of them shares code with what it judges.

mod certificate;
mod conformity;
mod fronts;
mod mesh;
mod mirror;
mod oracle;
mod quotient;
mod steps;

pub use crate::random::Random;
pub use certificate::{Certificate, Witness, is_least};
pub use conformity::{
    Content, Domain, Moved, cells, conformity, conformity_of_quotient, forest_saturation, plan, saturation,
};
pub use fronts::random_front;
pub use mesh::crack_free;
pub use mirror::Mirror;
pub use oracle::{front_determines_mesh, set_algebra};
pub use quotient::{active_ancestors, boundary_chain, dual_pieces, is_cut, patch_bounds, quotient};
pub use steps::{closure, ends, inverse, order, order_from_cells, order_of};

use crate::id::NodeId;

/// The laws of the Multi-Tessellation.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// Every modification keeps the boundary of its patch towards the rest.
    Conformity,
    /// Each cell is made once and killed at most once.
    Cells,
    /// Every reachable mesh conforms: no cracks, no overlaps, the boundary where the input has it.
    CrackFree,
    /// Coarsen undoes refine exactly, and the reverse.
    Inverse,
    /// The front determines the mesh, however it was reached.
    FrontDeterminesMesh,
    /// The empty front is the base mesh, the full front the input.
    Ends,
    /// Same input, same bytes. Judged by `verify::determinism`, which analyses twice.
    Determinism,
    /// Ids are a rank; prerequisites and obstacles tell the same as needs.
    Order,
    /// Fronts are closed, and closed sets form a lattice.
    Closure,
    /// Extract and adapt end in the least closure of the wish.
    Minimality,
    /// Bounds contain the bounds of what is discovered under them.
    Saturation,
    /// The mesh of a front is the quotient of the input by its active vertices.
    Quotient,
    /// The dual pieces of the active vertices cover the input, are disjoint, and any two share one portion of boundary.
    Partition,
    /// Code that somebody wrote comes to an end: it does not panic, names what is there, tells a history that can be, and
    /// what it says of itself is so.
    Conduct,
}

impl std::fmt::Display for Law {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Law::Conformity => "conformity",
            Law::Cells => "cells",
            Law::CrackFree => "crack-freeness",
            Law::Inverse => "inverse",
            Law::FrontDeterminesMesh => "front-determines-mesh",
            Law::Ends => "ends",
            Law::Determinism => "determinism",
            Law::Order => "order",
            Law::Closure => "closure",
            Law::Minimality => "minimality",
            Law::Saturation => "saturation",
            Law::Quotient => "quotient",
            Law::Partition => "partition",
            Law::Conduct => "conduct",
        })
    }
}

/// A law that is broken, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{law} is broken: {what}")]
pub struct Breach {
    /// Which law.
    pub law: Law,
    /// What is wrong, with ids.
    pub what: String,
    /// The modification concerned, where there is one.
    pub node: Option<NodeId>,
}

impl Breach {
    pub(crate) fn new(law: Law, node: impl Into<Option<NodeId>>, what: String) -> Self {
        Self { law, what, node: node.into() }
    }
}

/// Fails with a breach unless the condition holds.
macro_rules! ensure {
    ($condition:expr, $law:expr, $node:expr, $($what:tt)+) => {
        // A NaN holds nothing, so the condition is judged as it is written and never turned around.
        let holds: bool = $condition;
        if !holds {
            return Err($crate::check::Breach::new($law, $node, format!($($what)+)));
        }
    };
}
pub(crate) use ensure;
