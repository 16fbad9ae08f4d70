//! The better of anchored and matched rendering, by what each was worth lately.

use super::pace::share;
use crate::signal::Lanes;

/// Memory of the errors (s by the clock).
const MEMORY_S: f64 = 1.0;
/// Errors below this are equal (N).
const EQUAL_N: f64 = 1e-12;
/// Matched rendering is preferred while its error times this is not the greater one: it cannot kick.
const PREFERENCE: f64 = 0.95;

/// A softmin, per axis, of the running errors at the horizon. Holding needs no weight of its own: anchored rendering is
/// holding wherever its correction does not help.
#[derive(Clone, Debug)]
pub(super) struct Best {
    rate_hz: f64,
    judged: f64,
    anchored_n: Lanes,
    matched_n: Lanes,
    anchored: Lanes,
}

impl Best {
    pub(super) fn new(rate_hz: f64) -> Self {
        let none = Lanes::ZERO;
        Self { rate_hz, judged: 0.0, anchored_n: none, matched_n: none, anchored: none }
    }

    /// The weight of anchored rendering, 0 to 1; matched rendering has the rest, and everything until the first judgement.
    pub(super) fn anchored(&self) -> Lanes {
        self.anchored
    }

    /// Judges what both said (N) by the force that came.
    pub(super) fn judge(&mut self, anchored_n: Lanes, matched_n: Lanes, force_n: Lanes, pace: f64) {
        self.judged += pace;
        let share = share(pace, self.judged, MEMORY_S * self.rate_hz);
        for (mean_n, said_n) in [(&mut self.anchored_n, anchored_n), (&mut self.matched_n, matched_n)] {
            *mean_n = (*mean_n + ((force_n - said_n).map(f64::abs) - *mean_n) * share).settled();
        }
        let floor_n = Lanes::splat(EQUAL_N);
        let odds = eighth_power((self.matched_n * PREFERENCE + floor_n) / (self.anchored_n + floor_n));
        self.anchored = odds.map(|odds| odds / (1.0 + odds));
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}

/// The softmin's exponent.
pub(super) fn eighth_power(value: Lanes) -> Lanes {
    let square = value * value;
    let fourth = square * square;
    fourth * fourth
}
