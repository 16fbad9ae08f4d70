//! From what the wrist feels to the force at the tip: one step a tick, allocation-free.
//!
//! Weight and bias go first (`gravity`); what is left is the tissue's force plus the trocar's friction, which a trained network
//! takes out. Every force leaves in the world frame. A sample from which no force can be told gives none, with the
//! reason in [`ForceSource`].

use nima_core::{
    calibration::gravity::{Compensator, DEFAULT_TIME_CONSTANT_S, GravityModel},
    frames::WristSample,
    safety::PLAUSIBLE_N,
    tip_force::TipForce,
};

use crate::{
    messages::{ForceReport, ForceSource},
    rig::Sensed,
};

/// The calibrations in force.
#[derive(Clone, Debug, Default)]
pub struct Calibrations {
    /// Weight of the tool and bias of the wrist sensor.
    pub gravity: Option<GravityModel>,
    /// The network against the trocar's friction.
    pub tip_force: Option<TipForce>,
}

/// The chain of calibrations at work.
#[derive(Clone, Debug, Default)]
pub struct ForcePath {
    /// Which sensor is there is not known: its calibrations count for nothing.
    suspended: bool,
    gravity: Option<Compensator>,
    tip_force: Option<TipForce>,
}

impl ForcePath {
    /// A path through these calibrations for a loop of this period (s). Everything is allocated here.
    pub fn new(calibrations: &Calibrations, period_s: f64) -> Self {
        let live = |model| Compensator::new(model, DEFAULT_TIME_CONSTANT_S, period_s);
        Self { suspended: false, gravity: calibrations.gravity.map(live), tip_force: calibrations.tip_force.clone() }
    }

    /// From now on no force is told from what a wrist feels: the sensor came or went, and may be another one now.
    pub const fn suspend(&mut self) {
        self.suspended = true;
    }

    /// A force at the tip can be told from such a sample.
    pub const fn knows(&self, sensed: &Sensed) -> bool {
        matches!(sensed, Sensed::AtTip(_)) || (self.gravity.is_some() && !self.suspended)
    }

    /// The tip force of this sample, taken at this time (s).
    pub fn step(&mut self, t_s: f64, sensed: &Sensed) -> ForceReport {
        let report = self.report(t_s, sensed);
        // An impossible force from a plausible sample means a wrong calibration. Do not fall back on the last good force then.
        let possible = report.tip_n.iter().all(|f| f.abs() <= PLAUSIBLE_N);
        if possible { report } else { ForceReport::none(ForceSource::Poisoned, None) }
    }

    fn report(&mut self, t_s: f64, sensed: &Sensed) -> ForceReport {
        match sensed {
            Sensed::AtTip(tip_n) => ForceReport { tip_n: *tip_n, ..ForceReport::none(ForceSource::AtTip, None) },
            Sensed::AtWrist(sample) => self.at_wrist(t_s, sample),
        }
    }

    fn at_wrist(&mut self, t_s: f64, sample: &WristSample) -> ForceReport {
        let Some(gravity) = self.gravity.as_mut().filter(|_| !self.suspended) else {
            return ForceReport::none(ForceSource::Uncalibrated, None);
        };
        let gravity_free = gravity.step(sample);
        let (Some(wrench), Some(world_from_s1)) = (gravity_free, sample.world_from_s1) else {
            return ForceReport::none(ForceSource::NoOrientation, gravity_free);
        };
        let Some(tip_force) = &mut self.tip_force else {
            return ForceReport {
                tip_n: world_from_s1 * wrench.force_n,
                ..ForceReport::none(ForceSource::Wrist, gravity_free)
            };
        };
        let report = tip_force.step(t_s, &wrench, sample);
        let fallback = tip_force.fallback();
        let source = report.unsure.map_or(ForceSource::Network, |unsure| ForceSource::InDoubt { unsure, fallback });
        let tip_n = world_from_s1 * report.force_s1_n;
        ForceReport { source, tip_n, gravity_free, tip_force: Some(report) }
    }
}
