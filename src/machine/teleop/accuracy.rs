//! Running error of each mode's force relative to the true force; no samples are stored.

use nalgebra::Vector3;
use nima_core::impedance::{Mode, ModeSet, RenderedForces, SLOTS};

/// Mean, standard deviation and maximum of a vector error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorStats {
    pub count: u64,
    /// Mean of the error's norm, N.
    pub mae_n: f64,
    pub max_n: f64,
    mean_n: Vector3<f64>,
    squares_n2: f64,
}

impl ErrorStats {
    /// Adds one error (N). A non-finite error is ignored here; the caller must count it.
    pub fn add(&mut self, error_n: &Vector3<f64>) {
        let norm_n = error_n.norm();
        // One NaN would stay in every mean for the rest of the run.
        if !norm_n.is_finite() {
            return;
        }
        // Welford's update: numerically stable for long runs.
        self.count += 1;
        let count = self.count as f64;
        self.mae_n += (norm_n - self.mae_n) / count;
        self.max_n = self.max_n.max(norm_n);
        let before = error_n - self.mean_n;
        self.mean_n += before / count;
        self.squares_n2 += before.dot(&(error_n - self.mean_n));
    }

    /// Returns the standard deviation of the error vector about its mean, N (for one axis: of the signed error).
    pub fn sd_n(&self) -> f64 {
        // Population deviation: the errors of a run are all of them, not a sample.
        if self.count == 0 { 0.0 } else { (self.squares_n2 / self.count as f64).max(0.0).sqrt() }
    }
}

/// Errors of every mode's force before the gates, relative to the force at the follower at the same instant.
#[derive(Clone, Copy, Debug, Default)]
pub struct Accuracy {
    by_mode: [ErrorStats; SLOTS],
    invalid: [u64; SLOTS],
}

impl Accuracy {
    /// Adds one tick of the computed modes. A mode without a valid force renders zero, so its error is the whole force.
    pub fn add(&mut self, rendered: &RenderedForces, computed: ModeSet, truth_n: &Vector3<f64>) {
        for mode in computed.modes() {
            let force_n = rendered.force(mode);
            self.invalid[mode.index()] += u64::from(force_n.is_none());
            // A mode without a force renders none, so its error is the whole force.
            self.by_mode[mode.index()].add(&(force_n.unwrap_or_else(Vector3::zeros) - truth_n));
        }
    }

    pub const fn of(&self, mode: Mode) -> &ErrorStats {
        &self.by_mode[mode.index()]
    }

    /// Returns the number of ticks in which `mode` had no valid force.
    pub const fn invalid(&self, mode: Mode) -> u64 {
        self.invalid[mode.index()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_deviation_and_worst_of_signed_errors() {
        let mut stats = ErrorStats::default();
        for error in [1.0, -3.0, f64::NAN] {
            stats.add(&Vector3::new(error, 0.0, 0.0));
        }
        assert_eq!((stats.count, stats.mae_n, stats.sd_n(), stats.max_n), (2, 2.0, 2.0, 3.0));
    }
}
