//! The header of a PLY file: encoding, elements, properties.

use crate::format::error::{Place, Problem, Refusal, excerpt};
use crate::format::words::{line_of, parse as parse_number};

/// More elements or properties than any real file has.
const LIMIT: usize = 1000;

#[derive(Debug)]
pub(super) enum Encoding {
    Text,
    Binary { big: bool },
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the first element begins.
    pub(super) body: usize,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// A number, or a list: type of its count, type of its items.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Scalar(Scalar),
    List(Scalar, Scalar),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) const fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }
}

/// Reads the lines up to `end_header`; the place where the body begins.
fn parse_lines(bytes: &[u8], header: &mut Option<Encoding>, elements: &mut Vec<Element>) -> Result<usize, Refusal> {
    let mut at = 0;
    while at < bytes.len() {
        let start = at;
        let length = bytes[at..].iter().position(|b| matches!(b, b'\n' | b'\r'));
        let Some(length) = length.or((bytes[at..].trim_ascii() == b"end_header").then_some(bytes.len() - at)) else {
            break;
        };
        let line = &bytes[at..at + length];
        at += length + if bytes[at + length..].starts_with(b"\r\n") { 2 } else { 1 };
        if line.trim_ascii() == b"end_header" {
            return Ok(at.min(bytes.len()));
        }
        parse_line(line, header, elements).map_err(|problem| Refusal::new(line_of(bytes, start), problem))?;
    }
    Err(Refusal::new(line_of(bytes, bytes.len()), Problem::Truncated("the header (no end_header)".into())))
}

/// Reads the header. O(header).
pub(super) fn parse(bytes: &[u8]) -> Result<Header, Refusal> {
    if !bytes.starts_with(b"ply") {
        return Err(Refusal::malformed(Place::Line(1), "a PLY file begins with \"ply\""));
    }
    let (mut encoding, mut elements) = (None, Vec::new());
    let body = parse_lines(bytes, &mut encoding, &mut elements)?;
    let encoding = encoding.ok_or_else(|| Refusal::malformed(Place::File, "the header names no format"))?;
    Ok(Header { encoding, elements, body })
}

fn parse_line(line: &[u8], encoding: &mut Option<Encoding>, elements: &mut Vec<Element>) -> Result<(), Problem> {
    let malformed = |what: &str| Problem::Malformed(format!("{:?} {what}", excerpt(line)));
    let words: Vec<&[u8]> = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).take(6).collect();
    match words.as_slice() {
        [] | [b"ply"] | [b"comment", ..] | [b"obj_info", ..] => {}
        [b"format", name, ..] => {
            *encoding = Some(match *name {
                b"ascii" => Encoding::Text,
                b"binary_little_endian" => Encoding::Binary { big: false },
                b"binary_big_endian" => Encoding::Binary { big: true },
                _ => return Err(Problem::Unsupported(format!("the PLY format {:?}", excerpt(name)))),
            });
        }
        [b"element", name, count] => {
            let count = parse_number(count).ok_or_else(|| malformed("gives no count"))?;
            if elements.len() == LIMIT {
                return Err(Problem::TooLarge(format!("more than {LIMIT} kinds of elements")));
            }
            let name = String::from_utf8_lossy(name).into_owned();
            if elements.iter().any(|known| known.name == name) {
                return Err(malformed("declares an element a second time"));
            }
            elements.push(Element { name, count, properties: Vec::new() });
        }
        [b"property", b"list", count, item, name] => {
            let scalar = |name| Scalar::from_name(name).ok_or_else(|| malformed("names an unknown type"));
            let (count, item) = (scalar(count)?, scalar(item)?);
            if count.is_float() {
                return Err(malformed("counts with fractions"));
            }
            push_property(elements, name, Kind::List(count, item), line)?;
        }
        [b"property", kind, name] => {
            let scalar = Scalar::from_name(kind).ok_or_else(|| malformed("names an unknown type"))?;
            push_property(elements, name, Kind::Scalar(scalar), line)?;
        }
        _ => return Err(malformed("is no line of a PLY header")),
    }
    Ok(())
}

fn push_property(elements: &mut [Element], name: &[u8], kind: Kind, line: &[u8]) -> Result<(), Problem> {
    let Some(element) = elements.last_mut() else {
        return Err(Problem::Malformed(format!("{:?} stands before any element", excerpt(line))));
    };
    if element.properties.len() == LIMIT {
        return Err(Problem::TooLarge(format!("more than {LIMIT} properties")));
    }
    element.properties.push(Property { name: String::from_utf8_lossy(name).into_owned(), kind });
    Ok(())
}
