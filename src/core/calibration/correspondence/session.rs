//! Guided recording of pushes from live samples: a state machine without a clock or a screen.
//!
//! Takes the gravity-free force at the wrist (N, `s1`), the [`WristSample`] and the time (s); detects pushes by their
//! force, stores for each the mean over its stillest interval near the peak, requests the next direction, and fits
//! live. A push that is too short, not steady, or measured by one sensor only is refused with its reason and can be
//! repeated. Samples that are not finite or lack a source pause the session. Memory is bounded and allocated at the
//! start.

use nalgebra::{UnitQuaternion, Vector3};

use super::{
    CorrespondenceError, CorrespondenceOptions, CorrespondenceReport, PushPair, fit,
    interval::{IntervalReading, SlidingInterval},
};
use crate::frames::WristSample;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrespondenceSessionSettings {
    /// A push begins above this force at the wrist, N.
    pub begin_n: f64,
    /// A push ends below this force, N; also the largest reading of a sensor without contact.
    pub end_n: f64,
    /// Length of the interval that is averaged, s; shorter pushes are refused.
    pub stretch_s: f64,
    /// Maximum variation of the force within that interval (standard deviation of the worst axis of either sensor), N.
    pub still_n: f64,
    /// Time for which both sensors must be at rest before the first push, s.
    pub rest_s: f64,
    /// Whether the chain comes from the tracker; without it the result is `s1_from_s2`, valid for one orientation of
    /// the wrist only.
    pub chain: bool,
    pub options: CorrespondenceOptions,
}

