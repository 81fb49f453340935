//! Making a front simple: it moves towards the base mesh or the reference, by closed sets, while the same law stays broken.

use mt_core::check::Breach;
use mt_core::{Front, NodeId, Order};
use std::time::{Duration, Instant};

/// Shrinking a front stops after this at the latest.
const FRONT_TIME_MAX: Duration = Duration::from_secs(12);
/// And making a case small after this.
const CASE_TIME_MAX: Duration = Duration::from_secs(40);

/// When to stop making a case small.
pub(super) fn deadline() -> Instant {
    Instant::now() + CASE_TIME_MAX
}

/// A closed front nearest to the base mesh or to the reference, whichever is nearer, at which `broken` tells of the same
/// law as `breach`; and what it tells there.
pub(super) fn simplest(
    order: &Order,
    found: &Front,
    breach: Breach,
    broken: impl Fn(&Front) -> Option<Breach>,
) -> (Front, Breach) {
    let down = descend(order, found, &breach, &broken, &|front| front.clone(), &without);
    let others = |front: &Front| {
        let coarse = (0..order.len()).map(NodeId).filter(|&m| !front.is_refined(m));
        Front::from_nodes(order.len(), coarse)
    };
    let up = descend(order, found, &breach, &broken, &others, &with);
    if order.len() - up.0.len() < down.0.len() { up } else { down }
}

/// Changes the nodes that `rest` names, in chunks, as long as fewer are left by it.
fn descend(
    order: &Order,
    found: &Front,
    breach: &Breach,
    broken: &impl Fn(&Front) -> Option<Breach>,
    rest: &dyn Fn(&Front) -> Front,
    change: &dyn Fn(&Order, &Front, &[NodeId]) -> Front,
) -> (Front, Breach) {
    let deadline = Instant::now() + FRONT_TIME_MAX;
    let (mut front, mut breach) = (found.clone(), breach.clone());
    let mut chunk = rest(&front).len().div_ceil(2).max(1);
    while chunk > 0 && Instant::now() < deadline {
        let mut shrunk = false;
        let members: Vec<NodeId> = rest(&front).finest_first().collect();
        for part in members.chunks(chunk as usize) {
            let candidate = change(order, &front, part);
            if candidate == front || Instant::now() >= deadline {
                continue;
            }
            if let Some(again) = broken(&candidate).filter(|again| again.law == breach.law) {
                (front, breach, shrunk) = (candidate, again, true);
            }
        }
        chunk = if shrunk { chunk.min(rest(&front).len()) } else { chunk / 2 };
    }
    (front, breach)
}

/// The front with these nodes and all that they need.
fn with(order: &Order, front: &Front, nodes: &[NodeId]) -> Front {
    let mut larger = front.clone();
    nodes.iter().for_each(|&m| _ = larger.set(m, true));
    order.close(&mut larger);
    larger
}

/// The front less these nodes and all that need them.
pub(super) fn without(order: &Order, front: &Front, nodes: &[NodeId]) -> Front {
    let mut smaller = front.clone();
    let mut gone: Vec<NodeId> = nodes.to_vec();
    while let Some(m) = gone.pop() {
        if smaller.set(m, false) {
            gone.extend(order.dependents(m).iter().copied().filter(|&d| smaller.is_refined(d)));
        }
    }
    smaller
}
