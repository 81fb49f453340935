//! Accessors of glTF: positions and indices out of buffers, with every offset checked.

use super::{Resolve, container, missing};
use crate::format::error::{Place, Problem, Refusal, excerpt};
use glam::Vec3;
use gltf::json::accessor::{ComponentType, Type, sparse::Sparse};
use gltf::json::validation::Checked;
use gltf::json::{Accessor, Root};
use std::borrow::Cow;

/// The buffers of a file, fetched when first used.
pub(super) struct Buffers<'a> {
    root: &'a Root,
    binary: Option<&'a [u8]>,
    resolve: &'a Resolve<'a>,
    loaded: Vec<Option<Cow<'a, [u8]>>>,
}

/// Where values lie in a buffer: `count` of them, `stride` bytes apart. The bytes are there.
struct Layout {
    buffer: usize,
    start: usize,
    stride: usize,
    count: usize,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(root: &'a Root, binary: Option<&'a [u8]>, resolve: &'a Resolve<'a>) -> Self {
        Self { root, binary, resolve, loaded: vec![None; root.buffers.len()] }
    }

    /// Bytes fetched so far from outside the file.
    pub(super) fn loaded_bytes(&self) -> usize {
        let owned = self.loaded.iter().flatten().filter(|bytes| matches!(bytes, Cow::Owned(_)));
        owned.map(|bytes| bytes.len()).sum()
    }

    /// The positions of an accessor, as floats (quantised ones are converted).
    pub(super) fn positions(&mut self, index: usize) -> Result<Vec<Vec3>, Refusal> {
        let place = Place::Item("accessor", index);
        let accessor = self.accessor(index)?;
        let component = component(accessor, place)?;
        if accessor.type_ != Checked::Valid(Type::Vec3) {
            return Err(Refusal::malformed(place, "positions are not vectors of three"));
        }
        let decode = |bytes: &[u8]| {
            let size = component.size();
            Vec3::from_array([0, 1, 2].map(|axis| number(&bytes[axis * size..], component, accessor.normalized)))
        };
        let mut positions = self.values(accessor, 3 * component.size(), place, decode)?;
        if let Some(sparse) = &accessor.sparse {
            let changes = self.sparse(sparse, 3 * component.size(), place, decode)?;
            for (at, value) in changes {
                let count = positions.len();
                let problem = Problem::IndexOutOfRange { index: at.into(), count };
                *positions.get_mut(at as usize).ok_or_else(|| Refusal::new(place, problem))? = value;
            }
        }
        Ok(positions)
    }

    /// The values of an accessor of indices.
    pub(super) fn indices(&mut self, index: usize) -> Result<Vec<u32>, Refusal> {
        let place = Place::Item("accessor", index);
        let accessor = self.accessor(index)?;
        let component = component(accessor, place)?;
        let unsigned = matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if accessor.type_ != Checked::Valid(Type::Scalar) || !unsigned || accessor.sparse.is_some() {
            return Err(Refusal::malformed(place, "indices are not plain unsigned integers"));
        }
        self.values(accessor, component.size(), place, |bytes| integer(bytes, component))
    }

