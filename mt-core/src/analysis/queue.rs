//! The queue of sites by price: a four-ary heap of eight-byte entries, without updates.
//!
//! A site with a new price is a new site, so nothing is ever moved within the heap by name. An entry is the price as
//! `f32` bits over the place of its site in a table; eight bytes keep the heap of a hundred thousand triangles in the
//! cache, where a heap of prices and sites side by side took twice the time of the whole rest of the loop.

/// Sites by price; equal prices (as `f32`) by their place in the table, which depends on the input alone.
pub(super) struct Queue<S> {
    heap: Vec<u64>,
    sites: Vec<S>,
    free: Vec<u32>,
}

const ARITY: usize = 4;

impl<S: Copy> Queue<S> {
    pub(super) fn new(priced: impl Iterator<Item = (f64, S)>) -> Self {
        let mut queue = Self { heap: Vec::new(), sites: Vec::new(), free: Vec::new() };
        for (price, site) in priced {
            let entry = queue.entry(price, site);
            queue.heap.push(entry);
        }
        for at in (0..queue.heap.len().div_ceil(ARITY)).rev() {
            queue.sink(at);
        }
        queue
    }

    pub(super) fn push(&mut self, price: f64, site: S) {
        let entry = self.entry(price, site);
        self.heap.push(entry);
        self.swim(self.heap.len() - 1);
    }

    pub(super) fn pop(&mut self) -> Option<S> {
        let top = *self.heap.first()?;
        let last = self.heap.pop().expect("there is a first");
        if !self.heap.is_empty() {
            self.heap[0] = last;
            self.sink(0);
        }
        let place = top as u32;
        self.free.push(place);
        Some(self.sites[place as usize])
    }

    fn entry(&mut self, price: f64, site: S) -> u64 {
        let place = match self.free.pop() {
            Some(place) => {
                self.sites[place as usize] = site;
                place
            }
            None => {
                self.sites.push(site);
                self.sites.len() as u32 - 1
            }
        };
        u64::from(key(price)) << 32 | u64::from(place)
    }

    fn swim(&mut self, mut at: usize) {
        let entry = self.heap[at];
        while at > 0 {
            let parent = (at - 1) / ARITY;
            if self.heap[parent] <= entry {
                break;
            }
            self.heap[at] = self.heap[parent];
            at = parent;
        }
        self.heap[at] = entry;
    }

    fn sink(&mut self, mut at: usize) {
        let Some(&entry) = self.heap.get(at) else { return };
        loop {
            let first = at * ARITY + 1;
            let children = self.heap.get(first..(first + ARITY).min(self.heap.len())).unwrap_or(&[]);
            let Some((offset, &least)) = children.iter().enumerate().min_by_key(|(_, e)| **e) else { break };
            if least >= entry {
                break;
            }
            self.heap[at] = least;
            at = first + offset;
        }
        self.heap[at] = entry;
    }
}

/// Bits that order as prices do. Prices below 0 count as 0, what is not a number as the highest.
fn key(price: f64) -> u32 {
    if price.is_nan() { u32::MAX } else { (price.max(0.0) as f32).to_bits() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn comes_out_sorted(start in prop::collection::vec(0f64..10.0, 0..40), later in prop::collection::vec(0f64..10.0, 0..40)) {
            let mut queue = Queue::new(start.iter().map(|&p| (p, p)));
            let mut kept = start;
            for price in later {
                let popped = queue.pop();
                kept.sort_by(f64::total_cmp);
                let least = (!kept.is_empty()).then(|| kept.remove(0));
                prop_assert_eq!(popped.map(|p| p as f32), least.map(|p| p as f32));
                queue.push(price, price);
                kept.push(price);
            }
            kept.sort_by(f64::total_cmp);
            let rest: Vec<f32> = std::iter::from_fn(|| queue.pop()).map(|p| p as f32).collect();
            prop_assert_eq!(rest, kept.into_iter().map(|p| p as f32).collect::<Vec<_>>());
        }
    }
}
