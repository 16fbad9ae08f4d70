//! Published methods for comparison: each in its published form, as one more mode behind the same gates.
//!
//! At most one is computed, and only if it is requested by name; [`Follower`] creates the data for the link, [`Leader`]
//! computes the force. Every axis is treated as a separate channel, as in the publications, which have one degree of
//! freedom. Sources, constants, results and omissions: docs/modes.md.

mod autoregressive;
mod kalman;
mod model_mediated;
mod passivity;
mod rls;
#[cfg(test)]
mod tests;
mod waves;

pub use model_mediated::Contact;
pub use waves::Wave;

use self::{
    autoregressive::Autoregressive,
    kalman::Kalman,
    model_mediated::ModelMediated,
    passivity::{Controller, Returned},
    waves::Waves,
};
use super::{
    Baseline,
    features::Scales,
    messages::{Parcel, Posture, Report},
    method::{self, Seen},
    settings::{ModeSet, Settings},
};
use crate::signal::{Lanes, Motion};

/// Data that a baseline sends in addition to the force: plain numbers, fixed size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "it crosses the link by value, in a packet of fixed size")]
pub enum BaselineModel {
    /// No baseline is computed, or it has no data yet.
    Nothing,
    Contact(Contact),
    Wave(Wave),
    /// Time-domain passivity: the energy that the tissue has returned so far (J).
    Returned {
        /// One value per axis, never decreasing.
        energy_j: Lanes,
    },
    /// Kalman: the filtered force and its rate, which the leader extrapolates.
    Trend {
        force_n: Lanes,
        rate_n_s: Lanes,
    },
    /// Autoregressive: the force predicted for one delay later.
    Forecast {
        force_n: Lanes,
    },
}

#[derive(Clone, Debug)]
pub(super) struct Follower {
    scales: Scales,
    method: Method,
}

#[derive(Clone, Debug)]
enum Method {
    ModelMediated(Box<ModelMediated>),
    Waves(Waves),
    Passivity(Returned),
    Kalman(Kalman),
    Autoregressive(Box<Autoregressive>),
}

impl Follower {
    fn new(baseline: Baseline, settings: &Settings, delay_ticks: usize) -> Self {
        let rate_hz = settings.rate_hz;
        let method = match baseline {
            Baseline::ModelMediated => Method::ModelMediated(Box::new(ModelMediated::new(rate_hz))),
            Baseline::Waves => Method::Waves(Waves::new(rate_hz)),
            Baseline::Passivity => Method::Passivity(Returned::new(rate_hz)),
            Baseline::Kalman => Method::Kalman(Kalman::new(rate_hz)),
            Baseline::Autoregressive => Method::Autoregressive(Box::new(Autoregressive::new(rate_hz, delay_ticks))),
        };
        Self { scales: settings.scales, method }
    }

    /// Adds the follower's newest motion and force (N), `None` if either was not measured; returns the data to send.
    pub(super) fn step(&mut self, posture: &Posture, force_n: Option<Lanes>) -> BaselineModel {
        let motion = motion(posture, &self.scales);
        match &mut self.method {
            Method::ModelMediated(method) => BaselineModel::Contact(method.step(&motion, force_n)),
            Method::Waves(method) => BaselineModel::Wave(method.step(&motion, force_n)),
            Method::Passivity(method) => BaselineModel::Returned { energy_j: method.step(&motion, force_n) },
            Method::Kalman(method) => method.step(force_n),
            Method::Autoregressive(method) => method.step(force_n),
        }
    }

    pub(super) fn set_delay(&mut self, delay_ticks: usize) {
        if let Method::Autoregressive(method) = &mut self.method {
            method.set_delay(delay_ticks);
        }
    }

    pub(super) fn reset(&mut self) {
        match &mut self.method {
            Method::ModelMediated(method) => method.reset(),
            Method::Waves(method) => method.reset(),
            Method::Passivity(method) => method.reset(),
            Method::Kalman(method) => method.reset(),
            Method::Autoregressive(method) => method.reset(),
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Leader {
    scales: Scales,
    period_s: f64,
    controller: Controller,
}

impl Leader {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            scales: settings.scales,
            period_s: settings.rate_hz.recip(),
            controller: Controller::new(settings.rate_hz),
        }
    }

    /// Returns the force (N) of this tick from the received model, whose force is `measured_n` and whose age is
    /// `age_ticks`, and from the leader's own motion; `None` without a model or if the force is not finite.
    pub(super) fn step(
        &mut self,
        model: &BaselineModel,
        measured_n: Lanes,
        now: &Posture,
        age_ticks: usize,
    ) -> Option<Lanes> {
        let motion = motion(now, &self.scales);
        let force = match model {
            BaselineModel::Nothing => return None,
            BaselineModel::Contact(contact) => contact.force(&motion),
            BaselineModel::Wave(wave) => wave.force(&motion),
            BaselineModel::Returned { energy_j } => self.controller.step(measured_n, *energy_j, &motion),
            BaselineModel::Trend { force_n, rate_n_s } => {
                kalman::extrapolated(*force_n, *rate_n_s, age_ticks as f64 * self.period_s)
            }
            BaselineModel::Forecast { force_n } => *force_n,
        };
        force.is_finite().then_some(force)
    }

    pub(super) fn reset(&mut self) {
        self.controller.reset();
    }
}

/// Both ends of a baseline: the sender, and a leader that makes the follower's own motion.
#[derive(Clone, Debug)]
pub(super) struct Ends {
    follower: Follower,
    pub(super) leader: Leader,
}

impl Ends {
    pub(super) fn new(baseline: Baseline, settings: &Settings, delay_ticks: usize) -> Self {
        Self { follower: Follower::new(baseline, settings, delay_ticks), leader: Leader::new(settings) }
    }
}

impl method::Method for Ends {
    fn serves(&self, modes: ModeSet) -> bool {
        modes.baseline().is_some()
    }

    fn begins(&self, before: ModeSet, now: ModeSet) -> bool {
        now.baseline() != before.baseline()
    }

    fn take(&mut self, seen: &Seen<'_>, parcel: &mut Parcel, _report: &mut Report) {
        parcel.baseline = self.follower.step(seen.posture, seen.good.then_some(seen.force_n));
    }

    fn set_delay(&mut self, delay_ticks: usize) {
        self.follower.set_delay(delay_ticks);
    }

    fn reset(&mut self) {
        self.follower.reset();
        self.leader.reset();
    }
}

/// Returns position (m), velocity (m/s) and acceleration (m/s^2) of a posture.
fn motion(posture: &Posture, scales: &Scales) -> Motion {
    Motion {
        x: posture.stance.x,
        v: posture.features[1] * scales.velocity_m_s,
        a: posture.features[2] * scales.acceleration_m_s2,
    }
}

/// Returns `exp(-1 / memory)`: the fraction that a memory of this length (s) keeps over one tick.
fn kept(memory_s: f64, rate_hz: f64) -> f64 {
    libm::exp(-1.0 / (memory_s * rate_hz))
}
