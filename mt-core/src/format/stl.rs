//! Reads STL, text and binary. A read triangle has three vertices of its own; the weld joins them.
//!
//! Our own reader rather than `stl_io`: that one takes every file that begins with `solid ` for
//! text, which many binary files do, and names no lines.

use super::error::{Place, Problem, Refusal, excerpt};
use super::soup::Soup;
use super::words::Words;
use glam::Vec3;

const HEADER_BYTES: usize = 84;
const TRIANGLE_BYTES: usize = 50;

pub(super) fn read(bytes: &[u8]) -> Result<Soup, Refusal> {
    // The size decides: a binary file may begin with "solid", but a text file will not have
    // a size that follows from its bytes 80 to 84.
    let declared = bytes.get(80..HEADER_BYTES).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let exact = |count: u32| HEADER_BYTES as u64 + u64::from(count) * TRIANGLE_BYTES as u64;
    let text = bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    match declared {
        Some(count) if exact(count) == bytes.len() as u64 => Ok(read_binary(bytes, count)),
        _ if text => read_text(bytes),
        Some(count) if exact(count) < bytes.len() as u64 => {
            let mut soup = read_binary(bytes, count);
            soup.notes.push(format!("{} bytes after the last triangle ignored", bytes.len() as u64 - exact(count)));
            Ok(soup)
        }
        Some(count) => {
            let problem =
                Problem::CountTooLarge { what: "triangles".into(), declared: count.into(), bytes: bytes.len() };
            Err(Refusal::new(Place::Byte(80), problem))
        }
        None => Err(Refusal::malformed(Place::File, "neither text (solid ...) nor long enough for binary")),
    }
}

/// Requires: the bytes hold `count` triangles.
fn read_binary(bytes: &[u8], count: u32) -> Soup {
    let mut soup = Soup::default();
    soup.positions.reserve_exact(3 * count as usize);
    for triangle in bytes[HEADER_BYTES..].chunks_exact(TRIANGLE_BYTES).take(count as usize) {
        // 12 bytes of normal, then the corners, then two bytes of attributes.
        for corner in triangle[12..48].chunks_exact(12) {
            let float = |at: usize| f32::from_le_bytes([corner[at], corner[at + 1], corner[at + 2], corner[at + 3]]);
            soup.positions.push(Vec3::new(float(0), float(4), float(8)));
        }
    }
    number_triangles(&mut soup);
    soup
}

/// Only `vertex` lines carry what we want; the other words must be those of the grammar.
fn read_text(bytes: &[u8]) -> Result<Soup, Refusal> {
    let mut soup = Soup::default();
    let mut words = Words::new(bytes, 0);
    let mut solids = 0;
    let mut corners = 0;
    while let Some(word) = words.next() {
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => {
                solids += 1;
                words.rest_of_line();
            }
            b"endsolid" | b"facet" => {
                words.rest_of_line();
            }
            b"outer" => {
                words.rest_of_line();
                corners = 0;
            }
            b"vertex" => {
                let mut coordinate = || words.number::<f32>("a vertex");
                soup.positions.push(Vec3::new(coordinate()?, coordinate()?, coordinate()?));
                corners += 1;
            }
            b"endloop" if corners == 3 => corners = 0,
            b"endloop" => {
                return Err(Refusal::malformed(words.line(), format!("a loop of {corners} vertices instead of 3")));
            }
            b"endfacet" => {}
            _ => return Err(Refusal::malformed(words.line(), format!("{:?} is no word of STL", excerpt(word)))),
        }
    }
    if soup.positions.len() % 3 != 0 || corners != 0 {
        return Err(Refusal::new(words.line(), Problem::Truncated("a triangle".into())));
    }
    if solids > 1 {
        soup.notes.push(format!("{solids} solids read as one mesh"));
    }
    number_triangles(&mut soup);
    Ok(soup)
}

fn number_triangles(soup: &mut Soup) {
    soup.faces = soup.positions.len() / 3;
    soup.triangles = (0..soup.faces as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
}
