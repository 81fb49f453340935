//! Figure 2: a sequence in which four faces make the split of one vertex refine everything.
//!
//! In a triangulated grid the horizontal edges of one column collapse, row after row upwards. Each takes the triangle above
//! its edge, whose neighbour dies in the next row. So the first merge, which is the last to be undone, has its four faces
//! only when all rows are split.

use super::wish::Wished;
use crate::ledger::{Claim, Entry, LedgerError, Published, Workshop};
use crate::table::Table;
use glam::Vec3;
use mt_core::hierarchy::HierarchyError;
use mt_core::{Mesh, NodeId, Replay, Sequence, VertexId};
use operators::order::Scheme;
use std::sync::Arc;

const COLUMNS: u32 = 4;

/// The grid and the collapses of `rows` edges in its middle column.
pub(super) fn chain(rows: u32) -> (Mesh<3>, Sequence) {
    let at = |x: u32, y: u32| VertexId(y * COLUMNS + x);
    let mut mesh = Mesh { positions: Vec::new(), cells: Vec::new() };
    for y in 0..rows + 2 {
        mesh.positions.extend((0..COLUMNS).map(|x| Vec3::new(x as f32, y as f32, 0.0)));
    }
    for y in 0..rows + 1 {
        for x in 0..COLUMNS - 1 {
            mesh.cells.push([at(x, y), at(x + 1, y), at(x, y + 1)]);
            mesh.cells.push([at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]);
        }
    }
    let mut sequence = Sequence::new(&mesh);
    for y in 1..=rows {
        let place = Vec3::new(1.5, y as f32, 0.0);
        sequence.push(at(1, y), [at(2, y)], [y as f32 * 0.01], place, false);
    }
    (mesh, sequence)
}

/// How many nodes each scheme refines to split the vertex that was made first.
pub(super) fn splits(rows: u32) -> Result<Vec<(Scheme, u32)>, LedgerError> {
    let (mesh, sequence) = chain(rows);
    let replay = Replay::new(&mesh, &[], &sequence)
        .map_err(|error| LedgerError::Hierarchy("the chain".into(), HierarchyError::from(error)))?;
    let wished = Wished::new(Arc::new(replay), [NodeId(0)]);
    let schemes = [Scheme::OneRing, Scheme::CutPair, Scheme::FourFace, Scheme::DualPiece];
    schemes.into_iter().map(|scheme| Ok((scheme, wished.closed(scheme)?.len()))).collect()
}

pub(super) fn figure_2(_: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let mut table = Table::new(
        "Measured: nodes that are refined to split the vertex that was made first.",
        "#collapses | #one-ring | #cut-pair | #four-face | #dual-piece",
    );
    let mut holds = true;
    for rows in [5, 50, 500] {
        let splits = splits(rows)?;
        holds &= splits.iter().all(|&(scheme, count)| count == if scheme == Scheme::DualPiece { 1 } else { rows });
        table.row([rows].into_iter().chain(splits.iter().map(|split| split.1)));
    }
    entry.measured.push(table);
    entry.models.push("generated: the horizontal edges of one column of a grid, collapsed row by row".into());
    entry.claims.push(Claim::check(
        "to split one vertex, four faces may refine the base mesh up to the original; the new scheme splits it alone",
        holds,
        "four faces refine all nodes there are, and so do one-ring and the two cut vertices; dual pieces one",
        "",
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chain_is_as_long_as_the_grid_is_high() {
        let lengths: Vec<u32> = splits(7).unwrap().into_iter().map(|(_, count)| count).collect();
        assert_eq!(lengths, [7, 7, 7, 1]);
    }
}
