//! `OpenIGTLink`, versions 1 to 3: the codec, and a server that reports the state of a loop to clients.
//!
//! The codec uses no socket, thread or clock. It accepts untrusted input: every sequence of bytes gives a message or an
//! error.
//!
//! ```
//! use nima_bridges::igtl::{Content, IgtlHeader, PoseMatrix, IgtlMessage};
//!
//! let tip = IgtlMessage::new("right.tip", 1_500_000_000, Content::Transform(PoseMatrix::at([1.0, 2.0, 3.0])));
//! let bytes = tip.encode();
//! let (head, body) = bytes.split_at(IgtlHeader::BYTES);
//! let header = IgtlHeader::read(head)?;
//! assert_eq!((header.kind.as_str(), header.body_bytes), ("TRANSFORM", 48));
//! assert_eq!(IgtlMessage::read(&header, body)?, tip);
//! # Ok::<(), nima_bridges::igtl::IgtlFormatError>(())
//! ```

mod content;
mod image;
mod message;
#[cfg(feature = "loop")]
mod server;
mod tracking;
mod unit;
mod wire;

pub use content::{
    Content, ContentKind, ContentStatus, ContentStream, Position, SensorContent, StatusCode, TextContent, Verb,
};
pub use image::Image;
pub use message::{IgtlHeader, IgtlMessage};
#[cfg(feature = "loop")]
pub use server::{IMAGE_DEVICE, IgtlError, IgtlServer, ImageProvider, LoopOutline, PORT, StateText};
pub use tracking::{PoseMatrix, QuaternionTool, ToolKind, TrackingTool};
pub use unit::IgtlUnit;

/// Why bytes are not a message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum IgtlFormatError {
    /// Fewer bytes than the message needs.
    #[error("the message is truncated")]
    Short,
    #[error("the header's version is {0}, but only 1 and 2 are supported; use another version of the sender")]
    Version(u16),
    /// The checksum does not match the body.
    #[error("the checksum does not match: the message was damaged in transit")]
    Checksum,
    /// The length of the body does not match the counts in it.
    #[error("a message of type {kind} with {bytes} bytes does not match the counts in it")]
    Length { kind: String, bytes: usize },
    /// A number without a meaning.
    #[error("a message of type {kind} has an invalid value: {what}")]
    Value {
        kind: String,
        /// Name of the value.
        what: &'static str,
    },
}

#[cfg(test)]
mod tests;
