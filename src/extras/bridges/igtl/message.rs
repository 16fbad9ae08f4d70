//! A message: its header, the extended header and metadata of protocol version 3, and its content.

use crc::{CRC_64_ECMA_182, Crc};

use super::{
    Content, IgtlFormatError,
    wire::{IgtlCursor, put_name},
};

/// The header of every message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgtlHeader {
    /// 1 in versions 1 and 2 of the protocol, 2 in version 3.
    pub version: u16,
    /// The type of the message.
    pub kind: String,
    /// The name of the device.
    pub device: String,
    /// Time, ns since 1970 (UTC); 0 if not given.
    pub time_ns: u64,
    /// Size of the body. Untrusted: may be any number.
    pub body_bytes: u64,
    /// Checksum of the body.
    pub crc: u64,
}

/// The specification of the protocol prescribes ECMA-182 over the body.
pub(super) const CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_ECMA_182);

/// Lengths of text fields in the header, padded with zeros (specification of the protocol).
const TYPE: usize = 12;
const DEVICE: usize = 20;
/// Size of the extended header, which version 3 puts before the content.
const EXTENDED: usize = 12;

impl IgtlHeader {
    /// Size of a header. Version, type, device, time stamp, size and checksum: 2 + 12 + 20 + 8 + 8 + 8 (specification
    /// of the protocol).
    pub const BYTES: usize = 58;

    /// Parses a header.
    ///
    /// # Errors
    /// [`IgtlFormatError`] if the bytes are not a header.
    pub fn read(bytes: &[u8]) -> Result<Self, IgtlFormatError> {
        let mut from = IgtlCursor(bytes);
        let version = from.u16()?;
        if !(1..=2).contains(&version) {
            return Err(IgtlFormatError::Version(version));
        }
        let kind = from.bytes(TYPE)?.iter().take_while(|byte| **byte != 0);
        let kind = kind.map(|byte| if byte.is_ascii_graphic() { char::from(*byte) } else { '?' }).collect();
        let device = from.name(DEVICE)?;
        let seconds = u64::from(from.u32()?);
        let fraction = u64::from(from.u32()?);
        let time_ns = seconds * 1_000_000_000 + ((fraction * 1_000_000_000 + (1 << 31)) >> 32);
        Ok(Self { version, kind, device, time_ns, body_bytes: from.u64()?, crc: from.u64()? })
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct IgtlMessage {
    /// The name of the device, at most 20 bytes.
    pub device: String,
    /// ns since 1970 (UTC).
    pub time_ns: u64,
    /// Content.
    pub content: Content,
}

impl IgtlMessage {
    /// Creates a message of this device and time (ns since 1970, UTC).
    pub fn new(device: &str, time_ns: u64, content: Content) -> Self {
        Self { device: device.to_owned(), time_ns, content }
    }

    /// Returns its bytes, readable by every version of the protocol.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.put(&mut bytes);
        bytes
    }

    /// Appends its bytes.
    pub fn put(&self, bytes: &mut Vec<u8>) {
        let begin = bytes.len();
        bytes.extend(1_u16.to_be_bytes());
        put_name(bytes, &self.content.kind(), TYPE);
        put_name(bytes, &self.device, DEVICE);
        bytes.extend(stamp(self.time_ns).to_be_bytes());
        bytes.extend([0; 16]);
        let body = begin + IgtlHeader::BYTES;
        self.content.put(bytes);
        let length = (bytes.len() - body) as u64;
        let crc = CRC.checksum(&bytes[body..]);
        bytes[body - 16..body - 8].copy_from_slice(&length.to_be_bytes());
        bytes[body - 8..body].copy_from_slice(&crc.to_be_bytes());
    }

    /// Parses the body that belongs to a header. Metadata are left out.
    ///
    /// # Errors
    /// [`IgtlFormatError`] if it is damaged or not a message of its type.
    pub fn read(header: &IgtlHeader, body: &[u8]) -> Result<Self, IgtlFormatError> {
        if body.len() as u64 != header.body_bytes {
            return Err(IgtlFormatError::Short);
        }
        if CRC.checksum(body) != header.crc {
            return Err(IgtlFormatError::Checksum);
        }
        let content = if header.version == 1 { body } else { within(body)? };
        let content = Content::take(&header.kind, content)?;
        Ok(Self { device: header.device.clone(), time_ns: header.time_ns, content })
    }
}

/// Returns the content in a body of version 3: after the extended header, before the metadata.
fn within(body: &[u8]) -> Result<&[u8], IgtlFormatError> {
    let mut from = IgtlCursor(body);
    let extended = usize::from(from.u16()?);
    let index = usize::from(from.u16()?);
    let values = from.u32()? as usize;
    let end = body.len().checked_sub(index).and_then(|rest| rest.checked_sub(values)).ok_or(IgtlFormatError::Short)?;
    if extended < EXTENDED {
        return Err(IgtlFormatError::Value { kind: "header".to_owned(), what: "the length of the extended header" });
    }
    let content = body.get(extended..end).ok_or(IgtlFormatError::Short)?;
    metadata(&body[end..], index, values)?;
    Ok(content)
}

/// Checks that metadata match their own counts: a list of lengths, then keys and values.
fn metadata(region: &[u8], index: usize, values: usize) -> Result<(), IgtlFormatError> {
    if index == 0 && values == 0 {
        return Ok(());
    }
    let mut from = IgtlCursor(region);
    let count = usize::from(from.u16()?);
    let mut report = 0_u64;
    for _ in 0..count {
        let key = from.u16()?;
        let _ = from.u16()?;
        let value = from.u32()?;
        report += u64::from(key) + u64::from(value);
    }
    if index == 2 + 8 * count && report == values as u64 { Ok(()) } else { Err(IgtlFormatError::Short) }
}

/// Returns a time stamp with the seconds in the upper half and their fraction in the lower half.
fn stamp(time_ns: u64) -> u64 {
    let seconds = time_ns / 1_000_000_000;
    let rest_ns = time_ns % 1_000_000_000;
    (seconds << 32) | ((rest_ns << 32) / 1_000_000_000)
}
