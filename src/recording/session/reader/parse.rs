//! Parses the fields of records from untrusted bytes.

use std::collections::BTreeMap;

use crate::session::format::{HEAD, Statistics};

/// The unread part of a record.
pub(super) struct ParseFields<'a>(pub(super) &'a [u8]);

impl<'a> ParseFields<'a> {
    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, left) = self.0.split_at_checked(count)?;
        self.0 = left;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn bytes(&mut self) -> Option<&'a [u8]> {
        let count = self.u32()?;
        self.take(usize::try_from(count).ok()?)
    }

    pub(super) fn long_bytes(&mut self) -> Option<&'a [u8]> {
        let count = self.u64()?;
        self.take(usize::try_from(count).ok()?)
    }

    pub(super) fn text(&mut self) -> Option<String> {
        self.bytes().and_then(|bytes| str::from_utf8(bytes).ok()).map(str::to_owned)
    }

    /// Parses a map; `entry` parses one of its entries.
    fn map<T>(&mut self, entry: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let mut inside = Self(self.bytes()?);
        let mut entries = Vec::new();
        while !inside.0.is_empty() {
            entries.push(entry(&mut inside)?);
        }
        Some(entries)
    }

    pub(super) fn texts(&mut self) -> Option<BTreeMap<String, String>> {
        self.map(|inside| Some((inside.text()?, inside.text()?))).map(|entries| entries.into_iter().collect())
    }
}

/// Splits off the first record of `bytes`: kind, content, and the remaining bytes.
pub(super) fn first_record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (kind, length) = head(bytes)?;
    let (content, behind) = bytes.get(HEAD..)?.split_at_checked(usize::try_from(length).ok()?)?;
    Some((kind, content, behind))
}

pub(super) fn head(bytes: &[u8]) -> Option<(u8, u64)> {
    let mut fields = ParseFields(bytes);
    Some((fields.take(1)?[0], fields.u64()?))
}

pub(super) struct ParseSchema {
    pub(super) id: u16,
    pub(super) name: String,
    pub(super) encoding: String,
    pub(super) data: Vec<u8>,
}

pub(super) fn schema(content: &[u8]) -> Option<ParseSchema> {
    let mut fields = ParseFields(content);
    let id = fields.u16().filter(|&id| id != 0)?;
    Some(ParseSchema { id, name: fields.text()?, encoding: fields.text()?, data: fields.bytes()?.to_vec() })
}

pub(super) struct RawChannel {
    pub(super) id: u16,
    pub(super) schema: u16,
    pub(super) topic: String,
    pub(super) encoding: String,
}

pub(super) fn channel(content: &[u8]) -> Option<RawChannel> {
    let mut fields = ParseFields(content);
    let id = fields.u16()?;
    let schema = fields.u16()?;
    let topic = fields.text()?;
    let encoding = fields.text()?;
    fields.texts()?;
    Some(RawChannel { id, schema, topic, encoding })
}

/// All of a message except its data.
#[derive(Clone, Copy)]
pub(super) struct MessageHead {
    pub(super) channel: u16,
    pub(super) sequence: u32,
    pub(super) log_time_ns: u64,
    pub(super) publish_time_ns: u64,
}

/// Size of a message head, bytes.
pub(super) const MESSAGE_HEAD: usize = 2 + 4 + 8 + 8;

pub(super) fn message(content: &[u8]) -> Option<MessageHead> {
    let mut fields = ParseFields(content);
    let channel = fields.u16()?;
    let sequence = fields.u32()?;
    Some(MessageHead { channel, sequence, log_time_ns: fields.u64()?, publish_time_ns: fields.u64()? })
}

/// The fields before the records of a chunk.
pub(super) struct ChunkHead {
    pub(super) times_ns: (u64, u64),
    pub(super) uncompressed: u64,
    pub(super) crc: u32,
    pub(super) compression: String,
}

