//! The crate `mcap` as a reader of our files, without its C libraries: it uses our LZ4.

use mcap::{
    McapResult,
    read::Summary,
    sans_io::{
        IndexedReadEvent, IndexedReader, LinearReaderOptions,
        decompressor::{DecompressResult, Decompressor},
    },
};

/// Topic, time, data.
pub(super) type PeerMessage = Vec<(String, u64, Vec<u8>)>;

/// Reads by the index.
pub(super) fn indexed(bytes: &[u8]) -> McapResult<PeerMessage> {
    let summary = Summary::read(bytes)?.expect("there is a summary");
    for index in &summary.attachment_indexes {
        mcap::read::attachment(bytes, index)?;
    }
    for index in &summary.metadata_indexes {
        mcap::read::metadata(bytes, index)?;
    }
    let mut reader = IndexedReader::new(&summary)?;
    reader.add_decompressor(Lz4::default())?;
    let mut report = Vec::new();
    while let Some(event) = reader.next_event() {
        match event? {
            IndexedReadEvent::ReadChunkRequest { offset, length } => {
                let chunk = bytes[offset as usize..][..length].to_vec();
                reader.insert_chunk_record_data(offset, &chunk)?;
            }
            IndexedReadEvent::Message { header, data } => {
                let topic = summary.channels[&header.channel_id].topic.clone();
                report.push((topic, header.log_time, data.to_vec()));
            }
        }
    }
    let count = summary.stats.expect("there are statistics").message_count;
    assert_eq!(count, report.len() as u64, "the statistics agree");
    Ok(report)
}

/// Reads sequentially and verifies every checksum.
pub(super) fn linear(bytes: &[u8]) -> McapResult<PeerMessage> {
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true)
        .with_check_finishes_after_end_magic(true);
    let mut reader = mcap::io::MessageReader::new_with_options(bytes, options);
    reader.add_decompressor(Lz4::default())?;
    reader
        .map(|message| message.map(|message| (message.channel.topic.clone(), message.log_time, message.data.to_vec())))
        .collect()
}

/// Decodes LZ4 frames without content size and block checksums, as we write them, block by block.
#[derive(Default)]
struct Lz4 {
    taken: Vec<u8>,
    begun: bool,
    plain: Vec<u8>,
    given: usize,
}

const FRAME_HEAD: usize = 7;

impl Lz4 {
    /// Returns the number of bytes needed for the next step.
    fn wanted(&self) -> usize {
        if !self.begun {
            return FRAME_HEAD - self.taken.len();
        }
        match self.taken.first_chunk() {
            Some(&size) => 4 + (u32::from_le_bytes(size) & 0x7fff_ffff) as usize - self.taken.len(),
            None => 4 - self.taken.len(),
        }
    }

    fn block(&mut self) {
        let (size, block) = self.taken.split_first_chunk().unwrap();
        let size = u32::from_le_bytes(*size);
        let begin = self.plain.len();
        if size >> 31 == 1 {
            self.plain.extend_from_slice(block);
        } else if size != 0 {
            self.plain.resize(begin + (1 << 20), 0);
            let (before, room) = self.plain.split_at_mut(begin);
            let dictionary = &before[before.len().saturating_sub(64 << 10)..];
            let count = lz4_flex::block::decompress_into_with_dict(block, room, dictionary).expect("a block");
            self.plain.truncate(begin + count);
        }
        self.taken.clear();
    }
}

impl Decompressor for Lz4 {
    fn next_read_size(&self) -> usize {
        self.wanted()
    }

    fn decompress(&mut self, src: &[u8], dst: &mut [u8]) -> McapResult<DecompressResult> {
        let mut consumed = 0;
        while self.given == self.plain.len() && consumed < src.len() {
            let count = self.wanted().min(src.len() - consumed);
            self.taken.extend_from_slice(&src[consumed..consumed + count]);
            consumed += count;
            if self.wanted() > 0 {
                continue;
            }
            if self.begun {
                self.block();
            } else {
                self.begun = true;
                self.taken.clear();
            }
        }
        let wrote = dst.len().min(self.plain.len() - self.given);
        dst[..wrote].copy_from_slice(&self.plain[self.given..self.given + wrote]);
        self.given += wrote;
        Ok(DecompressResult { consumed, wrote })
    }

    fn reset(&mut self) -> McapResult<()> {
        *self = Self::default();
        Ok(())
    }

    fn name(&self) -> &'static str {
        "lz4"
    }
}
