//! The file of a recorded session: MCAP that is valid at every moment.

mod at;
mod chunk;
mod error;
mod format;
mod layout;
mod summary;
mod writer;

pub use error::WriteError;
pub use format::Statistics;
pub use writer::{CHUNK_BYTES, CHUNK_NS, ChannelId, Encoding, Writer};
