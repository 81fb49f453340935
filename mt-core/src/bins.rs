//! Sorting numbers by few keys, by several threads: triangles by the region or the portion that they are in.

use rayon::prelude::*;

/// Numbers sorted into bins, ascending in each.
pub(crate) struct Bins {
    /// Of each chunk of the numbers: where each bin begins, and the numbers bin by bin.
    chunks: Vec<(Vec<u32>, Vec<u32>)>,
}

/// Numbers that one thread sorts at a time, at least; four times as many as there are bins, if that is more, so that where bins
/// begin takes no more than what is in them.
const CHUNK: u32 = 1 << 16;

impl Bins {
    /// The numbers below `count`, each in the bins that `of` tells, in each of these once. O(numbers + bins × chunks).
    pub(crate) fn new<const K: usize>(count: u32, bins: usize, of: impl Fn(u32) -> [usize; K] + Sync) -> Self {
        let size = u32::try_from(4 * bins).unwrap_or(u32::MAX).max(CHUNK);
        let chunk = |first: u32| {
            let told: Vec<[usize; K]> = (first..first.saturating_add(size).min(count)).map(&of).collect();
            let once = |told: &[usize; K]| {
                let told = *told;
                (0..K).filter(move |&k| !told[..k].contains(&told[k])).map(move |k| told[k])
            };
            let numbered = (first..).zip(&told);
            rows(bins, 0, numbered.flat_map(|(number, told)| once(told).map(move |bin| (bin, number))))
        };
        let chunks = (0..count.div_ceil(size)).into_par_iter().map(|i| chunk(i * size)).collect();
        Self { chunks }
    }

    /// The numbers in a bin.
    pub(crate) fn of(&self, bin: usize) -> Vec<u32> {
        let rows = || self.chunks.iter().map(|(starts, items)| &items[starts[bin] as usize..starts[bin + 1] as usize]);
        let mut all = Vec::with_capacity(rows().map(<[u32]>::len).sum());
        rows().for_each(|row| all.extend_from_slice(row));
        all
    }
}

/// Things by the number of their row, in their order within each: where each of `count` rows begins, with one more entry, and
/// the things. Entries are asked for twice; `filler` is any thing. O(rows + things).
pub(crate) fn rows<T: Copy>(
    count: usize,
    filler: T,
    entries: impl Iterator<Item = (usize, T)> + Clone,
) -> (Vec<u32>, Vec<T>) {
    let mut starts = vec![0u32; count + 1];
    entries.clone().for_each(|(row, _)| starts[row + 1] += 1);
    (0..count).for_each(|row| starts[row + 1] += starts[row]);
    let mut next = starts.clone();
    let mut things = vec![filler; starts[count] as usize];
    for (row, thing) in entries {
        things[next[row] as usize] = thing;
        next[row] += 1;
    }
    (starts, things)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_number_is_in_its_bins_once(told in prop::collection::vec(prop::array::uniform2(0usize..5), 0..50), more in 0u32..2) {
            // Over the end of a chunk as well.
            let first = more * (CHUNK - 20);
            let of = |number: u32| number.checked_sub(first).map_or([0, 0], |at| told[at as usize]);
            let count = first + told.len() as u32;
            let bins = Bins::new(count, 5, of);
            for bin in 0..5 {
                let slow: Vec<u32> = (0..count).filter(|&number| of(number).contains(&bin)).collect();
                prop_assert_eq!(bins.of(bin), slow);
            }
        }
    }
}
