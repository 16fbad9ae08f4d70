//! Detects a change of tissue: an error that lasts, and that is many times the usual one.

use super::{
    holding::{ForceRenewal, STALE_S},
    motion_clock::newest_fraction,
};
use crate::signal::Lanes;

/// Length of a lasting error (s), if the delay is not longer: at least half of it. The error of a first contact ends sooner,
/// except that no model can know the contact before one delay has passed. With 0.15 s, joined recordings of two materials
/// have 1 % less error, but over tissue that changes at every touch `best` is up to 4 % worse than anchored rendering.
const LASTING_S: f64 = 0.2;
/// A lasting error this many times the usual one is a change. With 8 and 0.15 s, `best` errs 2 to 19 % more after a change.
const FACTOR: f64 = 6.0;
/// Memory of the usual error (s by the motion clock): some touches.
const USUAL_S: f64 = 4.0;
/// Minimum time between two changes (s), in which a model learns a tissue.
const APART_S: f64 = 0.5;

/// The smallest error (N) of the current block of ticks and of the previous one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LastingError {
    ticks: usize,
    min_n: [Lanes; 2],
}

impl LastingError {
    pub(super) fn step(&mut self, block: usize, error_n: Lanes) -> Lanes {
        if self.ticks.is_multiple_of(block) {
            let [newest_n, _] = self.min_n;
            // Before there is a block to compare with, no error can have lasted.
            self.min_n = [error_n, if self.ticks > 0 { newest_n } else { Lanes::ZERO }];
        }
        self.ticks += 1;
        let [newest_n, before_n] = &mut self.min_n;
        *newest_n = newest_n.zip(error_n, f64::min);
        newest_n.zip(*before_n, f64::min)
    }
}

/// Compares the errors of matched rendering with their usual size.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChangeDetector {
    rate_hz: f64,
    usual_n: Lanes,
    judged: f64,
    lasting: LastingError,
    /// Ticks since the last change.
    since: usize,
    renewal: ForceRenewal,
}

impl ChangeDetector {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self { rate_hz, ..Self::default() }
    }

    /// Adds a measured force and the size of the error of its prediction `age` ticks earlier (N), at this pace of the
    /// motion clock; returns whether the error reveals another tissue.
    pub(super) fn step(&mut self, force_n: Lanes, error_n: Lanes, pace: f64, age: usize) -> bool {
        // A sensor that renews its value slowly makes every model err until the next one. Exactly zero is a simulated tip
        // that touches nothing: after its errors of zero, any error would look large.
        if self.renewal.step(force_n, true) as f64 > STALE_S * self.rate_hz || force_n == Lanes::ZERO {
            return false;
        }
        let lasting = (LASTING_S * self.rate_hz) as usize;
        let block = (lasting.max(age) / 2).max(1);
        let lasting_n = self.lasting.step(block, error_n);
        self.since += 1;
        let sum = |lanes: Lanes| lanes.0.iter().sum::<f64>();
        // All axes together, because a tissue changes on all of them.
        let is_large = sum(lasting_n) > FACTOR * sum(self.usual_n);
        if is_large && self.since as f64 > APART_S * self.rate_hz {
            *self = Self::new(self.rate_hz);
            return true;
        }
        self.judged += pace;
        let fraction = newest_fraction(pace, self.judged, USUAL_S * self.rate_hz);
        self.usual_n = (self.usual_n + (error_n - self.usual_n) * fraction).settled();
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns whether errors of this size (N) reveal a change, after five seconds of errors of 0.1 N.
    fn is_change(age: usize, errors_n: impl Iterator<Item = f64>) -> bool {
        let mut detector = ChangeDetector::new(1000.0);
        let mut force_n = 0.0;
        let mut step = |error_n: f64| {
            force_n += 1.0;
            detector.step(Lanes::splat(force_n), Lanes::splat(error_n), 1.0, age)
        };
        assert!(!(0..5000).any(|_| step(0.1)));
        errors_n.into_iter().any(step)
    }

    #[test]
    fn an_error_that_lasts_is_a_change_and_one_that_passes_or_is_usual_is_none() {
        assert!(is_change(50, (0..200).map(|_| 1.0)));
        assert!(!is_change(50, (0..90).map(|_| 1.0)), "the error of a first contact is over sooner");
        assert!(!is_change(300, (0..140).map(|_| 1.0)), "and lasts longer with a longer delay");
        assert!(!is_change(50, (0..1000).map(|k| if k % 90 == 0 { 0.1 } else { 1.0 })));
        assert!(!is_change(50, (0..1000).map(|_| 0.5)));
    }

    #[test]
    fn nothing_is_a_change_at_the_start_or_while_the_sensor_repeats_itself() {
        let mut detector = ChangeDetector::new(1000.0);
        let renewed = |k: u32| Lanes::splat(f64::from(1 + k));
        assert!(!(0..400).any(|k| detector.step(renewed(k), renewed(k), 1.0, 50)));
        let stale = |k: u32| Lanes::splat(f64::from(1 + k / 250));
        let error_n = |k: u32| Lanes::splat(if k < 5000 { 0.1 } else { 1.0 });
        let is_change = |force_n: &dyn Fn(u32) -> Lanes| {
            let mut detector = ChangeDetector::new(1000.0);
            (0..7000).any(|k| detector.step(force_n(k), error_n(k), 1.0, 50))
        };
        assert!(is_change(&renewed) && !is_change(&stale) && !is_change(&|_| Lanes::ZERO));
    }
}
