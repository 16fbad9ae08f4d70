//! `OpenIGTLink`, versions 1 to 3: the codec, and a server that tells clients what a loop does.
//!
//! The codec knows no socket, thread or clock. It reads what anybody may send: every sequence of bytes gives a message or an error.
//!
//! ```
//! use nima_bridges::igtl::{Content, Header, Matrix, Message};
//!
//! let tip = Message::new("right.tip", 1_500_000_000, Content::Transform(Matrix::at([1.0, 2.0, 3.0])));
//! let bytes = tip.encode();
//! let (head, body) = bytes.split_at(Header::BYTES);
//! let header = Header::read(head)?;
//! assert_eq!((header.kind.as_str(), header.body_bytes), ("TRANSFORM", 48));
//! assert_eq!(Message::read(&header, body)?, tip);
//! # Ok::<(), nima_bridges::igtl::Wrong>(())
//! ```

mod content;
mod image;
mod message;
#[cfg(feature = "loop")]
mod server;
mod tracking;
mod unit;
mod wire;

pub use content::{Content, Kind, Position, Sensor, Status, StatusCode, Stream, Text, Verb};
pub use image::Image;
pub use message::{Header, Message};
#[cfg(feature = "loop")]
pub use server::{IMAGE_DEVICE, IgtlError, Outline, PORT, Pictures, Server, StateWords};
pub use tracking::{Matrix, Tool, ToolKind, Turned};
pub use unit::Unit;

/// Why bytes are no message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Wrong {
    /// Fewer bytes than the message needs.
    #[error("the message ends early")]
    Short,
    /// An unknown version of the header.
    #[error("the header's version is {0}; 1 and 2 are known")]
    Version(u16),
    /// The checksum does not fit the body.
    #[error("the checksum does not fit: the message was damaged on its way")]
    Checksum,
    /// The body's length does not fit what it says of itself.
    #[error("a message {kind} of {bytes} bytes does not fit its own counts")]
    Length {
        /// The kind.
        kind: String,
        /// Bytes of the content.
        bytes: usize,
    },
    /// A number that has no meaning.
    #[error("a message {kind} has a value that means nothing: {what}")]
    Value {
        /// The kind.
        kind: String,
        /// Which.
        what: &'static str,
    },
}

#[cfg(test)]
mod tests;
