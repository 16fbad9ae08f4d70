//! The journal in a session file.

use std::path::Path;

use nima_recording::session::{ReadError, Reader};

use crate::{
    recorder::JOURNAL_TOPIC,
    replay::{Journal, ReplayError},
};

/// A session file.
pub struct Recorded(Reader);

impl Recorded {
    /// Opens it.
    ///
    /// # Errors
    /// [`ReadError`] if it is no session file, or damaged.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Reader::open(path).map(Self)
    }

    /// The file.
    pub const fn reader(&self) -> &Reader {
        &self.0
    }

    /// Its journal.
    ///
    /// # Errors
    /// [`ReplayError`] if it has none, or its beginning cannot be read.
    pub fn journal(&self) -> Result<Journal<impl Iterator<Item = Result<Vec<u8>, ReplayError>> + '_>, ReplayError> {
        let messages = self.0.messages(&[JOURNAL_TOPIC], 0..u64::MAX);
        Journal::open(messages.map(|message| Ok(message?.data().to_vec())))
    }
}
