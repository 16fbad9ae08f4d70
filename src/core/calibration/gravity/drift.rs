//! Checks after every start whether a saved calibration is still valid, from the remaining force at rest. A state
//! machine without a clock.
//!
//! Takes every sample of the wrist sensor with the time (s) and whether the loop is idle; returns a [`GravityDrift`]. It waits
//! for two seconds; then the first still interval decides. While nothing touches the tool, the force without gravity
//! and bias is zero. A bias does not change within seconds, but the force of a hand does, so a bad verdict needs three
//! times as long an interval as a good one. An object that rests motionless on the tool cannot be distinguished from a
//! changed bias: the message of a bad verdict says so, and a later good interval revokes the verdict. Once the loop has
//! been engaged, the check ends, because the tool may touch tissue.

use super::{
    GravityModel,
    still::{StillInterval, StillSettings},
};
use crate::frames::WristSample;

/// Time that the filters of sensor and driver need to settle after a start, s. Otherwise every start would report the
/// filters' transient as a drift.
const SETTLE_S: f64 = 2.0;
/// A bad verdict needs this many consecutive still intervals: a hand on the tool sways, whereas a bias does not
/// (`docs/results/calibration.md`).
const STRETCHES_FOR_BAD: f64 = 3.0;
/// If there is no verdict after this time, the check reports the reason, s; a later still interval may still give a
/// verdict.
const TIMEOUT_S: f64 = 7.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotChecked {
    /// The sensor or the source of orientation is silent, or a number is not finite.
    NoSample,
    Moving,
    /// The tool does not turn, but the force is not constant.
    Touched,
    /// The body wall touches the instrument.
    InTrocar,
    Engaged,
}

/// Result of the check since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GravityDrift {
    Waiting,
    NotChecked(NotChecked),
    Fine {
        by_n: f64,
    },
    /// The bias has changed, unless something rests on the tool.
    Moved {
        by_n: f64,
    },
}

/// Compares the force remaining at rest with zero. Steps allocate nothing.
#[derive(Clone, Debug)]
pub struct DriftCheck {
    model: GravityModel,
    limit_n: f64,
    still: StillInterval,
    began_s: Option<f64>,
    newest: Option<WristSample>,
    fresh_s: f64,
    drift: GravityDrift,
}

impl DriftCheck {
    /// Starts a check of this model with a limit (N).
    pub fn new(model: GravityModel, limit_n: f64, still: StillSettings) -> Self {
        let still = StillInterval::new(still);
        Self {
            model,
            limit_n,
            still,
            began_s: None,
            newest: None,
            fresh_s: f64::NEG_INFINITY,
            drift: GravityDrift::Waiting,
        }
    }

    pub const fn drift(&self) -> GravityDrift {
        self.drift
    }

    /// Adds a sample (`None` while the sensor is silent) at time `t_s` (s, increasing); returns the current result.
    pub fn step(&mut self, sample: Option<&WristSample>, idle: bool, t_s: f64) -> GravityDrift {
        // A good verdict is final: from then on the tool may touch things.
        if matches!(self.drift, GravityDrift::Fine { .. } | GravityDrift::NotChecked(NotChecked::Engaged))
            || !t_s.is_finite()
        {
            return self.drift;
        }
        let since_s = t_s - *self.began_s.get_or_insert(t_s);
        if !idle {
            // Keep an existing verdict; without one, the check ends here.
            self.give_up(NotChecked::Engaged);
            self.still.reset();
            return self.drift;
        }
        // A frozen sensor repeats its last sample, which would look like rest.
        if sample.is_some() && self.newest.as_ref() == sample {
            if since_s > TIMEOUT_S && t_s - self.fresh_s > SETTLE_S {
                self.give_up(NotChecked::NoSample);
            }
            return self.drift;
        }
        self.newest = sample.copied();
        self.fresh_s = t_s;
        self.examine(sample, since_s, t_s);
        self.drift
    }

    /// Examines a new sample, this long after the check began (s).
    fn examine(&mut self, sample: Option<&WristSample>, since_s: f64, t_s: f64) {
        let field = sample.filter(|sample| sample.is_finite()).and_then(|sample| self.model.field_m_s2(sample));
        let late = since_s > TIMEOUT_S;
        match (sample, field) {
            // In the trocar the body wall holds the tool, so its force is not a bias.
            (Some(sample), Some(_)) if sample.insertion_m.is_some_and(|depth_m| depth_m > 0.0) => {
                self.still.reset();
                self.give_up(NotChecked::InTrocar);
            }
            (Some(sample), Some(field)) if since_s >= SETTLE_S => match self.still.step(sample, &field, t_s) {
                Some(fraction) if fraction >= 1.0 => self.judge(fraction),
                None if late && self.still.only_force_moved() => self.give_up(NotChecked::Touched),
                None if late => self.give_up(NotChecked::Moving),
                _ => {}
            },
            (Some(_), Some(_)) => {}
            _ => {
                self.still.reset();
                if late {
                    self.give_up(NotChecked::NoSample);
                }
            }
        }
    }

    /// Evaluates an interval of this multiple of the still time.
    fn judge(&mut self, fraction: f64) {
        let Some((wrench, field)) = self.still.mean() else { return };
        let by_n = (wrench.force_n - self.model.predict(&field).force_n).norm();
        // One still interval is enough for a good verdict; a bad one needs `STRETCHES_FOR_BAD`.
        if by_n <= self.limit_n {
            self.drift = GravityDrift::Fine { by_n };
        } else if fraction >= STRETCHES_FOR_BAD {
            self.drift = GravityDrift::Moved { by_n };
            // The next verdict needs a new interval.
            self.still.reset();
        }
    }

    fn give_up(&mut self, why: NotChecked) {
        // A verdict is never replaced by the reason for a missing one.
        if matches!(self.drift, GravityDrift::Waiting | GravityDrift::NotChecked(_)) {
            self.drift = GravityDrift::NotChecked(why);
        }
    }
}
