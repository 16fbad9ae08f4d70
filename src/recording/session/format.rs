//! The records of MCAP as bytes: <https://mcap.dev/spec>. Little endian; a record is its kind, its length and its
//! content.

use std::collections::BTreeMap;

/// First and last bytes of a file; the sixth is the version.
pub(super) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";
/// Kind and length of every record.
pub(super) const HEAD: usize = 1 + 8;
/// The end of a file: a footer and the magic bytes.
pub(super) const END: usize = HEAD + 8 + 8 + 4 + MAGIC.len();
/// The record that ends the data.
pub(super) const DATA_END: usize = HEAD + 4;

// Kinds of records, numbered by the MCAP specification.
pub(super) mod kind {
    pub(in crate::session) const HEADER: u8 = 0x01;
    pub(in crate::session) const FOOTER: u8 = 0x02;
    pub(in crate::session) const SCHEMA: u8 = 0x03;
    pub(in crate::session) const CHANNEL: u8 = 0x04;
    pub(in crate::session) const MESSAGE: u8 = 0x05;
    pub(in crate::session) const CHUNK: u8 = 0x06;
    pub(in crate::session) const MESSAGE_INDEX: u8 = 0x07;
    pub(in crate::session) const CHUNK_INDEX: u8 = 0x08;
    pub(in crate::session) const ATTACHMENT: u8 = 0x09;
    pub(in crate::session) const ATTACHMENT_INDEX: u8 = 0x0A;
    pub(in crate::session) const STATISTICS: u8 = 0x0B;
    pub(in crate::session) const METADATA: u8 = 0x0C;
    pub(in crate::session) const METADATA_INDEX: u8 = 0x0D;
    pub(in crate::session) const SUMMARY_OFFSET: u8 = 0x0E;
    pub(in crate::session) const DATA_END: u8 = 0x0F;
    /// Free space. Kinds from 0x80 are private, and every reader skips unknown kinds.
    pub(in crate::session) const ROOM: u8 = 0x80;
}

pub(super) trait RecordPut {
    fn u16(&mut self, value: u16);
    fn u32(&mut self, value: u32);
    fn u64(&mut self, value: u64);
    /// Appends bytes after their length, 32 bit.
    fn bytes(&mut self, bytes: &[u8]);
    fn text(&mut self, text: &str);
    fn texts(&mut self, entries: &BTreeMap<String, String>);
}

impl RecordPut for Vec<u8> {
    fn u16(&mut self, value: u16) {
        self.extend_from_slice(&value.to_le_bytes());
    }

    fn u32(&mut self, value: u32) {
        self.extend_from_slice(&value.to_le_bytes());
    }

    fn u64(&mut self, value: u64) {
        self.extend_from_slice(&value.to_le_bytes());
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.u32(bytes.len() as u32);
        self.extend_from_slice(bytes);
    }

    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    fn texts(&mut self, entries: &BTreeMap<String, String>) {
        let length: usize = entries.iter().map(|(key, value)| 8 + key.len() + value.len()).sum();
        self.u32(length as u32);
        for (key, value) in entries {
            self.text(key);
            self.text(value);
        }
    }
}

/// Appends a record whose content is appended by `fill`.
pub(super) fn record(out: &mut Vec<u8>, kind: u8, fill: impl FnOnce(&mut Vec<u8>)) {
    out.extend_from_slice(&head(kind, 0));
    let begin = out.len();
    fill(out);
    let length = (out.len() - begin) as u64;
    out[begin - 8..begin].copy_from_slice(&length.to_le_bytes());
}

pub(super) fn head(kind: u8, length: u64) -> [u8; HEAD] {
    let mut head = [kind; HEAD];
    head[1..].copy_from_slice(&length.to_le_bytes());
    head
}

pub(super) fn header(out: &mut Vec<u8>, profile: &str, library: &str) {
    record(out, kind::HEADER, |out| {
        out.text(profile);
        out.text(library);
    });
}

/// Appends the footer and the magic bytes. A checksum of 0 means none.
pub(super) fn end(out: &mut Vec<u8>, summary_start: u64, offsets_start: u64, crc: u32) {
    record(out, kind::FOOTER, |out| {
        out.u64(summary_start);
        out.u64(offsets_start);
        out.u32(crc);
    });
    out.extend_from_slice(&MAGIC);
}

pub(super) fn schema(out: &mut Vec<u8>, id: u16, name: &str, encoding: &str, data: &[u8]) {
    record(out, kind::SCHEMA, |out| {
        out.u16(id);
        out.text(name);
        out.text(encoding);
        out.bytes(data);
    });
}

pub(super) fn channel(out: &mut Vec<u8>, id: u16, schema: u16, topic: &str, encoding: &str) {
    record(out, kind::CHANNEL, |out| {
        out.u16(id);
        out.u16(schema);
        out.text(topic);
        out.text(encoding);
        out.texts(&BTreeMap::new());
    });
}

/// `time_ns` is the time of the sample, and is also stored as the time of publishing.
pub(super) fn message(out: &mut Vec<u8>, channel: u16, sequence: u32, time_ns: u64, data: &[u8]) {
    out.extend_from_slice(&head(kind::MESSAGE, (2 + 4 + 8 + 8 + data.len()) as u64));
    out.u16(channel);
    out.u32(sequence);
    out.u64(time_ns);
    out.u64(time_ns);
    out.extend_from_slice(data);
}

pub(super) fn attachment(out: &mut Vec<u8>, name: &str, media_type: &str, time_ns: u64, data: &[u8]) {
    record(out, kind::ATTACHMENT, |out| {
        let begin = out.len();
        out.u64(time_ns);
        out.u64(time_ns);
        out.text(name);
        out.text(media_type);
        out.u64(data.len() as u64);
        out.extend_from_slice(data);
        let crc = crc32fast::hash(&out[begin..]);
        out.u32(crc);
    });
}

pub(super) fn metadata(out: &mut Vec<u8>, name: &str, entries: &BTreeMap<String, String>) {
    record(out, kind::METADATA, |out| {
        out.text(name);
        out.texts(entries);
    });
}

/// Contents of a file in numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    pub messages: u64,
    /// Kinds of messages.
    pub schemas: u16,
    /// A channel is a topic.
    pub channels: u32,
    pub attachments: u32,
    pub metadata: u32,
    pub chunks: u32,
    /// Times of the first and the last message, ns; zero without messages.
    pub times_ns: (u64, u64),
    /// Messages of each channel, by its number.
    pub by_channel: BTreeMap<u16, u64>,
}

pub(super) fn statistics(out: &mut Vec<u8>, statistics: &Statistics) {
    record(out, kind::STATISTICS, |out| {
        out.u64(statistics.messages);
        out.u16(statistics.schemas);
        out.u32(statistics.channels);
        out.u32(statistics.attachments);
        out.u32(statistics.metadata);
        out.u32(statistics.chunks);
        out.u64(statistics.times_ns.0);
        out.u64(statistics.times_ns.1);
        out.u32((statistics.by_channel.len() * 10) as u32);
        for (&channel, &count) in &statistics.by_channel {
            out.u16(channel);
            out.u64(count);
        }
    });
}
