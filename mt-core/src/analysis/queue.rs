//! The queue of sites by price: buckets of nearly equal prices, first come, first served within each.
//!
//! A site with a new price is a new site, so nothing is ever moved within the queue by name. Prices within a bucket, which
//! are squared distances, differ by less than an eighth; on the armadillo the error at a tenth of the triangles is two
//! hundredths larger than with exact order. Taking turns among equals keeps flat parts, where all prices are zero, from
//! being eaten up from one corner. In profiles of its analysis, where a heap of all sites does not fit the cache, sinking
//! in a four-ary heap of eight-byte entries took 13 to 17 % of the time; these buckets take about 5 %.

/// Sites by price, to within an eighth, and by age.
pub(super) struct Queue<S> {
    /// One for each value of the price's upper bits.
    buckets: Vec<Bucket<S>>,
    /// No bucket below holds anything.
    lowest: usize,
}

struct Bucket<S> {
    sites: Vec<S>,
    /// How many have left.
    head: usize,
}

/// Bits of a price, as `f32`, that do not matter; the sign bit is never set.
const LOWER_BITS: u32 = 20;
/// One for each value of the bits that do.
const BUCKETS: usize = 1 << (31 - LOWER_BITS);

impl<S: Copy> Queue<S> {
    pub(super) fn new(priced: impl Iterator<Item = (f64, S)>) -> Self {
        let empty = || Bucket { sites: Vec::new(), head: 0 };
        let mut queue = Self { buckets: std::iter::repeat_with(empty).take(BUCKETS).collect(), lowest: 0 };
        priced.for_each(|(price, site)| queue.push(price, site));
        queue
    }

    pub(super) fn push(&mut self, price: f64, site: S) {
        let b = bucket_of(price);
        self.buckets[b].sites.push(site);
        self.lowest = self.lowest.min(b);
    }

    /// The cheapest site, if its price is not above `most`, to within a bucket.
    pub(super) fn pop_until(&mut self, most: f64) -> Option<S> {
        let end = bucket_of(most) + 1;
        while self.lowest < end {
            let bucket = self.buckets.get_mut(self.lowest)?;
            if let Some(&site) = bucket.sites.get(bucket.head) {
                bucket.head += 1;
                return Some(site);
            }
            bucket.sites.clear();
            bucket.head = 0;
            self.lowest += 1;
        }
        None
    }

    /// How many sites wait in each bucket.
    pub(super) fn counts(&self) -> Vec<usize> {
        self.buckets.iter().map(|bucket| bucket.sites.len() - bucket.head).collect()
    }
}

/// Of the sites that are dearer than `above`, the price that half of them do not exceed, to within a bucket.
pub(super) fn median_above(counts: &[usize], above: f64) -> Option<f64> {
    let from = if above < 0.0 { 0 } else { bucket_of(above) + 1 };
    let dearer = counts.get(from..).filter(|dearer| dearer.iter().any(|&count| count > 0))?;
    let half = dearer.iter().sum::<usize>().div_ceil(2);
    let mut passed = 0;
    let bucket = dearer.iter().position(|count| {
        passed += count;
        passed >= half
    })?;
    Some(f64::from(f32::from_bits(((from + bucket) as u32) << LOWER_BITS)))
}

/// Buckets order as prices do. Prices below 0 count as 0, what is not a number as the highest.
fn bucket_of(price: f64) -> usize {
    let price = if price.is_nan() { f32::INFINITY } else { price.max(0.0) as f32 };
    (price.to_bits() >> LOWER_BITS) as usize
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
        fn comes_out_by_bucket_and_age(start in prop::collection::vec(price(), 0..40), later in prop::collection::vec(price(), 0..80)) {
            let mut kept: Vec<_> = start.iter().enumerate().map(|(i, &p)| (bucket_of(p), i)).collect();
            let mut queue = Queue::new(start.iter().enumerate().map(|(i, &p)| (p, i)));
            for (i, price) in later.into_iter().enumerate() {
                kept.sort_unstable();
                let least = (!kept.is_empty()).then(|| kept.remove(0).1);
                prop_assert_eq!(queue.pop_until(f64::INFINITY), least);
                queue.push(price, 1000 + i);
                kept.push((bucket_of(price), 1000 + i));
            }
            kept.sort_unstable();
            let rest: Vec<usize> = std::iter::from_fn(|| queue.pop_until(f64::INFINITY)).collect();
            prop_assert_eq!(rest, kept.into_iter().map(|(_, i)| i).collect::<Vec<_>>());
        }
    }

    #[test]
    fn half_of_the_sites_are_not_above_the_median() {
        let queue = |prices: &[f64]| Queue::new(prices.iter().map(|&p| (p, ())));
        let median = |prices: &[f64], above| median_above(&queue(prices).counts(), above);
        assert_eq!(median(&[], -1.0), None);
        assert_eq!(median(&[0.0, 0.0, 5.0], -1.0), Some(0.0));
        assert_eq!(median(&[0.0, 0.0], 0.0), None);
        for above in [-1.0, 0.0, 0.5] {
            let middle = median(&[1.0, 2.0, 4.0, 1e9, 0.0], above).unwrap();
            assert!((1.77..=2.0).contains(&middle), "{middle} above {above}");
        }
        let mut some = queue(&[1.0, 2.0, 4.0]);
        assert!(some.pop_until(1.5).is_some() && some.pop_until(1.5).is_none() && some.pop_until(4.0).is_some());
    }

    #[test]
    fn buckets_are_no_wider_than_an_eighth() {
        for price in [1e-12, 0.7, 1.0, 123.0] {
            assert!(bucket_of(price * 1.126) > bucket_of(price));
        }
    }
}
