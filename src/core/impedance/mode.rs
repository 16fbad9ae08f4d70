//! The ways of turning measured force into rendered force.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

/// How the force for the hand is made from the follower's measurements.
///
/// ```
/// use nima_core::impedance::Mode;
///
/// for mode in Mode::ALL {
///     assert_eq!(mode.name().parse(), Ok(mode));
/// }
/// assert!("sideways".parse::<Mode>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// The paper to the letter: `f = M X`, degree chosen by the error inside the window (NIMA).
    Literal,
    /// The paper's linear predecessor: the same with degree 1 only (IMA).
    Linear,
    /// Direct force reflection: the measured force, as late as the link delivers it.
    Dfr,
    /// Anchored rendering: the last measured force, corrected by the identified impedance over the link's delay.
    Anchored,
    /// Matched rendering: parameters cross the link, the force is made of the hand's own motion (NIMA as it was meant).
    Matched,
    /// The paper's columns under the rules of matched rendering.
    Nima,
    /// Anchored and matched rendering, weighted by their errors of late.
    Best,
}

/// Number of modes.
pub const MODES: usize = 7;

impl Mode {
    /// Every mode, in the order of [`Mode::index`].
    pub const ALL: [Self; MODES] =
        [Self::Literal, Self::Linear, Self::Dfr, Self::Anchored, Self::Matched, Self::Nima, Self::Best];

    /// Position in [`Mode::ALL`], for tables with one entry per mode.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The name used on the command line, in files and on the screen.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Literal => "literal",
            Self::Linear => "linear",
            Self::Dfr => "dfr",
            Self::Anchored => "anchored",
            Self::Matched => "matched",
            Self::Nima => "nima",
            Self::Best => "best",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A word that names no mode.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no mode is called \"{word}\"; use one of {}", Mode::ALL.map(Mode::name).join(", "))]
pub struct ParseModeError {
    /// The word as given.
    pub word: String,
}

impl FromStr for Mode {
    type Err = ParseModeError;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|mode| mode.name() == word).ok_or_else(|| ParseModeError { word: word.to_owned() })
    }
}
