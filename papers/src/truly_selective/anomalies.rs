//! What we noticed in the paper: its Table 2 against arithmetic and against another paper, and flips.

use super::models::column;
use super::table_2::printed_share;
use super::wish::SCHEMES;
use crate::ledger::{Claim, Entry, LedgerError, Published, Workshop};
use crate::study::folds;
use mt_core::MultiTessellation;
use mt_core::model::cells_of;
use operators::order::Scheme;

pub(super) fn run(workshop: &mut Workshop<'_>, published: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let table = published.table("table-2")?;
    let too_many: Vec<String> =
        [("Xia V", "Xia F"), ("Hoppe V", "Hoppe F"), ("ours V", "ours F"), ("input V", "input F")]
            .into_iter()
            .map(|(vertices, faces)| Ok((vertices, table.column(vertices)?, table.column(faces)?)))
            .collect::<Result<Vec<_>, LedgerError>>()?
            .into_iter()
            .flat_map(|(heading, vertices, faces)| {
                let wrong = (0..vertices.len()).filter(|&i| faces[i] > 2.0 * vertices[i]).collect::<Vec<_>>();
                wrong.into_iter().map(move |i| (heading, i, vertices[i], faces[i]))
            })
            .map(|(heading, i, vertices, faces)| {
                format!("{}, {heading}: {faces} faces on {vertices} vertices", table.rows[i][0])
            })
            .collect();
    entry.claims.push(Claim::check(
        "a mesh has more faces than twice its vertices, which a sheet or a sphere cannot have",
        !too_many.is_empty(),
        format!("{}; 20105 may be meant", too_many.join("; ")),
        "",
    ));
    let row = |name: &str| table.rows.iter().find(|row| row[0].to_string() == name);
    let differing = row("Cow").zip(row("Horse")).map_or(Vec::new(), |(cow, horse)| {
        (1..cow.len()).filter(|&i| cow[i] != horse[i]).map(|i| table.columns[i].clone()).collect()
    });
    let cow = crate::strips::PAPER.published()?.table("table-1")?.number("Cow", "vertices")?;
    entry.claims.push(Claim::check(
        "the columns of Cow and Horse are equal but for the degenerate cases",
        differing == ["ours DC"],
        format!(
            "two models of one size, under three schemes each: one column is a copy. The cow of the strips paper has {cow} \
             vertices, so it seems to be Cow's that is one"
        ),
        "",
    ));
    let (horse, wished) = column(workshop, "Horse", printed_share(published, "Horse")?)?;
    let folds_at = |state_of: Scheme| -> Result<u32, LedgerError> {
        let (model, state) = wished.state(state_of)?;
        let cells: Vec<_> = cells_of(&model, &state.view.mesh).into_iter().map(|(_, cell)| cell).collect();
        Ok(folds(&cells, model.positions()))
    };
    let own = folds(&horse.subject.mesh.cells, &horse.subject.mesh.positions);
    let counts = SCHEMES.into_iter().map(|(_, scheme)| folds_at(scheme)).collect::<Result<Vec<_>, _>>()?;
    entry.models.push(horse.subject.told());
    entry.claims.push(Claim::check(
        "flips are left open: the scheme itself could generate a flipped triangle",
        counts[2] > counts[1] && counts[2] > own,
        format!(
            "folds in the meshes of Horse: {} under the one-ring, {} under four faces, {} under dual pieces, {own} in the input. A \
             mesh stays a valid complex; whoever minds adds a criterion that refines there (`selective::NormalChange`)",
            counts[0], counts[1], counts[2]
        ),
        "this mesh has none that the others have not",
    ));
    Ok(())
}
