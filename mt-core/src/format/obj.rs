//! Reads OBJ: `tobj` parses, this file decides what it gets to see.
//!
//! `tobj` divides positions by a fourth coordinate, starts a new mesh at every group or material,
//! renumbers vertices by first use, and fails on byte order marks, continued lines, old Macintosh
//! line ends and comments that are not UTF-8. So it is fed `v` and `f` lines only, cleaned, one at
//! a time, which also tells the line of an error. Before them it gets polygons that name every vertex
//! in order, so that its renumbering by first use is the order of the file; they are taken off again.

use super::error::{Place, Problem, Refusal, excerpt};
use super::soup::Soup;
use super::words::{is_space, parse, text_start};
use glam::Vec3;
use std::io::{BufRead, Read};

/// Vertices named by each of the leading polygons.
const LEAD: usize = 1024;

pub(super) fn read(bytes: &[u8]) -> Result<Soup, Refusal> {
    let text = &bytes[text_start(bytes)?..];
    let vertex_count = Lines::new(text).filter(|line| keyword(line.text) == b"v").count();
    let mut feeder = Feeder::new(text, vertex_count);
    let options = tobj::LoadOptions::default();
    let loaded = tobj::load_obj_buf(&mut feeder, &options, |_| Err(tobj::LoadError::GenericFailure));
    let (models, _) = loaded.map_err(|error| refusal(error, text, &feeder, vertex_count))?;
    // Without groups and materials there is one model, or none when there were no faces.
    let mesh = models.into_iter().next().map(|model| model.mesh).unwrap_or_default();
    let mut soup = Soup::default();
    soup.notes = feeder.notes();
    soup.left.other_elements = feeder.other_elements;
    soup.positions = mesh.positions.chunks_exact(3).map(|p| Vec3::new(p[0], p[1], p[2])).collect();
    collect_faces(&mut soup, &mesh, vertex_count);
    refuse_not_finite(&soup, text)?;
    Ok(soup)
}

/// Takes the faces behind the leading polygons.
fn collect_faces(soup: &mut Soup, mesh: &tobj::Mesh, vertex_count: usize) {
    let lead = vertex_count.div_ceil(LEAD);
    let indices = &mesh.indices[vertex_count.min(mesh.indices.len())..];
    if mesh.face_arities.is_empty() {
        // tobj leaves the arities out when all faces are triangles, the leading ones too.
        soup.triangles.reserve_exact(indices.len() / 3);
        indices.chunks_exact(3).for_each(|face| soup.push_face(face));
        return;
    }
    let arities = mesh.face_arities.get(lead..).unwrap_or_default();
    soup.triangles.reserve(arities.len());
    let mut at = 0;
    for &arity in arities {
        let end = (at + arity as usize).min(indices.len());
        soup.push_face(&indices[at..end]);
        at = end;
    }
}

/// As [`Soup::check_positions`], with the line.
fn refuse_not_finite(soup: &Soup, text: &[u8]) -> Result<(), Refusal> {
    soup.check_positions().map_err(|refusal| {
        let vertex = soup.first_not_finite().unwrap_or_default();
        let line = Lines::new(text).filter(|line| keyword(line.text) == b"v").nth(vertex);
        Refusal::new(line.map_or(refusal.place, |line| Place::Line(line.number)), refusal.problem)
    })
}

/// What went wrong and where, from tobj's error (which tells neither) and a second look.
fn refusal(error: tobj::LoadError, text: &[u8], feeder: &Feeder<'_>, vertex_count: usize) -> Refusal {
    let line = Place::Line(feeder.line.number);
    match error {
        tobj::LoadError::FaceVertexOutOfBounds => first_out_of_range(text, vertex_count),
        tobj::LoadError::PositionParseError => {
            Refusal::malformed(line, format!("{:?} is not a vertex of three numbers", excerpt(feeder.line.text)))
        }
        tobj::LoadError::FaceParseError => {
            Refusal::malformed(line, format!("{:?} is not a face", excerpt(feeder.line.text)))
        }
        error => Refusal::malformed(line, error.to_string()),
    }
}

/// The first face index without a vertex. Zero is out of range in OBJ, negative counts back from the line.
fn first_out_of_range(text: &[u8], count: usize) -> Refusal {
    let mut before = 0;
    for line in Lines::new(text) {
        match keyword(line.text) {
            b"v" => before += 1,
            b"f" => {
                for word in without_comment(line.text).split(is_separator).filter(|word| !word.is_empty()).skip(1) {
                    let Some(index) = word.split(|b| *b == b'/').next().and_then(parse::<i64>) else {
                        let what = format!("{:?} names no vertex", excerpt(word));
                        return Refusal::malformed(Place::Line(line.number), what);
                    };
                    let absolute = if index < 0 { index.saturating_add(before + 1) } else { index };
                    if absolute < 1 || absolute > count as i64 {
                        return Refusal::new(Place::Line(line.number), Problem::IndexOutOfRange { index, count });
                    }
                }
            }
            _ => {}
        }
    }
    Refusal::malformed(Place::File, "a face names a vertex that is not there")
}

