//! Extrapolation by a Kalman filter of the force and its rate.
//!
//! The rate of the force is driven by white noise and decays with a time constant `tau`, like the acceleration of a
//! target in Singer ("Estimating optimal tracking filter performance for manned maneuvering targets", IEEE Trans.
//! Aerospace and Electronic Systems 6, 1970), but one derivative lower, because a force has no inertia. Over a time `t`
//! the state changes by `f + f' tau (1 - e^(-t/tau))`, `f' e^(-t/tau)`; an infinite `tau` would be the constant-rate
//! filter of the textbooks, which overshoots by the whole rate times the delay. The gain is the fixed point of the
//! Riccati equation; the leader extrapolates over the packet's age. Time constant and bandwidth depend on the delay: over
//! a long delay the rate says nothing, and the mean of the last periods is a better prediction than the newest force.

use nima_core::{
    impedance::{Baseline, BaselineModel},
    signal::{Lanes, Motion},
};

use crate::BaselineSender;

#[derive(Clone, Copy, Debug)]
pub(crate) struct KalmanTuning {
    /// Time constant of the rate (s).
    lasting_s: f64,
    /// `w^4` is the spectral density of the noise divided by that of the measurement (Hz).
    bandwidth_hz: f64,
}

/// Tunings for delays up to 20 and 250 ms, and beyond (chosen on recordings, see docs/modes.md).
const TUNINGS: [KalmanTuning; 3] = [
    KalmanTuning { lasting_s: 0.01, bandwidth_hz: 100.0 },
    KalmanTuning { lasting_s: 0.005, bandwidth_hz: 100.0 },
    KalmanTuning { lasting_s: 0.015, bandwidth_hz: 3.0 },
];
const MAX_DELAYS_S: [f64; 2] = [0.02, 0.25];
/// The tuning of sessions with an earlier journal, at every delay.
const EARLIER: usize = 1;

fn place(delay_s: f64, earlier_forces: bool) -> usize {
    if earlier_forces { EARLIER } else { MAX_DELAYS_S.iter().filter(|max_s| delay_s > **max_s).count() }
}

impl KalmanTuning {
    pub(crate) fn of(delay_s: f64, earlier_forces: bool) -> Self {
        TUNINGS[place(delay_s, earlier_forces)]
    }

    /// Returns the force that a state leads to after a time.
    pub(crate) fn extrapolated(&self, force_n: Lanes, rate_n_s: Lanes, age_s: f64) -> Lanes {
        force_n - rate_n_s * (self.lasting_s * libm::expm1(-age_s / self.lasting_s))
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Kalman {
    period_s: f64,
    /// Gains of all tunings; computing them takes too long for a running loop.
    gains: [[f64; 2]; TUNINGS.len()],
    earlier_forces: bool,
    place: usize,
    state: Option<[Lanes; 2]>,
}

impl BaselineSender for Kalman {
    const BASELINE: Baseline = Baseline::Kalman;

    fn new(rate_hz: f64, delay_ticks: usize) -> Self {
        let gains = TUNINGS.map(|tuning| gain(rate_hz, &tuning));
        let mut kalman = Self { period_s: rate_hz.recip(), gains, earlier_forces: false, place: 0, state: None };
        kalman.set_delay(delay_ticks);
        kalman
    }

    fn earlier(self) -> Self {
        Self { earlier_forces: true, place: EARLIER, ..self }
    }

    fn set_delay(&mut self, delay_ticks: usize) {
        self.place = place(delay_ticks as f64 * self.period_s, self.earlier_forces);
    }

    fn step(&mut self, _motion: &Motion, force_n: Option<Lanes>) -> BaselineModel {
        let tuning = &TUNINGS[self.place];
        let gain = self.gains[self.place];
        if let Some([force, rate]) = &mut self.state {
            // A missing force leaves the state unchanged, because the leader extrapolates by age.
            if let Some(measured) = force_n {
                let foretold = tuning.extrapolated(*force, *rate, self.period_s);
                let innovation = measured - foretold;
                *force = (foretold + innovation * gain[0]).settled();
                let lasting = libm::exp(-self.period_s / tuning.lasting_s);
                *rate = (*rate * lasting + innovation * gain[1]).settled();
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
fn gain(rate_hz: f64, tuning: &KalmanTuning) -> [f64; 2] {
    let tau = tuning.lasting_s * rate_hz;
    let bandwidth_hz = tuning.bandwidth_hz.min(0.1 * rate_hz);
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
