//! The summary: what a reader needs to know before it reads a chunk. Kept as encoded records, one buffer for each kind.

use super::format::Put as _;
use super::format::{self, END, Statistics, kind, record};

#[derive(Default)]
pub(super) struct Summary {
    pub(super) schemas: Vec<u8>,
    pub(super) channels: Vec<u8>,
    pub(super) attachments: Vec<u8>,
    pub(super) metadata: Vec<u8>,
    pub(super) chunks: Vec<u8>,
    pub(super) statistics: Statistics,
}

impl Summary {
    fn groups(&self) -> [(u8, &[u8]); 5] {
        [
            (kind::SCHEMA, &self.schemas),
            (kind::CHANNEL, &self.channels),
            (kind::ATTACHMENT_INDEX, &self.attachments),
            (kind::METADATA_INDEX, &self.metadata),
            (kind::CHUNK_INDEX, &self.chunks),
        ]
    }

    /// Bytes without the statistics.
    pub(super) fn put_groups(&self, out: &mut Vec<u8>) {
        for (_, group) in self.groups() {
            out.extend_from_slice(group);
        }
    }

    pub(super) fn statistics_record(&self) -> Vec<u8> {
        let mut record = Vec::new();
        format::statistics(&mut record, &self.statistics);
        record
    }

    /// Most bytes of everything, the record before it and what fills gaps included.
    pub(super) fn room(&self) -> u64 {
        let groups: usize = self.groups().iter().map(|(_, group)| group.len()).sum();
        (groups + self.statistics_record().len() + 64) as u64
    }

    /// The end of a finished file, to stand at `at`: with the places of all groups and a checksum.
    pub(super) fn finished(&self, at: u64) -> Vec<u8> {
        let mut out = Vec::new();
        record(&mut out, kind::DATA_END, |out| out.u32(0));
        let begin = out.len();
        let statistics = self.statistics_record();
        let mut offsets = Vec::new();
        for (kind, group) in self.groups().into_iter().chain([(kind::STATISTICS, statistics.as_slice())]) {
            if !group.is_empty() {
                record(&mut offsets, kind::SUMMARY_OFFSET, |offsets| {
                    offsets.push(kind);
                    offsets.u64(at + out.len() as u64);
                    offsets.u64(group.len() as u64);
                });
                out.extend_from_slice(group);
            }
        }
        let offsets_start = at + out.len() as u64;
        out.extend_from_slice(&offsets);
        format::end(&mut out, at + begin as u64, offsets_start, 0);
        let checked = out.len() - (END - format::HEAD - 16);
        let crc = crc32fast::hash(&out[begin..checked]);
        out[checked..checked + 4].copy_from_slice(&crc.to_le_bytes());
        out
    }
}
