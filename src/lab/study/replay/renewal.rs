//! Rate at which a recording's force sensor delivers new values.

use nalgebra::Vector3;

/// A force that keeps its value for at least this many samples on average comes from a slower sensor.
const SAMPLES_PER_VALUE: f64 = 5.0;
/// Minimum number of values for this conclusion.
const VALUES: u64 = 4;

/// Counts the new values of a force during contact.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ForceRenewals {
    last: Vector3<f64>,
    samples: u64,
    values: u64,
}

impl ForceRenewals {
    pub(super) fn add(&mut self, force: &Vector3<f64>) {
        // Zero: the tip touches nothing.
        if *force != Vector3::zeros() {
            self.samples += 1;
            self.values += u64::from(*force != self.last);
        }
        self.last = *force;
    }

    /// Returns the rate of new values (Hz) if the force is renewed more slowly than it was recorded.
    pub(super) fn slow_hz(&self, rate_hz: f64) -> Option<f64> {
        let slow = self.values >= VALUES && self.samples as f64 >= SAMPLES_PER_VALUE * self.values as f64;
        slow.then(|| rate_hz * self.values as f64 / self.samples as f64)
    }
}
