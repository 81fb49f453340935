//! A sequence as bytes: little-endian arrays after a head of counts, and a checksum. What is read is checked like any
//! other sequence, by [`super::Replay::new`].

use super::sequence::Sequence;
use crate::bits::Bits;
use crate::id::VertexId;
use glam::Vec3;

const MAGIC: [u8; 8] = *b"mtseq\0\x01\n";
const HEAD: usize = 8 + 5 * 4;

/// Bytes that are no sequence.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SequenceError {
    /// They begin otherwise, or are of another version.
    #[error("not a sequence of merges, or one of another version")]
    Magic,
    /// They end early, or go on.
    #[error("{found} bytes where {wanted} are announced")]
    Length {
        /// What the head announces.
        wanted: u64,
        /// What is there.
        found: usize,
    },
    /// A merge that is said to keep its centre is none, or is said so twice.
    #[error("merge {0} is said to keep its centre, but it is none, or is named twice")]
    Kept(u32),
    /// The checksum differs.
    #[error("the checksum is wrong: the bytes are damaged")]
    Checksum,
}

impl Sequence {
    /// The sequence as bytes. O(nodes).
    pub fn to_bytes(&self) -> Vec<u8> {
        let kept: Vec<u32> = self.kept.iter().collect();
        let counts = [
            self.input_vertex_count,
            self.merge_count(),
            self.node_count(),
            kept.len() as u32,
            self.starts.len() as u32,
        ];
        let mut bytes = MAGIC.to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&counts.map(u32::to_le)));
        let mut words =
            |values: &mut dyn Iterator<Item = u32>| values.for_each(|v| bytes.extend_from_slice(&v.to_le_bytes()));
        words(&mut self.centers.iter().map(|v| v.0));
        words(&mut self.positions.iter().flat_map(|p| p.to_array().map(f32::to_bits)));
        words(&mut self.starts.iter().copied());
        words(&mut self.children.iter().map(|v| v.0));
        words(&mut self.errors.iter().map(|e| e.to_bits()));
        words(&mut kept.iter().copied());
        let sum = crc32fast::hash(&bytes);
        bytes.extend_from_slice(&sum.to_le_bytes());
        bytes
    }

    /// The sequence of these bytes. Allocates no more than the bytes are long.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SequenceError> {
        if bytes.len() < HEAD || bytes[..8] != MAGIC {
            return Err(SequenceError::Magic);
        }
        let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        let [leaves, merges, nodes, kept, starts] = [0, 1, 2, 3, 4].map(|i| word(8 + 4 * i));
        let words = u64::from(merges) * 4 + u64::from(nodes) * 2 + u64::from(kept) + u64::from(starts);
        let wanted = HEAD as u64 + 4 * words + 4;
        if bytes.len() as u64 != wanted {
            return Err(SequenceError::Length { wanted, found: bytes.len() });
        }
        if crc32fast::hash(&bytes[..bytes.len() - 4]) != word(bytes.len() - 4) {
            return Err(SequenceError::Checksum);
        }
        let mut at = HEAD;
        let mut take = |count: u32| {
            let from = at;
            at += 4 * count as usize;
            (from..at).step_by(4).map(word).collect::<Vec<u32>>()
        };
        let mut sequence = Sequence::with_input(leaves);
        sequence.centers = take(merges).into_iter().map(VertexId).collect();
        let floats: Vec<f32> =
            take(merges).into_iter().chain(take(merges)).chain(take(merges)).map(f32::from_bits).collect();
        sequence.positions = floats.chunks_exact(3).map(Vec3::from_slice).collect();
        sequence.starts = take(starts);
        sequence.children = take(nodes).into_iter().map(VertexId).collect();
        sequence.errors = take(nodes).into_iter().map(f32::from_bits).collect();
        sequence.keep(&take(kept))?;
        Ok(sequence)
    }

    /// Marks these merges, and no others, as ones that keep their centre.
    pub(crate) fn keep(&mut self, kept: &[u32]) -> Result<(), SequenceError> {
        let merges = self.merge_count();
        let mut flags = Bits::new(if kept.is_empty() { 0 } else { merges });
        if let Some(&merge) = kept.iter().find(|&&merge| merge >= merges || !flags.insert(merge)) {
            return Err(SequenceError::Kept(merge));
        }
        self.kept = flags;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Sequence {
        let mut sequence = Sequence::with_input(6);
        sequence.push(VertexId(0), [VertexId(1)], [0.5], Vec3::new(1.0, 2.0, -0.0), false);
        sequence.push(VertexId(2), [VertexId(3), VertexId(6)], [0.6, 0.7], Vec3::X, true);
        sequence
    }

    #[test]
    fn bytes_come_back_as_they_were() {
        let again = Sequence::from_bytes(&sample().to_bytes()).unwrap();
        assert_eq!(again.to_bytes(), sample().to_bytes());
        assert_eq!(
            (again.positions, again.children, again.starts),
            (sample().positions, sample().children, sample().starts)
        );
        assert!(again.kept.contains(1) && !again.kept.contains(0));
    }

    #[test]
    fn a_head_that_promises_too_much_is_refused() {
        let sum = |mut bytes: Vec<u8>| {
            let end = bytes.len() - 4;
            let crc = crc32fast::hash(&bytes[..end]);
            bytes[end..].copy_from_slice(&crc.to_le_bytes());
            bytes
        };
        for field in 0..5 {
            let mut bytes = sample().to_bytes();
            bytes[8 + 4 * field..12 + 4 * field].copy_from_slice(&u32::MAX.to_le_bytes());
            let read = Sequence::from_bytes(&sum(bytes));
            // The number of leaves is for the mesh to confirm; it costs nothing until then.
            assert!(field == 0 || read.is_err(), "field {field}");
            if let Ok(read) = read {
                assert!(crate::Replay::new(&crate::Mesh::default(), &[], &read).is_err());
            }
        }
        let mut twice = sample().to_bytes();
        let at = twice.len() - 8;
        twice[at..at + 4].copy_from_slice(&7u32.to_le_bytes());
        assert_eq!(Sequence::from_bytes(&sum(twice)).map(|_| ()), Err(SequenceError::Kept(7)));
    }

    #[test]
    fn damage_is_seen() {
        let bytes = sample().to_bytes();
        for cut in 0..bytes.len() {
            assert!(Sequence::from_bytes(&bytes[..cut]).is_err());
        }
        for at in 0..bytes.len() {
            let mut bad = bytes.clone();
            bad[at] ^= 0x10;
            assert!(Sequence::from_bytes(&bad).is_err(), "byte {at}");
        }
    }
}
