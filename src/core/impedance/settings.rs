//! Settings of the identifier and the renderer.

use serde::{Deserialize, Serialize};

use super::{AXES, Baseline, MAX_DEGREE, MODES, Mode, features::Scales, recipe::Recipe};
use crate::{
    limits::{DELAY_S, IDENTIFIED_RATE_HZ, REST_N, RIDGE, WINDOW_SAMPLES},
    signal::DifferentiatorKind,
};

/// Maximum programmed delay of the link (s), for which the ring buffers have room.
/// The same limit as a command's, so that no setting can ask for more than the buffers hold.
pub const MAX_DELAY_S: f64 = DELAY_S.max;

/// The modes to compute; the others cost nothing.
///
/// ```
/// use nima_core::impedance::{Mode, ModeSet};
///
/// let set = ModeSet::only(Mode::Dfr).with(Mode::Anchored);
/// assert!(set.contains(Mode::Anchored) && !set.contains(Mode::Literal));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModeSet {
    own: [bool; MODES],
    baseline: Option<Baseline>,
}

impl ModeSet {
    /// Every built-in mode; a baseline is computed only if requested.
    pub const ALL: Self = Self { own: [true; MODES], baseline: None };

    /// Returns one mode, with delayed reflection for comparison.
    pub const fn only(mode: Mode) -> Self {
        Self { own: [false; MODES], baseline: None }.with(Mode::Dfr).with(mode)
    }

    /// Returns this set with one more mode and the modes on which it is based; a baseline replaces the previous one.
    #[must_use]
    pub const fn with(mut self, mode: Mode) -> Self {
        if let Mode::Baseline(baseline) = mode {
            self.baseline = Some(baseline);
            return self;
        }
        self.own[mode.index()] = true;
        let parts = mode.parts();
        let mut i = 0;
        while i < parts.len() {
            self.own[parts[i].index()] = true;
            i += 1;
        }
        self
    }

    pub fn contains(self, mode: Mode) -> bool {
        match mode {
            Mode::Baseline(baseline) => self.baseline == Some(baseline),
            _ => self.own[mode.index()],
        }
    }

    pub const fn baseline(self) -> Option<Baseline> {
        self.baseline
    }

    pub fn modes(self) -> impl Iterator<Item = Mode> {
        let own = Mode::ALL.into_iter().filter(move |mode| self.contains(*mode));
        own.chain(self.baseline.map(Mode::Baseline))
    }

    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            own: std::array::from_fn(|mode| self.own[mode] && other.own[mode]),
            baseline: self.baseline.filter(|baseline| other.baseline == Some(*baseline)),
        }
    }
}

impl Default for ModeSet {
    fn default() -> Self {
        Self::ALL
    }
}

/// The motion from which the leader computes the force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OwnMotion {
    /// The follower's current position, estimated from its commands and its lag: accurate.
    #[default]
    Follower,
    /// The handle's position: the force belongs to the position that the follower will reach. Matched rendering then
    /// gives the hand no power on average: the energy from its changing parameters is damped.
    Handle,
}

/// Settings of an [`Identifier`](super::Identifier) and of the [`Renderer`](super::Renderer) at the other end of the
/// link; both ends must use the same settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImpedanceSettings {
    /// Samples per second, 5 to 10 000; a loop requires 20.
    pub rate_hz: f64,
    /// Length of the sliding window (s); 10 to 10 000 samples. The paper's 0.3.
    pub window_s: f64,
    /// Programmed delay of the link (s), 0 to [`MAX_DELAY_S`].
    pub delay_s: f64,
    /// Highest degree identified, 1 to 5.
    pub max_degree: usize,
    /// Axes in use, 1 to 3 (x; x, y; x, y, z).
    pub axes: usize,
    pub scales: Scales,
    /// The modes to compute; [`Identifier::compute`](super::Identifier::compute) can switch some of them off for a
    /// while.
    pub modes: ModeSet,
    /// The identification rests while the measured force and the rendered forces are within this (N), because there is
    /// no contact and nothing to learn. 0: it never rests.
    pub rest_n: f64,
    /// Whether the force on each axis may depend on the motion of the other axes (the full `M`) in matched rendering,
    /// and therefore also in `best`.
    pub cross_talk: bool,
    pub own_motion: OwnMotion,
    pub differentiator: DifferentiatorKind,
    /// Ridge of the anchored fit, per row of the window and in scaled columns: a coefficient costs as much as one more
    /// row with this mean square and no force. 0 switches it off.
    pub ridge: f64,
    /// Interpretation of the paper in the modes literal and linear.
    pub literal: Recipe,
    /// Computes the forces as sessions with a journal of version 5 did: `best` without holding, no restart of the fit on
    /// other tissue, single wrong positions used, the motion held during a gap, and a new lag of the follower used at once. For
    /// their replay only.
    pub earlier_forces: bool,
}

