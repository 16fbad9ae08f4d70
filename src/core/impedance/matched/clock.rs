//! A clock that motion drives.

use super::super::regressors::Stance;
use crate::signal::Lanes;

/// Memory of the largest motion of late (s by this clock).
const LARGEST_S: f64 = 20.0;
/// Time runs at full pace from this share of the largest motion on, and at rest at this pace.
const FULL: f64 = 0.1;
const REST: f64 = 0.02;
/// The pace falls off with this time constant (s), so that a turning point does not stop the clock.
const HOLD_S: f64 = 0.05;

/// Tells how much each sample weighs: memories that fade by it forget nothing while the hand stands still.
#[derive(Clone, Debug)]
pub(super) struct Clock {
    rate_hz: f64,
    release: f64,
    largest_m: Lanes,
    pace: f64,
}

impl Clock {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self { rate_hz, release: -(-1.0 / (HOLD_S * rate_hz)).exp_m1(), largest_m: Lanes::ZERO, pace: 0.0 }
    }

    /// The pace of this tick, above 0 up to 1, by the axis that moves most.
    pub(super) fn step(&mut self, stance: &Stance) -> f64 {
        let size_m = stance.u[1].map(f64::abs);
        let fade = (-self.pace / (LARGEST_S * self.rate_hz)).exp();
        self.largest_m = (self.largest_m * fade).settled().zip(size_m, f64::max);
        let shares = size_m * (self.largest_m * FULL).recip_or_zero();
        let pace = shares.0.into_iter().fold(REST, f64::max).min(1.0);
        self.pace = pace.max(self.pace + (pace - self.pace) * self.release);
        self.pace
    }

    /// The pace of the newest tick.
    pub(super) const fn pace(&self) -> f64 {
        self.pace
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}
