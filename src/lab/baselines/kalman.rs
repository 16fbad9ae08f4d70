//! Extrapolation by a Kalman filter of the force and its rate.
//!
//! The rate of the force is driven by white noise and decays with a time constant `tau`, like the acceleration of a
//! target in Singer ("Estimating optimal tracking filter performance for manned maneuvering targets", IEEE Trans.
//! Aerospace and Electronic Systems 6, 1970), but one derivative lower, because a force has no inertia. Over a time `t`
//! the state changes by `f + f' tau (1 - e^(-t/tau))`, `f' e^(-t/tau)`; an infinite `tau` would be the constant-rate
//! filter of the textbooks, which overshoots by the whole rate times the delay. The gain is the fixed point of the
//! Riccati equation; the leader extrapolates over the packet's age.

use nima_core::{
    impedance::{Baseline, BaselineModel},
    signal::{Lanes, Motion},
};

use crate::BaselineSender;

/// Time constant of the rate (s), and bandwidth of the filter (Hz): `w^4` is the spectral density of the noise divided
/// by that of the measurement (chosen on recordings, see docs/modes.md).
const LASTING_S: f64 = 0.005;
const BANDWIDTH_HZ: f64 = 100.0;

/// Returns the force that this state leads to after a time.
pub(crate) fn extrapolated(force_n: Lanes, rate_n_s: Lanes, age_s: f64) -> Lanes {
    force_n - rate_n_s * (LASTING_S * libm::expm1(-age_s / LASTING_S))
}

#[derive(Clone, Debug)]
pub(crate) struct Kalman {
    period_s: f64,
    lasting: f64,
    gain: [f64; 2],
    state: Option<[Lanes; 2]>,
}

impl BaselineSender for Kalman {
    const BASELINE: Baseline = Baseline::Kalman;

    fn new(rate_hz: f64, _delay_ticks: usize) -> Self {
        let period_s = rate_hz.recip();
        Self { period_s, lasting: libm::exp(-period_s / LASTING_S), gain: gain(rate_hz), state: None }
    }

    fn step(&mut self, _motion: &Motion, force_n: Option<Lanes>) -> BaselineModel {
        if let Some([force, rate]) = &mut self.state {
            // A missing force leaves the state unchanged, because the leader extrapolates by age.
            if let Some(measured) = force_n {
                let foretold = extrapolated(*force, *rate, self.period_s);
                let innovation = measured - foretold;
                *force = (foretold + innovation * self.gain[0]).settled();
                *rate = (*rate * self.lasting + innovation * self.gain[1]).settled();
            }
        } else {
            self.state = force_n.map(|force| [force, Lanes::ZERO]);
        }
        self.state.map_or(BaselineModel::Nothing, |[force_n, rate_n_s]| BaselineModel::Trend { force_n, rate_n_s })
    }

    fn reset(&mut self) {
        self.state = None;
    }
}

/// Returns the steady-state gain for force and rate (1, 1/s). It is computed in periods, so that all numbers are near
/// one.
fn gain(rate_hz: f64) -> [f64; 2] {
    let tau = LASTING_S * rate_hz;
    let bandwidth_hz = BANDWIDTH_HZ.min(0.1 * rate_hz);
    let way = -tau * libm::expm1(-1.0 / tau);
    let lasting = libm::exp(-1.0 / tau);
    let step = std::f64::consts::TAU * bandwidth_hz / rate_hz;
    let q = step * step * (step * step);
    // Covariances of the force, of force and rate, and of the rate; the measurement's is one.
    let mut ff = 1.0;
    let mut fr = 0.0;
    let mut rr = 1.0;
    let mut gain = [1.0, 0.0];
    for _ in 0..20_000 {
        let ahead_ff = ff + way * (2.0 * fr + way * rr) + q / 3.0;
        let ahead_fr = lasting * (fr + way * rr) + q / 2.0;
        let ahead_rr = lasting * lasting * rr + q;
        gain = [ahead_ff / (ahead_ff + 1.0), ahead_fr / (ahead_ff + 1.0)];
        ff = (1.0 - gain[0]) * ahead_ff;
        fr = (1.0 - gain[0]) * ahead_fr;
        rr = ahead_rr - gain[1] * ahead_fr;
    }
    [gain[0], gain[1] * rate_hz]
}
