//! The bytes of a session: a file, or memory.

use std::{
    fs::File,
    io::{self, ErrorKind},
};

use super::parse;
use crate::session::{at, format::HEAD};

pub(in crate::session) enum ReaderSource {
    File(File, u64),
    Bytes(Vec<u8>),
}

impl ReaderSource {
    pub(in crate::session) fn size(&self) -> u64 {
        match self {
            Self::File(_, size) => *size,
            Self::Bytes(bytes) => bytes.len() as u64,
        }
    }

    /// Reads these bytes; never allocates more than the length of the file.
    pub(in crate::session) fn read(&self, from: u64, length: u64) -> io::Result<Vec<u8>> {
        let end = from.checked_add(length).filter(|&end| end <= self.size()).ok_or(ErrorKind::UnexpectedEof)?;
        match self {
            Self::File(file, _) => {
                let mut bytes = vec![0; length as usize];
                at::read_exact(file, &mut bytes, from)?;
                Ok(bytes)
            }
            Self::Bytes(bytes) => Ok(bytes[from as usize..end as usize].to_vec()),
        }
    }
}

/// Walks over records in windows and reads only the requested bytes.
pub(in crate::session) struct Walk<'a> {
    source: &'a ReaderSource,
    /// Position of the next record.
    pub(in crate::session) at: u64,
    end: u64,
    window: Vec<u8>,
    window_at: u64,
}

#[derive(Clone, Copy)]
pub(in crate::session) struct RecordPlace {
    pub(in crate::session) kind: u8,
    pub(in crate::session) at: u64,
    /// Includes the record's head.
    pub(in crate::session) length: u64,
}

// Bytes read at once, so that the heads of small records need no read each.
const WINDOW: u64 = 64 << 10;

impl<'a> Walk<'a> {
    pub(in crate::session) fn new(source: &'a ReaderSource, at: u64, end: u64) -> Self {
        Self { source, at, end: end.min(source.size()), window: Vec::new(), window_at: 0 }
    }

    /// Returns the next record, complete or not; `None` at the end, and if the rest is too short for a record.
    pub(in crate::session) fn step(&mut self) -> io::Result<Option<RecordPlace>> {
        if self.end.saturating_sub(self.at) < HEAD as u64 {
            return Ok(None);
        }
        let at = self.at;
        let Some((kind, length)) = parse::head(self.bytes(at, HEAD as u64)?) else { return Ok(None) };
        let Some(length) = length.checked_add(HEAD as u64).filter(|&length| length <= self.end - at) else {
            return Ok(None);
        };
        self.at += length;
        Ok(Some(RecordPlace { kind, at, length }))
    }

    /// Returns the content of a record, or its first `max` bytes.
    pub(in crate::session) fn content(&mut self, place: RecordPlace, max: u64) -> io::Result<&[u8]> {
        self.bytes(place.at + HEAD as u64, (place.length - HEAD as u64).min(max))
    }

    fn bytes(&mut self, at: u64, length: u64) -> io::Result<&[u8]> {
        let inside = at >= self.window_at && at + length <= self.window_at + self.window.len() as u64;
        if !inside {
            let more = length.max(WINDOW).min(self.source.size().saturating_sub(at));
            self.window = self.source.read(at, more.max(length))?;
            self.window_at = at;
        }
        let begin = (at - self.window_at) as usize;
        Ok(&self.window[begin..begin + length as usize])
    }
}
