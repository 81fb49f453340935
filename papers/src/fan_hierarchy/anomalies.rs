//! What we noticed in the paper: its tables against each other and against its text, and its formulas.

use super::{TERRAIN, ends, fans, range};
use crate::ledger::{Claim, Entry, LedgerError, Published, PublishedTable, Workshop};
use glam::Vec3;
use mt_core::{Bound, Cone, NodeId};
use selective::{Criterion, Reading, VisualError};

/// A number of each row.
fn of_rows(table: &PublishedTable, value: impl Fn(&str) -> Option<f64>) -> Vec<f64> {
    table.rows.iter().filter_map(|row| value(&row[0].to_string())).collect()
}

/// The quotients of two columns, row by row.
fn quotients(table: &PublishedTable, above: &str, below: &str) -> Vec<f64> {
    of_rows(table, |row| Some(table.number(row, above)? / table.number(row, below)?))
}

pub(super) fn run(workshop: &mut Workshop<'_>, published: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let [built, sizes, adapted] = ["table-1", "table-2", "table-3"].map(|id| published.table(id));
    let (built, sizes, adapted) = (built?, sizes?, adapted?);
    order(workshop, entry)?;
    tables_against_each_other(entry, built, sizes);
    ratios(entry, sizes, adapted);
    equation(entry);
    entry.claims.push(Claim::check(
        "Figures 8 and 9 are of models of 320K and 202K triangles, and the tables of 7,500K and 7,218K",
        built.number("Armadillo", "triangles, K") == Some(7500.0)
            && built.number("A. Dragon", "triangles, K") == Some(7218.0),
        "so the pictures say nothing of the rows of the tables; ours are of one model each",
        "",
    ));
    Ok(())
}

fn order(workshop: &mut Workshop<'_>, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&TERRAIN)?;
    let replay = workshop.sequence(&subject, &fans())?.replay;
    let tenth = (replay.len() / 10).max(1);
    let mean = |nodes: std::ops::Range<u32>| {
        let count = f64::from(nodes.end - nodes.start);
        nodes.map(|m| f64::from(replay.node(NodeId(m)).error)).sum::<f64>() / count
    };
    let (first, last) = (mean(0..tenth), mean(replay.len() - tenth..replay.len()));
    entry.claims.push(Claim::check(
        "Section 3.2 merges \"in a decreasing order of the introduced errors\"; it has to be increasing",
        first < last,
        format!("in increasing order the first tenth of our merges has a mean error of {first:.2e} and the last of {last:.2e} model units; decreasing, the largest damage would come first"),
        "",
    ));
    Ok(())
}

fn tables_against_each_other(entry: &mut Entry, built: &PublishedTable, sizes: &PublishedTable) {
    let excess =
        of_rows(sizes, |row| Some(sizes.number(row, "VDT internal nodes, K")? - built.number(row, "vertices, K")?));
    let half = |row: &str| built.number(row, "triangles, K").unwrap_or(f64::NAN) / 2.0;
    entry.claims.push(Claim::check(
        "Table 2 has more internal nodes of the tree of Scene and Armadillo than Table 1 has vertices, which no binary tree has",
        excess.iter().filter(|more| **more > 0.0).count() == 2,
        format!(
            "Scene 1224K nodes and 872K vertices, Armadillo 3750K and 3390K; half the triangles are {:.0}K and {:.0}K, which is where the numbers seem to come from",
            half("Scene"),
            half("Armadillo")
        ),
        "",
    ));
    let text = |row: usize| built.rows[row][3].to_string();
    entry.claims.push(Claim::check(
        "Table 1 is headed seconds and holds minutes and seconds",
        text(0).contains(':'),
        format!("Terrain took {}, which read as seconds would be 31 vertices a millisecond on a Pentium 4", text(0)),
        "",
    ));
    let per_vertex: Vec<f64> = quotients(built, "FH, min:s", "vertices, K").into_iter().collect();
    let (least, most) = ends(&per_vertex);
    entry.claims.push(Claim::check(
        "\"Nearly linear\" is 0.57 to 2.16 ms a vertex",
        most / least > 2.0,
        format!("{} ms a vertex, a factor of {:.1}", range(&per_vertex, 2), most / least),
        "",
    ));
    let scene = sizes.number("Scene", "VDT size, KB").unwrap_or(f64::NAN)
        / sizes.number("Scene", "FH size, KB").unwrap_or(f64::NAN);
    entry.claims.push(Claim::check(
        "The saving factor of Scene is printed as 1.60",
        (scene - 1.6).abs() > 0.03,
        format!("its sizes give {scene:.2}"),
        "",
    ));
    let children =
        of_rows(sizes, |row| Some(built.number(row, "vertices, K")? / sizes.number(row, "FH internal nodes, K")?));
    entry.claims.push(Claim::check(
        "A depth of log6 n wants six children a fan, its centre among them",
        ends(&children).0 < 5.5,
        format!("vertices / internal nodes of the printed tables are {}: between five and seven", range(&children, 2)),
        "",
    ));
}