/// A line without its end, and its number from 1. A continued line holds its backslashes and inner line ends.
#[derive(Clone, Copy, Default)]
struct Line<'a> {
    text: &'a [u8],
    number: usize,
    continued: bool,
}

/// Lines ended by LF, CR LF or CR, and continued by a final backslash unless they are comments.
struct Lines<'a> {
    rest: &'a [u8],
    /// Number of the line that comes next.
    number: usize,
}

impl<'a> Lines<'a> {
    fn new(rest: &'a [u8]) -> Self {
        Self { rest, number: 1 }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        let number = self.number;
        let mut next = 0;
        let end = loop {
            let end = next
                + self.rest[next..].iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(self.rest.len() - next);
            let skip = if self.rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
            next = (end + skip).min(self.rest.len());
            self.number += 1;
            let continued = self.rest[..end].ends_with(b"\\") && next < self.rest.len();
            if !continued || keyword(self.rest).starts_with(b"#") {
                break end;
            }
        };
        let text = &self.rest[..end];
        self.rest = &self.rest[next..];
        Some(Line { text, number, continued: self.number > number + 1 })
    }
}

/// White space, or the backslash of a continued line.
fn is_separator(byte: &u8) -> bool {
    is_space(*byte) || *byte == b'\\'
}

/// The first word of a line.
fn keyword(line: &[u8]) -> &[u8] {
    let start = line.iter().position(|b| !matches!(b, b' ' | b'\t')).unwrap_or(line.len());
    let line = &line[start..];
    &line[..line.iter().position(is_separator).unwrap_or(line.len())]
}

fn without_comment(line: &[u8]) -> &[u8] {
    &line[..line.iter().position(|&b| b == b'#').unwrap_or(line.len())]
}

/// Hands tobj one cleaned line at a time, and remembers what it kept back.
struct Feeder<'a> {
    lines: Lines<'a>,
    vertex_count: usize,
    /// Vertices already named by leading polygons.
    named: usize,
    /// What tobj reads now, up to and with its line end.
    buffer: Vec<u8>,
    read: usize,
    /// The line that `buffer` comes from.
    line: Line<'a>,
    weights: usize,
    groups: usize,
    other_elements: usize,
}

impl<'a> Feeder<'a> {
    fn new(text: &'a [u8], vertex_count: usize) -> Self {
        Self {
            lines: Lines::new(text),
            vertex_count,
            named: 0,
            buffer: Vec::new(),
            read: 0,
            line: Line::default(),
            weights: 0,
            groups: 0,
            other_elements: 0,
        }
    }

    /// Remarks for the report.
    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.weights > 0 {
            notes.push(format!("{} vertices have a fourth coordinate, which is ignored", self.weights));
        }
        if self.groups > 1 {
            notes.push(format!("{} objects and groups read as one mesh", self.groups));
        }
        notes
    }

    /// Fills the buffer with the next line for tobj; leaves it empty at the end.
    fn refill(&mut self) {
        self.buffer.clear();
        self.read = 0;
        if self.named < self.vertex_count {
            return self.name_vertices();
        }
        while let Some(line) = self.lines.next() {
            let word = keyword(line.text);
            if !matches!(word, b"v" | b"f") {
                self.count_skipped(word);
                continue;
            }
            self.line = line;
            let whole = without_comment(line.text);
            let end = if word == b"v" { self.end_of_position(whole) } else { whole.len() };
            self.buffer.extend_from_slice(&whole[..end]);
            if line.continued {
                self.buffer.iter_mut().filter(|b| is_separator(b)).for_each(|b| *b = b' ');
            }
            self.buffer.push(b'\n');
            return;
        }
    }

    /// One leading polygon, see the head of this file.
    fn name_vertices(&mut self) {
        let end = (self.named + LEAD).min(self.vertex_count);
        self.buffer.push(b'f');
        for vertex in self.named + 1..=end {
            self.buffer.push(b' ');
            self.buffer.extend_from_slice(vertex.to_string().as_bytes());
        }
        self.buffer.push(b'\n');
        self.named = end;
    }

    /// Counts a statement that is not handed on.
    fn count_skipped(&mut self, word: &[u8]) {
        match word {
            b"o" | b"g" => self.groups += 1,
            b"l" | b"p" | b"curv" | b"curv2" | b"surf" => self.other_elements += 1,
            _ => {}
        }
    }

    /// The end of the third number: behind it come a weight or colours, which are not for tobj.
    fn end_of_position(&mut self, line: &[u8]) -> usize {
        let mut ends = line
            .iter()
            .enumerate()
            .filter(|&(i, b)| !is_separator(b) && line.get(i + 1).is_none_or(is_separator))
            .map(|(i, _)| i + 1);
        // The keyword is the first word.
        let end = ends.nth(3).unwrap_or(line.len());
        if let (Some(weight_end), None) = (ends.next(), ends.next()) {
            let weight: Option<f32> = parse(line[end..weight_end].trim_ascii());
            self.weights += usize::from(weight != Some(1.0));
        }
        end
    }
}

impl Read for Feeder<'_> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Feeder<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        if self.read == self.buffer.len() {
            self.refill();
        }
        Ok(&self.buffer[self.read..])
    }

    fn consume(&mut self, count: usize) {
        self.read += count;
    }
}
