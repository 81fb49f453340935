//! Packing of a section: its words in columns, as differences where neighbours are alike, byte by byte of like weight, and
//! that through Zstandard (`[ColletKucherawy2021]`).
//!
//! Arrays of a model are records of 32-bit words. Ids ascend or repeat, so what one record adds to the one before is small;
//! of floats the upper bytes are alike. Such bytes are put side by side, where a compressor finds them.

use std::io::{self, Read};

/// How a section lies in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Packing {
    /// As in memory.
    Plain,
    /// Through Zstandard as it is: text.
    Text,
    /// In columns of words; so many a record.
    Words { columns: u8, filter: Filter },
}

/// What is told of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filter {
    /// Itself.
    None,
    /// What it adds to the word above it.
    Differences,
    /// Itself as a signed number, so that small ones of either sign have small bytes.
    Signed,
}

impl Filter {
    const ALL: [Self; 3] = [Self::None, Self::Differences, Self::Signed];

    fn tell(self, word: u32, before: u32) -> u32 {
        match self {
            Self::None => word,
            Self::Differences => zigzag(word.wrapping_sub(before)),
            Self::Signed => zigzag(word),
        }
    }

    fn hear(self, told: u32, before: u32) -> u32 {
        match self {
            Self::None => told,
            Self::Differences => before.wrapping_add(unzigzag(told)),
            Self::Signed => unzigzag(told),
        }
    }
}

impl Packing {
    /// As two bytes of the table.
    pub(super) fn to_bytes(self) -> [u8; 2] {
        match self {
            Self::Plain => [0, 0],
            Self::Text => [1, 0],
            Self::Words { columns, filter } => [2 + filter as u8, columns],
        }
    }

    pub(super) fn from_bytes(bytes: [u8; 2]) -> Option<Self> {
        match bytes {
            [0, 0] => Some(Self::Plain),
            [1, 0] => Some(Self::Text),
            [kind, columns] if columns > 0 => {
                let filter = usize::from(kind).checked_sub(2).and_then(|filter| Filter::ALL.get(filter));
                filter.map(|&filter| Self::Words { columns, filter })
            }
            _ => None,
        }
    }
}

/// Zstandard's own usual level; others have not been compared.
const LEVEL: i32 = 3;

/// The bytes of a section as they go into the file. Requires: whole records, where they go in columns.
pub(super) fn pack(bytes: &[u8], packing: Packing) -> io::Result<Vec<u8>> {
    match packing {
        Packing::Plain => Ok(bytes.to_vec()),
        Packing::Text => zstd::bulk::compress(bytes, LEVEL),
        Packing::Words { columns, filter } => zstd::bulk::compress(&to_planes(bytes, columns.into(), filter), LEVEL),
    }
}

/// What was packed into `stored`, if that is `length` bytes. Allocates no more than comes out, and that never exceeds
/// `length`.
pub(super) fn unpack(stored: &[u8], packing: Packing, length: usize) -> Option<Vec<u8>> {
    let bytes = match packing {
        Packing::Plain => stored.to_vec(),
        Packing::Text | Packing::Words { .. } => inflate(stored, length)?,
    };
    if bytes.len() != length {
        return None;
    }
    match packing {
        Packing::Words { columns, filter } => from_planes(&bytes, columns.into(), filter),
        _ => Some(bytes),
    }
}

/// One frame of so many bytes, and nothing after it.
fn inflate(stored: &[u8], length: usize) -> Option<Vec<u8>> {
    let mut rest = stored;
    let mut decoder = zstd::stream::read::Decoder::with_buffer(&mut rest).ok()?.single_frame();
    let mut bytes = Vec::new();
    // One more than announced shows a frame that goes on.
    decoder.by_ref().take(length as u64 + 1).read_to_end(&mut bytes).ok()?;
    drop(decoder);
    rest.is_empty().then_some(bytes)
}

/// Byte `b` of word `c` of all records, one after the other, for each `c` and `b`.
fn to_planes(bytes: &[u8], columns: usize, filter: Filter) -> Vec<u8> {
    let records = bytes.len() / (4 * columns);
    debug_assert_eq!(records * 4 * columns, bytes.len(), "a section of whole records");
    let mut planes = vec![0; bytes.len()];
    for c in 0..columns {
        let mut before = 0u32;
        for r in 0..records {
            let word = word_at(bytes, r * columns + c);
            let told = filter.tell(word, before);
            before = word;
            for (b, byte) in told.to_le_bytes().into_iter().enumerate() {
                planes[(4 * c + b) * records + r] = byte;
            }
        }
    }
    planes
}

/// The records of these planes; `None` where they are no whole records.
fn from_planes(planes: &[u8], columns: usize, filter: Filter) -> Option<Vec<u8>> {
    if !planes.len().is_multiple_of(4 * columns) {
        return None;
    }
    let records = planes.len() / (4 * columns);
    let mut bytes = vec![0; planes.len()];
    for c in 0..columns {
        let mut before = 0u32;
        for r in 0..records {
            let told = u32::from_le_bytes([0, 1, 2, 3].map(|b| planes[(4 * c + b) * records + r]));
            let word = filter.hear(told, before);
            before = word;
            let at = 4 * (r * columns + c);
            bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
    }
    Some(bytes)
}

fn word_at(bytes: &[u8], index: usize) -> u32 {
    u32::from_le_bytes([0, 1, 2, 3].map(|b| bytes[4 * index + b]))
}

/// Small numbers of either sign become small numbers.
fn zigzag(difference: u32) -> u32 {
    (difference << 1) ^ ((difference as i32) >> 31) as u32
}

fn unzigzag(told: u32) -> u32 {
    (told >> 1) ^ (told & 1).wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_packed_comes_back(words in prop::collection::vec(any::<u32>(), 0..200), columns in 1u8..7, filter in prop::sample::select(Filter::ALL.to_vec())) {
            let whole = words.len() / columns as usize * columns as usize;
            let bytes: Vec<u8> = words[..whole].iter().flat_map(|word| word.to_le_bytes()).collect();
            for packing in [Packing::Plain, Packing::Text, Packing::Words { columns, filter }] {
                prop_assert_eq!(Packing::from_bytes(packing.to_bytes()), Some(packing));
                let stored = pack(&bytes, packing).unwrap();
                let again = unpack(&stored, packing, bytes.len());
                prop_assert_eq!(again.as_deref(), Some(bytes.as_slice()));
                prop_assert_eq!(unpack(&stored, packing, bytes.len() + 1), None);
                prop_assert!(bytes.is_empty() || unpack(&stored, packing, bytes.len() - 1).is_none());
                let longer = [stored.as_slice(), &[7]].concat();
                prop_assert_eq!(unpack(&longer, packing, bytes.len()), None);
            }
        }
    }

    #[test]
    fn ascending_ids_take_a_tenth_and_less() {
        let ids: Vec<u8> = (0..100_000u32).flat_map(|i| (3 * i + i % 2).to_le_bytes()).collect();
        let length = |packing| pack(&ids, packing).unwrap().len();
        let plain = length(Packing::Text);
        assert!(10 * length(Packing::Words { columns: 1, filter: Filter::Differences }) < ids.len());
        assert!(length(Packing::Words { columns: 1, filter: Filter::Differences }) < plain / 4);
    }

    #[test]
    fn a_frame_that_swells_is_cut_off_where_it_was_to_end() {
        let bomb = zstd::bulk::compress(&vec![0; 100_000_000], 3).unwrap();
        assert!(bomb.len() < 100_000);
        assert_eq!(unpack(&bomb, Packing::Text, 10), None);
    }
}