    fn accessor(&self, index: usize) -> Result<&'a Accessor, Refusal> {
        self.root.accessors.get(index).ok_or_else(|| missing("accessor", index))
    }

    /// Decodes all values of an accessor; zeros where it has no buffer of its own (then it is sparse).
    fn values<T: Clone>(
        &mut self,
        accessor: &Accessor,
        size: usize,
        place: Place,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, Refusal> {
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        match accessor.buffer_view {
            Some(view) => {
                let layout = self.layout(view.value(), offset, accessor.count.0, size, place)?;
                Ok(self.read(&layout, size, decode))
            }
            // The count is not backed by bytes: hold it to what the changes could reach in a real file.
            None if accessor.sparse.is_some() && accessor.count.0 <= 1 << 20 => {
                Ok(vec![decode(&[0; 24]); accessor.count.0 as usize])
            }
            None => Err(Refusal::malformed(place, "the accessor has no data")),
        }
    }

    fn sparse<T: Clone>(
        &mut self,
        sparse: &Sparse,
        size: usize,
        place: Place,
        decode: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<(u32, T)>, Refusal> {
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(Refusal::malformed(place, "sparse indices of an unknown type"));
        };
        let (indices, values) = (&sparse.indices, &sparse.values);
        let width = component.0.size();
        let layout = self.layout(indices.buffer_view.value(), indices.byte_offset.0, sparse.count.0, width, place)?;
        let at = self.read(&layout, width, |bytes| integer(bytes, component.0));
        let layout = self.layout(values.buffer_view.value(), values.byte_offset.0, sparse.count.0, size, place)?;
        Ok(at.into_iter().zip(self.read(&layout, size, decode)).collect())
    }

    /// Requires: a layout from [`Self::layout`] for the same `size`.
    fn read<T>(&self, layout: &Layout, size: usize, decode: impl Fn(&[u8]) -> T) -> Vec<T> {
        let bytes = self.loaded[layout.buffer].as_deref().unwrap_or_default();
        (0..layout.count)
            .map(|i| {
                let start = layout.start + i * layout.stride;
                decode(&bytes[start..start + size])
            })
            .collect()
    }

    /// Where `count` values of `size` bytes lie in a view, refused unless view and buffer hold them.
    fn layout(&mut self, view: usize, offset: u64, count: u64, size: usize, place: Place) -> Result<Layout, Refusal> {
        let json = self.root.buffer_views.get(view).ok_or_else(|| missing("bufferView", view))?;
        let buffer = json.buffer.value();
        let available = self.fetch(buffer)?.len() as u64;
        let stride = json.byte_stride.map_or(size, |stride| stride.0);
        let view_start = json.byte_offset.map_or(0, |offset| offset.0);
        let outside = || Refusal::malformed(place, format!("its {count} values reach outside of bufferView {view}"));
        if stride < size {
            return Err(Refusal::malformed(
                Place::Item("bufferView", view),
                format!("a stride of {stride} bytes for values of {size}"),
            ));
        }
        let view_end =
            view_start.checked_add(json.byte_length.0).filter(|end| *end <= available).ok_or_else(outside)?;
        let start = view_start.checked_add(offset).ok_or_else(outside)?;
        let span = match count {
            0 => 0,
            _ => (count - 1)
                .checked_mul(stride as u64)
                .and_then(|span| span.checked_add(size as u64))
                .ok_or_else(outside)?,
        };
        start.checked_add(span).filter(|end| *end <= view_end).ok_or_else(outside)?;
        Ok(Layout { buffer, start: start as usize, stride, count: count as usize })
    }

    /// The bytes of a buffer: the binary chunk, a data URI, or a file that the caller finds.
    fn fetch(&mut self, index: usize) -> Result<&[u8], Refusal> {
        let json = self.root.buffers.get(index).ok_or_else(|| missing("buffer", index))?;
        if self.loaded[index].is_none() {
            let bytes = match &json.uri {
                None if index == 0 => self.binary.map(Cow::Borrowed),
                None => None,
                Some(uri) if uri.starts_with("data:") => container::decode_data_uri(uri).map(Cow::Owned),
                Some(uri) => match self.same_uri(uri) {
                    // One file under many buffers is held once: buffers are then views of the first.
                    Some(_) => {
                        return Err(Refusal::malformed(Place::Item("buffer", index), "two buffers share one file"));
                    }
                    None => (self.resolve)(&container::decode_percent(uri)).map(Cow::Owned),
                },
            };
            let name = json.uri.as_deref().unwrap_or("the binary chunk");
            let missing = || Refusal::new(Place::Item("buffer", index), Problem::MissingFile(excerpt(name.as_bytes())));
            self.loaded[index] = Some(bytes.ok_or_else(missing)?);
        }
        Ok(self.loaded[index].as_deref().unwrap_or_default())
    }

    /// A loaded buffer of the same file.
    fn same_uri(&self, uri: &str) -> Option<usize> {
        let same = |i: &usize| self.loaded[*i].is_some() && self.root.buffers[*i].uri.as_deref() == Some(uri);
        (0..self.loaded.len()).find(same)
    }
}

fn component(accessor: &Accessor, place: Place) -> Result<ComponentType, Refusal> {
    match accessor.component_type {
        Checked::Valid(component) => Ok(component.0),
        Checked::Invalid => Err(Refusal::malformed(place, "values of an unknown type")),
    }
}

/// Requires: as many bytes as the component has.
fn integer(bytes: &[u8], component: ComponentType) -> u32 {
    match component {
        ComponentType::U8 | ComponentType::I8 => u32::from(bytes[0]),
        ComponentType::U16 | ComponentType::I16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        ComponentType::U32 | ComponentType::F32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    }
}

/// Requires: as many bytes as the component has.
fn number(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let bits = integer(bytes, component);
    let (value, most) = match component {
        ComponentType::F32 => return f32::from_bits(bits),
        ComponentType::I8 => (f32::from(bits as u8 as i8), 127.0),
        ComponentType::I16 => (f32::from(bits as u16 as i16), 32767.0),
        ComponentType::U8 => (bits as f32, 255.0),
        ComponentType::U16 => (bits as f32, 65535.0),
        ComponentType::U32 => (bits as f32, u32::MAX as f32),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}
