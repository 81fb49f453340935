//! A set of ids as bits: fronts are sets of nodes, alive sets are sets of cells.

/// A set of the numbers below `len`, one bit each.
#[derive(Debug, Default, PartialEq, Eq, Hash)]
pub struct Bits {
    words: Vec<u64>,
    len: u32,
    count: u32,
}

impl Clone for Bits {
    fn clone(&self) -> Self {
        Self { words: self.words.clone(), len: self.len, count: self.count }
    }

    /// In the memory of `self`, where that is large enough.
    fn clone_from(&mut self, other: &Self) {
        self.words.clone_from(&other.words);
        (self.len, self.count) = (other.len, other.count);
    }
}

impl Bits {
    /// The empty set of numbers below `len`.
    pub fn new(len: u32) -> Self {
        Self { words: vec![0; (len as usize).div_ceil(64)], len, count: 0 }
    }

    /// The set of all numbers below `len`.
    pub fn full(len: u32) -> Self {
        let mut bits = Self::new(len);
        bits.words.fill(u64::MAX);
        if !len.is_multiple_of(64) {
            *bits.words.last_mut().expect("len > 0") = (1 << (len % 64)) - 1;
        }
        bits.count = len;
        bits
    }

    /// The bound below which members lie.
    pub fn capacity(&self) -> u32 {
        self.len
    }

    /// How many members there are. O(1).
    #[inline]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Whether `i` is a member.
    #[inline]
    pub fn contains(&self, i: u32) -> bool {
        self.words[i as usize / 64] >> (i % 64) & 1 == 1
    }

    /// Adds `i`; whether it is new.
    #[inline]
    pub fn insert(&mut self, i: u32) -> bool {
        let (word, bit) = (&mut self.words[i as usize / 64], 1u64 << (i % 64));
        let new = *word & bit == 0;
        *word |= bit;
        self.count += u32::from(new);
        new
    }

    /// Takes `i` out; whether it was there.
    #[inline]
    pub fn remove(&mut self, i: u32) -> bool {
        let (word, bit) = (&mut self.words[i as usize / 64], 1u64 << (i % 64));
        let old = *word & bit != 0;
        *word &= !bit;
        self.count -= u32::from(old);
        old
    }

    /// Empties the set. O(capacity / 64).
    pub fn clear(&mut self) {
        self.words.fill(0);
        self.count = 0;
    }

    /// The members, ascending. O(capacity / 64 + members).
    pub fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        ascending(self.words.iter().copied())
    }

    /// The members of `self` that are not in `other`, ascending.
    pub fn difference<'a>(&'a self, other: &'a Bits) -> impl Iterator<Item = u32> + 'a {
        ascending(self.words.iter().zip(&other.words).map(|(a, b)| a & !b))
    }

    /// Whether every member of `self` is in `other`.
    pub fn is_subset(&self, other: &Bits) -> bool {
        self.words.iter().zip(&other.words).all(|(a, b)| a & !b == 0)
    }

    /// The words that hold the bits, lowest first: for sweeps that change the set while they go.
    pub fn words(&self) -> &[u64] {
        &self.words
    }
}

fn ascending(words: impl Iterator<Item = u64>) -> impl Iterator<Item = u32> {
    words
        .enumerate()
        .filter(|(_, word)| *word != 0)
        .flat_map(|(i, word)| ones(word).map(move |bit| i as u32 * 64 + bit))
}

/// Positions of the set bits of a word, lowest first.
#[inline]
pub fn ones(mut word: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        (word != 0).then(|| {
            let bit = word.trailing_zeros();
            word &= word - 1;
            bit
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_has_no_bit_beyond_its_end() {
        for len in [0, 1, 63, 64, 65, 128] {
            let bits = Bits::full(len);
            assert_eq!(bits.iter().collect::<Vec<_>>(), (0..len).collect::<Vec<_>>());
            assert_eq!(bits.count(), len);
        }
    }

    #[test]
    fn copies_reuse_memory() {
        let (mut copy, original) = (Bits::full(200), Bits::new(130));
        let at = copy.words().as_ptr();
        copy.clone_from(&original);
        assert!(copy == original && copy.words().as_ptr() == at);
    }

    #[test]
    fn count_follows_insert_and_remove() {
        let mut bits = Bits::new(100);
        assert!(bits.insert(70) && !bits.insert(70) && bits.insert(3));
        assert_eq!((bits.count(), bits.iter().collect::<Vec<_>>()), (2, vec![3, 70]));
        assert!(bits.remove(70) && !bits.remove(70));
        assert_eq!(bits.count(), 1);
    }
}
