//! Finds replies in a stream that may contain errors: ASCII lines and binary blocks, each with its checksum (reference
//! 1.2).
//!
//! Bounded memory, no allocation after [`Inbox::new`]. A binary block is recognised by its start sequence and the
//! checksum of its header; a line by its CR. A reply with a wrong checksum is reported as [`NdiArrival::Damaged`] and
//! discarded.
//!
//! Source: `ndicapi`, which `tests/peers` runs against the emulator.

use super::crc::{crc16, read_hex};
use crate::stream_buffer::Unread;

/// First bytes of a binary reply: 0xA5C4, little-endian.
const BINARY_START: [u8; 2] = [0xC4, 0xA5];
/// Maximum length of an accepted reply, bytes including checksums. `TX` with 24 tools has 1700.
pub const REPLY_MAX: usize = 4096;
// Start, length and checksum of the header, two bytes each.
const HEADER: usize = 6;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExpectedReply {
    Line,
    /// A binary block; or `ERRORnn`; or `RESET` if the unit was switched off and on.
    Block,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NdiArrival<'a> {
    /// An ASCII reply with a correct checksum; checksum and CR are removed.
    Line(&'a [u8]),
    /// The body of a binary reply with correct checksums.
    Block(&'a [u8]),
    /// A reply with a wrong checksum or an impossible length.
    Damaged,
}

/// Buffer of bytes that are not yet a complete reply.
#[derive(Debug)]
pub struct Inbox {
    unread: Unread,
    skipped: u64,
}

impl Default for Inbox {
    fn default() -> Self {
        Self::new()
    }
}

impl Inbox {
    pub fn new() -> Self {
        Self { unread: Unread::with_room(REPLY_MAX), skipped: 0 }
    }

    pub fn room(&mut self) -> &mut [u8] {
        if self.unread.is_full() {
            // These bytes never became a reply.
            self.clear();
        }
        self.unread.room()
    }

    /// Reports that `count` bytes were written into the space.
    pub fn filled(&mut self, count: usize) {
        self.unread.filled(count);
    }

    pub fn clear(&mut self) {
        self.skipped += self.unread.clear() as u64;
    }

    /// Returns the number of bytes that belonged to no reply, since the last call.
    pub const fn take_skipped(&mut self) -> u64 {
        std::mem::replace(&mut self.skipped, 0)
    }

    pub fn next(&mut self, expected: ExpectedReply) -> Option<NdiArrival<'_>> {
        match expected {
            ExpectedReply::Line => self.next_line(),
            ExpectedReply::Block => self.next_block(),
        }
    }

    fn next_line(&mut self) -> Option<NdiArrival<'_>> {
        let length = self.unread.bytes().iter().position(|byte| *byte == b'\r')?;
        let line = self.unread.pass(length + 1);
        let Some(text) = checked(&line[..length]) else {
            self.skipped += length as u64 + 1;
            return Some(NdiArrival::Damaged);
        };
        Some(NdiArrival::Line(text))
    }

    fn next_block(&mut self) -> Option<NdiArrival<'_>> {
        loop {
            match seek(self.unread.bytes()) {
                BufferStart::Nothing if self.unread.is_empty() => return None,
                BufferStart::Nothing => {
                    self.unread.pass(1);
                    self.skipped += 1;
                }
                BufferStart::Part => return None,
                BufferStart::Bad => {
                    self.unread.pass(2);
                    self.skipped += 2;
                    return Some(NdiArrival::Damaged);
                }
                BufferStart::Block(body) => {
                    return Some(NdiArrival::Block(&self.unread.pass(HEADER + body + 2)[HEADER..HEADER + body]));
                }
                BufferStart::Line(text) => {
                    return Some(NdiArrival::Line(&self.unread.pass(text + 5)[..text]));
                }
            }
        }
    }
}

/// Returns the text of a line with a correct checksum.
fn checked(line: &[u8]) -> Option<&[u8]> {
    let (text, crc) = line.split_at_checked(line.len().checked_sub(4)?)?;
    (read_hex(crc) == Some(u32::from(crc16(text)))).then_some(text)
}

/// Start of the buffer when a block is expected.
enum BufferStart {
    Nothing,
    Part,
    Bad,
    /// A block with a body of this length, bytes.
    Block(usize),
    /// A line with a text of this length, bytes.
    Line(usize),
}

fn seek(bytes: &[u8]) -> BufferStart {
    for (word, text) in [(b"ERROR", 7), (b"RESET", 5)] {
        let common = word.len().min(bytes.len());
        if common > 0 && bytes[..common] == word[..common] {
            return match bytes.get(..text + 5) {
                None => BufferStart::Part,
                Some(line) if line[text + 4] == b'\r' && checked(&line[..text + 4]).is_some() => {
                    BufferStart::Line(text)
                }
                Some(_) => BufferStart::Bad,
            };
        }
    }
    let common = BINARY_START.len().min(bytes.len());
    if common == 0 || bytes[..common] != BINARY_START[..common] {
        return BufferStart::Nothing;
    }
    let Some(header) = bytes.get(..HEADER) else { return BufferStart::Part };
    let body = usize::from(u16::from_le_bytes([header[2], header[3]]));
    if u16::from_le_bytes([header[4], header[5]]) != crc16(&header[..4]) || body > REPLY_MAX - HEADER - 2 {
        return BufferStart::Nothing;
    }
    let Some(tail) = bytes.get(HEADER + body..HEADER + body + 2) else { return BufferStart::Part };
    if u16::from_le_bytes([tail[0], tail[1]]) == crc16(&bytes[HEADER..HEADER + body]) {
        BufferStart::Block(body)
    } else {
        BufferStart::Bad
    }
}

/// Appends checksum and CR to the text in `reply`.
pub fn finish_line(reply: &mut Vec<u8>) {
    let crc = crc16(reply);
    reply.extend_from_slice(format!("{crc:04X}\r").as_bytes());
}

/// Returns a binary reply with this body; more than 65535 bytes cannot be represented and are truncated.
pub fn block_of(body: &[u8]) -> Vec<u8> {
    let body = &body[..body.len().min(usize::from(u16::MAX))];
    let mut reply = BINARY_START.to_vec();
    reply.extend_from_slice(&(body.len() as u16).to_le_bytes());
    reply.extend_from_slice(&crc16(&reply).to_le_bytes());
    reply.extend_from_slice(body);
    reply.extend_from_slice(&crc16(body).to_le_bytes());
    reply
}