impl Default for ImpedanceSettings {
    fn default() -> Self {
        Self {
            rate_hz: 1000.0,
            window_s: 0.3,
            delay_s: 0.05,
            max_degree: MAX_DEGREE,
            axes: AXES,
            scales: Scales::default(),
            modes: ModeSet::ALL,
            rest_n: 0.0,
            cross_talk: false,
            own_motion: OwnMotion::default(),
            differentiator: DifferentiatorKind::default(),
            // Design choice: far above the rounding of a window, far below the motion of a working hand.
            ridge: 1e-6,
            literal: Recipe::default(),
            earlier_forces: false,
        }
    }
}

impl ImpedanceSettings {
    /// Checks every range.
    ///
    /// # Errors
    /// The first setting that is out of its range.
    ///
    /// ```
    /// use nima_core::impedance::{ImpedanceSettings, SettingsError};
    ///
    /// assert!(ImpedanceSettings::default().validate().is_ok());
    /// let endless = ImpedanceSettings { delay_s: f64::INFINITY, ..ImpedanceSettings::default() };
    /// assert!(matches!(endless.validate(), Err(SettingsError::Delay { .. })));
    /// ```
    pub fn validate(&self) -> Result<(), SettingsError> {
        use SettingsError as E;
        if !IDENTIFIED_RATE_HZ.contains(self.rate_hz) {
            return Err(E::Rate { rate_hz: self.rate_hz });
        }
        let samples = (self.window_s * self.rate_hz).round();
        // In samples: both the memory and the cost of a tick depend on their number.
        let has_window = self.modes.modes().any(Mode::has_window);
        if !(self.window_s.is_finite() && samples <= WINDOW_SAMPLES.max) || has_window && samples < WINDOW_SAMPLES.min {
            return Err(E::Window { window_s: self.window_s, samples });
        }
        if !DELAY_S.contains(self.delay_s) {
            return Err(E::Delay { delay_s: self.delay_s });
        }
        if !(1..=MAX_DEGREE).contains(&self.max_degree) {
            return Err(E::Degree { degree: self.max_degree });
        }
        if !(1..=AXES).contains(&self.axes) {
            return Err(E::Axes { axes: self.axes });
        }
        let Scales { position_m, velocity_m_s, acceleration_m_s2, force_n } = self.scales;
        for (name, value) in [
            ("position_m", position_m),
            ("velocity_m_s", velocity_m_s),
            ("acceleration_m_s2", acceleration_m_s2),
            ("force_n", force_n),
        ] {
            if !(1e-9..=1e9).contains(&value) {
                return Err(E::Scale { name, value });
            }
        }
        if !REST_N.contains(self.rest_n) {
            return Err(E::Rest { rest_n: self.rest_n });
        }
        for ridge in [self.ridge, self.literal.ridge] {
            if !RIDGE.contains(ridge) {
                return Err(E::Ridge { ridge });
            }
        }
        if let Some(baseline) = self.modes.baseline()
            && Mode::Baseline(baseline).entry().is_none()
        {
            return Err(E::Baseline { name: baseline.name() });
        }
        Ok(())
    }

    /// Returns the number of rows in half a window (a window consists of two blocks, so its length is even).
    pub(super) fn block(&self) -> usize {
        // Half of the fewest samples that a window may have (`WINDOW_SAMPLES`).
        ((self.window_s * self.rate_hz / 2.0).round() as usize).max(5)
    }

    /// Returns the programmed delay in samples, at most [`MAX_DELAY_S`].
    pub fn delay_ticks(&self, delay_s: f64) -> usize {
        // An unknown delay must not index a buffer; zero renders the newest packet.
        let delay_s = if delay_s.is_finite() { delay_s.clamp(DELAY_S.min, DELAY_S.max) } else { 0.0 };
        (delay_s * self.rate_hz).round() as usize
    }
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    #[error("the sampling rate of {rate_hz} Hz is out of range: use {IDENTIFIED_RATE_HZ}")]
    Rate { rate_hz: f64 },
    #[error("the window of {window_s} s contains {samples} samples: use {WINDOW_SAMPLES}")]
    Window {
        window_s: f64,
        /// Number of samples at the given rate.
        samples: f64,
    },
    #[error("the delay of {delay_s} s is out of range: use {DELAY_S}")]
    Delay { delay_s: f64 },
    #[error("the highest degree {degree} is out of range: use 1 to {MAX_DEGREE}")]
    Degree { degree: usize },
    #[error("{axes} axes are not supported: use 1, 2 or 3")]
    Axes { axes: usize },
    #[error("the scale {name} = {value} is out of range: use 1e-9 to 1e9")]
    Scale {
        /// Field of [`Scales`].
        name: &'static str,
        value: f64,
    },
    #[error("the resting force of {rest_n} N is out of range: use {REST_N}")]
    Rest { rest_n: f64 },
    #[error("the ridge parameter {ridge} is out of range: use {RIDGE}")]
    Ridge { ridge: f64 },
    /// The baselines are not in this program; see [`add_baselines`](super::add_baselines).
    #[error("this program was built without the mode {name}; build it with the feature lab, or choose another mode")]
    Baseline { name: &'static str },
}
