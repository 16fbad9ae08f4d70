//! The content of a message.

use super::{
    IgtlFormatError, IgtlUnit, Image, PoseMatrix, QuaternionTool, TrackingTool,
    wire::{IgtlCursor, put_f32s, put_name},
};

/// Kinds of data, with their names in messages and in requests for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ContentKind {
    /// One pose.
    Transform,
    /// A position and an orientation.
    Position,
    /// A bundle of poses.
    Tracking,
    /// A bundle of poses with quaternions.
    Turned,
    /// Values of a sensor.
    Sensor,
    /// Status of a device.
    Status,
    Text,
    Image,
    /// Message types that a program supports.
    Capability,
}

impl ContentKind {
    pub const ALL: [Self; 9] = [
        Self::Transform,
        Self::Position,
        Self::Tracking,
        Self::Turned,
        Self::Sensor,
        Self::Status,
        Self::Text,
        Self::Image,
        Self::Capability,
    ];

    /// Returns its message type.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Transform => "TRANSFORM",
            Self::Position => "POSITION",
            Self::Tracking => "TDATA",
            Self::Turned => "QTDATA",
            Self::Sensor => "SENSOR",
            Self::Status => "STATUS",
            Self::Text => "STRING",
            Self::Image => "IMAGE",
            Self::Capability => "CAPABILITY",
        }
    }

    /// Returns the name in requests, which may also have at most 12 bytes.
    const fn short(self) -> &'static str {
        match self {
            Self::Transform => "TRANS",
            Self::Capability => "CAPABIL",
            other => other.name(),
        }
    }
}

/// Kind of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verb {
    /// Send once.
    Get,
    /// Send repeatedly.
    Start,
    /// Stop sending.
    Stop,
}

impl Verb {
    const ALL: [Self; 3] = [Self::Get, Self::Start, Self::Stop];

    const fn name(self) -> &'static str {
        match self {
            Self::Get => "GET_",
            Self::Start => "STT_",
            Self::Stop => "STP_",
        }
    }
}

const ANSWER: &str = "RTS_";

/// Requested interval and frame of a bundle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContentStream {
    /// Interval, ms; 0 lets the server choose.
    pub interval_ms: u32,
    /// Frame; empty lets the server choose.
    pub frame: String,
}

/// A position and an orientation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position {
    pub place_mm: [f32; 3],
    /// A quaternion with the scalar last; `None` if not given.
    pub turn: Option<[f32; 4]>,
}

/// Values of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorContent {
    /// The sensor's own status code.
    pub status: u8,
    /// Unit of all values.
    pub unit: IgtlUnit,
    /// At most 255.
    pub values: Vec<f64>,
}

/// The status codes used here; other codes are kept as numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StatusCode(pub u16);

impl StatusCode {
    /// All is well. The code numbers are from the specification of the protocol, STATUS message.
    pub const OK: Self = Self(1);
    /// Stopped in an emergency.
    pub const PANIC: Self = Self(3);
    /// Unknown here.
    pub const NOT_FOUND: Self = Self(4);
    /// No room for another client.
    pub const BUSY: Self = Self(6);
    /// No more data arrive.
    pub const TIMEOUT: Self = Self(7);
    /// A request that cannot be read.
    pub const ILLEGAL: Self = Self(12);
    pub const NOT_READY: Self = Self(13);
    /// Missing.
    pub const ABSENT: Self = Self(16);
    /// The hardware has failed.
    pub const HARDWARE: Self = Self(18);
    /// Ending.
    pub const ENDING: Self = Self(19);
}

/// Status of a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContentStatus {
    /// General code.
    pub code: StatusCode,
    /// Specific code.
    pub subcode: i64,
    /// A short name, at most 20 bytes.
    pub name: String,
    /// A sentence.
    pub text: String,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextContent {
    /// Number of the character set in the IANA list: 3 ASCII, 106 UTF-8.
    pub encoding: u16,
    /// At most 65 535.
    pub bytes: Vec<u8>,
}

impl TextContent {
    /// Character sets by their IANA numbers, as the specification of the protocol requires.
    const ASCII: u16 = 3;
    const UTF_8: u16 = 106;

