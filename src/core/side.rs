//! The two sides: hands, handles, arms, instruments.

use serde::{Deserialize, Serialize};

pub const SIDES: usize = 2;

/// A side, from the surgeon's point of view. A rig with one arm pair has the right one.
///
/// Every array with a value for each side has the order of [`Side::ALL`]. File formats write a side as its word, or number it in their
/// codec.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    #[default]
    Right,
    Left,
}

impl Side {
    /// Both sides, in the order of all arrays of sides.
    pub const ALL: [Self; SIDES] = [Self::Right, Self::Left];

    /// Both sides in the order of tables. The physics processes the instruments in this order too, because another
    /// order would change the last bits of its sums.
    pub const LEFT_TO_RIGHT: [Self; SIDES] = [Self::Left, Self::Right];

    pub const fn index(self) -> usize {
        self as usize
    }

    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Right => Self::Left,
            Self::Left => Self::Right,
        }
    }

    /// Returns an array with this value on this side and `None` on the other.
    pub fn alone<T>(self, value: T) -> [Option<T>; SIDES] {
        let mut values = [None, None];
        values[self.index()] = Some(value);
        values
    }

    /// Returns the name used in files and in English text.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Left => "left",
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{
        fs,
        path::{Path, PathBuf},
    };

    use super::*;

    fn sources(folder: &Path) -> Vec<PathBuf> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
        let below = folders.iter().filter(|path| !path.ends_with("target")).flat_map(|path| sources(path));
        let own = files.into_iter().filter(|path| path.extension().is_some_and(|ending| ending == "rs"));
        below.chain(own).collect()
    }

    #[test]
    fn there_is_no_other_type_of_this_name() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let all = ["src", "ui", "tests"].into_iter().flat_map(|folder| sources(&root.join(folder)));
        // The ROS 2 bridge is a separate workspace.
        let others = all.filter(|path| !path.ends_with("core/side.rs") && !path.ends_with("ros2/src/topics.rs"));
        let doubled: Vec<_> = others.filter(|path| fs::read_to_string(path).unwrap().contains("enum Side ")).collect();
        assert_eq!(doubled, [""; 0].map(PathBuf::from), "use nima_core::Side");
    }

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
