//! Table 2: one wish under three schemes, on images, terrains and surfaces.

use super::models::{NAMES, column};
use super::wish::{SCHEMES, Sizes};
use crate::ledger::{Claim, Entry, LedgerError, Published, Workshop};
use crate::table::Table;
use mt_core::model::cells_of;

/// A column of the paper, which is a row of ours.
struct Row {
    name: &'static str,
    input: Sizes,
    wished: Sizes,
    schemes: [Sizes; 3],
    degenerate: u32,
    as_written_is_least: bool,
    folds: [u32; 3],
}

/// The share of the input's vertices that the paper's answer has.
pub(super) fn printed_share(published: &Published, name: &str) -> Result<f64, LedgerError> {
    let table = published.table("table-2")?;
    let number = |heading| table.number(name, heading).unwrap_or(f64::NAN);
    Ok(number("ours V") / number("input V"))
}

fn measure(
    workshop: &mut Workshop<'_>,
    published: &Published,
    entry: &mut Entry,
    name: &'static str,
) -> Result<Row, LedgerError> {
    let (column, wished) = column(workshop, name, printed_share(published, name)?)?;
    workshop.go_on(name)?;
    entry.models.push(column.subject.told());
    let (mut fronts, mut folds) = (Vec::new(), [0; 3]);
    for (i, (_, scheme)) in SCHEMES.into_iter().enumerate() {
        let (model, state) = wished.state(scheme)?;
        let cells: Vec<_> = cells_of(&model, &state.view.mesh).into_iter().map(|(_, cell)| cell).collect();
        folds[i] = crate::study::folds(&cells, mt_core::MultiTessellation::positions(&model));
        fronts.push(state.front().clone());
    }
    let all = mt_core::Front::reference(wished.replay.len());
    Ok(Row {
        name,
        input: wished.sizes(&all),
        wished: wished.sizes(&wished.nodes),
        schemes: [0, 1, 2].map(|i| wished.sizes(&fronts[i])),
        degenerate: fronts[2].len() - wished.nodes.len(),
        as_written_is_least: wished.as_written()? == fronts[2],
        folds,
    })
}

pub(super) fn table_2(
    workshop: &mut Workshop<'_>,
    published: &Published,
    entry: &mut Entry,
) -> Result<(), LedgerError> {
    let mut rows = Vec::new();
    for name in NAMES {
        rows.push(measure(workshop, published, entry, name)?);
    }
    let mut sizes = Table::new(
        "Measured: vertices and triangles of the input, of the wish if nothing had to be forced, and under each scheme; \
         degenerate cases are the splits that dual pieces force; folds are edges whose triangles look at each other.",
        &[
            "model",
            "#input V",
            "#input F",
            "#wish V",
            "#Xia V",
            "#Xia F",
            "#Hoppe V",
            "#Hoppe F",
            "#ours V",
            "#ours F",
            "#ours DC",
            "#folds Xia",
            "#folds Hoppe",
            "#folds ours",
        ],
    );
    for row in &rows {
        let schemes = row.schemes.iter().flat_map(|sizes| [sizes.vertices, sizes.triangles]);
        let numbers = [row.input.vertices, row.input.triangles, row.wished.vertices].into_iter().chain(schemes);
        let numbers = numbers.chain([row.degenerate as usize]).chain(row.folds.map(|count| count as usize));
        sizes.row([row.name.to_owned()].into_iter().chain(numbers.map(|number| number.to_string())));
    }
    entry.measured.push(sizes);
    let printed = published.table("table-2")?;
    let mut ratios = Table::new(
        "Vertices by those of dual pieces, ours and as printed; and the share of the input.",
        &[
            "model",
            "#Xia / ours",
            "#printed",
            "#Hoppe / ours",
            "#printed",
            "#ours, % of input",
            "#printed",
            "#DC, % of ours",
            "#printed",
        ],
    );
    for row in &rows {
        let number = |heading| printed.number(row.name, heading).unwrap_or(f64::NAN);
        let [xia, hoppe, ours] = row.schemes.map(|sizes| sizes.vertices as f64);
        ratios.row([
            row.name.to_owned(),
            format!("{:.2}", xia / ours),
            format!("{:.2}", number("Xia V") / number("ours V")),
            format!("{:.2}", hoppe / ours),
            format!("{:.2}", number("Hoppe V") / number("ours V")),
            format!("{:.1}", 100.0 * ours / row.input.vertices as f64),
            format!("{:.1}", 100.0 * number("ours V") / number("input V")),
            format!("{:.2}", 100.0 * f64::from(row.degenerate) / ours),
            format!("{:.2}", 100.0 * number("ours DC") / number("ours V")),
        ]);
    }
    entry.measured.push(ratios);
    claims(entry, &rows);
    entry.note("Cameras, thresholds and models of the paper are not given: the angle of our cameras and the number of feature points are set so that dual pieces have the share of the input that they have in print. Feature points are the strongest of the Sobel mask; grey values are an attribute of the quadric.");
    entry.note("What is wished is the same set of nodes for all schemes, with their parents. Frusta are asked of the spheres of nodes, which reach further than their vertices.");
    Ok(())
}

fn claims(entry: &mut Entry, rows: &[Row]) {
    let ordered = rows.iter().filter(|row| {
        let [xia, hoppe, ours] = row.schemes.map(|sizes| sizes.vertices);
        xia >= hoppe && hoppe >= ours
    });
    let ordered = ordered.count();
    entry.claims.push(Claim::check(
        "dual pieces always generate smaller meshes than four faces, and these than the one-ring",
        ordered == rows.len(),
        format!("so in {ordered} of {} columns; the orders are nested, so it cannot be otherwise", rows.len()),
        "",
    ));
    let share = |row: &Row| f64::from(row.degenerate) / row.schemes[2].vertices.max(1) as f64;
    let (least, most) = rows.iter().map(share).fold((f64::MAX, 0.0f64), |(low, high), x| (low.min(x), high.max(x)));
    entry.claims.push(Claim::check(
        "additional splits are few (0.1 to 0.6 % of the vertices)",
        most < 0.0064,
        format!(
            "{:.2} to {:.2} %: fewer, for a wish here takes in all nodes whose sphere may reach the frustum",
            100.0 * least,
            100.0 * most
        ),
        "wishes with long borders meet more coinciding cut vertices, and small meshes have longer borders",
    ));
    let equal = rows.iter().filter(|row| row.as_written_is_least).count();
    entry.claims.push(Claim::check(
        "a split waits only for coinciding cut vertices (as the paper has it, section 4.4)",
        equal == rows.len(),
        format!(
            "forced by the paper's rule, node by node, the front is the one of the static order {{parent, lowest common \
             ancestor of the cut vertices}} in {equal} of {} columns",
            rows.len()
        ),
        "collapses that are put off leave fronts that the static order does not have",
    ));
}
