//! Whether a saved calibration still holds: the force left at rest, looked at after every start. A state machine without a clock.
//!
//! Takes every sample of the wrist sensor with the time (s) and whether the loop is idle; gives a [`Drift`]. For two seconds it
//! waits, then the first stretch that is still decides. While nothing touches the tool, what gravity and bias leave is zero. A
//! bias does not change within seconds and a hand on the tool does: a bad verdict takes three times the stretch of a good one.
//! What rests on the tool perfectly still cannot be told from a bias that moved, so a bad verdict asks for it first, and is
//! taken back by a later good stretch. Once the loop was engaged nothing is judged any more: the tool may touch tissue.

use super::{
    GravityModel,
    still::{Still, StillSettings},
};
use crate::frames::WristSample;

/// After a start the filters of sensor and driver settle, s.
const SETTLE_S: f64 = 2.0;
/// A bad verdict takes this many stretches on end.
const STRETCHES_FOR_BAD: f64 = 3.0;
/// Without a verdict by then the check is given up, until a still stretch comes, s.
const TIMEOUT_S: f64 = 7.0;

/// Why a calibration was not checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotChecked {
    /// The sensor or the source of orientation is silent, or a number is not finite.
    NoSample,
    /// The tool turns.
    Moving,
    /// The tool does not turn, and yet the force is not still.
    Touched,
    /// The body wall touches the instrument.
    InTrocar,
    /// The loop was engaged before there was a verdict.
    Engaged,
}

/// How a saved calibration stands since the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drift {
    /// Not looked at for long enough yet.
    Waiting,
    /// Nothing can be said.
    NotChecked(NotChecked),
    /// The bias is where it was.
    Fine {
        /// Force left at rest, N.
        by_n: f64,
    },
    /// The bias is not where it was, unless something rests on the tool.
    Moved {
        /// Force left at rest, N.
        by_n: f64,
    },
}

/// Compares the force left at rest with zero. Steps allocate nothing.
#[derive(Clone, Debug)]
pub struct DriftCheck {
    model: GravityModel,
    limit_n: f64,
    still: Still,
    began_s: Option<f64>,
    newest: Option<WristSample>,
    fresh_s: f64,
    drift: Drift,
}

impl DriftCheck {
    /// A check of this model with a limit (N), from the first sample on.
    pub fn new(model: GravityModel, limit_n: f64, still: StillSettings) -> Self {
        let still = Still::new(still);
        Self { model, limit_n, still, began_s: None, newest: None, fresh_s: f64::NEG_INFINITY, drift: Drift::Waiting }
    }

    /// How the calibration stands.
    pub const fn drift(&self) -> Drift {
        self.drift
    }

    /// Takes a sample, `None` while the sensor is silent, at time `t_s` (s, rising); says how the calibration stands.
    pub fn step(&mut self, sample: Option<&WristSample>, idle: bool, t_s: f64) -> Drift {
        if matches!(self.drift, Drift::Fine { .. } | Drift::NotChecked(NotChecked::Engaged)) || !t_s.is_finite() {
            return self.drift;
        }
        let since_s = t_s - *self.began_s.get_or_insert(t_s);
        if !idle {
            // A verdict stays; what has none gets none any more.
            self.give_up(NotChecked::Engaged);
            self.still.reset();
            return self.drift;
        }
        // A sensor that hangs repeats itself, and would look still.
        if sample.is_some() && self.newest.as_ref() == sample {
            if since_s > TIMEOUT_S && t_s - self.fresh_s > SETTLE_S {
                self.give_up(NotChecked::NoSample);
            }
            return self.drift;
        }
        (self.newest, self.fresh_s) = (sample.copied(), t_s);
        let field = sample.filter(|sample| sample.is_finite()).and_then(|sample| self.model.field_m_s2(sample));
        let late = since_s > TIMEOUT_S;
        match (sample, field) {
            (Some(sample), Some(_)) if sample.insertion_m.is_some_and(|depth_m| depth_m > 0.0) => {
                self.still.reset();
                self.give_up(NotChecked::InTrocar);
            }
            (Some(sample), Some(field)) if since_s >= SETTLE_S => match self.still.step(sample, &field, t_s) {
                Some(share) if share >= 1.0 => self.judge(share),
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
        self.drift
    }

    /// Judges a stretch of this many times the still time.
    fn judge(&mut self, share: f64) {
        let Some((wrench, field)) = self.still.mean() else { return };
        let by_n = (wrench.force_n - self.model.predict(&field).force_n).norm();
        if by_n <= self.limit_n {
            self.drift = Drift::Fine { by_n };
        } else if share >= STRETCHES_FOR_BAD {
            self.drift = Drift::Moved { by_n };
            // The next verdict takes a stretch of its own.
            self.still.reset();
        }
    }

    fn give_up(&mut self, why: NotChecked) {
        if matches!(self.drift, Drift::Waiting | Drift::NotChecked(_)) {
            self.drift = Drift::NotChecked(why);
        }
    }
}
