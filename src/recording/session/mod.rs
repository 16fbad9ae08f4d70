//! The file of a recorded session: MCAP (<https://mcap.dev/spec>) that is valid at every moment.
//!
//! [`Writer`] writes it; [`Reader`] reads our files and those of others. The crate `mcap` is used only in our tests, as
//! a reader: its writer makes a file valid only at the end and compresses through C libraries. docs/sessions.md
//! compares the two with measurements.

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
pub use reader::{Attachment, Channel, Message, Messages, Metadata, Reader};
pub use writer::{CHUNK_BYTES, CHUNK_NS, ChannelId, Encoding, Writer, is_being_written};

#[cfg(test)]
mod tests;
