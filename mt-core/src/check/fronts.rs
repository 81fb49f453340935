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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::order::Rows;

    /// Fronts are closed, and of all sizes: near the base mesh, near the input, and in between.
    #[test]
    fn fronts_are_closed_and_of_all_sizes() {
        let count = 60u32;
        let mut rows = Rows::default();
        (0..count)
            .for_each(|m| rows.push([m + 1, m + 7].into_iter().filter(|&need| need < count && m % 3 > 0).map(NodeId)));
        let order = Order::from_needs(rows).unwrap();
        let mut random = Random::new(5);
        let mut sizes = [0; 4];
        for _ in 0..400 {
            let front = random_front(&order, &mut random);
            assert!(order.is_closed(&front));
            sizes[(front.len() * 4 / (count + 1)) as usize] += 1;
        }
        assert!(sizes.iter().all(|&of_size| of_size > 20), "{sizes:?}");
        assert!(random_front(&Order::from_needs(Rows::default()).unwrap(), &mut random).is_empty());
    }
}
