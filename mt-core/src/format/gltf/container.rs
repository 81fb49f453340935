//! The outside of a glTF file: the chunks of a GLB, and base64 in data URIs.

use crate::format::error::{Place, Problem, Refusal};

/// The JSON and, in a GLB, the binary chunk.
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

/// Splits a GLB into its chunks; other bytes are taken for JSON.
pub(super) fn split(bytes: &[u8]) -> Result<Container<'_>, Refusal> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Container { json: bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), binary: None });
    }
    let version = word(bytes, 4)?;
    if version != 2 {
        return Err(Refusal::new(Place::Byte(4), Problem::Unsupported(format!("GLB version {version}"))));
    }
    let length = word(bytes, 8)? as usize;
    if length != bytes.len() {
        let what = format!("the header declares {length} bytes, the file has {}", bytes.len());
        return Err(Refusal::malformed(Place::Byte(8), what));
    }
    let (json, at) = chunk(bytes, 12, b"JSON")?;
    // Chunks of other kinds may follow and are to be ignored.
    let binary = if at < bytes.len() { Some(chunk(bytes, at, b"BIN\0")?.0) } else { None };
    Ok(Container { json, binary })
}

fn word(bytes: &[u8], at: usize) -> Result<u32, Refusal> {
    let word = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
    let truncated = || Refusal::new(Place::Byte(at), Problem::Truncated("a header".into()));
    word.map(|word| u32::from_le_bytes(*word)).ok_or_else(truncated)
}

fn chunk<'a>(bytes: &'a [u8], at: usize, kind: &[u8; 4]) -> Result<(&'a [u8], usize), Refusal> {
    let length = word(bytes, at)? as usize;
    if word(bytes, at + 4)? != u32::from_le_bytes(*kind) {
        let what = format!("there should be a {} chunk", String::from_utf8_lossy(kind).trim_end_matches('\0'));
        return Err(Refusal::malformed(Place::Byte(at), what));
    }
    let start = at + 8;
    match start.checked_add(length).and_then(|end| Some((bytes.get(start..end)?, end))) {
        Some(found) => Ok(found),
        None => Err(Refusal::new(Place::Byte(at), Problem::Truncated("a chunk".into()))),
    }
}

/// The bytes of a data URI; `None` when it is not base64.
pub(super) fn decode_data_uri(uri: &str) -> Option<Vec<u8>> {
    let (kind, text) = uri.strip_prefix("data:")?.split_once(',')?;
    kind.ends_with(";base64").then_some(())?;
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut bits = 0;
        for &letter in group {
            bits = (bits << 6) | sextet(letter)?;
        }
        // Two letters hold one byte, three hold two.
        let whole = match group.len() {
            4 => 3,
            3 => 2,
            2 => 1,
            _ => return None,
        };
        let aligned = bits << (32 - 6 * group.len() as u32);
        bytes.extend_from_slice(&aligned.to_be_bytes()[..whole]);
    }
    Some(bytes)
}

fn sextet(letter: u8) -> Option<u32> {
    Some(u32::from(match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' | b'-' => 62,
        b'/' | b'_' => 63,
        _ => return None,
    }))
}

/// A relative URI with its `%20` and the like decoded.
pub(super) fn decode_percent(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let hex = bytes.get(at + 1..at + 3).and_then(|digits| std::str::from_utf8(digits).ok());
        match hex.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) if bytes[at] == b'%' => {
                decoded.push(byte);
                at += 3;
            }
            _ => {
                decoded.push(bytes[at]);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&decoded).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_every_length() {
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob")] {
            let uri = format!("data:application/octet-stream;base64,{text}");
            assert_eq!(decode_data_uri(&uri).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(decode_data_uri("data:;base64,Zm9vY"), None);
        assert_eq!(decode_data_uri("data:,plain"), None);
    }

    #[test]
    fn percent_decoding_leaves_stray_signs() {
        assert_eq!(decode_percent("a%20b%2Fc%"), "a b/c%");
    }
}
