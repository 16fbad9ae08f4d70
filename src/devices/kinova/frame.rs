//! Frames of the Kortex router: one protobuf `KinovaFrame` per datagram; on TCP preceded by a mark and a length.
//!
//! ```text
//! Frame { Header header = 1; bytes payload = 2 }, Header of four fixed32:
//! frame_info   31:28 version (1) | 27:24 type | 23:16 device | 15:12 error | 11:0 sub error
//! message_info 31:16 session | 15:0 message
//! service_info 31:28 version (1) | 27:16 service | 15:0 function
//! payload_info 23:0 length of the payload
//! ```
//! On TCP: `07 78 45 74 52 6F 4B 07`, length as u32 big-endian, frame. There is no checksum, so structure, versions and
//! the length of the payload are checked. Source: the manufacturer's Python client as described in its documentation.

use prost::{
    Message,
    encoding::{WireType, encode_key, encode_varint, message},
};

use super::{
    messages::Rpc,
    wire::{DamagedMessage, WireFields},
};
use crate::stream_buffer::Unread;

/// Start of every packet on TCP.
pub const MARK: [u8; 8] = *b"\x07xEtRoK\x07";
// A big-endian number after the magic bytes (vendor client, `TCPTransport`).
const LENGTH_BYTES: usize = 4;
// Version of the header and of every service, in the upper four bits (Kortex API 2).
const VERSION: u32 = 1;

/// Types of frames that are used.
pub const REQUEST: u8 = 1;
/// An answer, with or without an error.
pub const RESPONSE: u8 = 3;
/// Sent by the base without a request.
pub const NOTIFICATION: u8 = 5;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KinovaHeader {
    /// [`REQUEST`], [`RESPONSE`], [`NOTIFICATION`].
    pub kind: u8,
    /// 0: the base; 1 to 7: an actuator.
    pub device: u8,
    /// Error class, 0 for none.
    pub error: u8,
    pub sub_error: u16,
    /// Session, 0 before login.
    pub session: u16,
    /// Number of the message; an answer has the number of its request.
    pub message: u16,
    pub service: u16,
    pub function: u16,
}

/// The header in its encoded form.
#[derive(Clone, Copy, PartialEq, Message)]
struct RawHeader {
    #[prost(fixed32, tag = "1")]
    frame: u32,
    #[prost(fixed32, tag = "2")]
    message: u32,
    #[prost(fixed32, tag = "3")]
    service: u32,
    #[prost(fixed32, tag = "4")]
    payload: u32,
}

impl KinovaHeader {
    pub const fn rpc(&self) -> Rpc {
        Rpc { service: self.service, function: self.function }
    }

    fn raw(&self, payload: usize) -> RawHeader {
        let bits = |value: u32, width: u32, shift: u32| (value & ((1 << width) - 1)) << shift;
        RawHeader {
            frame: bits(VERSION, 4, 28)
                | bits(u32::from(self.kind), 4, 24)
                | bits(u32::from(self.device), 8, 16)
                | bits(u32::from(self.error), 4, 12)
                | bits(u32::from(self.sub_error), 12, 0),
            message: bits(u32::from(self.session), 16, 16) | bits(u32::from(self.message), 16, 0),
            service: bits(VERSION, 4, 28)
                | bits(u32::from(self.service), 12, 16)
                | bits(u32::from(self.function), 16, 0),
            payload: bits(payload as u32, 24, 0),
        }
    }

