//! Packets of DYNAMIXEL Protocol 2.0: checksum, byte stuffing, and finding packets in a stream with errors (e-manual,
//! "Protocol 2.0").
//!
//! `FF FF FD 00 ID LEN_L LEN_H INST P1..Pn CRC_L CRC_H`, LEN = n + 3; status packets have instruction 0x55 and the
//! error byte as P1. After every `FF FF FD` within INST..Pn the sender inserts another `FD`, which LEN counts. Answers
//! to fast reads (status packets from the broadcast id) are not stuffed. No clock is used and nothing is allocated
//! after construction; the work per byte is bounded by the longest accepted packet.

use crc::{CRC_16_UMTS, Crc};

use crate::stream_buffer::Unread;

// Three bytes that stuffing keeps out of the parameters, and a reserved zero (ROBOTIS e-manual, protocol 2.0).
const HEADER: [u8; 4] = [0xFF, 0xFF, 0xFD, 0x00];
// Within the parameters, `FD` is inserted after these bytes, so that the header occurs only at the start of a packet.
const MARK: [u8; 3] = [0xFF, 0xFF, 0xFD];
const STUFFING: u8 = 0xFD;

/// Address of all servos at once (ROBOTIS e-manual, protocol 2.0).
pub const BROADCAST: u8 = 0xFE;
/// Instruction byte of a status packet (ROBOTIS e-manual, protocol 2.0).
pub const STATUS: u8 = 0x55;
/// Bytes of a packet in addition to its parameters.
pub const OVERHEAD: usize = 10;
// Header, id and length.
const PREFIX: usize = 7;

/// Polynomial 0x8005, not reflected.
const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_UMTS);

/// Packets to be sent. The buffer is reused; it grows only beyond its initial capacity.
#[derive(Debug)]
pub struct OutgoingPackets {
    bytes: Vec<u8>,
    begin: usize,
}

impl OutgoingPackets {
    /// Creates a buffer with an initial capacity of `room` bytes.
    pub fn new(room: usize) -> Self {
        Self { bytes: Vec::with_capacity(room), begin: 0 }
    }

    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub fn clear(&mut self) {
        self.bytes.clear();
    }

    /// Starts a packet after the existing ones.
    pub fn begin(&mut self, id: u8, instruction: u8) -> &mut Self {
        self.begin = self.bytes.len();
        self.bytes.extend_from_slice(&HEADER);
        self.bytes.extend_from_slice(&[id, 0, 0, instruction]);
        self
    }

    /// Appends parameters, with byte stuffing.
    pub fn put(&mut self, parameters: &[u8]) -> &mut Self {
        for &byte in parameters {
            self.bytes.push(byte);
            // A stuffed `FD` cannot be part of another mark: the bytes after it start a new one.
            if self.bytes[self.begin + PREFIX..].ends_with(&MARK) {
                self.bytes.push(STUFFING);
            }
        }
        self
    }

    pub fn put_u16(&mut self, number: u16) -> &mut Self {
        self.put(&number.to_le_bytes())
    }

    /// Completes the packet with its length and checksum.
    pub fn end(&mut self) {
        // The length counts from the instruction on, stuffed bytes and checksum included.
        let length = (self.bytes.len() - self.begin - PREFIX + 2) as u16;
        let [low, high] = length.to_le_bytes();
        self.bytes[self.begin + 5] = low;
        self.bytes[self.begin + 6] = high;
        self.seal();
    }

    /// Starts the answer to a fast read; `block_bytes` is the total length of its blocks (errors, ids, data and
    /// checksums).
    pub fn begin_fast(&mut self, block_bytes: usize) -> &mut Self {
        self.begin(BROADCAST, STATUS);
        let [low, high] = (block_bytes as u16 + 1).to_le_bytes();
        self.bytes[self.begin + 5] = low;
        self.bytes[self.begin + 6] = high;
        self
    }

    /// Appends one servo's block of the answer to a fast read; its checksum covers everything before it.
    pub fn put_block(&mut self, error: u8, id: u8, data: &[u8]) -> &mut Self {
        self.bytes.extend_from_slice(&[error, id]);
        self.bytes.extend_from_slice(data);
        self.seal();
        self
    }

    fn seal(&mut self) {
        let sum = CRC.checksum(&self.bytes[self.begin..]);
        self.bytes.extend_from_slice(&sum.to_le_bytes());
    }
}

/// A complete packet with a correct checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet<'a> {
    /// Id of the receiver or sender.
    pub id: u8,
    /// Instruction, or [`STATUS`].
    pub instruction: u8,
    /// Parameters, without stuffing; in a status packet the error byte comes first.
    pub body: &'a [u8],
    /// Length in the protocol, bytes.
    pub wire_bytes: usize,
}

/// Counters of refused data since construction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RefusedCounts {
    /// Packets with a wrong checksum or an impossible length.
    pub damaged: u64,
    /// Bytes skipped to find a header again.
    pub skipped: u64,
}

