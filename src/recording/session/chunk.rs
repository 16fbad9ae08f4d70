//! One chunk while it is being filled: messages with an index for each channel, compressed when the chunk is closed.

use std::io::{self, Write as _};

use lz4_flex::frame::{BlockMode, BlockSize, FrameEncoder, FrameInfo};

use super::format::{self, HEAD, RecordPut as _, kind, record};

/// The names of the compressions in the file: LZ4, and none.
pub(super) const LZ4: &str = "lz4";
const PLAIN: &str = "";

pub(super) struct RecordingChunk {
    compression: &'static str,
    /// The records.
    raw: Vec<u8>,
    /// Time and offset of each message, by channel number.
    index: Vec<Vec<u8>>,
    times_ns: Option<(u64, u64)>,
    messages: u64,
}

/// A chunk as stored in the file, followed by its message indexes.
pub(super) struct ClosedChunk {
    pub(super) bytes: Vec<u8>,
    compression: &'static str,
    chunk: usize,
    /// Channel, offset of its index in `bytes`, and number of messages.
    pub(super) indexes: Vec<(u16, usize, u64)>,
    compressed: u64,
    uncompressed: u64,
    pub(super) times_ns: Option<(u64, u64)>,
    pub(super) messages: u64,
}

impl RecordingChunk {
    pub(super) const fn compressed() -> Self {
        Self::of(LZ4)
    }

    /// Creates a chunk for data that are compressed already.
    pub(super) const fn plain() -> Self {
        Self::of(PLAIN)
    }

    const fn of(compression: &'static str) -> Self {
        Self { compression, raw: Vec::new(), index: Vec::new(), times_ns: None, messages: 0 }
    }

    /// Appends a schema or a channel.
    pub(super) fn put_record(&mut self, record: &[u8]) {
        self.raw.extend_from_slice(record);
    }

    pub(super) fn put_message(&mut self, channel: u16, sequence: u32, time_ns: u64, data: &[u8]) {
        let number = usize::from(channel);
        if self.index.len() <= number {
            self.index.resize_with(number + 1, Vec::new);
        }
        self.index[number].u64(time_ns);
        self.index[number].u64(self.raw.len() as u64);
        format::message(&mut self.raw, channel, sequence, time_ns, data);
        let (first, last) = self.times_ns.unwrap_or((time_ns, time_ns));
        self.times_ns = Some((first.min(time_ns), last.max(time_ns)));
        self.messages += 1;
    }

    pub(super) fn len(&self) -> usize {
        self.raw.len()
    }

    /// Returns the time span of the chunk with a message of this time added, ns.
    pub(super) fn span_ns(&self, time_ns: u64) -> u64 {
        self.times_ns.map_or(0, |(first, last)| last.max(time_ns) - first.min(time_ns))
    }

    /// Returns the finished bytes; the chunk is then empty again and keeps its memory.
    pub(super) fn close(&mut self) -> io::Result<ClosedChunk> {
        let (first, last) = self.times_ns.unwrap_or_default();
        let mut bytes = Vec::with_capacity(self.raw.len() / 3 + 1024);
        bytes.extend_from_slice(&format::head(kind::CHUNK, 0));
        bytes.u64(first);
        bytes.u64(last);
        bytes.u64(self.raw.len() as u64);
        bytes.u32(crc32fast::hash(&self.raw));
        bytes.text(self.compression);
        bytes.u64(0);
        let begin = bytes.len();
        let mut bytes = if self.compression.is_empty() {
            bytes.extend_from_slice(&self.raw);
            bytes
        } else {
            self.compress(bytes)?
        };
        let chunk = bytes.len();
        let compressed = (chunk - begin) as u64;
        bytes[begin - 8..begin].copy_from_slice(&compressed.to_le_bytes());
        bytes[1..HEAD].copy_from_slice(&((chunk - HEAD) as u64).to_le_bytes());
        let mut indexes = Vec::new();
        for (channel, entries) in self.index.iter_mut().enumerate().filter(|(_, entries)| !entries.is_empty()) {
            indexes.push((channel as u16, bytes.len(), (entries.len() / 16) as u64));
            record(&mut bytes, kind::MESSAGE_INDEX, |out| {
                out.u16(channel as u16);
                out.bytes(entries);
            });
            entries.clear();
        }
        let uncompressed = self.raw.len() as u64;
        self.raw.clear();
        let times_ns = self.times_ns.take();
        let messages = std::mem::take(&mut self.messages);
        let compression = self.compression;
        Ok(ClosedChunk { bytes, compression, chunk, indexes, compressed, uncompressed, times_ns, messages })
    }

    /// Uses the smallest, linked blocks, although they make the file 0.1 % larger than blocks of 1 MB: a reader
    /// allocates three blocks for each chunk, and a report of ten minutes spent two thirds of its time on their pages.
    fn compress(&self, into: Vec<u8>) -> io::Result<Vec<u8>> {
        let info = FrameInfo::new().block_size(BlockSize::Max64KB).block_mode(BlockMode::Linked);
        let mut encoder = FrameEncoder::with_frame_info(info, into);
        encoder.write_all(&self.raw)?;
        encoder.finish().map_err(io::Error::other)
    }
}

impl ClosedChunk {
    /// Returns the entry for the summary if the chunk is at offset `at`.
    pub(super) fn index(&self, at: u64) -> Vec<u8> {
        let (first, last) = self.times_ns.unwrap_or_default();
        let mut index = Vec::new();
        record(&mut index, kind::CHUNK_INDEX, |out| {
            out.u64(first);
            out.u64(last);
            out.u64(at);
            out.u64(self.chunk as u64);
            out.u32((self.indexes.len() * 10) as u32);
            for &(channel, begin, _) in &self.indexes {
                out.u16(channel);
                out.u64(at + begin as u64);
            }
            out.u64((self.bytes.len() - self.chunk) as u64);
            out.text(self.compression);
            out.u64(self.compressed);
            out.u64(self.uncompressed);
        });
        index
    }
}
