//! Random closed fronts, of all sizes and shapes, from a seed.

use crate::front::Front;
use crate::id::NodeId;
use crate::order::Order;

/// A small generator of random numbers whose sequence never changes (SplitMix64).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The generator of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// A number below `bound`; 0 for a bound of 0.
    pub fn below(&mut self, bound: u32) -> u32 {
        ((self.next_u64() >> 32) * u64::from(bound) >> 32) as u32
    }

    /// A number in `0.0..1.0`.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A random closed front: the closure of a few random nodes, or the reference less a few random nodes and all that
/// need them. O(nodes / 64 + arcs of the front).
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
    let mut pick = |random: &mut Random| {
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