/// Finds packets in a stream.
#[derive(Debug)]
pub struct IncomingPackets {
    unread: Unread,
    body: Vec<u8>,
    longest: usize,
    refused: RefusedCounts,
}

impl IncomingPackets {
    /// Accepts packets of at most `longest` bytes. Longer ones count as damaged, so that a wrong length cannot swallow
    /// the packets after it.
    pub fn new(longest: usize) -> Self {
        let longest = longest.max(OVERHEAD);
        Self {
            unread: Unread::with_room(2 * longest),
            body: Vec::with_capacity(longest),
            longest,
            refused: RefusedCounts::default(),
        }
    }

    pub const fn refused(&self) -> RefusedCounts {
        self.refused
    }

    /// Returns whether an incomplete packet is in the buffer.
    pub const fn is_midway(&self) -> bool {
        !self.unread.is_empty()
    }

    /// Discards an incomplete packet; returns the number of discarded bytes, which count as skipped.
    pub fn reset(&mut self) -> usize {
        let rest = self.unread.clear();
        self.refused.skipped += rest as u64;
        rest
    }

    /// Accepts as many bytes as fit and returns their number. Call [`next`](Self::next) until it returns `None`, then
    /// pass the remaining bytes.
    pub fn feed(&mut self, bytes: &[u8]) -> usize {
        self.unread.feed(bytes)
    }

    /// Returns the next complete packet.
    #[expect(clippy::should_implement_trait, reason = "the packet borrows the buffer, which an iterator's item cannot")]
    pub fn next(&mut self) -> Option<Packet<'_>> {
        loop {
            self.find_header();
            let rest = self.unread.bytes();
            if rest.len() < PREFIX {
                return None;
            }
            let wire_bytes = PREFIX + usize::from(u16::from_le_bytes([rest[5], rest[6]]));
            // A length that no packet has, or an id that protocol 2.0 does not use: not a header.
            if wire_bytes < OVERHEAD || wire_bytes > self.longest || rest[4] == 0xFF {
                self.refuse();
                continue;
            }
            if rest.len() < wire_bytes {
                return None;
            }
            let (covered, sum) = rest[..wire_bytes].split_at(wire_bytes - 2);
            if CRC.checksum(covered) != u16::from_le_bytes([sum[0], sum[1]]) {
                self.refuse();
                continue;
            }
            let id = rest[4];
            let instruction = rest[PREFIX];
            self.body.clear();
            // The answer to a fast read is not stuffed (e-manual).
            if (id, instruction) == (BROADCAST, STATUS) {
                self.body.extend_from_slice(&covered[PREFIX + 1..]);
            } else {
                unstuff(&covered[PREFIX + 1..], &mut self.body);
            }
            self.unread.pass(wire_bytes);
            return Some(Packet { id, instruction, body: &self.body, wire_bytes });
        }
    }

    /// Counts a damaged packet and looks for the next header within it.
    fn refuse(&mut self) {
        self.refused.damaged += 1;
        self.refused.skipped += 1;
        self.unread.pass(1);
    }

    fn find_header(&mut self) {
        let rest = self.unread.bytes();
        // A header that is cut off by the end of the buffer counts as one: the rest may still arrive.
        let begins = |tail: &[u8]| tail.iter().zip(HEADER).all(|(byte, known)| *byte == known);
        let skip = (0..rest.len()).find(|at| begins(&rest[*at..])).unwrap_or(rest.len());
        self.refused.skipped += skip as u64;
        self.unread.pass(skip);
    }
}

/// Copies `from` without the `FD` after each mark. A mark without an `FD` is copied unchanged, because some senders do
/// not stuff.
fn unstuff(from: &[u8], to: &mut Vec<u8>) {
    let mut matched = 0;
    for &byte in from {
        if matched == MARK.len() {
            matched = 0;
            if byte == STUFFING {
                continue;
            }
        }
        matched = match byte {
            // More than two `FF` in a row still end in two.
            0xFF => (matched + 1).min(2),
            0xFD if matched == 2 => 3,
            _ => 0,
        };
        to.push(byte);
    }
}

/// One servo's block in the answer to a fast read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DynamixelBlock<'a> {
    pub error: u8,
    pub id: u8,
    pub data: &'a [u8],
}

/// Splits the body of the answer to a fast read into blocks of `data_bytes` each. The checksum of the packet, which is
/// also that of the last block, has been removed already, and it covers the checksums in between. Returns `None` if the
/// length does not fit.
pub fn blocks(body: &[u8], data_bytes: usize) -> Option<impl Iterator<Item = DynamixelBlock<'_>>> {
    // Error, id, data and a checksum of two bytes; the last checksum covers the packet.
    let each = data_bytes + 4;
    let fits = (body.len() + 2).is_multiple_of(each) && !body.is_empty();
    fits.then(|| {
        body.chunks(each).map(move |block| DynamixelBlock {
            error: block[0],
            id: block[1],
            data: &block[2..2 + data_bytes],
        })
    })
}
