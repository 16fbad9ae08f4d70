//! Protocol Buffers messages that Foxglove recognises by name: frames, text, arrows, images.
//!
//! The structs are written by hand from the published field numbers. [`encoding`] returns the description that is
//! stored in the file; it lets a reader without Foxglove support decode them.

mod descriptor;
mod schemas;

use prost::Message;

use crate::session::Encoding;

pub trait Described: Message {
    /// Name in the package `foxglove`.
    const NAME: &'static str;
}

/// Returns the encoding of a channel of these messages.
///
/// ```
/// use nima_recording::messages::foxglove::{encoding, Log};
/// assert_eq!(encoding::<Log>().schema, "foxglove.Log");
/// ```
pub fn encoding<M: Described>() -> Encoding {
    Encoding {
        schema: format!("foxglove.{}", M::NAME),
        schema_encoding: "protobuf".into(),
        schema_data: descriptor::file_set(M::NAME).encode_to_vec(),
        message_encoding: "protobuf".into(),
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Message)]
pub struct Timestamp {
    /// s
    #[prost(int64, tag = "1")]
    pub seconds: i64,
    /// ns
    #[prost(int32, tag = "2")]
    pub nanos: i32,
}

impl Timestamp {
    /// Converts ns since the epoch of the session's times.
    pub fn of_ns(ns: u64) -> Self {
        let second = 1_000_000_000;
        Self { seconds: (ns / second).cast_signed(), nanos: (ns % second) as i32 }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Message)]
pub struct Duration {
    /// s
    #[prost(int64, tag = "1")]
    pub seconds: i64,
    /// ns
    #[prost(int32, tag = "2")]
    pub nanos: i32,
}

/// A vector: a position in m unless stated otherwise.
#[derive(Clone, Copy, PartialEq, Message)]
pub struct Vector3 {
    #[prost(double, tag = "1")]
    pub x: f64,
    #[prost(double, tag = "2")]
    pub y: f64,
    #[prost(double, tag = "3")]
    pub z: f64,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub struct Quaternion {
    #[prost(double, tag = "1")]
    pub x: f64,
    #[prost(double, tag = "2")]
    pub y: f64,
    #[prost(double, tag = "3")]
    pub z: f64,
    #[prost(double, tag = "4")]
    pub w: f64,
}

/// A place and a rotation.
#[derive(Clone, Copy, PartialEq, Message)]
pub struct Pose {
    /// m.
    #[prost(message, optional, tag = "1")]
    pub position: Option<Vector3>,
    /// Orientation.
    #[prost(message, optional, tag = "2")]
    pub orientation: Option<Quaternion>,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub struct Color {
    #[prost(double, tag = "1")]
    pub r: f64,
    #[prost(double, tag = "2")]
    pub g: f64,
    #[prost(double, tag = "3")]
    pub b: f64,
    #[prost(double, tag = "4")]
    pub a: f64,
}

/// Pose of a frame in its parent frame.
#[derive(Clone, PartialEq, Message)]
pub struct FrameTransform {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub parent_frame_id: String,
    #[prost(string, tag = "3")]
    pub child_frame_id: String,
    /// m.
    #[prost(message, optional, tag = "4")]
    pub translation: Option<Vector3>,
    /// Parent from child.
    #[prost(message, optional, tag = "5")]
    pub rotation: Option<Quaternion>,
}

/// Poses of several frames.
#[derive(Clone, PartialEq, Message)]
pub struct FrameTransforms {
    #[prost(message, repeated, tag = "1")]
    pub transforms: Vec<FrameTransform>,
}

/// Severity of a log line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, prost::Enumeration)]
#[repr(i32)]
pub enum Level {
    Unknown = 0,
    Debug = 1,
    Info = 2,
    Warning = 3,
    Error = 4,
    Fatal = 5,
}

#[derive(Clone, PartialEq, Message)]
pub struct Log {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    #[prost(enumeration = "Level", tag = "2")]
    pub level: i32,
    #[prost(string, tag = "3")]
    pub message: String,
    /// The part of the program that reports it.
    #[prost(string, tag = "4")]
    pub name: String,
    /// Source file of the program.
    #[prost(string, tag = "5")]
    pub file: String,
    /// Line in that file.
    #[prost(fixed32, tag = "6")]
    pub line: u32,
    /// The message as a value of the program that wrote it. Not in Foxglove's schema; Foxglove's readers ignore it.
    #[prost(bytes = "vec", optional, tag = "1000")]
    pub value: Option<Vec<u8>>,
}

/// An arrow along its x axis.
#[derive(Clone, PartialEq, Message)]
pub struct Arrow {
    /// Position of the tail and direction of the arrow.
    #[prost(message, optional, tag = "1")]
    pub pose: Option<Pose>,
    /// m.
    #[prost(double, tag = "2")]
    pub shaft_length: f64,
    /// m.
    #[prost(double, tag = "3")]
    pub shaft_diameter: f64,
    /// m.
    #[prost(double, tag = "4")]
    pub head_length: f64,
    /// m.
    #[prost(double, tag = "5")]
    pub head_diameter: f64,
    #[prost(message, optional, tag = "6")]
    pub color: Option<Color>,
}

/// Objects that are drawn together; only arrows are written here.
#[derive(Clone, PartialEq, Message)]
pub struct SceneEntity {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub frame_id: String,
    /// An entity with the same name is replaced.
    #[prost(string, tag = "3")]
    pub id: String,
    /// How long it is shown; unlimited if absent.
    #[prost(message, optional, tag = "4")]
    pub lifetime: Option<Duration>,
    /// Whether it moves with its frame.
    #[prost(bool, tag = "5")]
    pub frame_locked: bool,
    #[prost(message, repeated, tag = "7")]
    pub arrows: Vec<Arrow>,
}

/// Changes of the scene.
#[derive(Clone, PartialEq, Message)]
pub struct SceneUpdate {
    /// New entities, and those that replace others.
    #[prost(message, repeated, tag = "2")]
    pub entities: Vec<SceneEntity>,
}

#[derive(Clone, PartialEq, Eq, Message)]
pub struct CompressedImage {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    #[prost(bytes = "vec", tag = "2")]
    pub data: Vec<u8>,
    /// `jpeg`.
    #[prost(string, tag = "3")]
    pub format: String,
    /// Frame of the camera: x to the right of the image, y down, z away from the lens.
    #[prost(string, tag = "4")]
    pub frame_id: String,
}

/// A frame of a video stream; some frames refer to earlier ones.
#[derive(Clone, PartialEq, Eq, Message)]
pub struct CompressedVideo {
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// As in [`CompressedImage`].
    #[prost(string, tag = "2")]
    pub frame_id: String,
    /// The bytes of this frame; for H.264 in annex B format, without frames that refer to later ones.
    #[prost(bytes = "vec", tag = "3")]
    pub data: Vec<u8>,
    /// `h264`.
    #[prost(string, tag = "4")]
    pub format: String,
}

impl Described for CompressedImage {
    const NAME: &'static str = "CompressedImage";
}
impl Described for CompressedVideo {
    const NAME: &'static str = "CompressedVideo";
}
impl Described for FrameTransforms {
    const NAME: &'static str = "FrameTransforms";
}
impl Described for Log {
    const NAME: &'static str = "Log";
}
impl Described for SceneUpdate {
    const NAME: &'static str = "SceneUpdate";
}
