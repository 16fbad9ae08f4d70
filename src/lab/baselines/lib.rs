//! Published methods of others for comparison: each in its published form, as one more mode behind the same gates.
//!
//! They implement the trait of the program's own modes, [`RenderingMethod`]; a program that calls [`provide`] first builds
//! them into its loop. At most one is computed, and only if it is requested by name. Every axis is a separate channel, as
//! in the publications, which have one degree of freedom. Sources, constants, figures and omissions: docs/modes.md.

mod autoregressive;
mod increments;
mod kalman;
mod model_mediated;
mod passivity;
mod rls;
#[cfg(test)]
mod tests;
mod waves;

use std::{fmt::Debug, marker::PhantomData};

use nima_core::{
    impedance::{
        Baseline, BaselineModel, Entry, FollowerEnd, IdentificationReport, ImpedanceSettings, LeaderEnd, LeaderInput,
        LinkPacket, MethodInput, ModeSet, RenderingMethod, Scales, add_baselines,
    },
    signal::{Lanes, Motion},
};

use crate::{
    autoregressive::Autoregressive,
    increments::Increments,
    kalman::{Kalman, KalmanTuning},
    model_mediated::ModelMediated,
    passivity::{PassivityController, ReturnedEnergy},
    waves::Waves,
};

/// Adds the baselines to the modes of this process. Call it before a loop is created or a session replayed; a second
/// call has no effect.
pub fn provide() {
    add_baselines(|baseline| match baseline {
        Baseline::ModelMediated => Entry::of::<BaselineMethod<ModelMediated>>(),
        Baseline::Waves => Entry::of::<BaselineMethod<Waves>>(),
        Baseline::Passivity => Entry::of::<BaselineMethod<ReturnedEnergy>>(),
        Baseline::Kalman => Entry::of::<BaselineMethod<Kalman>>(),
        Baseline::Autoregressive => Entry::of::<BaselineMethod<Autoregressive>>(),
        Baseline::Increments => Entry::of::<BaselineMethod<Increments>>(),
    });
}

/// The part of a baseline on the follower.
trait BaselineSender: Clone + Debug + Send + Sync + 'static {
    /// Name of the baseline.
    const BASELINE: Baseline;

    fn new(rate_hz: f64, delay_ticks: usize) -> Self;

    /// Computes as in sessions with an earlier journal ([`ImpedanceSettings::earlier_forces`]).
    fn earlier(self) -> Self {
        self
    }

    /// Takes the follower's newest motion and force (N; `None` if not measured); returns the data to send.
    fn step(&mut self, motion: &Motion, force_n: Option<Lanes>) -> BaselineModel;

    /// Predicts over another delay from now on.
    fn set_delay(&mut self, _delay_ticks: usize) {}

    fn reset(&mut self);
}

/// A baseline as a mode.
struct BaselineMethod<S>(PhantomData<S>);

impl<S: BaselineSender> RenderingMethod for BaselineMethod<S> {
    const NAME: &'static str = S::BASELINE.name();
    const ABOUT: &'static str = "a method of others";

    fn follower(settings: &ImpedanceSettings, delay_ticks: usize) -> Option<Box<dyn FollowerEnd>> {
        let sender = S::new(settings.rate_hz, delay_ticks);
        let sender = if settings.earlier_forces { sender.earlier() } else { sender };
        Some(Box::new(BaselineFollower { scales: settings.scales, sender }))
    }

    fn leader(settings: &ImpedanceSettings) -> Box<dyn LeaderEnd> {
        Box::new(BaselineLeader {
            scales: settings.scales,
            period_s: settings.rate_hz.recip(),
            earlier_forces: settings.earlier_forces,
            controller: PassivityController::new(settings.rate_hz),
        })
    }
}

/// The follower's part.
#[derive(Clone, Debug)]
struct BaselineFollower<S> {
    scales: Scales,
    sender: S,
}

impl<S: BaselineSender> FollowerEnd for BaselineFollower<S> {
    /// There is memory for only one of the baselines.
    fn serves(&self, modes: ModeSet) -> bool {
        modes.baseline().is_some()
    }

    fn begins(&self, before: ModeSet, now: ModeSet) -> bool {
        now.baseline() != before.baseline()
    }

    fn take(&mut self, seen: &MethodInput<'_>, parcel: &mut LinkPacket, _report: &mut IdentificationReport) {
        let motion = seen.posture.motion(&self.scales);
        parcel.models.baseline = self.sender.step(&motion, seen.good.then_some(seen.force_n));
    }

    fn set_delay(&mut self, delay_ticks: usize) {
        self.sender.set_delay(delay_ticks);
    }

    fn reset(&mut self) {
        self.sender.reset();
    }
}

/// The leader's part, the same for all baselines: the received data determine the computation.
#[derive(Clone, Debug)]
struct BaselineLeader {
    scales: Scales,
    period_s: f64,
    earlier_forces: bool,
    controller: PassivityController,
}

impl LeaderEnd for BaselineLeader {
    fn render(&mut self, moment: &LeaderInput<'_>) -> Option<Lanes> {
        moment.parcel.modes.baseline()?;
        let own = moment.now.motion(&self.scales);
        let force = match &moment.parcel.models.baseline {
            BaselineModel::Nothing => return None,
            BaselineModel::Contact(contact) => model_mediated::force(contact, &own),
            BaselineModel::Wave(wave) => waves::decoded(wave, &own),
            BaselineModel::Returned { energy_j } => self.controller.step(moment.measured_n, *energy_j, &own),
            BaselineModel::Trend { force_n, rate_n_s } => {
                let age_s = moment.age_ticks as f64 * self.period_s;
                KalmanTuning::of(age_s, self.earlier_forces).extrapolated(*force_n, *rate_n_s, age_s)
            }
            BaselineModel::Forecast { force_n } => *force_n,
            BaselineModel::Increments(increments) => {
                increments::force(increments, moment.measured_n, &moment.then.motion(&self.scales), &own)
            }
        };
        force.is_finite().then_some(force)
    }

    fn compute(&mut self, before: ModeSet, now: ModeSet) {
        if now.baseline() != before.baseline() {
            self.reset();
        }
    }

    fn reset(&mut self) {
        self.controller.reset();
    }
}

/// Returns `exp(-1 / memory)`: the fraction that a memory of this length (s) keeps over one tick.
fn kept(memory_s: f64, rate_hz: f64) -> f64 {
    libm::exp(-1.0 / (memory_s * rate_hz))
}
