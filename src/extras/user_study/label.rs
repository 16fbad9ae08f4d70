//! The letter that stands for a condition.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A, B, ...: what everybody sees in place of a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Label(char);

impl Label {
    /// Most labels, and so conditions, in a study.
    pub const MOST: usize = 10;

    /// The first `count` labels, at most [`Label::MOST`].
    pub fn first(count: usize) -> Vec<Self> {
        ('A'..='Z').take(count.min(Self::MOST)).map(Self).collect()
    }

    /// The letter.
    pub const fn letter(self) -> char {
        self.0
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}
