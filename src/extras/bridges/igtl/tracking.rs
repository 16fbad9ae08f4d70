//! Poses, and bundles of them.

use super::{
    Wrong,
    wire::{Cursor, put_f32s, put_name},
};

/// A pose in the form of `OpenIGTLink`: three columns of a rotation, then the position (mm).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix(pub [[f32; 3]; 4]);

impl Matrix {
    /// Size in bytes.
    pub(super) const BYTES: usize = 48;

    /// A pose without rotation at this position (mm).
    pub const fn at(place_mm: [f32; 3]) -> Self {
        Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], place_mm])
    }

    pub(super) fn put(&self, bytes: &mut Vec<u8>) {
        put_f32s(bytes, self.0.into_iter().flatten());
    }

    pub(super) fn take(from: &mut Cursor<'_>) -> Result<Self, Wrong> {
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

    fn of(number: u8, kind: &str) -> Result<Self, Wrong> {
        let found = Self::ALL.into_iter().find(|known| known.number() == number);
        found.ok_or_else(|| Wrong::Value { kind: kind.to_owned(), what: "the kind of a tool" })
    }
}

/// A tool in a bundle `TDATA`.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    /// At most 20 bytes.
    pub name: String,
    /// The known part of its pose.
    pub kind: ToolKind,
    pub pose: Matrix,
}

/// A tool in a bundle `QTDATA`.
#[derive(Clone, Debug, PartialEq)]
pub struct Turned {
    /// At most 20 bytes.
    pub name: String,
    /// The known part of its pose.
    pub kind: ToolKind,
    pub place_mm: [f32; 3],
    /// Orientation: a quaternion, its scalar last.
    pub turn: [f32; 4],
}

const NAME: usize = 20;

impl Tool {
    /// Size in bytes.
    pub(super) const BYTES: usize = NAME + 2 + Matrix::BYTES;

    pub(super) fn put(&self, bytes: &mut Vec<u8>) {
        put_name(bytes, &self.name, NAME);
        bytes.extend([self.kind.number(), 0]);
        self.pose.put(bytes);
    }

    pub(super) fn take(from: &mut Cursor<'_>) -> Result<Self, Wrong> {
        let name = from.name(NAME)?;
        let [kind, _] = from.array()?;
        Ok(Self { name, kind: ToolKind::of(kind, "TDATA")?, pose: Matrix::take(from)? })
    }
}

impl Turned {
    /// Size in bytes.
    pub(super) const BYTES: usize = NAME + 2 + 28;

    pub(super) fn put(&self, bytes: &mut Vec<u8>) {
        put_name(bytes, &self.name, NAME);
        bytes.extend([self.kind.number(), 0]);
        put_f32s(bytes, self.place_mm);
        put_f32s(bytes, self.turn);
    }

    pub(super) fn take(from: &mut Cursor<'_>) -> Result<Self, Wrong> {
        let name = from.name(NAME)?;
        let [kind, _] = from.array()?;
        Ok(Self { name, kind: ToolKind::of(kind, "QTDATA")?, place_mm: from.f32s()?, turn: from.f32s()? })
    }
}
