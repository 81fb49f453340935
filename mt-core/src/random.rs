//! Randomness without a dependency, whose sequence never changes: the same seed tells the same story for ever.

/// SplitMix64: 8 bytes of state, every seed good, the same sequence everywhere.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The generator that starts at `seed`.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        scramble(self.state)
    }

    /// A number in `0..end`; 0 where `end` is 0. The bias is below `end / 2^64`.
    pub fn below(&mut self, end: usize) -> usize {
        ((u128::from(self.bits()) * end as u128) >> 64) as usize
    }

    /// A number in [0, 1), with 53 random bits.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// The finaliser of SplitMix64: every bit of `x` moves every bit of the result.
pub(crate) fn scramble(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_in_their_range_and_spread_over_it() {
        let mut random = Random::new(3);
        let between: Vec<f64> = (0..1000).map(|_| random.between(-2.0, 6.0)).collect();
        assert!(between.iter().all(|x| (-2.0..6.0).contains(x)));
        let mean = between.iter().sum::<f64>() / 1000.0;
        assert!((mean - 2.0).abs() < 0.3, "{mean}");
        assert!(between.iter().any(|&x| x < -1.5) && between.iter().any(|&x| x > 5.5));
        assert!((0..100).all(|_| random.below(3) < 3) && random.below(0) == 0);
    }

    #[test]
    fn a_seed_tells_the_same_story_for_ever() {
        // The first numbers of SplitMix64, as published with it, for seed 1234567.
        let mut random = Random::new(1_234_567);
        assert_eq!([random.bits(), random.bits()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }
}
