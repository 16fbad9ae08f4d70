//! A session file that is written on another machine during the recording.
//!
//! The recorder's thread forwards all written data, as [`FilePart`]s in numbered [`Bundle`]s. A receiver that has all
//! bundles from the first one writes a file that replays like the original. A receiver that joins later begins with a
//! [`SessionHead`], which holds the tables, files and channels of the bundles that are gone, and writes an excerpt: a
//! journal can be replayed only from its beginning.

use std::{collections::BTreeMap, path::Path};

use nima_recording::session::{ChannelId, Encoding, SessionWriter, WriteError};
use prost::{Message as _, Oneof};

use crate::{
    recorder::{AttachedFile, JOURNAL_TOPIC},
    trim::{self, JournalOutcome},
};

/// Version of heads and bundles; other versions are refused.
const VERSION: u32 = 1;

/// One write into a session file.
#[derive(Clone, PartialEq, Oneof)]
pub enum FilePart {
    #[prost(message, tag = "1")]
    Table(NamedValues),
    #[prost(message, tag = "2")]
    File(WholeFile),
    /// A new channel. Channels are numbered from 0 in the order of their creation.
    #[prost(message, tag = "3")]
    Channel(NewChannel),
    #[prost(message, tag = "4")]
    Message(ChannelMessage),
}

#[derive(Clone, PartialEq, prost::Message)]
pub struct NamedValues {
    #[prost(string, tag = "1")]
    pub name: String,
    /// Values, by name.
    #[prost(btree_map = "string, string", tag = "2")]
    pub entries: BTreeMap<String, String>,
}

#[derive(Clone, PartialEq, prost::Message)]
pub struct WholeFile {
    /// Time of its creation, ns since 1970.
    #[prost(uint64, tag = "1")]
    pub time_ns: u64,
    #[prost(string, tag = "2")]
    pub name: String,
    #[prost(string, tag = "3")]
    pub media_type: String,
    #[prost(bytes = "vec", tag = "4")]
    pub data: Vec<u8>,
}

/// A channel, with the fields of [`Encoding`].
#[derive(Clone, PartialEq, prost::Message)]
pub struct NewChannel {
    #[prost(string, tag = "1")]
    pub topic: String,
    #[prost(string, tag = "2")]
    pub schema: String,
    #[prost(string, tag = "3")]
    pub schema_encoding: String,
    #[prost(bytes = "vec", tag = "4")]
    pub schema_data: Vec<u8>,
    #[prost(string, tag = "5")]
    pub message_encoding: String,
}

#[derive(Clone, PartialEq, prost::Message)]
pub struct ChannelMessage {
    #[prost(uint32, tag = "1")]
    pub channel: u32,
    /// Time of its sample, ns since 1970.
    #[prost(fixed64, tag = "2")]
    pub time_ns: u64,
    #[prost(bytes = "vec", tag = "3")]
    pub data: Vec<u8>,
}

impl FilePart {
    /// Returns whether it is a message; every other part belongs into every file of the session.
    pub const fn is_message(&self) -> bool {
        matches!(self, Self::Message(_))
    }

    pub fn table(name: &str, entries: &BTreeMap<String, String>) -> Self {
        Self::Table(NamedValues { name: name.to_owned(), entries: entries.clone() })
    }

    pub fn file(time_ns: u64, attached: &AttachedFile) -> Self {
        let AttachedFile { name, media_type, data } = attached.clone();
        Self::File(WholeFile { time_ns, name, media_type, data })
    }

    pub fn channel(topic: &str, encoding: &Encoding) -> Self {
        let Encoding { schema, schema_encoding, schema_data, message_encoding } = encoding.clone();
        Self::Channel(NewChannel { topic: topic.to_owned(), schema, schema_encoding, schema_data, message_encoding })
    }

    pub fn message(channel: usize, time_ns: u64, data: &[u8]) -> Self {
        Self::Message(ChannelMessage { channel: channel as u32, time_ns, data: data.to_vec() })
    }
}

/// Wraps a part in its own message, as Protocol Buffers require.
#[derive(Clone, PartialEq, prost::Message)]
pub struct MessageSlot {
    /// `None` in a damaged message.
    #[prost(oneof = "FilePart", tags = "1, 2, 3, 4")]
    pub part: Option<FilePart>,
}

