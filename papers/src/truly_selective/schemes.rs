//! Table 1 and the times: what each scheme stores a node, and how fast splits and collapses are.

use super::models::{BUNNY, quadric};
use crate::bench;
use crate::ledger::{Claim, Entry, LedgerError, Published, Workshop};
use crate::table::Table;
use mt_core::{Hierarchy, Replay, VertexId};
use operators::order::{Scheme, Stored};
use std::sync::Arc;
use std::time::Instant;

/// What the schemes would store of a sequence, in all nodes together.
#[derive(Debug, Default, PartialEq)]
struct Details {
    cut_vertices: usize,
    ring: usize,
    faces: usize,
}

fn details(replay: &Replay) -> Details {
    let mut found = Details::default();
    let mut ring: Vec<VertexId> = Vec::new();
    replay.sweep(|m, view| {
        let ends = replay.ends(m);
        ring.clear();
        ring.extend(ends.into_iter().flat_map(|end| view.mesh.ring(end)).filter(|w| !ends.contains(w)));
        ring.sort_unstable();
        ring.dedup();
        found.ring += ring.len();
        found.cut_vertices += replay.born(m).len();
        let faces = &view.mesh.faces;
        for cell in replay.born(m) {
            let apex = faces.cell(cell.0).iter().find(|w| !ends.contains(w));
            let beside = |end: &VertexId| {
                let mut star = faces.star(*end);
                star.any(|(slot, _)| slot != cell.0 && apex.is_some_and(|apex| faces.cell(slot).contains(apex)))
            };
            found.faces += ends.iter().filter(|end| beside(end)).count();
        }
    });
    found
}

pub(super) fn table_1(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&BUNNY)?;
    entry.models.push(subject.told());
    let replay = workshop.sequence(&subject, &quadric())?.replay;
    let nodes = f64::from(replay.len().max(1));
    let details = details(&replay);
    let rows = [
        ("Hoppe 96", Scheme::CutPair, details.cut_vertices),
        ("Xia, Varshney", Scheme::OneRing, details.ring),
        ("Hoppe 97", Scheme::FourFace, details.faces),
        ("El-Sana, Varshney", Scheme::ImplicitIds, 2 * replay.len() as usize),
        ("Kim, Lee", Scheme::DualPiece, details.cut_vertices),
    ];
    let mut table = Table::new(
        "Measured: entries a node as the paper tells the schemes, and what our static orders store of them: the needs that \
         neither the forest nor another need implies.",
        &["scheme", "order", "#entries a node", "#stored needs a node", "#bytes a node", "#nodes with a need, %"],
    );
    let mut stored_needs = Vec::new();
    for (name, scheme, entries) in rows {
        let stored = scheme.stored(&replay).map_err(|error| LedgerError::Hierarchy(name.into(), error))?;
        let needs = stored.as_ref().map(needs);
        stored_needs.push(needs.map_or(0.0, |(needs, _)| needs as f64 / nodes));
        let bytes = stored.as_ref().map_or(0, mt_core::hierarchy::Dependency::bytes) as f64;
        table.row([
            name.to_owned(),
            scheme.name().to_owned(),
            format!("{:.2}", entries as f64 / nodes),
            format!("{:.3}", stored_needs.last().copied().unwrap_or(0.0)),
            format!("{:.2}", bytes / nodes),
            needs.map_or("0".into(), |(_, rows)| format!("{:.1}", 100.0 * rows as f64 / nodes)),
        ]);
    }
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "the earlier schemes keep entities of the simplified meshes, the new one two vertices of the input",
        details.cut_vertices <= 2 * replay.len() as usize,
        format!(
            "two entries at most, {:.2} on the average, one at boundaries. As a static order the two are worth one need, \
             their lowest common ancestor, which the forest mostly implies: {:.3} stored a node against {:.2} of the one-ring",
            details.cut_vertices as f64 / nodes,
            stored_needs[4],
            stored_needs[1]
        ),
        "",
    ));
    entry.claims.push(Claim::check(
        "fewer conditions, fewer needs: one-ring, four faces, dual pieces",
        stored_needs[1] > stored_needs[2] && stored_needs[2] > stored_needs[4],
        format!("{:.2}, {:.2}, {:.3} stored a node", stored_needs[1], stored_needs[2], stored_needs[4]),
        "",
    ));
    entry.note("implicit-ids is a rule on the numbers of current neighbours here; the least and largest ids, stored as this paper tells it, are unsound (`mtess info` and the documentation of `implicit-ids-stored`).");
    Ok(())
}

/// Needs stored, and nodes that have one.
fn needs(stored: &Stored) -> (usize, usize) {
    let mut nodes: Vec<_> = stored.needs_rows().entries().map(|(m, _)| m).collect();
    let count = nodes.len();
    nodes.dedup();
    (count, nodes.len())
}

pub(super) fn times(workshop: &mut Workshop<'_>, published: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&BUNNY)?;
    entry.models.push(subject.told());
    let replay = workshop.sequence(&subject, &quadric())?.replay;
    let dependency = Stored::dual_piece(&replay).map_err(|error| LedgerError::Hierarchy("dual-piece".into(), error))?;
    let model = Hierarchy { replay: Arc::clone(&replay), dependency };
    let begun = Instant::now();
    let steps = bench::steps(&model, &|| begun.elapsed().as_secs_f64());
    let printed = published.table("times")?;
    let number = |row| printed.number(row, "ms").unwrap_or(f64::NAN);
    let [split, collapse] = [steps.refine_per_s, steps.coarsen_per_s].map(|rate| 1e3 / rate);
    let mut table = Table::new(
        "Measured: dual pieces, all nodes refined and coarsened again by rank, tests included; the best of three.",
        &["transformation", "#ms", "#printed, ms", "#times faster"],
    );
    for (name, ms) in [("vsplit", split), ("ecol", collapse)] {
        table.row([
            name.to_owned(),
            format!("{ms:.6}"),
            format!("{}", number(name)),
            format!("{:.0}", number(name) / ms),
        ]);
    }
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "a split takes a little longer than a collapse, 1.3 times: finding the cut vertices is no strong overhead",
        split > collapse && split < 3.0 * collapse,
        format!("{:.2} times", split / collapse),
        "the machine is noisy, and both walk the same stars",
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truly_selective::chain::chain;

    #[test]
    fn entries_are_those_of_the_chain() {
        let (mesh, sequence) = chain(3);
        let replay = Replay::new(&mesh, &[], &sequence).unwrap();
        // Two cut vertices and four faces each; six neighbours of the edges, where rows below have become one vertex less one.
        assert_eq!(details(&replay), Details { cut_vertices: 6, ring: 8 + 7 + 7, faces: 12 });
    }
}
