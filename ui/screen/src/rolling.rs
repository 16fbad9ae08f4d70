//! Statistics over the last seconds, updated with every sample.

use std::collections::VecDeque;

/// Number of degrees, including 0 for "none".
pub const DEGREES: usize = nima_core::impedance::MAX_DEGREE + 1;

/// Number of times each degree was chosen in the last `capacity` ticks.
#[derive(Clone, Debug)]
pub struct DegreeFractions {
    chosen: VecDeque<u8>,
    counts: [u32; DEGREES],
    capacity: usize,
}

impl DegreeFractions {
    pub fn new(capacity: usize) -> Self {
        Self { chosen: VecDeque::with_capacity(capacity), counts: [0; DEGREES], capacity: capacity.max(1) }
    }

    /// Adds one choice; an invalid degree is ignored.
    pub fn push(&mut self, degree: u8) {
        let Some(count) = self.counts.get_mut(usize::from(degree)) else { return };
        *count += 1;
        self.chosen.push_back(degree);
        while self.chosen.len() > self.capacity {
            if let Some(old) = self.chosen.pop_front() {
                self.counts[usize::from(old)] -= 1;
            }
        }
    }

    /// Returns the fraction of each degree, 0 to 1; zeros before the first.
    pub fn fractions(&self) -> [f64; DEGREES] {
        let total = self.chosen.len().max(1) as f64;
        self.counts.map(|count| f64::from(count) / total)
    }

    pub fn is_empty(&self) -> bool {
        self.chosen.is_empty()
    }

    /// Returns the fraction of degrees 2 and above, 0 to 1.
    pub fn nonlinear(&self) -> f64 {
        self.fractions().iter().skip(2).sum()
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub struct FadingMean {
    value: Option<f64>,
}

impl FadingMean {
    /// Adds a value that was valid for `dt_s`; a non-finite value is ignored.
    pub fn push(&mut self, value: f64, dt_s: f64, constant_s: f64) {
        if !value.is_finite() {
            return;
        }
        let fraction = if dt_s > 0.0 { 1.0 - (-dt_s / constant_s).exp() } else { 0.0 };
        self.value = Some(self.value.map_or(value, |old| old + fraction * (value - old)));
    }

    /// Returns the current mean; `None` before the first value.
    pub const fn known(self) -> Option<f64> {
        self.value
    }

    /// Returns the current mean; zero before the first value.
    pub fn get(self) -> f64 {
        self.value.unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_forget_what_is_old() {
        let mut fractions = DegreeFractions::new(4);
        for degree in [5, 5, 5, 5, 1, 0, 2, 3, 99] {
            fractions.push(degree);
        }
        let percent = fractions.fractions().map(|fraction| (100.0 * fraction).round() as u32);
        assert_eq!(percent, [25, 25, 25, 25, 0, 0]);
        assert!((fractions.nonlinear() - 0.5).abs() < 1e-12);
        assert!(DegreeFractions::new(10).nonlinear().abs() < 1e-12);
    }

    #[test]
    fn a_fading_mean_follows_and_ignores_nan() {
        let mut mean = FadingMean::default();
        mean.push(1.0, 0.001, 0.1);
        mean.push(f64::NAN, 0.001, 0.1);
        assert!((mean.get() - 1.0).abs() < 1e-12);
        for _ in 0..1000 {
            mean.push(3.0, 0.001, 0.1);
        }
        assert!((mean.get() - 3.0).abs() < 1e-3);
    }
}
