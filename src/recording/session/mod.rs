//! The file of a recorded session: MCAP that is valid at every moment.

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
pub use reader::{Attachment, Channel, Message, Messages, Reader};
pub use writer::{CHUNK_BYTES, CHUNK_NS, ChannelId, Encoding, Writer};

#[cfg(test)]
mod tests;
