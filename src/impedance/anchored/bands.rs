//! A signal and what four low-passes leave of it.

use crate::signal::Lanes;

/// Number of low-passes.
pub(super) const BANDS: usize = 4;
/// Shortest and longest time constant, s; the others lie between in equal ratios.
const TIME_CONSTANTS_S: [f64; 2] = [0.005, 0.32];

/// A position, and the position minus each of its low-passes.
///
/// `x - lowpass(x)` is the velocity times the time constant for slow motion and the motion itself for fast: together the four
/// span velocity and acceleration at four bandwidths, and the relaxation of tissue, without a differentiator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in super::super) struct BandMotion {
    /// Position, m.
    pub(super) x: Lanes,
    /// Position minus its low-passes, fastest first, m.
    pub(super) u: [Lanes; BANDS],
}

/// The four low-passes of one signal.
#[derive(Clone, Debug)]
pub(in super::super) struct Bands {
    low: [Lanes; BANDS],
    share: [f64; BANDS],
    started: bool,
}

impl Bands {
    pub(in super::super) fn new(rate_hz: f64) -> Self {
        let period_s = rate_hz.recip();
        let shortest_s = TIME_CONSTANTS_S[0].max(period_s);
        let ratio = (TIME_CONSTANTS_S[1].max(4.0 * shortest_s) / shortest_s).cbrt();
        let mut time_s = shortest_s;
        let share = std::array::from_fn(|_| {
            let share = 1.0 - (-period_s / time_s).exp();
            time_s *= ratio;
            share
        });
        Self { low: [Lanes::ZERO; BANDS], share, started: false }
    }

    /// Takes this tick's value; gives it minus each low-pass. The first value counts as having been there for ever.
    pub(super) fn high_passes(&mut self, value: Lanes) -> [Lanes; BANDS] {
        if !self.started {
            self.low = [value; BANDS];
            self.started = true;
        }
        let mut rest = [Lanes::ZERO; BANDS];
        for ((low, share), rest) in self.low.iter_mut().zip(self.share).zip(&mut rest) {
            *low += (value - *low) * share;
            *rest = value - *low;
        }
        rest
    }

    /// Takes this tick's position, m.
    pub(in super::super) fn motion(&mut self, x: Lanes) -> BandMotion {
        BandMotion { x, u: self.high_passes(x) }
    }

    pub(in super::super) fn reset(&mut self) {
        self.started = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_leaves_speed_times_time_constant_and_a_rest_leaves_nothing() {
        let mut bands = Bands::new(1000.0);
        let speed = 0.1;
        let mut rest = [Lanes::ZERO; BANDS];
        for i in 0..4000 {
            rest = bands.high_passes(Lanes::splat(speed * f64::from(i) * 1e-3));
        }
        for (rest, time_s) in rest.iter().zip([0.005, 0.02, 0.08, 0.32]) {
            assert!((rest[0] / (speed * time_s) - 1.0).abs() < 0.11, "{} at {time_s} s", rest[0]);
        }
        for _ in 0..6000 {
            rest = bands.high_passes(Lanes::splat(0.4));
        }
        assert!(rest.iter().all(|r| r[0].abs() < 1e-8));
    }
}
