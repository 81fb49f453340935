//! The queue of sites by price: buckets of nearly equal prices, sorted when their turn comes.
//!
//! A site with a new price is a new site, so nothing is ever moved within the queue by name, and what leaves it is in
//! exact order. Measured on scans of a hundred thousand triangles, where a heap of all sites does not fit the cache: a
//! binary heap of prices and sites took half of all analysis, a four-ary heap of eight-byte entries a third of it, this
//! a twentieth.

/// Sites by price (as `f32`), equal prices by site.
pub(super) struct Queue<S> {
    /// One for each value of the price's upper bits: prices within a bucket differ by less than a hundredth.
    buckets: Vec<Vec<(u32, S)>>,
    /// No bucket below holds anything.
    lowest: usize,
    /// The bucket that is sorted, lowest last.
    current: usize,
}

/// Bits of a price that choose within a bucket; the sign bit is never set.
const LOWER_BITS: u32 = 16;
const BUCKETS: usize = 1 << (31 - LOWER_BITS);

impl<S: Copy + Ord> Queue<S> {
    pub(super) fn new(priced: impl Iterator<Item = (f64, S)>) -> Self {
        let buckets = std::iter::repeat_with(Vec::new).take(BUCKETS).collect();
        let mut queue = Self { buckets, lowest: 0, current: usize::MAX };
        priced.for_each(|(price, site)| queue.push(price, site));
        queue
    }

    pub(super) fn push(&mut self, price: f64, site: S) {
        let entry = (key(price), site);
        let b = (entry.0 >> LOWER_BITS) as usize;
        let bucket = &mut self.buckets[b];
        if b == self.current {
            let at = bucket.partition_point(|other| *other > entry);
            bucket.insert(at, entry);
        } else {
            bucket.push(entry);
        }
        self.lowest = self.lowest.min(b);
    }

    pub(super) fn pop(&mut self) -> Option<S> {
        while self.buckets.get(self.lowest)?.is_empty() {
            self.lowest += 1;
        }
        let bucket = &mut self.buckets[self.lowest];
        if self.lowest != self.current {
            bucket.sort_unstable_by(|a, b| b.cmp(a));
            self.current = self.lowest;
        }
        bucket.pop().map(|(_, site)| site)
    }
}

/// Bits that order as prices do. Prices below 0 count as 0, what is not a number as the highest.
fn key(price: f64) -> u32 {
    if price.is_nan() { f32::INFINITY.to_bits() } else { (price.max(0.0) as f32).to_bits() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Prices over many buckets, and several in one.
    fn price() -> impl Strategy<Value = f64> {
        prop_oneof![0f64..10.0, 1f64..1.005, Just(0.0), Just(f64::INFINITY), 1e-30f64..1e-20]
    }

    proptest! {
        #[test]
        fn comes_out_sorted(start in prop::collection::vec(price(), 0..40), later in prop::collection::vec(price(), 0..80)) {
            let entry = |i: usize, price: f64| (key(price), i);
            let mut kept: Vec<_> = start.iter().enumerate().map(|(i, &p)| entry(i, p)).collect();
            let mut queue = Queue::new(start.iter().enumerate().map(|(i, &p)| (p, i)));
            for (i, price) in later.into_iter().enumerate() {
                kept.sort_unstable();
                let least = (!kept.is_empty()).then(|| kept.remove(0).1);
                prop_assert_eq!(queue.pop(), least);
                queue.push(price, 1000 + i);
                kept.push(entry(1000 + i, price));
            }
            kept.sort_unstable();
            let rest: Vec<usize> = std::iter::from_fn(|| queue.pop()).collect();
            prop_assert_eq!(rest, kept.into_iter().map(|(_, i)| i).collect::<Vec<_>>());
        }
    }
}
