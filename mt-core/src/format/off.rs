//! Reads OFF: Geomview's text format with its header variants (`COFF`, `NOFF`, `STOFF`, ...).
//!
//! What follows a position on its line (normals, colours, texture coordinates) is skipped, and so
//! is what follows the corners of a face.

use super::error::{Place, Problem, Refusal, excerpt};
use super::soup::{Soup, index_of};
use super::words::{Words, check_count, parse, text_start};
use glam::Vec3;

/// Bytes of the shortest vertex (`0 0 0` and a line end) and the shortest face (`1 0`).
const VERTEX_BYTES: usize = 6;
const FACE_BYTES: usize = 2;

pub(super) fn read(bytes: &[u8]) -> Result<Soup, Refusal> {
    let mut words = Words::new(bytes, text_start(bytes)?);
    let [vertices, faces] = header(&mut words)?;
    let vertices = words.check_count("vertices", vertices, VERTEX_BYTES)?;
    let faces = words.check_count("faces", faces, FACE_BYTES)?;
    let mut soup = Soup::default();
    soup.positions.reserve_exact(vertices);
    for _ in 0..vertices {
        words.skip_comments();
        let mut coordinate = || words.number::<f32>("a vertex");
        soup.positions.push(Vec3::new(coordinate()?, coordinate()?, coordinate()?));
        words.rest_of_line();
    }
    soup.triangles.reserve(faces.min(words.remaining() / 8));
    let mut corners = Vec::new();
    for face in 0..faces {
        words.skip_comments();
        read_corners(&mut words, face, vertices, &mut corners)?;
        soup.push_face(&corners);
        words.rest_of_line();
    }
    words.skip_comments();
    if words.remaining() > 0 {
        soup.notes.push(format!("{} bytes after the last face ignored", words.remaining()));
    }
    Ok(soup)
}

fn read_corners(words: &mut Words<'_>, face: usize, vertices: usize, corners: &mut Vec<u32>) -> Result<(), Refusal> {
    let count = words.number::<u64>("a face")?;
    let count = words.check_count("corners of a face", count, FACE_BYTES)?;
    corners.clear();
    for _ in 0..count {
        corners.push(index_of(words.number::<i64>("a face")?, face, vertices)?);
        if corners.last().is_some_and(|corner| *corner as usize >= vertices) {
            let index = corners.last().copied().unwrap_or_default().into();
            return Err(Refusal::new(words.line(), Problem::IndexOutOfRange { index, count: vertices }));
        }
    }
    Ok(())
}

/// Reads the keyword, if there is one, and the counts of vertices and faces; the count of edges may be missing.
fn header(words: &mut Words<'_>) -> Result<[u64; 2], Refusal> {
    words.skip_comments();
    let mut first = words.next().ok_or_else(|| Refusal::new(Place::File, Problem::Empty))?;
    let mut from_keyword_line = words.rest_of_line();
    if let Some(prefix) = first.strip_suffix(b"OFF") {
        if prefix.contains(&b'4') || prefix.contains(&b'n') {
            let what = format!("{} (vertices that are not three-dimensional)", excerpt(first));
            return Err(Refusal::new(words.line(), Problem::Unsupported(what)));
        }
        if !prefix.iter().all(|letter| b"STNC".contains(letter)) {
            return Err(Refusal::malformed(words.line(), format!("{:?} is no OFF header", excerpt(first))));
        }
        let comment = from_keyword_line.iter().position(|&b| b == b'#').unwrap_or(from_keyword_line.len());
        let mut rest = Words::new(&from_keyword_line[..comment], 0);
        first = match rest.next() {
            Some(b"BINARY") => return Err(Refusal::new(words.line(), Problem::Unsupported("binary OFF".into()))),
            Some(word) => word,
            None => {
                words.skip_comments();
                let word =
                    words.next().ok_or_else(|| Refusal::new(words.line(), Problem::Truncated("the header".into())))?;
                from_keyword_line = words.rest_of_line();
                rest = Words::new(from_keyword_line, 0);
                word
            }
        };
        return counts(words, first, rest);
    }
    counts(words, first, Words::new(from_keyword_line, 0))
}

fn counts(words: &Words<'_>, first: &[u8], mut rest: Words<'_>) -> Result<[u64; 2], Refusal> {
    let not_a_number = |word: &[u8]| Refusal::new(words.line(), Problem::NotANumber(excerpt(word)));
    let second = rest.next().unwrap_or_default();
    let vertices = parse(first).ok_or_else(|| not_a_number(first))?;
    let faces = parse(second).ok_or_else(|| not_a_number(second))?;
    check_count(words.line(), "vertices", vertices, VERTEX_BYTES, words.remaining())?;
    Ok([vertices, faces])
}
