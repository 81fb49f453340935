//! A container in a file, of which only what is asked for is read.

use super::layout::{self, Entry};
use super::{ContainerError, Meta, meta_of, missing};
use std::io::{Read, Seek};

/// A container whose head has been read and checked. Its sections are read and checked when they are asked for.
pub struct Archive<R> {
    source: R,
    entries: Vec<Entry>,
    meta: Meta,
}

/// A section of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SectionInfo {
    /// Four letters.
    pub name: String,
    /// Bytes in the file.
    pub stored: u64,
    /// Bytes when unpacked.
    pub length: u64,
}

impl<R: Read + Seek> Archive<R> {
    /// Reads head and metadata. Refuses what is truncated, altered or newer; never panics. O(metadata).
    pub fn open(mut source: R) -> Result<Self, ContainerError> {
        let entries = layout::read_table(&mut source)?.entries;
        let entry = *entries.iter().find(|entry| entry.name == *b"META").ok_or_else(|| missing(b"META"))?;
        entry.check_meta()?;
        let meta = meta_of(&layout::read_section(&mut source, &entry)?)?;
        Ok(Self { source, entries, meta })
    }

    /// What the file says about its model.
    pub fn meta(&self) -> &Meta {
        &self.meta
    }

    /// All sections, in the order of the file.
    pub fn sections(&self) -> impl Iterator<Item = SectionInfo> + '_ {
        self.entries.iter().map(|entry| SectionInfo {
            name: String::from_utf8_lossy(&entry.name).into_owned(),
            stored: entry.stored,
            length: entry.length,
        })
    }

    /// The bytes of the section of this name, unpacked. O(section).
    pub fn section(&mut self, name: &[u8; 4]) -> Result<Vec<u8>, ContainerError> {
        let entry = *self.entries.iter().find(|entry| entry.name == *name).ok_or_else(|| missing(name))?;
        layout::read_section(&mut self.source, &entry)
    }
}
