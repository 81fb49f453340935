//! A cursor over the words of a text file; it counts lines only when something is wrong.

use super::error::{Place, Problem, Refusal, excerpt};
use std::str::FromStr;

/// Words separated by ASCII white space.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Start of the word returned last, for messages.
    last: usize,
}

impl<'a> Words<'a> {
    /// Starts at byte `at` of a file; lines are counted from the beginning of `bytes`.
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at, last: at }
    }

    /// The next word, on this line or a later one.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !is_space(*b))?;
        let length = rest[start..].iter().position(|b| is_space(*b)).unwrap_or(rest.len() - start);
        self.last = self.at + start;
        self.at = self.last + length;
        Some(&rest[start..start + length])
    }

    /// The rest of the current line, without its end.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
        self.last = self.at;
        self.at += length;
        &rest[..length]
    }

    /// Skips white space and comments that begin with `#` (to the end of their line).
    pub(super) fn skip_comments(&mut self) {
        loop {
            let rest = &self.bytes[self.at..];
            self.at += rest.iter().position(|b| !is_space(*b)).unwrap_or(rest.len());
            if self.bytes.get(self.at) != Some(&b'#') {
                return;
            }
            self.rest_of_line();
        }
    }

    /// The next word as a number.
    pub(super) fn number<T: FromStr>(&mut self, of: &str) -> Result<T, Refusal> {
        let Some(word) = self.next() else {
            return Err(Refusal::new(self.line(), Problem::Truncated(of.into())));
        };
        parse(word).ok_or_else(|| Refusal::new(self.line(), Problem::NotANumber(excerpt(word))))
    }

    /// Bytes not yet read.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The line of the word returned last.
    pub(super) fn line(&self) -> Place {
        line_of(self.bytes, self.last)
    }

    /// Refuses a count that the remaining bytes cannot hold at `least` bytes each.
    pub(super) fn check_count(&self, what: &str, declared: u64, least: usize) -> Result<usize, Refusal> {
        // The line is counted only for a refusal: this is called for every face.
        check_count(Place::File, what, declared, least, self.remaining())
            .map_err(|refusal| Refusal::new(self.line(), refusal.problem))
    }
}

/// `declared` as a size, if so many things of at least `least` bytes fit `bytes` (the last one may lack its separator).
pub(super) fn check_count(
    place: Place,
    what: &str,
    declared: u64,
    least: usize,
    bytes: usize,
) -> Result<usize, Refusal> {
    let fits = (bytes as u64 + 1) / least.max(1) as u64;
    if declared > fits {
        let problem = Problem::CountTooLarge { what: what.into(), declared, bytes };
        return Err(Refusal::new(place, problem));
    }
    Ok(declared as usize)
}

/// A word as a number.
pub(super) fn parse<T: FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The line, from 1, in which byte `at` lies; LF, CR LF and CR all end lines.
pub(super) fn line_of(bytes: &[u8], at: usize) -> Place {
    let before = &bytes[..at.min(bytes.len())];
    let ends = before.iter().enumerate().filter(|&(i, b)| match b {
        b'\n' => true,
        b'\r' => bytes.get(i + 1) != Some(&b'\n'),
        _ => false,
    });
    Place::Line(1 + ends.count())
}

/// The text without a UTF-8 byte order mark; refuses what begins like UTF-16 or binary data.
pub(super) fn text_start(bytes: &[u8]) -> Result<usize, Refusal> {
    let head = &bytes[..bytes.len().min(64)];
    if head.starts_with(&[0xFE, 0xFF]) || head.starts_with(&[0xFF, 0xFE]) || head.contains(&0) {
        return Err(Refusal::new(Place::File, Problem::NotText));
    }
    Ok(if bytes.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 })
}

pub(super) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0B | 0x0C)
}
