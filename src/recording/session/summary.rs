//! The summary at the end of a session, which a reader needs before it reads a chunk. Kept as encoded records, one
//! buffer for each kind. The indexes of chunks stay in the file, because their number grows with the session.

use super::format::{self, Statistics, kind};

#[derive(Default)]
pub(super) struct RecordingSummary {
    pub(super) schemas: Vec<u8>,
    pub(super) channels: Vec<u8>,
    pub(super) attachments: Vec<u8>,
    pub(super) metadata: Vec<u8>,
    /// Indexes of chunks that are not in the file's summary yet.
    new_indexes: Vec<u8>,
    /// Bytes of the indexes that are.
    indexed: u64,
    pub(super) statistics: Statistics,
}

impl RecordingSummary {
    /// Returns the kinds kept here, in their order in the file; the indexes of chunks follow them.
    pub(super) fn groups(&self) -> [(u8, &[u8]); 4] {
        [
            (kind::SCHEMA, &self.schemas),
            (kind::CHANNEL, &self.channels),
            (kind::ATTACHMENT_INDEX, &self.attachments),
            (kind::METADATA_INDEX, &self.metadata),
        ]
    }

    /// Adds the index of a chunk.
    pub(super) fn index(&mut self, record: &[u8]) {
        self.new_indexes.extend_from_slice(record);
    }

    pub(super) fn new_indexes(&self) -> &[u8] {
        &self.new_indexes
    }

    pub(super) fn indexes(&self) -> u64 {
        self.indexed + self.new_indexes.len() as u64
    }

    /// Marks the new indexes as written to the file.
    pub(super) fn is_in_file(&mut self) {
        self.indexed += self.new_indexes.len() as u64;
        self.new_indexes.clear();
    }

    pub(super) fn statistics_record(&self) -> Vec<u8> {
        let mut record = Vec::new();
        format::statistics(&mut record, &self.statistics);
        record
    }

    /// Returns the upper limit of the bytes of everything, including the record before it and padding.
    pub(super) fn room(&self) -> u64 {
        let groups: usize = self.groups().iter().map(|(_, group)| group.len()).sum();
        (groups + self.statistics_record().len() + 64) as u64 + self.indexes()
    }
}
