//! The methods that turn measured force into rendered force.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

/// A published method for comparison; see the folder `impedance/baselines`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Baseline {
    /// Model-mediated teleoperation: a Hunt-Crossley contact by recursive least squares.
    ModelMediated,
    /// Wave variables, return channel.
    Waves,
    /// Time-domain passivity with the energy that the tissue returned, return channel.
    Passivity,
    /// Extrapolation by a Kalman filter of force and its rate.
    Kalman,
    /// Extrapolation by an autoregressive model of the force, by recursive least squares.
    Autoregressive,
}

impl Baseline {
    pub const ALL: [Self; 5] = [Self::ModelMediated, Self::Waves, Self::Passivity, Self::Kalman, Self::Autoregressive];

    /// Returns the name used on the command line, in files and on the screen.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ModelMediated => "model_mediated",
            Self::Waves => "waves",
            Self::Passivity => "passivity",
            Self::Kalman => "kalman",
            Self::Autoregressive => "autoregressive",
        }
    }
}

/// Method that computes the force for the hand from the follower's measurements.
///
/// ```
/// use nima_core::impedance::{Baseline, Mode};
///
/// for mode in Mode::ALL.into_iter().chain(Mode::BASELINES) {
///     assert_eq!(mode.name().parse(), Ok(mode));
/// }
/// assert_eq!("kalman".parse(), Ok(Mode::Baseline(Baseline::Kalman)));
/// assert!("sideways".parse::<Mode>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
pub enum Mode {
    /// The paper to the letter: `f = M X`, degree chosen by the error inside the window (NIMA).
    Literal,
    /// The paper's linear predecessor: the same with degree 1 only (IMA).
    Linear,
    /// Direct force reflection: the measured force, as late as the link delivers it.
    Dfr,
    /// Anchored rendering: the last measured force, corrected by the identified impedance over the link's delay.
    Anchored,
    /// Matched rendering: parameters cross the link, and the force is computed from the hand's own motion (NIMA as
    /// intended).
    Matched,
    /// The paper's columns under the rules of matched rendering.
    Nima,
    /// Anchored and matched rendering, weighted by their recent errors.
    Best,
    Baseline(Baseline),
}

/// Number of the program's own modes.
pub const MODES: usize = 7;
/// Number of entries in a table of modes: the program's own, and the one baseline that may be computed with them.
pub const SLOTS: usize = MODES + 1;

impl Mode {
    /// The program's own modes, in the order of [`Mode::index`].
    pub const ALL: [Self; MODES] =
        [Self::Literal, Self::Linear, Self::Dfr, Self::Anchored, Self::Matched, Self::Nima, Self::Best];
    pub const BASELINES: [Self; Baseline::ALL.len()] = {
        let mut modes = [Self::Dfr; Baseline::ALL.len()];
        let mut i = 0;
        while i < modes.len() {
            modes[i] = Self::Baseline(Baseline::ALL[i]);
            i += 1;
        }
        modes
    };

    /// Returns the entry in tables of [`SLOTS`] modes: the position in [`Mode::ALL`], or the last entry for whichever
    /// baseline is computed.
    pub const fn index(self) -> usize {
        match self {
            Self::Literal => 0,
            Self::Linear => 1,
            Self::Dfr => 2,
            Self::Anchored => 3,
            Self::Matched => 4,
            Self::Nima => 5,
            Self::Best => 6,
            Self::Baseline(_) => MODES,
        }
    }

    /// Returns whether the mode is fitted to a window of samples, whose length is then one of its settings. The others
    /// forget with their own memories.
    pub const fn has_window(self) -> bool {
        matches!(self, Self::Literal | Self::Linear | Self::Nima)
    }

    /// Returns whether the mode chooses among polynomial degrees, the highest of which is then one of its settings.
    pub const fn has_degrees(self) -> bool {
        matches!(self, Self::Literal | Self::Nima)
    }

    /// Returns the name used on the command line, in files and on the screen.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Literal => "literal",
            Self::Linear => "linear",
            Self::Dfr => "dfr",
            Self::Anchored => "anchored",
            Self::Matched => "matched",
            Self::Nima => "nima",
            Self::Best => "best",
            Self::Baseline(baseline) => baseline.name(),
        }
    }
}

impl From<Mode> for &'static str {
    fn from(mode: Mode) -> Self {
        mode.name()
    }
}

impl TryFrom<String> for Mode {
    type Error = ParseModeError;

    fn try_from(word: String) -> Result<Self, ParseModeError> {
        word.parse()
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A word that is not the name of a mode.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "unknown mode \"{word}\": use one of {}, or a baseline: {}",
    Mode::ALL.map(Mode::name).join(", "),
    Mode::BASELINES.map(Mode::name).join(", ")
)]
pub struct ParseModeError {
    pub word: String,
}

impl FromStr for Mode {
    type Err = ParseModeError;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        let mut known = Self::ALL.into_iter().chain(Self::BASELINES);
        known.find(|mode| mode.name() == word).ok_or_else(|| ParseModeError { word: word.to_owned() })
    }
}