    fn of(raw: &RawHeader) -> Result<Self, DamagedMessage> {
        let bits = |value: u32, width: u32, shift: u32| (value >> shift) & ((1 << width) - 1);
        // The version is the only constant in a frame without a checksum, so it also detects damage.
        if bits(raw.frame, 4, 28) != VERSION || bits(raw.service, 4, 28) != VERSION {
            return Err(DamagedMessage);
        }
        Ok(Self {
            kind: bits(raw.frame, 4, 24) as u8,
            device: bits(raw.frame, 8, 16) as u8,
            error: bits(raw.frame, 4, 12) as u8,
            sub_error: bits(raw.frame, 12, 0) as u16,
            session: bits(raw.message, 16, 16) as u16,
            message: bits(raw.message, 16, 0) as u16,
            service: bits(raw.service, 12, 16) as u16,
            function: bits(raw.service, 16, 0) as u16,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KinovaFrame<'a> {
    pub header: KinovaHeader,
    /// Payload; the call determines the type of the message.
    pub payload: &'a [u8],
}

impl<'a> KinovaFrame<'a> {
    /// Decodes the bytes of one datagram or packet.
    ///
    /// # Errors
    /// [`DamagedMessage`] if structure, version or length do not belong to a frame.
    pub fn decode(bytes: &'a [u8]) -> Result<Self, DamagedMessage> {
        let mut raw = None;
        let mut payload = [].as_slice();
        for field in WireFields::of(bytes) {
            match field? {
                (1, value) => raw = Some(raw_header(value.bytes()?)?),
                (2, value) => payload = value.bytes()?,
                _ => {}
            }
        }
        let raw = raw.ok_or(DamagedMessage)?;
        if (raw.payload & 0xff_ffff) as usize != payload.len() {
            return Err(DamagedMessage);
        }
        Ok(Self { header: KinovaHeader::of(&raw)?, payload })
    }
}

fn raw_header(bytes: &[u8]) -> Result<RawHeader, DamagedMessage> {
    let mut raw = RawHeader::default();
    for field in WireFields::of(bytes) {
        match field? {
            (1, value) => raw.frame = value.fixed32()?,
            (2, value) => raw.message = value.fixed32()?,
            (3, value) => raw.service = value.fixed32()?,
            (4, value) => raw.payload = value.fixed32()?,
            _ => {}
        }
    }
    Ok(raw)
}

/// Appends a frame; allocates nothing while `out` has room.
pub fn encode(header: &KinovaHeader, payload: &impl Message, out: &mut Vec<u8>) {
    let length = payload.encoded_len();
    message::encode(1, &header.raw(length), out);
    if length > 0 {
        message::encode(2, payload, out);
    }
}

/// Appends a frame with a payload that is already encoded.
pub fn encode_written(header: &KinovaHeader, payload: &[u8], out: &mut Vec<u8>) {
    message::encode(1, &header.raw(payload.len()), out);
    if !payload.is_empty() {
        encode_key(2, WireType::LengthDelimited, out);
        encode_varint(payload.len() as u64, out);
        out.extend_from_slice(payload);
    }
}

/// Appends a packet for TCP; allocates nothing while `out` has room.
pub fn encode_packet(header: &KinovaHeader, payload: &impl Message, out: &mut Vec<u8>) {
    packed(out, |out| encode(header, payload, out));
}

/// Appends a packet around a frame.
pub fn packed(out: &mut Vec<u8>, frame: impl FnOnce(&mut Vec<u8>)) {
    out.extend_from_slice(&MARK);
    let length_at = out.len();
    out.extend_from_slice(&[0; LENGTH_BYTES]);
    frame(out);
    let length = (out.len() - length_at - LENGTH_BYTES) as u32;
    out[length_at..length_at + LENGTH_BYTES].copy_from_slice(&length.to_be_bytes());
}

/// Maximum length of an accepted packet; the longest in use has a few hundred bytes. A longer one is skipped as
/// damaged.
pub const PACKET_MAX: usize = 16 * 1024;

/// Finds packets in a stream that may contain errors. Fixed memory; every byte is examined a bounded number of times.
#[derive(Debug)]
pub struct PacketReader {
    unread: Unread,
    /// Bytes skipped while searching for a mark.
    pub skipped: u64,
    pub damaged: u64,
}

/// Mark and length, bytes.
const PREFIX: usize = MARK.len() + LENGTH_BYTES;

impl Default for PacketReader {
    fn default() -> Self {
        // Two packets: the rest of one and the whole next one.
        Self { unread: Unread::with_room(2 * PACKET_MAX), skipped: 0, damaged: 0 }
    }
}

impl PacketReader {
    /// Returns the buffer for new bytes; report their number with [`filled`](Self::filled). Never empty once all
    /// complete packets have been read.
    pub fn room(&mut self) -> &mut [u8] {
        self.unread.room()
    }

    /// Reports that `count` bytes were written into the buffer.
    pub fn filled(&mut self, count: usize) {
        self.unread.filled(count);
    }

    /// Returns the next complete frame; `None` until more bytes arrive.
    pub fn next_frame(&mut self) -> Option<KinovaFrame<'_>> {
        let length = self.find()?;
        KinovaFrame::decode(&self.unread.pass(PREFIX + length)[PREFIX..]).ok()
    }

    /// Moves to the next complete packet, and returns the length of its frame, bytes.
    fn find(&mut self) -> Option<usize> {
        loop {
            self.seek();
            let waiting = self.unread.bytes();
            let length = waiting.get(MARK.len()..PREFIX)?;
            let length = u32::from_be_bytes(length.try_into().ok()?) as usize;
            // Otherwise a damaged length would wait for bytes that never arrive.
            if length <= PACKET_MAX - PREFIX {
                let frame = waiting.get(PREFIX..PREFIX + length)?;
                if KinovaFrame::decode(frame).is_ok() {
                    return Some(length);
                }
            }
            // The length may be the damaged part, so continue the search directly after this mark.
            self.damaged += 1;
            self.unread.pass(MARK.len());
        }
    }

    /// Moves to the next position where a mark begins, possibly truncated at the end.
    fn seek(&mut self) {
        let waiting = self.unread.bytes();
        let begins = |at: &usize| {
            let tail = &waiting[*at..];
            // A mark may be cut by the end of a read, so its beginning is kept.
            let length = tail.len().min(MARK.len());
            tail[..length] == MARK[..length]
        };
        let skip = (0..waiting.len()).find(begins).unwrap_or(waiting.len());
        self.skipped += skip as u64;
        self.unread.pass(skip);
    }
}
