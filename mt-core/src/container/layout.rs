//! Head, table and sections as bytes: lengths and checksums, and no byte that nobody checks.

use super::pack::{Packing, unpack};
use super::{ContainerError, VERSION};
use std::borrow::Cow;
use std::io::{self, Read, Seek, SeekFrom, Write};

const MAGIC: [u8; 8] = *b"\x89MT\r\n\x1a\n\0";
const HEAD: usize = 24;
const ALIGN: u64 = 64;
/// More sections than any version will have; bounds what a damaged head can ask for.
const SECTIONS_MAX: u32 = 64;
/// No packing makes bytes fewer than this share of what they are: so many bytes of what a section claims to be are believed
/// for each that is there.
const SWELL_MAX: u64 = 1 << 16;

/// More metadata than any file has.
const META_MAX: u64 = 16 << 20;

/// Bytes of an entry of the table. The second version says how a section is packed.
fn entry_len(version: u32) -> usize {
    if version == 1 { 24 } else { 40 }
}

/// A named run of bytes, as it goes into a file.
pub(super) struct Section<'a> {
    pub(super) name: [u8; 4],
    pub(super) bytes: Cow<'a, [u8]>,
    pub(super) packing: Packing,
    /// Bytes before packing.
    pub(super) length: u64,
}

/// Where a section lies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) name: [u8; 4],
    crc: u32,
    offset: u64,
    /// Bytes in the file.
    pub(super) stored: u64,
    /// Bytes when unpacked.
    pub(super) length: u64,
    packing: Packing,
}

impl Entry {
    /// Refuses metadata that is no text of a reasonable length, before it is unpacked.
    pub(super) fn check_meta(&self) -> Result<(), ContainerError> {
        let fits = self.length <= META_MAX;
        if fits { Ok(()) } else { Err(ContainerError::Layout(format!("{} bytes of metadata", self.length))) }
    }

    /// What to call it in errors.
    pub(super) fn title(&self) -> String {
        format!("section {}", String::from_utf8_lossy(&self.name))
    }

    fn check(&self, stored: &[u8]) -> Result<(), ContainerError> {
        if crc32fast::hash(stored) == self.crc { Ok(()) } else { Err(ContainerError::Altered(self.title())) }
    }

    /// The section whose bytes in the file are these, once they have been checked.
    pub(super) fn unpacked<'a>(&self, stored: &'a [u8]) -> Result<Cow<'a, [u8]>, ContainerError> {
        let altered = || ContainerError::Altered(self.title());
        if self.packing == Packing::Plain {
            return Ok(Cow::Borrowed(stored));
        }
        let length = usize::try_from(self.length).map_err(|_| altered())?;
        unpack(stored, self.packing, length).map(Cow::Owned).ok_or_else(altered)
    }
}

/// What the head says.
pub(super) struct Table {
    pub(super) entries: Vec<Entry>,
    /// Bytes of head and table.
    end: usize,
}

