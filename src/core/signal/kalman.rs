//! Steady-state Kalman filter of a constant-jerk motion.

use std::f64::consts::TAU;

use nalgebra::{Matrix4, Vector4};

use super::{Lanes, Motion};

/// Estimates position, velocity, acceleration and jerk of a motion whose jerk is driven by white noise; only the
/// position is measured.
///
/// The gain is the fixed point of the Riccati equation, found once at construction. Its only parameter is a bandwidth:
/// for spectral density `q` of the noise and `r` of the measurement the closed-loop poles are the poles of a
/// fourth-order Butterworth filter with `w^8 = q / r`.
#[derive(Clone, Debug)]
pub(super) struct SignalKalman {
    gain: [f64; 4],
    period_s: f64,
    state: [Lanes; 4],
    ticks: usize,
    settling_ticks: usize,
}

impl SignalKalman {
    /// Creates a filter with the given bandwidth (Hz), limited to a tenth of the rate.
    pub(super) fn new(bandwidth_hz: f64, rate_hz: f64) -> Self {
        // Above a tenth of the rate the discrete filter no longer has the poles of the continuous one.
        let bandwidth_hz = bandwidth_hz.min(0.1 * rate_hz);
        let period_s = 1.0 / rate_hz;
        // Time in units of one period: the transition matrix then contains only factorials, and all numbers are near
        // one.
        let step = TAU * bandwidth_hz * period_s;
        let fourth = step * step * (step * step);
        let a = transition(1.0);
        let q = process_noise(fourth * fourth);
        let mut p = Matrix4::identity();
        // Stops at the fixed point; the limit only ensures an end.
        for _ in 0..20_000 {
            let predicted = a * p * a.transpose() + q;
            // Only the position is measured, so the innovation covariance is a number: its variance plus 1 for the
            // measurement.
            let gain: Vector4<f64> = predicted.column(0) / (predicted[(0, 0)] + 1.0);
            let updated = predicted - gain * predicted.row(0);
            let settled = (updated - p).norm() <= 1e-14 * updated.norm();
            // Made symmetric again: rounding would otherwise let the two halves drift apart.
            p = (updated + updated.transpose()) * 0.5;
            if settled {
                break;
            }
        }
        let predicted = a * p * a.transpose() + q;
        let k = predicted.column(0) / (predicted[(0, 0)] + 1.0);
        // Back from periods to seconds: each derivative gains one factor of the rate.
        let gain = [k[0], k[1] * rate_hz, k[2] * (rate_hz * rate_hz), k[3] * (rate_hz * rate_hz * rate_hz)];
        // One period of the bandwidth: the poles have then decayed to e^-2.4 (their real part is at least 0.38 of the
        // bandwidth in rad/s).
        let settling_ticks = (rate_hz / bandwidth_hz).ceil() as usize;
        Self { gain, period_s, state: [Lanes::ZERO; 4], ticks: 0, settling_ticks }
    }

    pub(super) fn step(&mut self, position: Lanes) -> Motion {
        if self.ticks == 0 {
            // Starts at the first position with zero speed, otherwise the distance from the origin would be a speed.
            self.state = [position, Lanes::ZERO, Lanes::ZERO, Lanes::ZERO];
        }
        self.ticks = self.ticks.saturating_add(1);
        let [x, v, a, j] = self.state;
        let t = self.period_s;
        let predicted = [x + (v + (a + j * (t / 3.0)) * (t / 2.0)) * t, v + (a + j * (t / 2.0)) * t, a + j * t, j];
        let innovation = position - predicted[0];
        for ((state, predicted), gain) in self.state.iter_mut().zip(predicted).zip(self.gain) {
            *state = predicted + innovation * gain;
        }
        Motion { x: self.state[0], v: self.state[1], a: self.state[2] }
    }

    pub(super) fn settled(&self) -> bool {
        self.ticks >= self.settling_ticks
    }

    pub(super) fn reset(&mut self) {
        self.ticks = 0;
    }
}

fn transition(t: f64) -> Matrix4<f64> {
    let t2 = t * t / 2.0;
    let t3 = t * t * t / 6.0;
    Matrix4::new(1.0, t, t2, t3, 0.0, 1.0, t, t2, 0.0, 0.0, 1.0, t, 0.0, 0.0, 0.0, 1.0)
}

/// Returns the process covariance of one period for white noise of density `q` on the derivative of the jerk.
fn process_noise(q: f64) -> Matrix4<f64> {
    let factorial = [6.0, 2.0, 1.0, 1.0];
    // The integral of `t^(3-i) t^(3-j) / ((3-i)! (3-j)!)` over one period.
    Matrix4::from_fn(|i, j| q / (factorial[i] * factorial[j] * (7 - i - j) as f64))
}
