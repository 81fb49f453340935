//! The implicit dependency rule: as the slide has it, as it is meant, and what order it amounts to.

use crate::ledger::{COW, Claim, Entry, LedgerError, Published, Workshop, edge_collapse};
use crate::table::Table;
use mt_core::check::{self, Random};
use mt_core::{Front, Hierarchy, NodeId, Replay};
use operators::order::{ImplicitIds, Stored};
use selective::State;
use std::sync::Arc;

/// Of the merges of the analysis itself: how many the slide's rule allows, how many the rule about parents does, and how
/// many of their splits the rule on splits does.
pub(crate) fn allowed(replay: &Replay) -> [u32; 3] {
    let mut counts = [0; 3];
    replay.sweep(|m, view| {
        let ends = replay.ends(m);
        let ring = || ends.into_iter().flat_map(|end| view.mesh.ring(end)).filter(|w| !ends.contains(w));
        let parent = replay.leaf_count() + m.0;
        let id = |w| replay.latest(w, &view.front).map_or(w.0, |node: NodeId| replay.leaf_count() + node.0);
        counts[0] += u32::from(ring().all(|w| parent < id(w)));
        counts[1] += u32::from(ring().all(|w| m < replay.next(w, &view.front)));
        counts[2] += u32::from(ring().all(|w| parent > id(w)));
    });
    counts
}

/// Forces wishes of a few nodes under the rule, and closes them under two orders: how often all three are one.
fn agreeing(replay: &Arc<Replay>, wishes: u32) -> Result<[u32; 2], LedgerError> {
    let implicit = Hierarchy { replay: Arc::clone(replay), dependency: ImplicitIds };
    let orders = [Stored::explicit(replay), Stored::one_ring(replay)]
        .map(|dependency| check::order_of(&Hierarchy { replay: Arc::clone(replay), dependency }));
    let mut random = Random::new(11);
    let mut agree = [0, 0];
    for _ in 0..wishes {
        let nodes: Vec<NodeId> = (0..8).map(|_| NodeId::new(random.below(replay.len() as usize))).collect();
        let mut state = State::new(&implicit, ());
        nodes.iter().for_each(|&m| state.force(&implicit, m));
        for (count, order) in agree.iter_mut().zip(&orders) {
            let order = order.as_ref().map_err(|breach| LedgerError::Data(breach.to_string()))?;
            let mut front = Front::from_nodes(replay.len(), nodes.iter().copied());
            order.close(&mut front);
            *count += u32::from(front == *state.front());
        }
    }
    Ok(agree)
}

pub(super) fn implicit_ids(workshop: &mut Workshop<'_>, _: &Published, entry: &mut Entry) -> Result<(), LedgerError> {
    let subject = workshop.subject(&COW)?;
    entry.models.push(subject.told());
    let replay = workshop.sequence(&subject, &edge_collapse())?.replay;
    let [slide, parents, splits] = allowed(&replay);
    let wishes = workshop.pick(100, 10);
    let [cells, ring] = agreeing(&replay, wishes)?;
    let mut table = Table::new("Measured", "what | #of | #count");
    let merges = replay.len();
    table.row([
        "merges of the analysis that the slide's rule allows".to_owned(),
        merges.to_string(),
        slide.to_string(),
    ]);
    table.row([
        "the same, neighbours' parents instead of neighbours".to_owned(),
        merges.to_string(),
        parents.to_string(),
    ]);
    table.row([
        "splits that undo them and that the slide's rule allows".to_owned(),
        merges.to_string(),
        splits.to_string(),
    ]);
    table.row([
        "random wishes whose front is that of the cells' order".to_owned(),
        wishes.to_string(),
        cells.to_string(),
    ]);
    table.row(["random wishes whose front is that of the one-ring".to_owned(), wishes.to_string(), ring.to_string()]);
    entry.measured.push(table);
    entry.claims.push(Claim::check(
        "a pair may merge when its parent's id is less than the ids of the neighbours",
        slide == merges,
        format!("that allows {slide} of the {merges} merges that made the hierarchy"),
        "ids grow with the merges, so the parent's is the largest there is when the merge is made. Meant are the neighbours' \
         parents",
    ));
    entry.claims.push(Claim::check(
        "a vertex may split when its id is greater than the ids of all its neighbours",
        splits == merges,
        format!("that allows {splits} of the {merges} splits that undo them"),
        "",
    ));
    entry.claims.push(
        Claim::check(
            "read with the neighbours' parents the rule allows every merge of the analysis",
            parents == merges,
            format!("{parents} of {merges}"),
            "",
        )
        .ours(),
    );
    entry.claims.push(Claim::check(
        "dependency lists are eliminated: the ids say the same",
        cells == wishes && ring == wishes,
        format!(
            "for full collapses of a manifold, with new ids, the fronts are those of the cells' order in {cells} and of the \
             one-ring in {ring} of {wishes} wishes"
        ),
        "",
    ));
    Ok(())
}
