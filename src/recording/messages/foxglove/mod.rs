//! Messages that Foxglove knows by name, as Protocol Buffers: frames, text, arrows, pictures.
//!
//! The structs are written by hand from the published field numbers; [`encoding`] makes the description that goes with them into
//! the file, of which a reader without knowledge of Foxglove decodes them.

mod descriptor;
mod schemas;

use prost::Message;

use crate::session::Encoding;

/// A kind of message with a description.
pub trait Described: Message {
    /// Its name in the package `foxglove`.
    const NAME: &'static str;
}

/// How a reader is to understand a channel of these messages.
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

/// A moment.
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
    /// ns since the epoch of the session's times.
    pub fn of_ns(ns: u64) -> Self {
        let second = 1_000_000_000;
        Self { seconds: (ns / second).cast_signed(), nanos: (ns % second) as i32 }
    }
}

/// A length of time.
#[derive(Clone, Copy, PartialEq, Eq, Message)]
pub struct Duration {
    /// s
    #[prost(int64, tag = "1")]
    pub seconds: i64,
    /// ns
    #[prost(int32, tag = "2")]
    pub nanos: i32,
}

/// A vector: a place in m, where nothing else is said.
#[derive(Clone, Copy, PartialEq, Message)]
pub struct Vector3 {
    #[prost(double, tag = "1")]
    pub x: f64,
    #[prost(double, tag = "2")]
    pub y: f64,
    #[prost(double, tag = "3")]
    pub z: f64,
}

/// A rotation, of length 1.
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
    /// m
    #[prost(message, optional, tag = "1")]
    pub position: Option<Vector3>,
    /// Where it points.
    #[prost(message, optional, tag = "2")]
    pub orientation: Option<Quaternion>,
}

/// A colour, each part from 0 to 1.
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

/// Where a frame stands in another one.
#[derive(Clone, PartialEq, Message)]
pub struct FrameTransform {
    /// Since when.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// In which frame.
    #[prost(string, tag = "2")]
    pub parent_frame_id: String,
    /// Which frame.
    #[prost(string, tag = "3")]
    pub child_frame_id: String,
    /// m
    #[prost(message, optional, tag = "4")]
    pub translation: Option<Vector3>,
    /// Parent from child.
    #[prost(message, optional, tag = "5")]
    pub rotation: Option<Quaternion>,
}

/// Where several frames stand.
#[derive(Clone, PartialEq, Message)]
pub struct FrameTransforms {
    /// Each of them.
    #[prost(message, repeated, tag = "1")]
    pub transforms: Vec<FrameTransform>,
}

/// How much a line of a log matters.
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

/// A line of a log.
#[derive(Clone, PartialEq, Message)]
pub struct Log {
    /// When.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// How much it matters.
    #[prost(enumeration = "Level", tag = "2")]
    pub level: i32,
    /// What.
    #[prost(string, tag = "3")]
    pub message: String,
    /// Of which part.
    #[prost(string, tag = "4")]
    pub name: String,
    /// Of which file of the program.
    #[prost(string, tag = "5")]
    pub file: String,
    /// And line.
    #[prost(fixed32, tag = "6")]
    pub line: u32,
    /// The same as a value of the program that wrote it. Not in the schema of Foxglove, whose readers pass over it.
    #[prost(bytes = "vec", optional, tag = "1000")]
    pub value: Option<Vec<u8>>,
}

/// An arrow along its x axis.
#[derive(Clone, PartialEq, Message)]
pub struct Arrow {
    /// Where its tail is and where it points.
    #[prost(message, optional, tag = "1")]
    pub pose: Option<Pose>,
    /// m
    #[prost(double, tag = "2")]
    pub shaft_length: f64,
    /// m
    #[prost(double, tag = "3")]
    pub shaft_diameter: f64,
    /// m
    #[prost(double, tag = "4")]
    pub head_length: f64,
    /// m
    #[prost(double, tag = "5")]
    pub head_diameter: f64,
    /// Its colour.
    #[prost(message, optional, tag = "6")]
    pub color: Option<Color>,
}

/// Things that are drawn together; only arrows are written here.
#[derive(Clone, PartialEq, Message)]
pub struct SceneEntity {
    /// Since when.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// In which frame.
    #[prost(string, tag = "2")]
    pub frame_id: String,
    /// Which thing: one of the same name is replaced.
    #[prost(string, tag = "3")]
    pub id: String,
    /// For how long; for ever where there is none.
    #[prost(message, optional, tag = "4")]
    pub lifetime: Option<Duration>,
    /// Whether it moves with its frame.
    #[prost(bool, tag = "5")]
    pub frame_locked: bool,
    /// The arrows.
    #[prost(message, repeated, tag = "7")]
    pub arrows: Vec<Arrow>,
}

/// What changes in the scene.
#[derive(Clone, PartialEq, Message)]
pub struct SceneUpdate {
    /// New things, and those that replace others.
    #[prost(message, repeated, tag = "2")]
    pub entities: Vec<SceneEntity>,
}

/// A picture as a camera compressed it.
#[derive(Clone, PartialEq, Eq, Message)]
pub struct CompressedImage {
    /// When.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// Its bytes.
    #[prost(bytes = "vec", tag = "2")]
    pub data: Vec<u8>,
    /// Their format: `jpeg`.
    #[prost(string, tag = "3")]
    pub format: String,
    /// In which frame: x to the right of the picture, y down, z away from the lens.
    #[prost(string, tag = "4")]
    pub frame_id: String,
}

/// A picture of a stream: some refer to those before them.
#[derive(Clone, PartialEq, Eq, Message)]
pub struct CompressedVideo {
    /// When.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// In which frame, as in [`CompressedImage`].
    #[prost(string, tag = "2")]
    pub frame_id: String,
    /// The bytes of this one picture; of H.264 as annex B has them, without pictures that refer to later ones.
    #[prost(bytes = "vec", tag = "3")]
    pub data: Vec<u8>,
    /// Their format: `h264`.
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