    /// Creates a text; a text that is too long is cut off.
    pub fn of(text: &str) -> Self {
        let mut end = text.len().min(usize::from(u16::MAX));
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let text = &text[..end];
        let encoding = if text.is_ascii() { Self::ASCII } else { Self::UTF_8 };
        Self { encoding, bytes: text.as_bytes().to_vec() }
    }
}

/// The content of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    Transform(PoseMatrix),
    Position(Position),
    Tracking(Vec<TrackingTool>),
    Turned(Vec<QuaternionTool>),
    Sensor(SensorContent),
    Status(ContentStatus),
    Text(TextContent),
    Image(Image),
    /// Message types that a program supports.
    Capability(Vec<String>),
    /// A request, with its interval for kinds that have one.
    Request(Verb, ContentKind, Option<ContentStream>),
    /// Result of a request for data of this kind: 0 if it was accepted.
    Answer(ContentKind, u8),
    /// A message type that is not parsed here.
    Other(String),
}

/// Lengths of the fields of a STATUS message (specification of the protocol).
const NAME: usize = 20;
const TYPE: usize = 12;
const FRAME: usize = 32;

impl Content {
    /// Returns its type, as in the header.
    pub fn kind(&self) -> String {
        let known = match self {
            Self::Transform(_) => ContentKind::Transform,
            Self::Position(_) => ContentKind::Position,
            Self::Tracking(_) => ContentKind::Tracking,
            Self::Turned(_) => ContentKind::Turned,
            Self::Sensor(_) => ContentKind::Sensor,
            Self::Status(_) => ContentKind::Status,
            Self::Text(_) => ContentKind::Text,
            Self::Image(_) => ContentKind::Image,
            Self::Capability(_) => ContentKind::Capability,
            Self::Request(verb, kind, _) => return verb.name().to_owned() + kind.short(),
            Self::Answer(kind, _) => return ANSWER.to_owned() + kind.short(),
            Self::Other(kind) => return kind.clone(),
        };
        known.name().to_owned()
    }

