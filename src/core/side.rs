//! The two sides: hands, handles, arms, instruments.

use serde::{Deserialize, Serialize};

/// Number of sides.
pub const SIDES: usize = 2;

/// A side, from the surgeon's point of view. A rig with one arm pair has the right one.
///
/// Every array with a value for each side has the order of [`Side::ALL`]. File formats write a side as its word, or number it in their
/// codec.
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

    /// Both sides as a table shows them. Also the order in which the physics takes the instruments: another order would change the last
    /// bits of its sums.
    pub const LEFT_TO_RIGHT: [Self; SIDES] = [Self::Left, Self::Right];

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

    /// An array with this value on this side and nothing on the other.
    pub fn alone<T>(self, value: T) -> [Option<T>; SIDES] {
        let mut values = [None, None];
        values[self.index()] = Some(value);
        values
    }

    /// Its name in files and in English text.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_and_order_are_those_of_recorded_sessions() {
        assert_eq!(Side::ALL.map(Side::index), [0, 1]);
        assert_eq!(Side::ALL, [Side::Right, Side::Left]);
        assert_eq!(Side::Left.alone(7), [None, Some(7)]);
        for side in Side::ALL {
            assert_eq!(serde_json::to_value(side).unwrap(), side.word());
        }
    }
}