pub(super) fn chunk(content: &[u8]) -> Option<(ChunkHead, &[u8])> {
    let mut fields = ParseFields(content);
    let head = ChunkHead {
        times_ns: (fields.u64()?, fields.u64()?),
        uncompressed: fields.u64()?,
        crc: fields.u32()?,
        compression: fields.text()?,
    };
    Some((head, fields.long_bytes()?))
}

pub(super) struct ChunkIndex {
    pub(super) times_ns: (u64, u64),
    pub(super) at: u64,
    pub(super) length: u64,
    pub(super) channels: Vec<u16>,
}

pub(super) fn chunk_index(content: &[u8]) -> Option<ChunkIndex> {
    let mut fields = ParseFields(content);
    let times_ns = (fields.u64()?, fields.u64()?);
    let at = fields.u64()?;
    let length = fields.u64()?;
    let channels = fields.map(|inside| {
        let channel = inside.u16()?;
        inside.u64().map(|_| channel)
    })?;
    Some(ChunkIndex { times_ns, at, length, channels })
}

/// An attachment without its data, from the summary or from its own record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    pub name: String,
    /// `None` if the file does not state it.
    pub media_type: String,
    /// Time of its recording, ns.
    pub log_time_ns: u64,
    /// Bytes of its data.
    pub size: u64,
    /// Position and length of its record.
    pub(super) place: (u64, u64),
}

pub(super) fn attachment_index(content: &[u8]) -> Option<Attachment> {
    let mut fields = ParseFields(content);
    let place = (fields.u64()?, fields.u64()?);
    let log_time_ns = fields.u64()?;
    fields.u64()?;
    let size = fields.u64()?;
    Some(Attachment { place, log_time_ns, size, name: fields.text()?, media_type: fields.text()? })
}

/// Parses the fields before an attachment's data; `place` is the position of the record, `size` the size of the data.
pub(super) fn attachment_head(content: &[u8], place: (u64, u64)) -> Option<Attachment> {
    let mut fields = ParseFields(content);
    let log_time_ns = fields.u64()?;
    fields.u64()?;
    Some(Attachment { place, log_time_ns, name: fields.text()?, media_type: fields.text()?, size: fields.u64()? })
}

/// Returns its data, and whether the checksum is correct.
pub(super) fn attachment_data(content: &[u8]) -> Option<(&[u8], bool)> {
    let (checked, mut crc) =
        content.split_at_checked(content.len().checked_sub(4)?).map(|(all, crc)| (all, ParseFields(crc)))?;
    let crc = crc.u32()?;
    let mut fields = ParseFields(checked);
    fields.take(16)?;
    fields.bytes()?;
    fields.bytes()?;
    let data = fields.long_bytes()?;
    Some((data, crc == 0 || crc == crc32fast::hash(checked)))
}

/// Returns the position and length of a metadata record.
pub(super) fn metadata_index(content: &[u8]) -> Option<(u64, u64)> {
    let mut fields = ParseFields(content);
    Some((fields.u64()?, fields.u64()?))
}

pub(super) fn metadata(content: &[u8]) -> Option<(String, BTreeMap<String, String>)> {
    let mut fields = ParseFields(content);
    Some((fields.text()?, fields.texts()?))
}

pub(super) fn statistics(content: &[u8]) -> Option<Statistics> {
    let mut fields = ParseFields(content);
    Some(Statistics {
        messages: fields.u64()?,
        schemas: fields.u16()?,
        channels: fields.u32()?,
        attachments: fields.u32()?,
        metadata: fields.u32()?,
        chunks: fields.u32()?,
        times_ns: (fields.u64()?, fields.u64()?),
        by_channel: fields.map(|inside| Some((inside.u16()?, inside.u64()?)))?.into_iter().collect(),
    })
}

pub(super) struct Footer {
    pub(super) summary_start: u64,
    pub(super) crc: u32,
}

pub(super) fn footer(content: &[u8]) -> Option<Footer> {
    let mut fields = ParseFields(content);
    let summary_start = fields.u64()?;
    fields.u64()?;
    Some(Footer { summary_start, crc: fields.u32()? })
}
