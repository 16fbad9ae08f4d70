//! Limits of the settings that an operator, a rig file or a command may choose. Sliders, checks and texts use these
//! values.

use std::fmt;

/// Range from `min` to `max`, both included. Shown as `0 to 1 s`.
///
/// ```
/// use nima_core::limits::DELAY_S;
///
/// assert!(DELAY_S.contains(0.3) && !DELAY_S.contains(f64::NAN));
/// assert_eq!(DELAY_S.to_string(), "0 to 1 s");
/// assert_eq!(DELAY_S.per(1e-3, "ms").to_string(), "0 to 1000 ms");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    pub min: f64,
    pub max: f64,
    /// Unit of both limits; empty for a plain number.
    pub unit: &'static str,
}

impl Limits {
    const fn new(min: f64, max: f64, unit: &'static str) -> Self {
        Self { min, max, unit }
    }

    /// Returns whether the value is within the limits; NaN is not.
    /// An inclusive range is false for NaN, so no separate test is needed.
    pub fn contains(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }

    /// Returns the same limits in another unit, which is `size` of this one.
    #[must_use]
    pub fn per(&self, size: f64, unit: &'static str) -> Self {
        Self { min: self.min / size, max: self.max / size, unit }
    }
}

impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { min, max, unit } = self;
        let space = if unit.is_empty() { "" } else { " " };
        write!(f, "{min} to {max}{space}{unit}")
    }
}

// A slower loop cannot follow a hand; no supported device delivers readings faster than 10 kHz.
pub const RATE_HZ: Limits = Limits::new(20.0, 10_000.0, "Hz");
/// Rate of a recording. Modes without a window also identify recordings that are too slow for a loop.
pub const IDENTIFIED_RATE_HZ: Limits = Limits::new(5.0, 10_000.0, "Hz");

/// Feedback gain that any command or file may choose.
/// 1 is the force at the tip, felt unchanged; amplification is a separate, deliberate action.
pub const GAIN: Limits = Limits::new(0.0, 1.0, "");
/// Feedback gain after the operator's second, deliberate action.
/// At 3, a force of the usual ceiling (4 N) reaches the 12 N of an omega.7.
pub const GAIN_ABOVE_ONE: Limits = Limits::new(0.0, 3.0, "");

/// Programmed one-way delay of the link. The loop's ring buffers have room for the maximum.
/// Far above a delay with which a person can work (`SLIDER_DELAY_S`).
pub const DELAY_S: Limits = Limits::new(0.0, 1.0, "s");
/// Delay on the slider of the window. Rig files, studies and replays allow more; on the slider that would halve the
/// resolution in the range where a person can still work (the paper uses 0.3 s).
pub const SLIDER_DELAY_S: Limits = Limits::new(0.0, 0.5, "s");

/// Speed of the hand below which no force is rendered.
/// Larger bands would hide nearly every force of careful work.
pub const DEAD_BAND_M_S: Limits = Limits::new(0.0, 0.1, "m/s");
/// Dead band on the slider of the window, for a fine resolution around the paper's 1 mm/s.
pub const SLIDER_DEAD_BAND_M_S: Limits = Limits::new(0.0, 0.01, "m/s");

/// Force ceiling of a rig file that does not set one, N: the ceiling of the studies in `docs/results/release.md`.
pub const USUAL_CEILING_N: f64 = 4.0;
/// Highest force ceiling of a rig file, N: the force of the strongest handle that has a built-in driver (omega.7).
pub const MAX_CEILING_N: f64 = OMEGA7_FORCE_N;
/// Maximum force of an omega.7, N (chai3d's device table).
pub const OMEGA7_FORCE_N: f64 = 12.0;
/// Maximum force of the omega.7's gripper, N (chai3d's device table).
pub const OMEGA7_GRIPPER_N: f64 = 8.0;

/// Distance between the two lenses of an endoscope.
/// Wider than an endoscope (a tube of 5 to 12 mm) permits, so that only wrong units are refused.
pub const BASELINE_M: Limits = Limits::new(0.000_5, 0.05, "m");
// Design choice: larger coefficients fold the image over itself.
pub const DISTORTION: Limits = Limits::new(-2.0, 2.0, "");

/// Travel of the tip per travel of the hand.
/// Design choice: at 5, a tremor of 0.1 mm already moves the tip by 0.5 mm.
pub const SCALE: Limits = Limits::new(0.01, 5.0, "");

/// Samples in the window of the identification.
/// Five rows in each half are the fewest for a fit; ten thousand are 10 s at 1 kHz.
pub const WINDOW_SAMPLES: Limits = Limits::new(10.0, 10_000.0, "samples");
/// Force that counts as no force, below which the identification pauses.
/// Above 1 N the identification would rest during gentle contacts.
pub const REST_N: Limits = Limits::new(0.0, 1.0, "N");
/// Ridge parameter of the identification.
/// 1e6 already shrinks every coefficient to zero.
pub const RIDGE: Limits = Limits::new(0.0, 1e6, "");
