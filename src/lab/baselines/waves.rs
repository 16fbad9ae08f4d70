//! Wave variables, return channel (Niemeyer and Slotine, "Stable adaptive teleoperation", IEEE J. Oceanic Engineering
//! 16, 1991).
//!
//! With velocity `v`, force `F` against the motion and wave impedance `b`, the waves are `u = (b v + F) / sqrt(2 b)`
//! forwards and `w = (b v - F) / sqrt(2 b)` backwards. The follower sends `w`; the leader, whose hand imposes the
//! velocity, decodes `F = b v - sqrt(2 b) w`. Forces here act from the tissue on the instrument, `f = -F`.
//!
//! The wave `u`, which would make the follower yield to the force, is omitted, because the motion reaches the follower
//! without delay in this loop and the follower tracks a position. This version is therefore not passive by
//! construction.

use nima_core::{
    impedance::{Baseline, BaselineModel, Wave},
    signal::{Lanes, Motion},
};

use crate::{BaselineSender, kept};

/// Wave impedance as a fraction of the force per speed in motion, `sum |(f - mean f) v| / sum v^2`: the publication
/// leaves it to the task, and a number in N s/m would suit only one device and one unit (chosen on recordings, see
/// docs/modes.md).
const FRACTION: f64 = 0.4;
/// Memory of the sums, and of the mean force (s).
const MEMORY_S: f64 = 20.0;

/// Returns the force (N) of a returning wave, decoded with the leader's own velocity.
pub(crate) fn decoded(wave: &Wave, own: &Motion) -> Lanes {
    let b = wave.impedance_n_s_m;
    wave.returning * (b * 2.0).sqrt() - own.v * b
}

#[derive(Clone, Debug)]
pub(crate) struct Waves {
    kept: f64,
    seen: f64,
    mean_n: Lanes,
    /// `sum |(f - mean f) v|` and `sum v^2`, with forgetting.
    sums: [Lanes; 2],
    last_n: Lanes,
}

impl BaselineSender for Waves {
    const BASELINE: Baseline = Baseline::Waves;

    fn new(rate_hz: f64, _delay_ticks: usize) -> Self {
        Self {
            kept: kept(MEMORY_S, rate_hz),
            seen: 0.0,
            mean_n: Lanes::ZERO,
            sums: [Lanes::ZERO; 2],
            last_n: Lanes::ZERO,
        }
    }

    fn step(&mut self, motion: &Motion, force_n: Option<Lanes>) -> BaselineModel {
        if let Some(force_n) = force_n {
            self.last_n = force_n;
            // A plain mean at first, then one with exponential forgetting.
            self.seen = self.seen * self.kept + 1.0;
            self.mean_n = (self.mean_n + (force_n - self.mean_n) * self.seen.recip()).settled();
            let own_n = force_n - self.mean_n;
            for (sum, size) in self.sums.iter_mut().zip([own_n * motion.v, motion.v * motion.v]) {
                *sum = (*sum * self.kept + size.map(f64::abs)).settled();
            }
        }
        let [powers, squares] = self.sums;
        // Never zero, so that the wave always carries the force; without motion, b is too small to add anything to it.
        let b = (powers * squares.recip_or_zero() * FRACTION).map(|b| b.clamp(1e-12, 1e12));
        let returning = (b * motion.v + self.last_n) / (b * 2.0).sqrt();
        BaselineModel::Wave(Wave { returning, impedance_n_s_m: b })
    }

    fn reset(&mut self) {
        self.seen = 0.0;
        self.mean_n = Lanes::ZERO;
        self.sums = [Lanes::ZERO; 2];
        self.last_n = Lanes::ZERO;
    }
}
