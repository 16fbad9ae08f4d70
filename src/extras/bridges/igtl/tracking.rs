//! Poses, and batches of them.

use super::{
    IgtlFormatError,
    wire::{IgtlCursor, put_f32s, put_name},
};

/// A pose in the form of `OpenIGTLink`: three columns of a rotation, then the position (mm).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseMatrix(pub [[f32; 3]; 4]);

impl PoseMatrix {
    /// Size in bytes.
    pub(super) const BYTES: usize = 48;

    /// Creates a pose without rotation at this position (mm).
    pub const fn at(place_mm: [f32; 3]) -> Self {
        Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], place_mm])
    }

    pub(super) fn put(&self, bytes: &mut Vec<u8>) {
        put_f32s(bytes, self.0.into_iter().flatten());
    }

    pub(super) fn take(from: &mut IgtlCursor<'_>) -> Result<Self, IgtlFormatError> {
        Ok(Self([from.f32s()?, from.f32s()?, from.f32s()?, from.f32s()?]))
    }
}

/// The known part of a tool's pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolKind {
    /// The tracker itself.
    Tracker,
    /// The whole pose.
    SixD,
    /// The position.
    ThreeD,
    /// The position and the direction of the axis.
    FiveD,
}

impl ToolKind {
    const ALL: [Self; 4] = [Self::Tracker, Self::SixD, Self::ThreeD, Self::FiveD];

    const fn number(self) -> u8 {
        self as u8 + 1
    }

    fn of(number: u8, kind: &str) -> Result<Self, IgtlFormatError> {
        let found = Self::ALL.into_iter().find(|known| known.number() == number);
        found.ok_or_else(|| IgtlFormatError::Value { kind: kind.to_owned(), what: "the type of a tool" })
    }
}

/// A tool in a bundle `TDATA`.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackingTool {
    /// At most 20 bytes.
    pub name: String,
    /// The known part of its pose.
    pub kind: ToolKind,
    pub pose: PoseMatrix,
}

/// A tool in a bundle `QTDATA`.
#[derive(Clone, Debug, PartialEq)]
pub struct QuaternionTool {
    /// At most 20 bytes.
    pub name: String,
    /// The known part of its pose.
    pub kind: ToolKind,
    pub place_mm: [f32; 3],
    /// Orientation: a quaternion with the scalar last.
    pub turn: [f32; 4],
}

const NAME: usize = 20;

impl TrackingTool {
    /// Size in bytes.
    pub(super) const BYTES: usize = NAME + 2 + PoseMatrix::BYTES;

    pub(super) fn put(&self, bytes: &mut Vec<u8>) {
        put_name(bytes, &self.name, NAME);
        bytes.extend([self.kind.number(), 0]);
        self.pose.put(bytes);
    }

    pub(super) fn take(from: &mut IgtlCursor<'_>) -> Result<Self, IgtlFormatError> {
        let name = from.name(NAME)?;
        let [kind, _] = from.array()?;
        Ok(Self { name, kind: ToolKind::of(kind, "TDATA")?, pose: PoseMatrix::take(from)? })
    }
}

impl QuaternionTool {
    /// Size in bytes.
    pub(super) const BYTES: usize = NAME + 2 + 28;

    pub(super) fn put(&self, bytes: &mut Vec<u8>) {
        put_name(bytes, &self.name, NAME);
        bytes.extend([self.kind.number(), 0]);
        put_f32s(bytes, self.place_mm);
        put_f32s(bytes, self.turn);
    }

    pub(super) fn take(from: &mut IgtlCursor<'_>) -> Result<Self, IgtlFormatError> {
        let name = from.name(NAME)?;
        let [kind, _] = from.array()?;
        Ok(Self { name, kind: ToolKind::of(kind, "QTDATA")?, place_mm: from.f32s()?, turn: from.f32s()? })
    }
}
