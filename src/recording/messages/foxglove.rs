//! Messages that Foxglove knows by name, as Protocol Buffers: frames, text, arrows, pictures.
//!
//! They are from Foxglove's own library. [`encoding`] gives their description, with which a reader without knowledge of
//! Foxglove decodes them.

pub use ::foxglove::messages::{
    ArrowPrimitive, Color, CompressedImage, CompressedVideo, FrameTransform, FrameTransforms, Pose, Quaternion,
    SceneEntity, SceneUpdate, Timestamp, Vector3, log::Level,
};
use ::foxglove::{Encode, Schema, messages};
use prost::{Message, bytes::BufMut};

use crate::session::Encoding;

/// Returns how a reader is to understand a channel of these messages.
///
/// ```
/// use nima_recording::messages::foxglove::{encoding, Log};
/// assert_eq!(encoding::<Log>().schema, "foxglove.Log");
/// ```
pub fn encoding<M: Encode>() -> Encoding {
    // Every Foxglove message has a schema.
    let schema = M::get_schema().unwrap_or_else(|| Schema::new("", "", Vec::new()));
    Encoding {
        schema: schema.name,
        schema_encoding: schema.encoding,
        schema_data: schema.data.into_owned(),
        message_encoding: M::get_message_encoding(),
    }
}

/// Returns the moment this many nanoseconds after 1970, up to the year 2106.
pub fn timestamp(ns: u64) -> Timestamp {
    let second = 1_000_000_000;
    Timestamp::new(u32::try_from(ns / second).unwrap_or(u32::MAX), (ns % second) as u32)
}

/// A line of a log: Foxglove's message, with a value that its readers ignore.
#[derive(Clone, PartialEq, Message)]
pub struct Log {
    /// When.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// Severity.
    #[prost(enumeration = "Level", tag = "2")]
    pub level: i32,
    /// The text.
    #[prost(string, tag = "3")]
    pub message: String,
    /// Part of the program that wrote it.
    #[prost(string, tag = "4")]
    pub name: String,
    /// Source file that wrote it.
    #[prost(string, tag = "5")]
    pub file: String,
    /// Line of that file.
    #[prost(fixed32, tag = "6")]
    pub line: u32,
    /// The text as a value of the program that wrote it; not in Foxglove's schema.
    #[prost(bytes = "vec", optional, tag = "1000")]
    pub value: Option<Vec<u8>>,
}

impl Encode for Log {
    type Error = prost::EncodeError;

    fn get_schema() -> Option<Schema> {
        messages::Log::get_schema()
    }

    fn get_message_encoding() -> String {
        messages::Log::get_message_encoding()
    }

    fn encode(&self, buffer: &mut impl BufMut) -> Result<(), Self::Error> {
        Message::encode(self, buffer)
    }
}
