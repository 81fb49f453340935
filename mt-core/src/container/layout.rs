//! Head, table and sections as bytes: lengths and checksums, and no byte that nobody checks.

use super::{ContainerError, VERSION};
use std::io::Write;

const MAGIC: [u8; 8] = *b"\x89MT\r\n\x1a\n\0";
const HEAD: usize = 24;
const ENTRY: usize = 24;
const ALIGN: u64 = 64;
/// More sections than any version will have; bounds what a damaged head can ask for.
const SECTIONS_MAX: u32 = 64;

/// A named run of bytes.
#[derive(Clone, Copy)]
pub(super) struct Section<'a> {
    pub(super) name: [u8; 4],
    pub(super) bytes: &'a [u8],
}

/// Writes head, table and sections.
pub(super) fn write(sections: &[Section<'_>], out: &mut impl Write) -> std::io::Result<()> {
    let mut offset = aligned((HEAD + ENTRY * sections.len() + 4) as u64);
    let mut table = Vec::new();
    for section in sections {
        table.extend_from_slice(&section.name);
        table.extend_from_slice(&crc32fast::hash(section.bytes).to_le_bytes());
        table.extend_from_slice(&offset.to_le_bytes());
        table.extend_from_slice(&(section.bytes.len() as u64).to_le_bytes());
        offset = aligned(offset + section.bytes.len() as u64);
    }
    let mut head = MAGIC.to_vec();
    head.extend_from_slice(&VERSION.to_le_bytes());
    head.extend_from_slice(&(sections.len() as u32).to_le_bytes());
    head.extend_from_slice(&offset.to_le_bytes());
    head.extend_from_slice(&table);
    let crc = crc32fast::hash(&head);
    head.extend_from_slice(&crc.to_le_bytes());
    write_padded(&head, out)?;
    sections.iter().try_for_each(|section| write_padded(section.bytes, out))
}

fn aligned(offset: u64) -> u64 {
    offset.next_multiple_of(ALIGN)
}

fn write_padded(bytes: &[u8], out: &mut impl Write) -> std::io::Result<()> {
    out.write_all(bytes)?;
    let padding = aligned(bytes.len() as u64) as usize - bytes.len();
    out.write_all(&[0; ALIGN as usize][..padding])
}

/// The sections of a file, with every byte of it accounted for.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Section<'_>>, ContainerError> {
    let found = bytes.len() as u64;
    let start = &bytes[..bytes.len().min(MAGIC.len())];
    if bytes.is_empty() || start != &MAGIC[..start.len()] {
        return Err(ContainerError::NotAModel);
    }
    if bytes.len() < HEAD {
        return Err(ContainerError::Truncated { expected: HEAD as u64, found });
    }
    let (version, count, length) = (u32_at(bytes, 8), u32_at(bytes, 12), u64_at(bytes, 16));
    if version > VERSION {
        return Err(ContainerError::Newer(version));
    }
    if version == 0 {
        return Err(ContainerError::Layout("there is no format version 0".into()));
    }
    if count > SECTIONS_MAX {
        return Err(ContainerError::Altered("the head".into()));
    }
    let table_end = HEAD + ENTRY * count as usize;
    if bytes.len() < table_end + 4 {
        return Err(ContainerError::Truncated { expected: table_end as u64 + 4, found });
    }
    if crc32fast::hash(&bytes[..table_end]) != u32_at(bytes, table_end) {
        return Err(ContainerError::Altered("the head".into()));
    }
    if found < length {
        return Err(ContainerError::Truncated { expected: length, found });
    }
    if found > length {
        return Err(ContainerError::Layout(format!("{} bytes too many", found - length)));
    }
    sections(bytes, count as usize, table_end + 4)
}

fn sections(bytes: &[u8], count: usize, mut end: usize) -> Result<Vec<Section<'_>>, ContainerError> {
    let mut sections = Vec::with_capacity(count);
    for i in 0..count {
        let entry = HEAD + ENTRY * i;
        let name = [0, 1, 2, 3].map(|k| bytes[entry + k]);
        let (crc, offset, length) = (u32_at(bytes, entry + 4), u64_at(bytes, entry + 8), u64_at(bytes, entry + 16));
        let title = || format!("section {}", String::from_utf8_lossy(&name));
        let span = usize::try_from(offset).ok().zip(usize::try_from(length).ok());
        let body = span.and_then(|(from, length)| bytes.get(from..from.checked_add(length)?));
        let gap = span.and_then(|(from, _)| bytes.get(end..from));
        let (Some(body), Some(gap)) = (body, gap) else {
            return Err(ContainerError::Layout(format!("{} lies outside the file", title())));
        };
        if crc32fast::hash(body) != crc {
            return Err(ContainerError::Altered(title()));
        }
        check_gap(gap)?;
        end = offset as usize + body.len();
        sections.push(Section { name, bytes: body });
    }
    check_gap(&bytes[end..])?;
    Ok(sections)
}

fn check_gap(gap: &[u8]) -> Result<(), ContainerError> {
    let clean = gap.len() < ALIGN as usize && gap.iter().all(|&b| b == 0);
    if clean { Ok(()) } else { Err(ContainerError::Altered("the space between sections".into())) }
}

/// The bytes of the section of this name.
pub(super) fn find<'a>(sections: &[Section<'a>], name: &[u8; 4]) -> Result<&'a [u8], ContainerError> {
    let missing = || ContainerError::Layout(format!("section {} is missing", String::from_utf8_lossy(name)));
    sections.iter().find(|section| section.name == *name).map(|section| section.bytes).ok_or_else(missing)
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([0, 1, 2, 3].map(|i| bytes[at + i]))
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes([0, 1, 2, 3, 4, 5, 6, 7].map(|i| bytes[at + i]))
}
