//! Computes the force at the tip from the wrist sensor: one step per tick, without allocation.
//!
//! First `gravity` removes weight and bias; the remainder is the tissue's force plus the trocar's friction, which a
//! trained network removes. All forces are returned in the world frame. If a sample gives no force, [`ForceSource`]
//! contains the reason.

use nima_core::{
    calibration::{
        Verdict,
        gravity::{Compensator, DEFAULT_TIME_CONSTANT_S, GravityModel, GravityRecord},
    },
    frames::WristSample,
    safety::PLAUSIBLE_N,
    tip_force::LiveTipForce,
};

use crate::{
    messages::{ForceReport, ForceSource},
    rig::SensedForce,
};

#[derive(Clone, Debug, Default)]
pub struct Calibrations {
    /// Weight of the tool and bias of the wrist sensor.
    pub gravity: Option<GravityModel>,
    /// Network that removes the trocar's friction.
    pub tip_force: Option<LiveTipForce>,
    /// Quality of the gravity calibration, if known. Only for display: nothing in the loop depends on it.
    pub gravity_check: Option<GravityCheck>,
}

/// Quality of a gravity calibration when it was recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityCheck {
    pub verdict: Verdict,
    /// Whether a person uses it in spite of its verdict.
    pub is_overridden: bool,
    /// Mean error on poses that were not used for the fit, N.
    pub held_out_n: f64,
    pub poses: usize,
}

impl GravityCheck {
    pub fn of(record: &GravityRecord) -> Self {
        let GravityRecord { judgement, residuals, poses, .. } = record;
        Self {
            verdict: judgement.verdict,
            is_overridden: judgement.override_by.is_some(),
            held_out_n: residuals.held_out.mean_mae(),
            poses: *poses,
        }
    }
}

/// The calibrations in the form that is applied to each sample.
#[derive(Clone, Debug, Default)]
pub struct ForcePath {
    /// The connected sensor is unknown, so the calibrations must not be used.
    suspended: bool,
    gravity: Option<Compensator>,
    period_s: f64,
    /// Time of the last sample of the wrist, s.
    last_s: Option<f64>,
    tip_force: Option<LiveTipForce>,
}

impl ForcePath {
    /// Creates the path for a loop of this period (s). All memory is allocated here.
    pub fn new(calibrations: &Calibrations, period_s: f64) -> Self {
        let live = |model| Compensator::new(model, DEFAULT_TIME_CONSTANT_S, period_s);
        Self {
            suspended: false,
            gravity: calibrations.gravity.map(live),
            period_s,
            last_s: None,
            tip_force: calibrations.tip_force.clone(),
        }
    }

    /// Stops computing forces from wrist samples: the sensor was connected or lost, and may be a different one.
    pub const fn suspend(&mut self) {
        self.suspended = true;
    }

    /// Returns whether a force at the tip can be computed from such a sample.
    pub const fn knows(&self, sensed: &SensedForce) -> bool {
        match sensed {
            SensedForce::AtTip(_) => true,
            // After a change of the sensor no calibration is known to belong to it.
            SensedForce::AtWrist(_) => self.gravity.is_some() && !self.suspended,
            SensedForce::FarEnd(identified) => identified.source.is_usable(),
        }
    }

    /// Returns the tip force of this sample, taken at `t_s` (s).
    pub fn step(&mut self, t_s: f64, sensed: &SensedForce) -> ForceReport {
        let report = self.report(t_s, sensed);
        // An impossible force from a plausible sample means that the calibration is wrong, so do not fall back to the
        // last good force.
        // NaN fails the comparison too, so it counts as impossible.
        let possible = report.tip_n.iter().all(|f| f.abs() <= PLAUSIBLE_N);
        if possible || !report.source.is_usable() { report } else { ForceReport::none(ForceSource::Poisoned, None) }
    }

    fn report(&mut self, t_s: f64, sensed: &SensedForce) -> ForceReport {
        match sensed {
            SensedForce::AtTip(tip_n) => ForceReport { tip_n: *tip_n, ..ForceReport::none(ForceSource::AtTip, None) },
            SensedForce::AtWrist(sample) => self.at_wrist(t_s, sample),
            // Already computed at the other machine.
            SensedForce::FarEnd(identified) => ForceReport::of_far_end(identified.source, identified.force_n),
        }
    }

    fn at_wrist(&mut self, t_s: f64, sample: &WristSample) -> ForceReport {
        // Before the calibration is looked up: the sensor itself is unknown.
        if self.suspended {
            return ForceReport::none(ForceSource::Unidentified, None);
        }
        let Some(gravity) = &mut self.gravity else {
            return ForceReport::none(ForceSource::Uncalibrated, None);
        };
        // The low-pass of the compensation runs on time, so missed ticks have to count.
        let dt_s = self.last_s.replace(t_s).map_or(self.period_s, |last_s| (t_s - last_s).max(0.0));
        let gravity_free = gravity.step_after(dt_s, sample);
        // Without the orientation neither weight nor the direction of the force is known.
        let (Some(wrench), Some(world_from_s1)) = (gravity_free, sample.world_from_s1) else {
            return ForceReport::none(ForceSource::NoOrientation, gravity_free);
        };
        let Some(tip_force) = &mut self.tip_force else {
            return ForceReport {
                // Without a network the force at the wrist is used, which includes the friction of the trocar.
                tip_n: world_from_s1 * wrench.force_n,
                ..ForceReport::none(ForceSource::Wrist, gravity_free)
            };
        };
        let report = tip_force.step(t_s, &wrench, sample);
        let fallback = tip_force.fallback_now();
        let source = match report.unsure {
            Some(unsure) => ForceSource::InDoubt { unsure, fallback },
            None if report.extrapolates => ForceSource::Extrapolated,
            None => ForceSource::Network,
        };
        let tip_n = world_from_s1 * report.force_s1_n;
        ForceReport { source, tip_n, gravity_free, tip_force: Some(report) }
    }
}
