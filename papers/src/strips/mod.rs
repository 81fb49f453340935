//! Multiresolution strips (`[BelmonteRemolar2002]`): not implemented; its tables and what we noticed have their place already.

use crate::ledger::{Claim, Entry, Item, LedgerError, Paper, Published, Workshop};

/// The paper in the ledger.
pub const PAPER: Paper = Paper {
    data: include_str!("../../published/strips.json"),
    items: &[
        Item { id: "table-1", title: "the models", run: later },
        Item { id: "table-2", title: "construction time and size", run: later },
        Item { id: "anomalies", title: "what we noticed in the paper", run: anomalies },
    ],
};

fn later(_: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    entry.claims.push(Claim::open("what the table has", "strips are not implemented yet"));
    Ok(())
}

fn anomalies(_: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    entry.claims.extend([
        Claim::read(
            "a label -2 is tested for that the text does not define: it has -1, end and beginning, and -3, end",
            "Listing 2 and section 3.1.1",
        ),
        Claim::read("\"Starting from xx LoD\" was left unfilled", "section 4.3"),
        Claim::read("\"the MT Phone model\" should be the PM Phone model", "section 4.3"),
        Claim::read("there is no section 4.2", "sections 4.1 and 4.3 follow each other"),
        Claim::open(
            "the field `res` is an upper bound only, and does not say at which level an element comes back",
            "to be shown by an example when strips are implemented",
        ),
    ]);
    Ok(())
}
