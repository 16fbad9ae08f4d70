//! A bank of first-order low-pass filters, whose time constants match those of tissue contact.

use super::Lanes;

// Each further filter costs a column in every fit.
pub const BANK: usize = 4;

/// Differences between a signal and its low-pass filtered past, for four time constants.
///
/// `value - low_pass(value)` for time constants in geometric steps. The differences cover velocity and acceleration at
/// four bandwidths and the relaxation of tissue, need no differentiator, and work the same from 20 Hz to 10 kHz.
///
/// ```
/// use nima_core::signal::{Lanes, LowPassBank};
///
/// let mut bank = LowPassBank::new(0.005, 0.32, 1000.0);
/// bank.step(Lanes::ZERO);
/// let [quick, .., slow] = bank.step(Lanes::splat(1.0));
/// assert!(quick[0] < slow[0], "the quick filter follows a step sooner, so less of it is left");
/// ```
#[derive(Clone, Debug)]
pub struct LowPassBank {
    fraction: [f64; BANK],
    low: [Lanes; BANK],
    started: bool,
}

impl LowPassBank {
    /// Creates filters with time constants from `shortest_s` (at least one sample) to `longest_s`, in geometric steps.
    pub fn new(shortest_s: f64, longest_s: f64, rate_hz: f64) -> Self {
        let period_s = rate_hz.recip();
        // A filter faster than a sample would only copy its input.
        let shortest_s = shortest_s.max(period_s);
        // The cube root, because three steps lead from the first to the fourth. The factor of four keeps them
        // distinct at low rates.
        let step = libm::cbrt(longest_s.max(4.0 * shortest_s) / shortest_s);
        let tau_s = [1.0, step, step * step, step * step * step].map(|factor| factor * shortest_s);
        // `expm1`, because `1 - exp(-x)` loses digits for small `x`.
        Self { fraction: tau_s.map(|tau_s| -libm::expm1(-period_s / tau_s)), low: [Lanes::ZERO; BANK], started: false }
    }

    /// Adds the newest value; returns its difference from each low-pass, the shortest time constant first. The first
    /// value initialises the filters.
    pub fn step(&mut self, value: Lanes) -> [Lanes; BANK] {
        if !self.started {
            // Started at the value itself: a filter started at zero would show a jump from the origin.
            self.low = [value; BANK];
            self.started = true;
        }
        let mut differences = [Lanes::ZERO; BANK];
        for ((low, fraction), difference) in self.low.iter_mut().zip(self.fraction).zip(&mut differences) {
            *low += (value - *low) * fraction;
            *difference = (value - *low).settled();
            // The low-pass is corrected by the rounded difference, so that both always add up to the value.
            *low = value - *difference;
        }
        differences
    }

    /// Replaces the last `ticks` values, which were all the same, by values that change evenly by `change` in total: after
    /// a gap, its ends are known, and the motion between them was not a jump.
    pub fn glide(&mut self, change: Lanes, ticks: usize) {
        let slope = change * (ticks.max(1) as f64).recip();
        for (low, fraction) in self.low.iter_mut().zip(self.fraction) {
            let kept = libm::pow(1.0 - fraction, ticks as f64);
            let behind = slope * ((1.0 - fraction) / fraction * (1.0 - kept));
            *low += change - behind;
        }
    }

    pub fn reset(&mut self) {
        self.started = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_decays_with_each_time_constant() {
        let mut bank = LowPassBank::new(0.005, 0.32, 1000.0);
        bank.step(Lanes::ZERO);
        let mut differences = [Lanes::ZERO; BANK];
        for _ in 0..20 {
            differences = bank.step(Lanes::splat(1.0));
        }
        for (difference, tau_s) in differences.iter().zip([0.005, 0.02, 0.08, 0.32]) {
            assert!((difference[0] - (-0.02_f64 / tau_s).exp()).abs() < 1e-12);
        }
    }

    #[test]
    fn a_glide_replaces_the_values_of_a_gap() {
        let [mut seen, mut bridged] = [(); 2].map(|()| LowPassBank::new(0.005, 0.32, 1000.0));
        for bank in [&mut seen, &mut bridged] {
            bank.step(Lanes::ZERO);
            for k in 0..100 {
                bank.step(Lanes::splat(0.01 * f64::from(k)));
            }
        }
        let last = 0.99;
        for k in 1..=500 {
            seen.step(Lanes::splat(last + 0.002 * f64::from(k)));
            bridged.step(Lanes::splat(last));
        }
        bridged.glide(Lanes::splat(1.0), 500);
        let [seen, bridged] = [seen, bridged].map(|mut bank| bank.step(Lanes::splat(1.992)));
        for (seen, bridged) in seen.iter().zip(bridged) {
            assert!((seen[0] - bridged[0]).abs() < 1e-9, "{} {}", seen[0], bridged[0]);
        }
    }

    #[test]
    fn rest_leaves_exact_zeros() {
        let mut bank = LowPassBank::new(0.005, 0.32, 1000.0);
        bank.step(Lanes::splat(1.0));
        let mut differences = [Lanes::ZERO; BANK];
        for _ in 0..100_000 {
            differences = bank.step(Lanes::ZERO);
        }
        assert_eq!(differences, [Lanes::ZERO; BANK]);
    }
}
