//! The records of one chunk, decompressed and checked.

use std::io::{self, Read as _};

use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;

use super::{parse, source::ReaderSource};
use crate::session::{
    chunk::LZ4,
    format::{HEAD, kind},
};

pub(super) struct ReaderChunk {
    pub(super) records: Vec<u8>,
    pub(super) times_ns: (u64, u64),
}

/// One LZ4 byte expands to at most this many bytes; a chunk that claims more is rejected.
const MAX_FOR_A_BYTE: u64 = 255;
/// Zstandard, in which `ros2 bag` and other programs compress.
const ZSTD: &str = "zstd";
/// Maximum length of a chunk in Zstandard, in which a few bytes can stand for any number of equal ones.
const ZSTD_MAX: u64 = 256 << 20;

/// Reads the chunk at this position, or returns what is wrong with it.
pub(super) fn read(source: &ReaderSource, at: u64, length: u64) -> io::Result<Result<ReaderChunk, String>> {
    let bytes = match source.read(at, length) {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
            return Ok(Err("it is beyond the end of the file".into()));
        }
        read => read?,
    };
    let found = parse::first_record(&bytes).filter(|&(kind, _, behind)| kind == kind::CHUNK && behind.is_empty());
    let Some((head, compressed)) = found.and_then(|(_, content, _)| parse::chunk(content)) else {
        return Ok(Err("it is not a complete chunk".into()));
    };
    Ok(decompress(&head, compressed).and_then(|records| {
        // A checksum of 0 stands for none (MCAP specification).
        if head.crc == 0 || crc32fast::hash(&records) == head.crc {
            Ok(ReaderChunk { records, times_ns: head.times_ns })
        } else {
            Err("its checksum does not match: the data were changed or damaged".into())
        }
    }))
}

fn decompress(head: &parse::ChunkHead, compressed: &[u8]) -> Result<Vec<u8>, String> {
    let max = match head.compression.as_str() {
        "" => compressed.len() as u64,
        LZ4 => compressed.len() as u64 * MAX_FOR_A_BYTE,
        ZSTD => ZSTD_MAX,
        other => {
            let other = nima_files::quoted(other);
            return Err(format!("it is compressed with {other}; convert the file: mcap compress --compression lz4"));
        }
    };
    if head.uncompressed > max {
        return Err("its stated length is longer than it can be".into());
    }
    // Allocate only for a likely compression ratio at first, whatever the chunk claims.
    let likely = head.uncompressed.min(8 * compressed.len() as u64);
    let mut records = Vec::with_capacity(likely as usize);
    // One byte more than stated, so that longer data are noticed.
    let failed = |error: &dyn std::fmt::Display| format!("it cannot be decompressed: {error}");
    let read = match head.compression.as_str() {
        "" => {
            records.extend_from_slice(compressed);
            Ok(records.len())
        }
        ZSTD => {
            let decoder = StreamingDecoder::new(compressed).map_err(|error| failed(&error))?;
            decoder.take(head.uncompressed + 1).read_to_end(&mut records)
        }
        _ => FrameDecoder::new(compressed).take(head.uncompressed + 1).read_to_end(&mut records),
    };
    read.map_err(|error| failed(&error))?;
    if records.len() as u64 == head.uncompressed {
        Ok(records)
    } else {
        Err("it does not have the length that it states".into())
    }
}

/// Returns kind, content and position of each record; ends where the bytes are not a record.
pub(super) fn records(bytes: &[u8]) -> impl Iterator<Item = (u8, &[u8], usize)> {
    let mut left = bytes;
    std::iter::from_fn(move || {
        let (kind, content, behind) = parse::first_record(left)?;
        let at = bytes.len() - left.len() + HEAD;
        left = behind;
        Some((kind, content, at))
    })
}

#[cfg(test)]
mod tests {
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};

    use super::*;

    #[test]
    fn a_chunk_in_zstandard_is_read_and_a_wrong_length_refused() {
        let records: Vec<u8> = (0..5000_u32).flat_map(u32::to_le_bytes).collect();
        let compressed = compress_to_vec(&records[..], CompressionLevel::Fastest);
        let head = |uncompressed: u64| parse::ChunkHead {
            times_ns: (0, 1),
            uncompressed,
            crc: 0,
            compression: ZSTD.to_owned(),
        };
        assert_eq!(decompress(&head(records.len() as u64), &compressed), Ok(records.clone()));
        for wrong in [0, records.len() as u64 - 1, records.len() as u64 + 1, u64::MAX] {
            assert!(decompress(&head(wrong), &compressed).is_err(), "{wrong}");
        }
        assert!(decompress(&head(records.len() as u64), &compressed[..compressed.len() / 2]).is_err());
    }
}
