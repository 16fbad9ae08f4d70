//! The two arm pairs.

use serde::{Deserialize, Serialize};

/// Arm pairs at most.
pub const SIDES: usize = 2;

/// Which arm pair, from the surgeon's point of view. A rig with one pair has the right one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// For the right hand.
    #[default]
    Right,
    /// For the left hand.
    Left,
}

impl Side {
    /// Both sides, in the order of every array of sides.
    pub const ALL: [Self; SIDES] = [Self::Right, Self::Left];

    /// Index in an array of sides.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }

    /// Its name on the screen.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }
}
