//! List of the rendering modes, which compute a rendered force from the measured force.

use std::{fmt, str::FromStr, sync::OnceLock};

use serde::{Deserialize, Serialize};

use super::{
    anchored::{AnchoredMethod, AnchoredModel},
    baseline::{Baseline, BaselineModel},
    best::Best,
    dfr::Dfr,
    matched::{MatchedMethod, MatchedModel, Nima},
    method::{Entry, Place},
    paper::{Linear, Literal, LiteralModel},
};

/// Declares the modes from one list, each with the [`RenderingMethod`](super::RenderingMethod) that implements it.
macro_rules! modes {
    ($(#[$attribute:meta])* enum Mode { $($(#[$doc:meta])* $mode:ident: $method:ty,)* }) => {
        $(#[$attribute])*
        pub enum Mode {
            $($(#[$doc])* $mode,)*
            /// A method of others, to compare with.
            Baseline(Baseline),
        }

        /// Number of the program's own modes.
        pub const MODES: usize = [$(stringify!($mode)),*].len();

        impl Mode {
            /// The program's own modes, in the order of [`Mode::index`].
            pub const ALL: [Self; MODES] = [$(Self::$mode),*];

            const ENTRIES: &'static [Entry; MODES] = &[$(Entry::of::<$method>()),*];

            /// Returns its index in tables of [`SLOTS`] modes: the position in [`Mode::ALL`], or the last index for the
            /// baseline that is computed.
            pub const fn index(self) -> usize {
                enum Place { $($mode,)* Baseline }
                let place = match self {
                    // An enum without a payload can be cast to its position; `Mode` has one in its last variant.
                    $(Self::$mode => Place::$mode,)*
                    Self::Baseline(_) => Place::Baseline,
                };
                place as usize
            }
        }
    };
}

modes! {
    /// How the force for the hand is computed from the follower's measurements.
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
    enum Mode {
        /// The paper to the letter: `f = M X`, degree chosen by the error inside the window (NIMA).
        Literal: Literal,
        /// The paper's linear predecessor: the same with degree 1 only (IMA).
        Linear: Linear,
        /// Direct force reflection: the measured force, delayed by the link.
        Dfr: Dfr,
        /// Anchored rendering: the last measured force, corrected by the identified impedance over the link's delay.
        Anchored: AnchoredMethod,
        /// Matched rendering: parameters cross the link, and the force is computed from the hand's own motion (the
        /// intended form of NIMA).
        Matched: MatchedMethod,
        /// The paper's columns under the rules of matched rendering.
        Nima: Nima,
        /// Anchored and matched rendering, weighted by their errors of late.
        Best: Best,
    }
}

/// The parameters that the modes send.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Models {
    /// The paper's choice.
    pub literal: LiteralModel,
    /// The paper's linear model.
    pub linear: LiteralModel,
    /// Anchored rendering's choice.
    pub anchored: AnchoredModel,
    /// Matched rendering's parameters.
    pub matched: MatchedModel,
    /// The same with the paper's columns.
    pub nima: MatchedModel,
    /// Data of the baseline, if one is computed.
    pub baseline: BaselineModel,
}

impl Models {
    /// Nothing is known.
    pub const NONE: Self = Self {
        literal: LiteralModel::NONE,
        linear: LiteralModel::NONE,
        anchored: AnchoredModel::NONE,
        matched: MatchedModel::NONE,
        nima: MatchedModel::NONE,
        baseline: BaselineModel::Nothing,
    };
}

/// Number of entries in a table of modes: the program's own modes, and the single baseline that may be computed in
/// addition.
pub const SLOTS: usize = MODES + 1;

/// Constructors of the baselines, if the program includes them.
static OTHERS: OnceLock<fn(Baseline) -> Entry> = OnceLock::new();

/// Adds the baselines to this process. Without them, selecting one is a
/// [`SettingsError::Baseline`](super::SettingsError).
pub fn add_baselines(entry: fn(Baseline) -> Entry) {
    // A second call has no effect.
    // The first list stays: replacing it would change the meaning of a mode in a running process.
    OTHERS.set(entry).ok();
}

impl Mode {
    /// Every baseline as a mode.
    pub const BASELINES: [Self; Baseline::ALL.len()] = {
        let mut modes = [Self::Dfr; Baseline::ALL.len()];
        let mut i = 0;
        while i < modes.len() {
            // A loop instead of `map`: a constant cannot call closures.
            modes[i] = Self::Baseline(Baseline::ALL[i]);
            i += 1;
        }
        modes
    };

    /// Returns the entry in the list if this is one of the program's own modes.
    const fn own(self) -> Option<&'static Entry> {
        match self {
            Self::Baseline(_) => None,
            own => Some(&Self::ENTRIES[own.index()]),
        }
    }

    /// Returns the method that implements the mode; `None` for a baseline that this program does not include.
    pub(super) fn entry(self) -> Option<Entry> {
        match self {
            Self::Baseline(baseline) => OTHERS.get().map(|entry| entry(baseline)),
            own => own.own().copied(),
        }
    }

    /// Returns the modes whose forces this mode uses; they are computed with it.
    pub(super) const fn parts(self) -> &'static [Self] {
        match self.own() {
            Some(entry) => entry.parts,
            None => &[],
        }
    }

    /// Returns whether the mode is fitted to a window of samples; the length of the window is then one of its settings.
    /// The other modes forget with their own memories.
    pub const fn has_window(self) -> bool {
        matches!(self.own(), Some(Entry { has_window: true, .. }))
    }

    /// Returns whether the mode chooses among polynomial degrees; the highest degree is then one of its settings.
    pub const fn has_degrees(self) -> bool {
        matches!(self.own(), Some(Entry { has_degrees: true, .. }))
    }

    /// Returns the name used on the command line, in files and on the screen.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Baseline(baseline) => baseline.name(),
            own => Self::ENTRIES[own.index()].name,
        }
    }

    /// Returns the position of its parameters in a packet; `None` if it sends none.
    pub(super) const fn parameters(self) -> Option<Place> {
        match self.own() {
            Some(entry) => entry.parameters,
            None => None,
        }
    }

    /// Returns whether its force is damped if the leader's motion is measured at the handle.
    pub(super) const fn is_damped(self) -> bool {
        matches!(self.own(), Some(Entry { is_damped: true, .. }))
    }

    /// Returns a short description for tables.
    pub const fn about(self) -> &'static str {
        match self.own() {
            Some(entry) => entry.about,
            None => "a method of others",
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
