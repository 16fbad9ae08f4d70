//! From what the wrist feels to the force at the tip: one step a tick, allocation-free.
//!
//! Weight and bias go first (`gravity`); what is left is the tissue's force plus the trocar's friction, which a trained network
//! takes out. Every force leaves in the workspace frame (`kbf`). A sample from which no force can be told gives none, with the
//! reason in [`ForceSource`].

use nalgebra::Vector3;

use crate::{
    calibration::gravity::{Compensator, DEFAULT_TIME_CONSTANT_S, GravityModel},
    device::Sensed,
    frames::{Wrench, WristSample},
    safety::PLAUSIBLE_N,
    tip_force::{Fallback, TipForce, TipForceReport, Unsure},
};

/// Where the tip force of a tick comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceSource {
    /// Measured at the tip.
    AtTip,
    /// Measured at the wrist, weight and bias taken out; friction in the trocar is still in it.
    Wrist,
    /// Measured at the wrist, weight, bias and friction taken out.
    Network,
    /// The network is not sure: the fallback answers.
    InDoubt {
        /// Why.
        unsure: Unsure,
        /// Which fallback.
        fallback: Fallback,
    },
    /// Measured at the wrist, and no calibration is in force: nothing is rendered from it.
    Uncalibrated,
    /// Calibrated, but the sample lacks the orientation that the calibration needs.
    NoOrientation,
    /// A calibration or the network made an impossible number of a good sample.
    Poisoned,
}

impl ForceSource {
    /// The tip force may be felt by a hand.
    pub const fn is_usable(self) -> bool {
        !matches!(self, Self::Uncalibrated | Self::NoOrientation | Self::Poisoned)
    }

    /// In words, for the screen.
    pub const fn words(self) -> &'static str {
        match self {
            Self::AtTip => "measured at the tip",
            Self::Wrist => "wrist force without weight; trocar friction is still in it",
            Self::Network => "wrist force without weight and trocar friction (network)",
            Self::InDoubt { fallback: Fallback::WristForce, .. } => "network in doubt: the wrist force, with friction",
            Self::InDoubt { fallback: Fallback::HoldAndFade, .. } => "network in doubt: the last sure force fades out",
            Self::Uncalibrated => "unknown: the wrist sensor is not calibrated",
            Self::NoOrientation => "unknown: the orientation of the wrist is missing",
            Self::Poisoned => "unknown: the calibration or the network gives impossible numbers",
        }
    }

    /// Why the network does not answer, where it does not.
    pub const fn doubt(self) -> Option<Unsure> {
        match self {
            Self::InDoubt { unsure, .. } => Some(unsure),
            _ => None,
        }
    }
}

/// What the path made of one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceReport {
    /// Where the tip force comes from.
    pub source: ForceSource,
    /// Force of the tissue on the tip, N, workspace frame (`kbf`); zero when there is no usable one.
    pub tip_n: Vector3<f64>,
    /// What the wrist feels without weight and bias (`s1`), once gravity is calibrated.
    pub gravity_free: Option<Wrench>,
    /// What the network said, where one is in force.
    pub tip_force: Option<TipForceReport>,
}

impl ForceReport {
    /// No force, for this reason.
    pub(super) const fn none(source: ForceSource, gravity_free: Option<Wrench>) -> Self {
        Self { source, tip_n: Vector3::new(0.0, 0.0, 0.0), gravity_free, tip_force: None }
    }
}

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
    gravity: Option<Compensator>,
    tip_force: Option<TipForce>,
}

impl ForcePath {
    /// A path through these calibrations for a loop of this period (s). Everything is allocated here.
    pub fn new(calibrations: &Calibrations, period_s: f64) -> Self {
        let live = |model| Compensator::new(model, DEFAULT_TIME_CONSTANT_S, period_s);
        Self { gravity: calibrations.gravity.map(live), tip_force: calibrations.tip_force.clone() }
    }

    /// The tip force of this sample, taken at this time (s).
    pub fn step(&mut self, t_s: f64, sensed: &Sensed) -> ForceReport {
        let report = self.report(t_s, sensed);
        // Not so on a plausible sample: then it is the calibration, and the last good force must not stand for it.
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
        let Some(gravity) = &mut self.gravity else { return ForceReport::none(ForceSource::Uncalibrated, None) };
        let gravity_free = gravity.step(sample);
        let (Some(wrench), Some(kbf_from_s1)) = (gravity_free, sample.kbf_from_s1) else {
            return ForceReport::none(ForceSource::NoOrientation, gravity_free);
        };
        let Some(tip_force) = &mut self.tip_force else {
            return ForceReport {
                tip_n: kbf_from_s1 * wrench.force_n,
                ..ForceReport::none(ForceSource::Wrist, gravity_free)
            };
        };
        let report = tip_force.step(t_s, &wrench, sample);
        let fallback = tip_force.fallback();
        let source = report.unsure.map_or(ForceSource::Network, |unsure| ForceSource::InDoubt { unsure, fallback });
        let tip_n = kbf_from_s1 * report.force_s1_n;
        ForceReport { source, tip_n, gravity_free, tip_force: Some(report) }
    }
}
