//! The lasting part of the force that the parameters do not explain: a slowly drifting offset, kept small.

use crate::signal::{DelayLine, Lanes};

/// Memory of the learned fraction and of the mean and maximum force (s). Chosen as in `matched/mod.rs`.
const FRACTION_S: f64 = 1.0;
const FORCE_S: f64 = 2.0;
/// Ridge of the fit of the fraction, and the part of the mean force that is added to an error before its weight is
/// computed. Chosen as in `matched/mod.rs`.
const RIDGE: f64 = 0.02;
const FLATTEN: f64 = 0.05;
/// The offset may be at most this fraction of the recent maximum force, so that it does not become a reflected force.
const BOUND: f64 = 0.1;

/// Learns, per axis, the fraction of the residual of one delay ago that still remains (0 to 1, least absolute error).
#[derive(Clone, Debug)]
pub(super) struct ResidualDrift {
    rate_hz: f64,
    residuals_n: DelayLine<Lanes>,
    products: Lanes,
    right: Lanes,
    fraction: Lanes,
    mean_n: Lanes,
    largest_n: Lanes,
    seen: f64,
}

impl ResidualDrift {
    pub(super) fn new(rate_hz: f64, max_delay: usize) -> Self {
        Self {
            rate_hz,
            residuals_n: DelayLine::new(max_delay, Lanes::ZERO),
            products: Lanes::ZERO,
            right: Lanes::ZERO,
            fraction: Lanes::ZERO,
            mean_n: Lanes::ZERO,
            largest_n: Lanes::ZERO,
            seen: 0.0,
        }
    }

    /// Takes the force that the parameters of `delay` ticks ago do not explain now (N), and the offset that was sent
    /// with them (N). The residual of that time is `delay - 1` entries back, because this tick's residual is still
    /// missing.
    pub(super) fn judge(&mut self, delay: usize, unexplained_n: Lanes, sent_n: Lanes) {
        // Nothing to compare with during the first delay.
        let Some(then_n) = self.residuals_n.get(delay - 1).copied() else { return };
        // Divided by the size of the error: least absolute error, in which a single impact counts little.
        let size = (unexplained_n - sent_n).map(f64::abs) + self.mean_n * FLATTEN;
        let weighted = then_n * size.recip_or_zero();
        let fade = libm::exp(-1.0 / (FRACTION_S * self.rate_hz));
        self.products = (self.products * fade + weighted * then_n).settled();
        self.right = (self.right * fade + weighted * unexplained_n).settled();
        let fraction = self.right * (self.products * (1.0 + RIDGE)).recip_or_zero();
        // A fraction above 1 would let the offset grow by itself, one below 0 would swing.
        self.fraction = fraction.within(Lanes::ZERO, Lanes::splat(1.0));
    }

    /// Takes this tick's residual and force (N); returns the offset to send (N).
    pub(super) fn step(&mut self, residual_n: Lanes, force_n: Lanes) -> Lanes {
        self.residuals_n.push(residual_n);
        let size_n = force_n.map(f64::abs);
        // Ticks, not the motion clock: the offset drifts with time, not with motion.
        self.seen += 1.0;
        let memory = FORCE_S * self.rate_hz;
        self.mean_n = (self.mean_n + (size_n - self.mean_n) * self.seen.min(memory).recip()).settled();
        self.largest_n = (self.largest_n * (1.0 - memory.recip())).settled().zip(size_n, f64::max);
        let bound_n = self.largest_n * BOUND;
        (self.fraction * residual_n).within(-bound_n, bound_n)
    }

    /// Advances a tick without a measurement.
    pub(super) fn hold(&mut self) {
        // Repeat the last residual for the missing one, so that each index corresponds to a time.
        let last_n = self.residuals_n.get(0).copied().unwrap_or_default();
        self.residuals_n.push(last_n);
    }

    pub(super) fn reset(&mut self) {
        self.residuals_n.clear();
        let rest = Lanes::ZERO;
        self.products = rest;
        self.right = rest;
        self.fraction = rest;
        self.mean_n = rest;
        self.largest_n = rest;
        self.seen = 0.0;
    }
}
