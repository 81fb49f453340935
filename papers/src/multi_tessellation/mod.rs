//! The Multi-Tessellation (`[DeFlorianiTutorial2002]`): criteria on cells, both ways of answering, what is optimal about
//! them, budgets as the slides have them, and interruption.

mod anomalies;
mod budget;
mod criteria;
mod interruption;
mod optimality;
mod slides;

use crate::ledger::{Item, Paper, Role, Size, fuji};
use mt_core::generate::terrain;

/// The paper in the ledger.
pub const PAPER: Paper = Paper {
    data: include_str!("../../published/multi-tessellation.json"),
    items: &[
        Item { id: "criteria", title: "uniform, by region, by field value", run: criteria::criteria },
        Item { id: "strategies", title: "top-down and incremental", run: criteria::strategies },
        Item { id: "optimality", title: "when an answer is of minimum size", run: optimality::optimality },
        Item { id: "budget", title: "contraction and expansion within a budget", run: budget::budget },
        Item { id: "interruption", title: "error against modifications made", run: interruption::interruption },
        Item { id: "anomalies", title: "what we noticed in the tutorial", run: anomalies::run },
    ],
};

/// A field over the plane: heights are its values.
const FIELD: Role = Role {
    name: "field",
    file: "terrain/fuji.png",
    grid: fuji(Some([100, 100, 257, 257])),
    stand_in: |size| terrain(if size == Size::Small { 48 } else { 128 }, 0.5, 5),
};