    /// Appends its bytes.
    pub(super) fn put(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::Transform(matrix) => matrix.put(bytes),
            Self::Position(Position { place_mm, turn }) => {
                put_f32s(bytes, *place_mm);
                put_f32s(bytes, turn.iter().flatten().copied());
            }
            Self::Tracking(tools) => tools.iter().for_each(|tool| tool.put(bytes)),
            Self::Turned(tools) => tools.iter().for_each(|tool| tool.put(bytes)),
            Self::Sensor(SensorContent { status, unit, values }) => {
                let values = &values[..values.len().min(usize::from(u8::MAX))];
                bytes.extend([values.len() as u8, *status]);
                bytes.extend(unit.0.to_be_bytes());
                for value in values {
                    bytes.extend(value.to_be_bytes());
                }
            }
            Self::Status(ContentStatus { code, subcode, name, text }) => {
                bytes.extend(code.0.to_be_bytes());
                bytes.extend(subcode.to_be_bytes());
                put_name(bytes, name, NAME);
                bytes.extend(text.bytes().filter(|byte| *byte != 0));
                bytes.push(0);
            }
            Self::Text(TextContent { encoding, bytes: text }) => {
                let text = &text[..text.len().min(usize::from(u16::MAX))];
                bytes.extend(encoding.to_be_bytes());
                bytes.extend((text.len() as u16).to_be_bytes());
                bytes.extend(text);
            }
            Self::Image(image) => image.put(bytes),
            Self::Capability(types) => types.iter().for_each(|name| put_name(bytes, name, TYPE)),
            Self::Request(_, _, None) | Self::Other(_) => {}
            Self::Request(_, _, Some(ContentStream { interval_ms, frame })) => {
                bytes.extend(interval_ms.to_be_bytes());
                put_name(bytes, frame, FRAME);
            }
            Self::Answer(_, status) => bytes.push(*status),
        }
    }

    /// Parses the content of a message of this type.
    pub(super) fn take(name: &str, content: &[u8]) -> Result<Self, IgtlFormatError> {
        if let Some(kind) = ContentKind::ALL.into_iter().find(|kind| kind.name() == name) {
            return Self::data(kind, content);
        }
        let of = |beginning: &str| {
            let rest = name.strip_prefix(beginning)?;
            ContentKind::ALL.into_iter().find(|kind| kind.short() == rest)
        };
        for verb in Verb::ALL {
            if let Some(kind) = of(verb.name()) {
                return Self::request(verb, kind, content);
            }
        }
        match (of(ANSWER), content.first()) {
            (Some(kind), Some(status)) => Ok(Self::Answer(kind, *status)),
            (Some(_), None) => Err(IgtlFormatError::Short),
            (None, _) => Ok(Self::Other(name.to_owned())),
        }
    }

    /// Returns the kind of data that a request of this type starts or stops: a client waits for its answer.
    pub(super) fn answered_kind(name: &str) -> Option<ContentKind> {
        let rest = name.strip_prefix(Verb::Start.name()).or_else(|| name.strip_prefix(Verb::Stop.name()))?;
        ContentKind::ALL.into_iter().find(|kind| kind.short() == rest)
    }

    fn request(verb: Verb, kind: ContentKind, content: &[u8]) -> Result<Self, IgtlFormatError> {
        let has_rate = verb == Verb::Start && matches!(kind, ContentKind::Tracking | ContentKind::Turned);
        if !has_rate || content.is_empty() {
            return Ok(Self::Request(verb, kind, None));
        }
        let mut from = IgtlCursor(content);
        let stream = ContentStream { interval_ms: from.u32()?, frame: from.name(FRAME)? };
        Ok(Self::Request(verb, kind, Some(stream)))
    }

    fn data(kind: ContentKind, content: &[u8]) -> Result<Self, IgtlFormatError> {
        let bytes = content.len();
        let fits = |fits: bool| {
            if fits { Ok(()) } else { Err(IgtlFormatError::Length { kind: kind.name().to_owned(), bytes }) }
        };
        let mut from = IgtlCursor(content);
        Ok(match kind {
            ContentKind::Transform => {
                fits(bytes == PoseMatrix::BYTES)?;
                Self::Transform(PoseMatrix::take(&mut from)?)
            }
            ContentKind::Position => {
                fits([12, 24, 28].contains(&bytes))?;
                let place_mm = from.f32s()?;
                let turn = match bytes {
                    28 => Some(from.f32s()?),
                    // The short form omits the scalar, which follows from the length 1.
                    24 => Some(from.f32s().map(with_scalar)?),
                    _ => None,
                };
                Self::Position(Position { place_mm, turn })
            }
            ContentKind::Tracking => {
                fits(bytes.is_multiple_of(TrackingTool::BYTES))?;
                let count = bytes / TrackingTool::BYTES;
                Self::Tracking((0..count).map(|_| TrackingTool::take(&mut from)).collect::<Result<_, _>>()?)
            }
            ContentKind::Turned => {
                fits(bytes.is_multiple_of(QuaternionTool::BYTES))?;
                let count = bytes / QuaternionTool::BYTES;
                Self::Turned((0..count).map(|_| QuaternionTool::take(&mut from)).collect::<Result<_, _>>()?)
            }
            ContentKind::Sensor => {
                let [count, status] = from.array()?;
                fits(bytes == 10 + 8 * usize::from(count))?;
                let unit = IgtlUnit(from.u64()?);
                let values = (0..count).map(|_| from.f64()).collect::<Result<_, _>>()?;
                Self::Sensor(SensorContent { status, unit, values })
            }
            ContentKind::Status => {
                let code = StatusCode(from.u16()?);
                let subcode = from.u64()?.cast_signed();
                let name = from.name(NAME)?;
                let rest = from.0.len();
                Self::Status(ContentStatus { code, subcode, name, text: from.name(rest)? })
            }
            ContentKind::Text => {
                let encoding = from.u16()?;
                let length = from.u16()?;
                fits(bytes == 4 + usize::from(length))?;
                Self::Text(TextContent { encoding, bytes: from.0.to_vec() })
            }
            ContentKind::Image => Self::Image(Image::take(content)?),
            ContentKind::Capability => {
                fits(bytes.is_multiple_of(TYPE))?;
                Self::Capability((0..bytes / TYPE).map(|_| from.name(TYPE)).collect::<Result<_, _>>()?)
            }
        })
    }
}

fn with_scalar([x, y, z]: [f32; 3]) -> [f32; 4] {
    [x, y, z, (1.0 - x * x - y * y - z * z).max(0.0).sqrt()]
}
