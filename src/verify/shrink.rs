//! Making a counterexample small: fronts shrink towards the base mesh, by closed sets, while the same law stays broken.

use super::{Counterexample, Laws, Summary, finish};
use mt_core::check::{Breach, Random};
use mt_core::{Front, NodeId};
use selective::{State, approach};
use std::time::{Duration, Instant};

/// Shrinking stops here at the latest.
const TIME_MAX: Duration = Duration::from_secs(30);

/// The smallest front found at which the law of `breach` is broken, with the same random choices.
pub(super) fn counterexample<const N: usize>(
    laws: &Laws<'_, N>,
    breach: Breach,
    found: &Front,
    case: &Random,
) -> Counterexample<N> {
    let deadline = Instant::now() + TIME_MAX;
    let (mut front, mut breach) = (found.clone(), breach);
    let mut chunk = front.len().div_ceil(2).max(1);
    while chunk > 0 && Instant::now() < deadline {
        let mut shrunk = false;
        let members: Vec<NodeId> = front.finest_first().collect();
        for part in members.chunks(chunk as usize) {
            let candidate = without(laws, &front, part);
            if candidate.len() == front.len() || Instant::now() >= deadline {
                continue;
            }
            if let Some(again) = broken(laws, &candidate, case).filter(|again| again.law == breach.law) {
                (front, breach, shrunk) = (candidate, again, true);
            }
        }
        chunk = if shrunk { chunk.min(front.len()) } else { chunk / 2 };
    }
    finish(laws.model, breach, front, found.len())
}

/// The front less these nodes and all that need them.
fn without<const N: usize>(laws: &Laws<'_, N>, front: &Front, nodes: &[NodeId]) -> Front {
    let mut smaller = front.clone();
    let mut gone: Vec<NodeId> = nodes.to_vec();
    while let Some(m) = gone.pop() {
        if smaller.set(m, false) {
            gone.extend(laws.order.dependents(m).iter().copied().filter(|&d| smaller.is_refined(d)));
        }
    }
    smaller
}

fn broken<const N: usize>(laws: &Laws<'_, N>, front: &Front, case: &Random) -> Option<Breach> {
    let mut state = State::new(laws.model, ());
    approach(laws.model, front, &mut state);
    laws.at(&mut state.view, &mut case.clone(), &mut Summary::new()).err()
}
