//! Multiresolution strips (`[BelmonteRemolar2002]`): not implemented; what we noticed in the paper has its place already.

use crate::ledger::{Claim, Entry, Item, LedgerError, Paper, Published, Workshop};

/// The paper in the ledger.
pub const PAPER: Paper = Paper {
    data: include_str!("../../published/strips.json"),
    items: &[Item { id: "anomalies", title: "what we noticed in the paper", run: anomalies }],
};

fn anomalies(_: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let later = "read in the text; there is no implementation here yet that could be held against it";
    for says in [
        "Listing 2 tests for a label -2, which the text does not define: it has -1, end and beginning, and -3, end",
        "\"Starting from xx LoD\" was left unfilled",
        "The field `res` is an upper bound only, and does not say at which level an element comes back",
        "\"MT Phone\" should be PM Phone",
        "There is no section 4.2",
    ] {
        entry.claims.push(Claim::open(says, later));
    }
    Ok(())
}