/// Writes head, table and sections, in the oldest version that can hold them and that knows what they hold: `since`.
pub(super) fn write(sections: &[Section<'_>], since: u32, out: &mut impl Write) -> io::Result<()> {
    let plain = sections.iter().all(|section| section.packing == Packing::Plain);
    let version = if plain { since } else { VERSION };
    let mut offset = aligned((HEAD + entry_len(version) * sections.len() + 4) as u64);
    let mut table = Vec::new();
    for section in sections {
        table.extend_from_slice(&section.name);
        table.extend_from_slice(&crc32fast::hash(&section.bytes).to_le_bytes());
        table.extend_from_slice(&offset.to_le_bytes());
        table.extend_from_slice(&(section.bytes.len() as u64).to_le_bytes());
        if version > 1 {
            table.extend_from_slice(&section.length.to_le_bytes());
            table.extend_from_slice(&section.packing.to_bytes());
            table.extend_from_slice(&[0; 6]);
        }
        offset = aligned(offset + section.bytes.len() as u64);
    }
    let mut head = MAGIC.to_vec();
    head.extend_from_slice(&version.to_le_bytes());
    head.extend_from_slice(&(sections.len() as u32).to_le_bytes());
    head.extend_from_slice(&offset.to_le_bytes());
    head.extend_from_slice(&table);
    let crc = crc32fast::hash(&head);
    head.extend_from_slice(&crc.to_le_bytes());
    write_padded(&head, out)?;
    sections.iter().try_for_each(|section| write_padded(&section.bytes, out))
}

fn aligned(offset: u64) -> u64 {
    offset.next_multiple_of(ALIGN)
}

fn write_padded(bytes: &[u8], out: &mut impl Write) -> io::Result<()> {
    out.write_all(bytes)?;
    let padding = aligned(bytes.len() as u64) as usize - bytes.len();
    out.write_all(&[0; ALIGN as usize][..padding])
}

/// The table of a file that is `found` bytes long and begins with these bytes.
fn table(start: &[u8], found: u64) -> Result<Table, ContainerError> {
    let magic = &start[..start.len().min(MAGIC.len())];
    if start.is_empty() || magic != &MAGIC[..magic.len()] {
        return Err(ContainerError::NotAModel);
    }
    if start.len() < HEAD {
        return Err(ContainerError::Truncated { expected: HEAD as u64, found });
    }
    let (version, count, length) = (u32_at(start, 8), u32_at(start, 12), u64_at(start, 16));
    if version > VERSION {
        return Err(ContainerError::Newer(version));
    }
    if version == 0 {
        return Err(ContainerError::Layout("there is no format version 0".into()));
    }
    if count > SECTIONS_MAX {
        return Err(ContainerError::Altered("the head".into()));
    }
    let end = HEAD + entry_len(version) * count as usize;
    if start.len() < end + 4 {
        return Err(ContainerError::Truncated { expected: end as u64 + 4, found });
    }
    if crc32fast::hash(&start[..end]) != u32_at(start, end) {
        return Err(ContainerError::Altered("the head".into()));
    }
    if found < length {
        return Err(ContainerError::Truncated { expected: length, found });
    }
    if found > length {
        return Err(ContainerError::Layout(format!("{} bytes too many", found - length)));
    }
    let rows = start[HEAD..end].chunks_exact(entry_len(version));
    let entries: Vec<Entry> = rows.map(entry).collect::<Result<_, _>>()?;
    let mut from = end as u64 + 4;
    for entry in &entries {
        let ends = entry.offset.checked_add(entry.stored).filter(|&ends| ends <= length && entry.offset >= from);
        from = ends.ok_or_else(|| ContainerError::Layout(format!("{} lies outside the file", entry.title())))?;
    }
    Ok(Table { entries, end: end + 4 })
}

fn entry(row: &[u8]) -> Result<Entry, ContainerError> {
    let name = [0, 1, 2, 3].map(|k| row[k]);
    let stored = u64_at(row, 16);
    let (length, packing) = match row.get(24..) {
        Some([.., kind, columns, 0, 0, 0, 0, 0, 0]) => (u64_at(row, 24), Packing::from_bytes([*kind, *columns])),
        Some([_, ..]) => (stored, None),
        _ => (stored, Some(Packing::Plain)),
    };
    let entry = |packing| Entry { name, crc: u32_at(row, 4), offset: u64_at(row, 8), stored, length, packing };
    let fits = |packing: &Packing| match packing {
        Packing::Plain => length == stored,
        // What is packed is a frame, which is never nothing.
        _ => stored > 0 && length <= stored.saturating_mul(SWELL_MAX),
    };
    let unknown =
        || ContainerError::Layout(format!("section {} is packed in no known way", String::from_utf8_lossy(&name)));
    packing.filter(fits).map(entry).ok_or_else(unknown)
}

/// The sections of a file, with every byte of it accounted for.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<(Entry, &[u8])>, ContainerError> {
    let table = table(bytes, bytes.len() as u64)?;
    let mut end = table.end;
    let mut sections = Vec::with_capacity(table.entries.len());
    for entry in table.entries {
        let span = usize::try_from(entry.offset).ok().zip(usize::try_from(entry.stored).ok());
        let body = span.and_then(|(from, length)| bytes.get(from..from.checked_add(length)?));
        let gap = span.and_then(|(from, _)| bytes.get(end..from));
        let (Some(body), Some(gap)) = (body, gap) else {
            return Err(ContainerError::Layout(format!("{} lies outside the file", entry.title())));
        };
        entry.check(body)?;
        check_gap(gap)?;
        end = entry.offset as usize + body.len();
        sections.push((entry, body));
    }
    check_gap(&bytes[end..])?;
    Ok(sections)
}

fn check_gap(gap: &[u8]) -> Result<(), ContainerError> {
    let clean = gap.len() < ALIGN as usize && gap.iter().all(|&b| b == 0);
    if clean { Ok(()) } else { Err(ContainerError::Altered("the space between sections".into())) }
}

/// The table of a file, of which nothing else is read.
pub(super) fn read_table(source: &mut (impl Read + Seek)) -> Result<Table, ContainerError> {
    let told = |error: io::Error| ContainerError::Unreadable(error.to_string());
    let found = source.seek(SeekFrom::End(0)).map_err(told)?;
    source.rewind().map_err(told)?;
    let most = HEAD + entry_len(VERSION) * SECTIONS_MAX as usize + 4;
    let mut start = Vec::new();
    source.take(most as u64).read_to_end(&mut start).map_err(told)?;
    table(&start, found)
}

/// One section of a file, of which nothing else is read.
pub(super) fn read_section(source: &mut (impl Read + Seek), entry: &Entry) -> Result<Vec<u8>, ContainerError> {
    let told = |error: io::Error| ContainerError::Unreadable(error.to_string());
    source.seek(SeekFrom::Start(entry.offset)).map_err(told)?;
    let mut stored = Vec::new();
    source.take(entry.stored).read_to_end(&mut stored).map_err(told)?;
    entry.check(&stored)?;
    Ok(entry.unpacked(&stored)?.into_owned())
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([0, 1, 2, 3].map(|i| bytes[at + i]))
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes([0, 1, 2, 3, 4, 5, 6, 7].map(|i| bytes[at + i]))
}
