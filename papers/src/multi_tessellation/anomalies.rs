//! What we noticed in the tutorial, in all of its parts.

use super::{budget, optimality};
use crate::generalized;
use crate::ledger::{COW, Claim, Entry, LedgerError, Published, Workshop, edge_collapse};

pub(super) fn run(workshop: &mut Workshop<'_>, published: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&COW)?;
    entry.models.push(subject.told());
    let replay = workshop.sequence(&subject, &edge_collapse())?.replay;
    let [slide, parents, _] = generalized::allowed(&replay);
    entry.claims.push(Claim::check(
        "the rule for merges compares with the neighbours, and should with their parents",
        slide < replay.len() && parents == replay.len(),
        format!(
            "of {} merges the one allows {slide} and the other {parents}: `generalized implicit-ids`",
            replay.len()
        ),
        "",
    ));
    let (whole, cells) = optimality::counterexample()?;
    entry.claims.push(Claim::check(
        "\"Top-down always returns the mesh of minimum size\" needs the test of single cells",
        cells < whole,
        format!(
            "{whole} modifications by the test of whole ones, {cells} by that of cells: `multi-tessellation optimality`"
        ),
        "",
    ));
    let kept = budget::slides(workshop)?;
    entry.claims.push(Claim::check(
        "a mesh grows beyond its budget",
        kept.over > 0,
        format!("in {} frames, by up to {} triangles: `multi-tessellation budget`", kept.over, kept.over_max),
        "",
    ));
    entry.claims.push(Claim::check(
        "recursive adding does not roll back",
        kept.in_vain > 0,
        format!("{} nodes were added for others that then did not fit", kept.in_vain),
        "",
    ));
    entry.claims.push(Claim::check(
        "contraction and expansion oscillate",
        kept.restless > 0.0,
        format!("{:.1} steps a frame for a camera that stands still", kept.restless),
        "",
    ));
    let table = published.table("anomalies")?;
    let of =
        |row: &str| Ok::<f64, LedgerError>(table.number(row, "total decimations")? / table.number(row, "decimations")?);
    let steps = [of("First")?, of("Arbitrary")?, of("Average")?];
    entry.claims.push(Claim::check(
        "the totals of the T-DAG are of 301 time steps, where the text has 400",
        steps.iter().all(|&steps| steps == 301.0),
        format!("total by single decimations: {}", steps.map(|steps| steps.to_string()).join(", ")),
        "",
    ));
    entry.claims.push(Claim::read(
        "the quality formula divides by N, the number of contractions, where the text averages over edges",
        "Shamir and Pascucci, the measure before Figure 4",
    ));
    entry.claims.push(Claim::read(
        "stage 3 applies the inverse of A where A is needed",
        "Shamir and Pascucci, the summary of the construction",
    ));
    entry.claims.push(Claim::read(
        "the body of the server's EXPANSION is lost",
        "Puppo, slide 21; the stand-alone one is there",
    ));
    Ok(())
}
