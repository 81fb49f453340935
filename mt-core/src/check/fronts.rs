//! Random closed fronts, of all sizes and shapes, from a seed.

use crate::front::Front;
use crate::id::NodeId;
use crate::order::Order;
use crate::random::Random;

/// A random closed front: the closure of a few random nodes, or the reference less a few random nodes and all that
/// need them. O(nodes + arcs).
pub fn random_front(order: &Order, random: &mut Random) -> Front {
    let count = order.len();
    if count == 0 {
        return Front::base(0);
    }
    // Few nodes as often as many: the exponent is uniform.
    let picks = (f64::from(count).powf(random.unit()) as u32).max(1);
    // A biased rank makes fronts that stay near the base mesh and ones that reach the input.
    let skew = 1.0 + 3.0 * random.unit();
    let from_top = random.below(2) == 0;
    let pick = |random: &mut Random| {
        let rank = (random.unit().powf(skew) * f64::from(count)) as u32;
        NodeId(if from_top { count - 1 - rank.min(count - 1) } else { rank.min(count - 1) })
    };
    if random.below(2) == 0 {
        let mut front = Front::from_nodes(count, (0..picks).map(|_| pick(random)));
        order.close(&mut front);
        return front;
    }
    let mut front = Front::reference(count);
    for _ in 0..picks {
        front.set(pick(random), false);
    }
    // Coarsest first: a node stays only while all that it needs does.
    for m in (0..count).rev().map(NodeId) {
        if order.needs(m).iter().any(|&need| !front.is_refined(need)) {
            front.set(m, false);
        }
    }
    front
}