fn ratios(entry: &mut Entry, sizes: &PublishedTable, adapted: &PublishedTable) {
    let steps = of_rows(adapted, |row| {
        let number = |heading| adapted.number(row, heading);
        Some(number("VDT steps")? / (number("FH fan steps")? + number("FH edge steps")?))
    });
    let honest = of_rows(adapted, |row| {
        let number = |heading| adapted.number(row, heading);
        Some(number("VDT steps")? / (5.0 * number("FH fan steps")? + number("FH edge steps")?))
    });
    let nodes = quotients(sizes, "VDT internal nodes, K", "FH internal nodes, K");
    let times = quotients(adapted, "VDT adapt, ms", "FH adapt, ms");
    let rates = quotients(adapted, "FH frames a s", "VDT frames a s");
    for (what, said, values) in [
        ("internal nodes", (4.0, 6.0), &nodes),
        ("adapt operations", (3.0, 5.0), &steps),
        ("adaptation time", (2.0, 3.25), &times),
        ("frame rates", (1.2, 2.0), &rates),
    ] {
        let (least, most) = ends(values);
        entry.claims.push(Claim::check(
            &format!("The text says {} to {} times for {what}", said.0, said.1),
            most > said.1 + 0.04 || least > said.0 + 0.5,
            format!("the printed table gives {}", range(values, 1)),
            "",
        ));
    }
    entry.claims.push(Claim::check(
        "Much of the gain in operations is that a fan counts as one",
        ends(&honest).1 < 1.5,
        format!("a fan as five edges, the printed table gives {}", range(&honest, 2)),
        "",
    ));
}

/// Equation 3, at either side of its branch and at two distances.
fn equation(entry: &mut Entry) {
    let epsilon = 0.2;
    let visual =
        |reading| VisualError { eye: Vec3::ZERO, light: Vec3::X, epsilon, scale: 1.0, error_min: 0.0, reading };
    // A small flat patch whose normal has this cosine with the view and looks at the light as much as it can.
    let at = |cosine: f32, distance: f32| {
        let normal = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, -cosine);
        Bound { center: Vec3::Z * distance, radius: 1e-4, error: 1.0, cone: Cone::of_normals(&[normal]) }
    };
    let weight = |bound| f64::from(visual(Reading::Error).excess(&bound, false)) + 1.0;
    let jump = weight(at(epsilon - 0.05, 10.0)) / weight(at(epsilon + 0.05, 10.0));
    entry.claims.push(Claim::check(
        "Equation 3 is discontinuous at the silhouette",
        jump > 2.0,
        format!("its value jumps by a factor of {jump:.1} where |N.D| passes epsilon = {epsilon}; nodes near it flicker, which hysteresis calms (`selective::Hysteresis`)"),
        "",
    ));
    let growth = weight(at(0.6, 20.0)) / weight(at(0.6, 10.0));
    entry.claims.push(Claim::check(
        "Equation 3 grows with distance, though it is called an error that should fall with it",
        growth > 1.5,
        format!("twice as far away it is {growth:.2} times as large; read as a tolerance that is right, but then silhouettes get coarser. Both readings are there (`selective::VisualError`)"),
        "",
    ));
}
