//! The Multi-Tessellation (`[DeFlorianiTutorial2002]`): criteria on cells, both ways of answering, what is optimal about
//! them, budgets as the slides have them, and interruption.

mod budget;
mod criteria;
mod interruption;
mod optimality;
mod slides;

use crate::ledger::{Claim, Entry, Item, LedgerError, Paper, Published, Role, Size, Workshop};
use mt_core::generate::terrain;
use operators::metric::{AnyMetric, Quadrics};
use operators::{AnyOperator, EdgeCollapse};

/// The paper in the ledger.
pub const PAPER: Paper = Paper {
    data: include_str!("../../published/multi-tessellation.json"),
    items: &[
        Item { id: "criteria", title: "uniform, by region, by field value", run: criteria::criteria },
        Item { id: "strategies", title: "top-down and incremental", run: criteria::strategies },
        Item { id: "optimality", title: "when an answer is of minimum size", run: optimality::optimality },
        Item { id: "budget", title: "contraction and expansion within a budget", run: budget::budget },
        Item { id: "interruption", title: "error against modifications made", run: interruption::interruption },
        Item { id: "anomalies", title: "what we noticed in the other halves of the tutorial", run: anomalies },
    ],
};

/// A field over the plane: heights are its values.
const FIELD: Role = Role {
    name: "field",
    file: "terrain/fuji.png",
    part: Some([100, 100, 257, 257]),
    stand_in: |size| terrain(if size == Size::Small { 20 } else { 128 }, 0.5, 5),
};

fn collapse() -> AnyOperator {
    AnyOperator::EdgeCollapse(EdgeCollapse::FULL.with(AnyMetric::Quadric(Quadrics)))
}

fn anomalies(_: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let here = |says: &str, at: &str| Claim::open(says, format!("answered by measuring, at `{at}`"));
    entry.claims.extend([
        here("A pair may merge when its parent's id is less than the neighbours'", "generalized implicit-ids"),
        here("A mesh grows beyond its budget; recursive adding does not roll back; contraction oscillates", "multi-tessellation budget"),
        here("\"Top-down always returns the mesh of minimum size\" needs the test of single cells", "multi-tessellation optimality"),
        Claim::open("The body of the server's EXPANSION is lost on slide 21", "the stand-alone one is there; client and server are not implemented yet"),
        Claim::open(
            "The totals of the T-DAG are of 301 time steps, not of 400; the quality formula divides by N though the text averages over \
             edges; stage 3 applies the inverse where A is needed",
            "read in the text; time-dependent meshes are not implemented yet",
        ),
    ]);
    Ok(())
}
