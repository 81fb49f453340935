//! Truly selective refinement (`[KimLee2001]`): one wish under three orders, and what the orders are made of.
//!
//! A wish is a set of nodes that does not depend on the order: those under which feature points lie, or of which the bound
//! reaches into a frustum. Each scheme closes it in its own way, and what the closure adds is what the scheme costs.

mod anomalies;
mod chain;
mod models;
mod pictures;
mod schemes;
mod table_2;
mod wish;

use crate::ledger::{Item, Paper};

/// The paper in the ledger.
pub const PAPER: Paper = Paper {
    data: include_str!("../../published/truly-selective.json"),
    items: &[
        Item { id: "table-1", title: "what each scheme stores", run: schemes::table_1 },
        Item { id: "table-2", title: "sizes of selectively refined meshes", run: table_2::table_2 },
        Item { id: "times", title: "time of a split and of a collapse", run: schemes::times },
        Item { id: "figure-2", title: "the worst case of four faces", run: chain::figure_2 },
        Item { id: "figure-4", title: "progressive meshes and their dual pieces", run: pictures::figure_4 },
        Item { id: "figure-8", title: "a terrain within a frustum, three schemes", run: pictures::figure_8 },
        Item { id: "figure-9", title: "an image by its feature points, three schemes", run: pictures::figure_9 },
        Item { id: "figure-10", title: "the bunny's face, and its dual pieces", run: pictures::figure_10 },
        Item { id: "figure-11", title: "the silhouette of a horse, and its dual pieces", run: pictures::figure_11 },
        Item { id: "anomalies", title: "what we noticed in the paper", run: anomalies::run },
    ],
};