/// The parts written within a short time.
#[derive(Clone, PartialEq, prost::Message)]
pub struct Bundle {
    /// See [`VERSION`].
    #[prost(uint32, tag = "1")]
    version: u32,
    /// Identifies the session within the rig's program.
    #[prost(uint64, tag = "2")]
    pub session: u64,
    /// Counts the bundles of a session from 0.
    #[prost(uint64, tag = "3")]
    pub number: u64,
    /// Whether the session has ended with this bundle.
    #[prost(bool, tag = "4")]
    pub closes: bool,
    #[prost(message, repeated, tag = "5")]
    parts: Vec<MessageSlot>,
}

impl Bundle {
    pub fn new(session: u64, number: u64, parts: Vec<FilePart>, closes: bool) -> Self {
        let parts = parts.into_iter().map(|part| MessageSlot { part: Some(part) }).collect();
        Self { version: VERSION, session, number, closes, parts }
    }

    pub fn parts(&self) -> impl Iterator<Item = &FilePart> {
        self.parts.iter().filter_map(|slot| slot.part.as_ref())
    }

    pub fn pack(&self) -> Vec<u8> {
        self.encode_to_vec()
    }

    /// Parses the bytes of [`Bundle::pack`].
    ///
    /// # Errors
    /// [`CopyError`] if they come from another version or are damaged.
    pub fn read(bytes: &[u8]) -> Result<Self, CopyError> {
        let bundle = Self::decode(bytes).map_err(|error| CopyError::Damaged(error.to_string()))?;
        if bundle.version == VERSION { Ok(bundle) } else { Err(CopyError::Version) }
    }
}

/// All data from earlier batches that are needed to start at a later one.
#[derive(Clone, PartialEq, prost::Message)]
pub struct SessionHead {
    #[prost(uint32, tag = "1")]
    version: u32,
    /// Identifies the session within the rig's program.
    #[prost(uint64, tag = "2")]
    pub session: u64,
    /// Name and version of the recording program.
    #[prost(string, tag = "3")]
    pub program: String,
    /// Start of the loop's clock, ns since 1970 (UTC).
    #[prost(fixed64, tag = "4")]
    pub started_ns: u64,
    /// Number of the first bundle that is still available.
    #[prost(uint64, tag = "5")]
    pub first: u64,
    /// Whether messages were in the bundles before it.
    #[prost(bool, tag = "6")]
    pub lacks: bool,
    #[prost(message, repeated, tag = "7")]
    parts: Vec<MessageSlot>,
}

impl SessionHead {
    /// Creates the head at the beginning of a session.
    pub fn new(session: u64, program: &str, started_ns: u64) -> Self {
        let program = program.to_owned();
        Self { version: VERSION, session, program, started_ns, first: 0, lacks: false, parts: Vec::new() }
    }

    /// Removes the oldest batch but keeps its data except the messages.
    pub fn outlive(&mut self, oldest: Bundle) {
        self.first = oldest.number + 1;
        for slot in oldest.parts {
            match &slot.part {
                Some(part) if !part.is_message() => self.parts.push(slot),
                _ => self.lacks = true,
            }
        }
    }

    pub fn pack(&self) -> Vec<u8> {
        self.encode_to_vec()
    }

    /// Parses the bytes of [`SessionHead::pack`].
    ///
    /// # Errors
    /// [`CopyError`] if they come from another version or are damaged.
    pub fn read(bytes: &[u8]) -> Result<Self, CopyError> {
        let head = Self::decode(bytes).map_err(|error| CopyError::Damaged(error.to_string()))?;
        if head.version == VERSION { Ok(head) } else { Err(CopyError::Version) }
    }

    /// Returns a table of the session, from this head or from its first bundle.
    pub fn table<'a>(&'a self, first: &'a Bundle, name: &str) -> Option<&'a BTreeMap<String, String>> {
        let parts = self.parts.iter().chain(&first.parts).filter_map(|slot| slot.part.as_ref());
        parts.into_iter().find_map(|part| match part {
            FilePart::Table(table) if table.name == name => Some(&table.entries),
            _ => None,
        })
    }
}

