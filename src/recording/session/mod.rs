//! The file of a recorded session: MCAP (<https://mcap.dev/spec>) that is valid at every moment.
//!
//! [`SessionWriter`] makes it, [`SessionReader`] reads it and those of others. Not with the crate `mcap`: its writer makes a file valid at its end
//! only, and compresses through C libraries; our tests read with it. docs/decisions/own-mcap-writer.md compares the two.

mod at;
mod chunk;
mod error;
mod format;
mod layout;
mod reader;
mod summary;
mod writer;

pub use error::{ReadError, WriteError};
pub use format::Statistics;
pub use reader::{Attachment, Metadata, ReaderChannel, ReaderMessages, SessionMessage, SessionReader};
pub use writer::{CHUNK_BYTES, CHUNK_NS, ChannelId, Encoding, SessionWriter, is_being_written};

#[cfg(test)]
mod tests;
