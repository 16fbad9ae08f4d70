//! Causal Savitzky-Golay filter: a parabola through the last samples, evaluated at the newest one.

use nalgebra::{DMatrix, DVector};

use super::{DelayLine, Lanes, Motion};

/// A least-squares parabola over the last `n` samples, which gives position, velocity and acceleration at the newest
/// one.
///
/// Exact for constant acceleration (no lag); the noise of the velocity falls with `n^1.5`, that of the acceleration
/// with `n^2.5`.
#[derive(Clone, Debug)]
pub(super) struct SavitzkyGolay {
    samples: DelayLine<Lanes>,
    /// Weights of (x, v, a) for the sample `k` ticks old.
    weights: Vec<[f64; 3]>,
}

impl SavitzkyGolay {
    /// Fits a parabola over `n >= 3` samples at `rate_hz`.
    pub(super) fn new(n: usize, rate_hz: f64) -> Self {
        // A parabola has three parameters.
        let n = n.max(3);
        // Time in units of the window, newest sample at 0: the Vandermonde matrix is then well conditioned at every
        // rate.
        let span = (n - 1) as f64;
        let vandermonde = DMatrix::from_fn(n, 3, |k, power| {
            let age = -(k as f64) / span;
            [1.0, age, age * age][power]
        });
        let qr = vandermonde.qr();
        let r = qr.r();
        let q_transposed = qr.q().transpose();
        let solve = |k: usize| {
            let z = DVector::from_iterator(3, q_transposed.column(k).iter().copied());
            r.solve_upper_triangular(&z).unwrap_or_else(|| DVector::zeros(3))
        };
        // From the scaled time back to seconds: one factor per derivative.
        let per_second = rate_hz / span;
        let weights = (0..n)
            .map(|k| {
                let c = solve(k);
                [c[0], c[1] * per_second, 2.0 * c[2] * per_second * per_second]
            })
            .collect();
        Self { samples: DelayLine::new(n - 1, Lanes::ZERO), weights }
    }

    /// Adds the newest position. Until `n` samples have been added, returns the position with zero derivatives.
    pub(super) fn step(&mut self, position: Lanes) -> Motion {
        self.samples.push(position);
        if !self.settled() {
            // A half-filled window would show the start at zero as motion.
            return Motion { x: position, ..Motion::default() };
        }
        let mut motion = Motion { x: position, ..Motion::default() };
        // Uses differences from the newest sample, so that a large constant offset does not reduce the precision.
        for (k, [wx, wv, wa]) in self.weights.iter().enumerate() {
            let Some(sample) = self.samples.get(k) else { break };
            let step = *sample - position;
            motion.x += step * *wx;
            motion.v += step * *wv;
            motion.a += step * *wa;
        }
        motion
    }

    pub(super) fn settled(&self) -> bool {
        self.samples.len() == self.weights.len()
    }

    pub(super) fn reset(&mut self) {
        self.samples.clear();
    }
}
