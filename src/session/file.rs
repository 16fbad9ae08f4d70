//! The journal in a session file.

use std::path::Path;

use nima_recording::{
    messages::foxglove::{Level, Log},
    session::{ReadError, Reader},
};
use prost::Message as _;

use crate::{
    journal::{Message, decode},
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

    /// Whether the recording was closed: if not, it goes on, or the program was killed, or the file was cut.
    ///
    /// # Errors
    /// [`ReadError`] if the end cannot be read.
    pub fn is_closed(&self) -> Result<bool, ReadError> {
        let last_ns = self.0.statistics().times_ns.1;
        let end = self.0.messages(&[JOURNAL_TOPIC], last_ns..u64::MAX).last().transpose()?;
        Ok(end.is_some_and(|end| matches!(decode(end.data()), Ok((_, Message::End(_))))))
    }

    /// Time (ns) and words of the last error in the log.
    ///
    /// # Errors
    /// [`ReadError`] if the log cannot be read.
    pub fn last_fault(&self) -> Result<Option<(u64, String)>, ReadError> {
        let mut last = None;
        for message in self.0.messages(&["log"], 0..u64::MAX) {
            let message = message?;
            let line = Log::decode(message.data()).ok().filter(|line| line.level() >= Level::Error);
            last = line.map(|line| (message.log_time_ns(), line.message)).or(last);
        }
        Ok(last)
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