#[derive(Debug, thiserror::Error)]
pub enum CopyError {
    #[error("the rig runs a different version of this program; install the same version on both computers")]
    Version,
    #[error("a message from the rig is damaged: {0}")]
    Damaged(String),
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("part {came} of the session arrived, but part {due} was expected; start a new copy")]
    Gap { came: u64, due: u64 },
}

/// Writes a copy of a session file.
pub struct Copy {
    writer: SessionWriter,
    /// Channels of the copy, by their numbers in the session; `None` for the journal of an excerpt.
    channels: Vec<Option<ChannelId>>,
    is_stretch: bool,
    due: u64,
}

impl Copy {
    /// Creates a file from this head; `first` is the bundle that follows it.
    ///
    /// # Errors
    /// [`CopyError`] if the file cannot be written or `first` is another bundle.
    pub fn create(path: &Path, head: &SessionHead, first: &Bundle) -> Result<Self, CopyError> {
        let writer = SessionWriter::create(path, &head.program)?;
        let mut copy = Self { writer, channels: Vec::new(), is_stretch: head.lacks, due: head.first };
        if head.lacks {
            let begins_ns = first.parts().find_map(|part| match part {
                FilePart::Message(message) => Some(message.time_ns),
                _ => None,
            });
            let times_ns = begins_ns.unwrap_or(head.started_ns)..u64::MAX;
            let session = head.table(first, "session").and_then(|table| table.get("started"));
            let name = session.map_or("a session", String::as_str);
            let table = trim::table(name, head.started_ns, &times_ns, JournalOutcome::LeftOut, None);
            copy.writer.metadata(trim::TABLE, &table)?;
        }
        for part in head.parts.iter().filter_map(|slot| slot.part.as_ref()) {
            copy.part(part)?;
        }
        copy.add(first)?;
        Ok(copy)
    }

    /// Adds the next bundle and closes the chunk of the file.
    ///
    /// # Errors
    /// [`CopyError`] if it is not the next bundle or the file cannot be written.
    pub fn add(&mut self, bundle: &Bundle) -> Result<(), CopyError> {
        if bundle.number != self.due {
            return Err(CopyError::Gap { came: bundle.number, due: self.due });
        }
        for part in bundle.parts() {
            self.part(part)?;
        }
        self.due += 1;
        Ok(self.writer.flush()?)
    }

    /// Returns the number of the expected bundle.
    pub const fn due(&self) -> u64 {
        self.due
    }

    pub fn bytes(&self) -> u64 {
        self.writer.bytes().1
    }

    /// Closes the file and returns its number of messages.
    ///
    /// # Errors
    /// [`CopyError`] if it cannot be written.
    pub fn finish(self) -> Result<u64, CopyError> {
        Ok(self.writer.finish()?.messages)
    }

    fn part(&mut self, part: &FilePart) -> Result<(), WriteError> {
        match part {
            FilePart::Table(NamedValues { name, entries }) => self.writer.metadata(name, entries),
            FilePart::File(WholeFile { time_ns, name, media_type, data }) => {
                self.writer.attachment(name, media_type, *time_ns, data)
            }
            FilePart::Channel(channel) => {
                let of_file = !self.is_stretch || channel.topic != JOURNAL_TOPIC;
                let id = of_file.then(|| self.writer.channel(&channel.topic, channel.encoding())).transpose()?;
                self.channels.push(id);
                Ok(())
            }
            FilePart::Message(ChannelMessage { channel, time_ns, data }) => {
                let channel = usize::try_from(*channel).ok().and_then(|number| self.channels.get(number));
                channel.copied().flatten().map_or(Ok(()), |id| self.writer.message(id, *time_ns, data))
            }
        }
    }
}

impl NewChannel {
    fn encoding(&self) -> Encoding {
        let Self { topic: _, schema, schema_encoding, schema_data, message_encoding } = self.clone();
        Encoding { schema, schema_encoding, schema_data, message_encoding }
    }
}

impl std::fmt::Debug for Copy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Copy").field("due", &self.due).field("is_stretch", &self.is_stretch).finish_non_exhaustive()
    }
}

#[cfg(test)]
#[path = "remote_copy_tests.rs"]
mod tests;
