//! Flat helpers of the census: a union-find and buckets over `u32`, without a map in sight.

/// Disjoint sets of `0..n`, 4 bytes each. The representative of a set is its smallest member.
pub(super) struct Sets {
    parent: Vec<u32>,
}

impl Sets {
    /// `count` sets of one member.
    pub(super) fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// The smallest member of the set of `member`; halves the path on the way.
    pub(super) fn find(&mut self, mut member: u32) -> u32 {
        loop {
            let parent = self.parent[member as usize];
            if parent == member {
                return member;
            }
            let grandparent = self.parent[parent as usize];
            self.parent[member as usize] = grandparent;
            member = grandparent;
        }
    }

    /// Joins two sets; true if they were two.
    pub(super) fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
        a != b
    }
}

/// Items sorted by a first key in `0..n` (counting sort), then among themselves.
pub(super) struct Buckets<T> {
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Ord + Default> Buckets<T> {
    /// O(items + n) plus the sorting inside each bucket. `pairs` is walked twice and must repeat itself.
    pub(super) fn new(count: usize, pairs: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut starts = vec![0u32; count + 1];
        for (key, _) in pairs.clone() {
            starts[key as usize + 1] += 1;
        }
        for key in 0..count {
            starts[key + 1] += starts[key];
        }
        let mut items = vec![T::default(); starts[count] as usize];
        for (key, item) in pairs {
            let slot = &mut starts[key as usize];
            items[*slot as usize] = item;
            *slot += 1;
        }
        // Each start has become its bucket's end: shift them back by one.
        starts.rotate_right(1);
        starts[0] = 0;
        for key in 0..count {
            items[starts[key] as usize..starts[key + 1] as usize].sort_unstable();
        }
        Self { starts, items }
    }

    /// Every bucket, in the order of its key.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, &[T])> {
        self.starts
            .windows(2)
            .enumerate()
            .map(|(key, range)| (key as u32, &self.items[range[0] as usize..range[1] as usize]))
    }
}
