//! The elements of a PLY file, row by row, from text or from bytes.

use super::header::{Element, Kind, Scalar};
use crate::format::error::{Place, Problem, Refusal};
use crate::format::words::Words;
use glam::Vec3;

/// Rows of elements, whatever their encoding.
pub(super) trait Source {
    /// Where reading has come to.
    fn place(&self) -> Place;

    /// Bytes not yet read.
    fn remaining(&self) -> usize;

    /// The fewest bytes a row of the element can take, 0 without properties.
    fn least_size(&self, element: &Element) -> usize;

    /// The next number.
    fn number(&mut self, scalar: Scalar) -> Result<f64, Refusal>;

    /// The next items of a list, as indices.
    fn indices(&mut self, count: usize, scalar: Scalar, into: &mut Vec<i64>) -> Result<(), Refusal>;

    /// Skips the next items of a list.
    fn skip(&mut self, count: usize, scalar: Scalar) -> Result<(), Refusal>;

    /// All positions at once, where every row has the same size. Requires: the bytes are there.
    fn packed_positions(&mut self, element: &Element, axes: [usize; 3], count: usize) -> Option<Vec<Vec3>>;

    /// Reads one row: numbers go to `keep` with their property, the items of the wanted list to `items`.
    fn row(
        &mut self,
        element: &Element,
        keep: &mut impl FnMut(usize, f64),
        items: &mut Vec<i64>,
        wanted: Option<usize>,
    ) -> Result<(), Refusal> {
        for (index, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(scalar) => keep(index, self.number(scalar)?),
                Kind::List(count, item) => {
                    let place = self.place_of_list();
                    let count = self.number(count)?;
                    if count < 0.0 || count > self.remaining() as f64 {
                        return Err(Refusal::malformed(
                            place.unwrap_or_else(|| self.place()),
                            format!("a list of {count} items"),
                        ));
                    }
                    let count = count as usize;
                    if wanted == Some(index) {
                        items.clear();
                        self.indices(count, item, items)?;
                    } else {
                        self.skip(count, item)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The place to name if a list's length is wrong, if that must be known before it is read.
    fn place_of_list(&self) -> Option<Place>;
}

/// Text rows. Line breaks do not matter, only the order of the words.
pub(super) struct Text<'a> {
    pub(super) words: Words<'a>,
}

impl Source for Text<'_> {
    fn place(&self) -> Place {
        self.words.line()
    }

    fn place_of_list(&self) -> Option<Place> {
        None
    }

    fn remaining(&self) -> usize {
        self.words.remaining()
    }

    fn least_size(&self, element: &Element) -> usize {
        2 * element.properties.len()
    }

    fn number(&mut self, scalar: Scalar) -> Result<f64, Refusal> {
        match scalar {
            // Rounded once: a float written as text must come back as the same float.
            Scalar::F32 => self.words.number::<f32>("an element").map(f64::from),
            _ => self.words.number::<f64>("an element"),
        }
    }

    fn indices(&mut self, count: usize, _: Scalar, into: &mut Vec<i64>) -> Result<(), Refusal> {
        for _ in 0..count {
            into.push(self.words.number("a list")?);
        }
        Ok(())
    }

    fn skip(&mut self, count: usize, _: Scalar) -> Result<(), Refusal> {
        let missing = (0..count).any(|_| self.words.next().is_none());
        if missing { Err(Refusal::new(self.place(), Problem::Truncated("a list".into()))) } else { Ok(()) }
    }

    fn packed_positions(&mut self, _: &Element, _: [usize; 3], _: usize) -> Option<Vec<Vec3>> {
        None
    }
}

/// Rows of bytes.
pub(super) struct Binary<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    pub(super) big: bool,
}

impl<'a> Binary<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Refusal> {
        let end = self.at.checked_add(count).filter(|end| *end <= self.bytes.len());
        let Some(end) = end else {
            return Err(Refusal::new(Place::Byte(self.at), Problem::Truncated("an element".into())));
        };
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }
}

/// The first bytes as an array. Requires: they are there.
fn first<const N: usize>(bytes: &[u8], big: bool) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(&bytes[..N]);
    if big {
        array.reverse();
    }
    array
}

fn decode(bytes: &[u8], scalar: Scalar, big: bool) -> f64 {
    match scalar {
        Scalar::I8 => f64::from(bytes[0] as i8),
        Scalar::U8 => f64::from(bytes[0]),
        Scalar::I16 => f64::from(i16::from_le_bytes(first(bytes, big))),
        Scalar::U16 => f64::from(u16::from_le_bytes(first(bytes, big))),
        Scalar::I32 => f64::from(i32::from_le_bytes(first(bytes, big))),
        Scalar::U32 => f64::from(u32::from_le_bytes(first(bytes, big))),
        Scalar::F32 => f64::from(f32::from_le_bytes(first(bytes, big))),
        Scalar::F64 => f64::from_le_bytes(first(bytes, big)),
    }
}

impl Source for Binary<'_> {
    fn place(&self) -> Place {
        Place::Byte(self.at)
    }

    fn place_of_list(&self) -> Option<Place> {
        Some(self.place())
    }

    fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn least_size(&self, element: &Element) -> usize {
        let sizes = element.properties.iter().map(|property| match property.kind {
            Kind::Scalar(scalar) => scalar.size(),
            Kind::List(count, _) => count.size(),
        });
        sizes.sum()
    }

    #[inline]
    fn number(&mut self, scalar: Scalar) -> Result<f64, Refusal> {
        let big = self.big;
        Ok(decode(self.take(scalar.size())?, scalar, big))
    }

    #[inline]
    fn indices(&mut self, count: usize, scalar: Scalar, into: &mut Vec<i64>) -> Result<(), Refusal> {
        let big = self.big;
        // At most eight bytes an item, and the count is at most the bytes left.
        let bytes = self.take(count * scalar.size())?;
        match scalar {
            Scalar::I32 => into.extend(bytes.chunks_exact(4).map(|b| i64::from(i32::from_le_bytes(first(b, big))))),
            Scalar::U32 => into.extend(bytes.chunks_exact(4).map(|b| i64::from(u32::from_le_bytes(first(b, big))))),
            _ => into.extend(bytes.chunks_exact(scalar.size()).map(|b| decode(b, scalar, big) as i64)),
        }
        Ok(())
    }

    fn skip(&mut self, count: usize, scalar: Scalar) -> Result<(), Refusal> {
        self.take(count * scalar.size()).map(|_| ())
    }

    fn packed_positions(&mut self, element: &Element, axes: [usize; 3], count: usize) -> Option<Vec<Vec3>> {
        let mut offsets = Vec::with_capacity(element.properties.len());
        let mut stride = 0;
        for property in &element.properties {
            let Kind::Scalar(scalar) = property.kind else { return None };
            offsets.push((stride, scalar));
            stride += scalar.size();
        }
        let (axes, big) = (axes.map(|axis| offsets[axis]), self.big);
        let rows = self.take(count.checked_mul(stride)?).ok()?;
        let coordinate = |row: &[u8], (at, scalar): (usize, Scalar)| decode(&row[at..], scalar, big) as f32;
        Some(rows.chunks_exact(stride).map(|row| Vec3::from_array(axes.map(|axis| coordinate(row, axis)))).collect())
    }
}