impl Default for CorrespondenceSessionSettings {
    fn default() -> Self {
        Self {
            // A push begins well above its end, so that noise does not start and end it several times.
            begin_n: 0.8,
            end_n: 0.3,
            // A tenth of a second: an arm can hold still for that long, and noise averages over 100 samples at 1 kHz.
            stretch_s: 0.1,
            still_n: 0.3,
            rest_s: 0.5,
            chain: true,
            options: CorrespondenceOptions::default(),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingInput {
    /// The gravity-free force at the wrist: the sensor is silent or gravity is not calibrated.
    WristForce,
    TissueForce,
    /// A rotation in the chain between the frames, which the arm or the tracker measures.
    Chain,
    /// A number is not finite, or the time does not increase.
    Sense,
}

/// Reason why a push was not stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PushRefusal {
    TooShort,
    /// The force was not steady.
    Moved {
        /// Standard deviation of the stillest interval, N.
        by_n: f64,
    },
    MissedTissue,
    Full,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CorrespondencePhase {
    Missing(MissingInput),
    /// Waiting for both sensors to be at rest without contact, before the first push.
    Resting {
        fraction: f64,
        /// Reading of the wrist sensor, N; if it stays above the limit, the sensor must be zeroed.
        f1_n: f64,
        /// Reading of the sensor under the tissue, N.
        f2_n: f64,
    },
    Ready,
    Pushing {
        force_n: f64,
        /// The interval is long and steady enough: the push may end.
        enough: bool,
    },
    /// The push that just ended was stored with this index.
    Recorded(usize),
    Refused(PushRefusal),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PushTarget {
    pub name: &'static str,
    /// Direction in which the tool pushes, unit vector (`world`: x away from the base, y left, z up).
    pub push_in_world: Vector3<f64>,
}

const S: f64 = std::f64::consts::FRAC_1_SQRT_2;

const fn target(name: &'static str, x: f64, y: f64, z: f64) -> PushTarget {
    PushTarget { name, push_in_world: Vector3::new(x, y, z) }
}

/// The requested pushes, in this order: directions in which a tool can push on tissue below it.
pub const TARGETS: [PushTarget; 9] = [
    target("down", 0.0, 0.0, -1.0),
    target("left", 0.0, 1.0, 0.0),
    target("right", 0.0, -1.0, 0.0),
    target("away from the base", 1.0, 0.0, 0.0),
    target("towards the base", -1.0, 0.0, 0.0),
    target("down and left", 0.0, S, -S),
    target("down and right", 0.0, -S, -S),
    target("down and away", S, 0.0, -S),
    target("down and towards the base", -S, 0.0, -S),
];

/// Cosine of the angle within which a push counts for a target: 30 degrees. A person cannot push more precisely than
/// that, and nine targets cover all directions of a push even so.
const NEAR_TARGET: f64 = 0.866;
/// More would hardly improve the result, and the session keeps every push in memory.
const MAX_PUSHES: usize = 64;

#[derive(Clone, Copy, Debug)]
struct CorrespondencePush {
    pair: PushPair,
    /// Direction of the push (unit, `world`); `None` without the arm's kinematics.
    towards_in_world: Option<Vector3<f64>>,
}

/// A guided session. [`step`](Self::step) allocates nothing.
#[derive(Clone, Debug)]
pub struct CorrespondenceSession {
    settings: CorrespondenceSessionSettings,
    pushes: Vec<CorrespondencePush>,
    stretch: SlidingInterval,
    phase: CorrespondencePhase,
    last_t_s: f64,
    rested_s: f64,
    world_from_s1: Option<UnitQuaternion<f64>>,
}

impl CorrespondenceSession {
    pub fn new(settings: CorrespondenceSessionSettings) -> Self {
        Self {
            settings,
            pushes: Vec::with_capacity(MAX_PUSHES),
            stretch: SlidingInterval::new(settings.stretch_s),
            phase: CorrespondencePhase::Resting { fraction: 0.0, f1_n: 0.0, f2_n: 0.0 },
            last_t_s: f64::NEG_INFINITY,
            rested_s: 0.0,
            world_from_s1: None,
        }
    }

    /// Adds one sample; returns the state of the session. `Recorded` and `Refused` last until the next push begins.
    pub fn step(&mut self, f1_n: Option<Vector3<f64>>, sample: &WristSample, t_s: f64) -> CorrespondencePhase {
        let reading = match self.reading(f1_n, sample, t_s) {
            Ok(reading) => reading,
            Err(missing) => {
                // The current push is discarded, because a push with a gap is invalid.
                self.stretch.clear();
                self.phase = CorrespondencePhase::Missing(missing);
                return self.phase;
            }
        };
        let gap_s = t_s - self.last_t_s;
        self.last_t_s = t_s;
        self.phase = match self.phase {
            CorrespondencePhase::Pushing { .. } => self.push_on(&reading, sample),
            _ if self.rested_s < self.settings.rest_s => self.rest(&reading, gap_s),
            CorrespondencePhase::Missing(_) | CorrespondencePhase::Resting { .. }
                if reading.f1_n.norm() > self.settings.end_n =>
            {
                // A push is not used if its start was missed.
                CorrespondencePhase::Resting { fraction: 1.0, f1_n: reading.f1_n.norm(), f2_n: reading.f2_n.norm() }
            }
            CorrespondencePhase::Missing(_) | CorrespondencePhase::Resting { .. } => CorrespondencePhase::Ready,
            _ if reading.f1_n.norm() >= self.settings.begin_n => {
                self.stretch.clear();
                self.push_on(&reading, sample)
            }
            phase => phase,
        };
        self.phase
    }

    fn reading(
        &self,
        f1_n: Option<Vector3<f64>>,
        sample: &WristSample,
        t_s: f64,
    ) -> Result<IntervalReading, MissingInput> {
        let f1_n = f1_n.ok_or(MissingInput::WristForce)?;
        let f2_n = sample.tissue_n.ok_or(MissingInput::TissueForce)?;
        let s1_from_c = if self.settings.chain {
            sample.s1_from_c().ok_or(MissingInput::Chain)?
        } else {
            UnitQuaternion::identity()
        };
        let sense = sample.is_finite() && f1_n.iter().all(|x| x.is_finite()) && t_s.is_finite() && t_s > self.last_t_s;
        if sense { Ok(IntervalReading { t_s, f1_n, f2_n, s1_from_c }) } else { Err(MissingInput::Sense) }
    }

    /// Requires both sensors to read almost zero for a while, so that a sensor that was not zeroed is found before the
    /// first push.
    fn rest(&mut self, reading: &IntervalReading, gap_s: f64) -> CorrespondencePhase {
        let f1_n = reading.f1_n.norm();
        let f2_n = reading.f2_n.norm();
        let resting = f1_n.max(f2_n) <= self.settings.end_n;
        // A gap in the samples (or the first sample) does not count as rest.
        self.rested_s = if resting { self.rested_s + if gap_s < 0.1 { gap_s } else { 0.0 } } else { 0.0 };
        if self.rested_s >= self.settings.rest_s {
            return CorrespondencePhase::Ready;
        }
        CorrespondencePhase::Resting { fraction: self.rested_s / self.settings.rest_s, f1_n, f2_n }
    }

    fn push_on(&mut self, reading: &IntervalReading, sample: &WristSample) -> CorrespondencePhase {
        let force_n = reading.f1_n.norm();
        if force_n < self.settings.end_n {
            return self.finish();
        }
        if self.stretch.take(reading) {
            self.world_from_s1 = sample.world_from_s1;
        }
        let enough = self.stretch.best().is_some_and(|best| best.deviation_n <= self.settings.still_n);
        CorrespondencePhase::Pushing { force_n, enough }
    }

    fn finish(&mut self) -> CorrespondencePhase {
        // The window has never been full.
        let Some(best) = self.stretch.best() else { return CorrespondencePhase::Refused(PushRefusal::TooShort) };
        if best.deviation_n > self.settings.still_n {
            return CorrespondencePhase::Refused(PushRefusal::Moved { by_n: best.deviation_n });
        }
        // The wrist felt a push but the tissue did not: the tool touched something else.
        if best.pair.f2_n.norm() < self.settings.options.limits.min_force_n {
            return CorrespondencePhase::Refused(PushRefusal::MissedTissue);
        }
        if self.pushes.len() == MAX_PUSHES {
            return CorrespondencePhase::Refused(PushRefusal::Full);
        }
        // The wrist measures the reaction; the tool pushes in the opposite direction.
        let towards_in_world = self.world_from_s1.and_then(|turn| (turn * -best.pair.f1_n).try_normalize(1e-9));
        self.pushes.push(CorrespondencePush { pair: best.pair, towards_in_world });
        CorrespondencePhase::Recorded(self.pushes.len() - 1)
    }

    pub const fn phase(&self) -> CorrespondencePhase {
        self.phase
    }

    /// Returns the next push to request: the first direction without a push. Without the arm's kinematics the
    /// directions are requested in turn. `None` when all are complete; further pushes still improve the fit.
    pub fn target(&self) -> Option<PushTarget> {
        // Without directions the pushes can only be counted.
        if self.pushes.iter().any(|push| push.towards_in_world.is_none()) {
            return TARGETS.get(self.pushes.len()).copied();
        }
        let near = |target: &PushTarget| {
            let mut towards = self.pushes.iter().filter_map(|push| push.towards_in_world);
            towards.any(|towards| towards.dot(&target.push_in_world) >= NEAR_TARGET)
        };
        TARGETS.iter().find(|target| !near(target)).copied()
    }

    pub const fn targets(&self) -> usize {
        TARGETS.len()
    }

    /// Returns the directions of the stored pushes: unit vectors (`world`), without those recorded without the arm's
    /// kinematics.
    pub fn taken_in_world(&self) -> Vec<Vector3<f64>> {
        self.pushes.iter().filter_map(|push| push.towards_in_world).collect()
    }

    pub const fn settings(&self) -> &CorrespondenceSessionSettings {
        &self.settings
    }

    /// Sets whether the forces under the tissue are inverted in fits; stored pushes are kept.
    pub const fn set_flip_s2(&mut self, flip_s2: bool) {
        self.settings.options.flip_s2 = flip_s2;
    }

    pub const fn pushes(&self) -> usize {
        self.pushes.len()
    }

    pub fn pairs(&self) -> Vec<PushPair> {
        self.pushes.iter().map(|push| push.pair).collect()
    }

    /// Removes one push; returns `false` if the index does not exist.
    pub fn remove(&mut self, index: usize) -> bool {
        let there = index < self.pushes.len();
        if there {
            self.pushes.remove(index);
        }
        there
    }

    /// Removes the newest push; returns `false` if there is none.
    pub fn undo(&mut self) -> bool {
        self.pushes.pop().is_some()
    }

    /// Fits the stored pushes and evaluates the fit. Allocates, so call it on the screen's thread.
    ///
    /// # Errors
    /// The errors of [`fit`](super::fit()).
    pub fn report(&self) -> Result<CorrespondenceReport, CorrespondenceError> {
        fit(&self.pairs(), &self.settings.options)
    }
}

#[cfg(test)]
#[path = "session_tests.rs"]
mod tests;
