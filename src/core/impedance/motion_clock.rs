//! A clock that motion drives.

use crate::signal::Lanes;

/// Memory of the recent maximum motion (s by this clock). Design choice.
const LARGEST_S: f64 = 20.0;
/// Fraction of the maximum motion above which time runs at full pace, and the pace at rest. Time stands nearly still at
/// rest, so that a pause does not make the regression forget what the last motion showed.
/// Design choice: a larger fraction would slow time in gentle motion, a smaller one would let tremor run it.
const FULL: f64 = 0.1;
const REST: f64 = 0.02;
/// The pace decays with this time constant (s), so that a turning point does not stop the clock.
const HOLD_S: f64 = 0.05;
/// Memory of the mean magnitude of the motion (s by this clock); dry friction saturates at half of it.
const KNEE_S: f64 = 2.0;

/// Clock that weights each sample, so that memories based on it forget nothing while the hand is at rest.
#[derive(Clone, Debug)]
pub(super) struct MotionClock {
    rate_hz: f64,
    release: f64,
    largest_m: Lanes,
    mean_m: Lanes,
    pace: f64,
    passed: f64,
}

impl MotionClock {
    pub(super) fn new(rate_hz: f64) -> Self {
        let release = -libm::expm1(-1.0 / (HOLD_S * rate_hz));
        Self { rate_hz, release, largest_m: Lanes::ZERO, mean_m: Lanes::ZERO, pace: 0.0, passed: 0.0 }
    }

    /// Adds the motion of this tick (position above its 20 ms low-pass, m).
    pub(super) fn step(&mut self, motion_m: Lanes) {
        let size_m = motion_m.map(f64::abs);
        // By its own pace, so that a rest does not shrink the largest motion and make tremor look like motion.
        let fade = 1.0 - self.pace / (LARGEST_S * self.rate_hz);
        self.largest_m = (self.largest_m * fade).settled().zip(size_m, f64::max);
        // A zero maximum gives a fraction of zero, hence the pace at rest.
        let fractions = size_m * (self.largest_m * FULL).recip_or_zero();
        let pace = fractions.0.into_iter().fold(REST, f64::max).min(1.0);
        // Rises at once and falls slowly: see `HOLD_S`.
        self.pace = pace.max(self.pace + (pace - self.pace) * self.release);
        self.passed += self.pace;
        let fraction = fraction(self.pace, self.passed, KNEE_S * self.rate_hz);
        self.mean_m = (self.mean_m + (size_m - self.mean_m) * fraction).settled();
    }

    /// Returns the pace of the newest tick, above 0 and up to 1, on the axis that moves most.
    pub(super) const fn pace(&self) -> f64 {
        self.pace
    }

    /// Returns the motion at which dry friction saturates (m).
    pub(super) fn knee_m(&self) -> Lanes {
        self.mean_m * 0.5
    }

    pub(super) fn reset(&mut self) {
        *self = Self::new(self.rate_hz);
    }
}

/// Returns the weight of the newest value in a running mean over `memory` ticks of the clock, after `passed` ticks.
pub(super) fn fraction(pace: f64, passed: f64, memory: f64) -> f64 {
    // Plain mean until the memory is full: the first value counts fully and the start at zero leaves no trace.
    (pace / passed.max(1.0).min(memory)).min(1.0)
}

/// Returns the same weight, but twice that of a plain mean until the memory is full. For errors of a method that is
/// still learning, because its first errors are not representative.
pub(super) fn newest_fraction(pace: f64, passed: f64, memory: f64) -> f64 {
    fraction(2.0 * pace, passed, 2.0 * memory)
}
