//! The letter that represents a condition.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A, B, ...: shown instead of a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Label(char);

impl Label {
    /// Maximum number of labels, and thus of conditions, in a study.
    pub const MAX: usize = 10;

    /// Returns the first `count` labels, at most [`Label::MAX`].
    pub fn first(count: usize) -> Vec<Self> {
        ('A'..='Z').take(count.min(Self::MAX)).map(Self).collect()
    }

    pub const fn letter(self) -> char {
        self.0
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}
