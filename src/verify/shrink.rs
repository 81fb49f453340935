//! Making a counterexample small: fronts shrink towards the base mesh, by closed sets, while the same law stays broken.

use mt_core::check::Breach;
use mt_core::{Front, NodeId, Order};
use std::time::{Duration, Instant};

/// Shrinking stops here at the latest.
const TIME_MAX: Duration = Duration::from_secs(30);

/// The smallest closed front found at which `broken` tells of the same law as `breach`, and what it tells there.
pub(super) fn smallest(
    order: &Order,
    found: &Front,
    breach: Breach,
    broken: impl Fn(&Front) -> Option<Breach>,
) -> (Front, Breach) {
    let deadline = Instant::now() + TIME_MAX;
    let (mut front, mut breach) = (found.clone(), breach);
    let mut chunk = front.len().div_ceil(2).max(1);
    while chunk > 0 && Instant::now() < deadline {
        let mut shrunk = false;
        let members: Vec<NodeId> = front.finest_first().collect();
        for part in members.chunks(chunk as usize) {
            let candidate = without(order, &front, part);
            if candidate.len() == front.len() || Instant::now() >= deadline {
                continue;
            }
            if let Some(again) = broken(&candidate).filter(|again| again.law == breach.law) {
                (front, breach, shrunk) = (candidate, again, true);
            }
        }
        chunk = if shrunk { chunk.min(front.len()) } else { chunk / 2 };
    }
    (front, breach)
}

/// The front less these nodes and all that need them.
fn without(order: &Order, front: &Front, nodes: &[NodeId]) -> Front {
    let mut smaller = front.clone();
    let mut gone: Vec<NodeId> = nodes.to_vec();
    while let Some(m) = gone.pop() {
        if smaller.set(m, false) {
            gone.extend(order.dependents(m).iter().copied().filter(|&d| smaller.is_refined(d)));
        }
    }
    smaller
}
