//! Checks before the first pose that the sensor delivers data, and evaluates its rate, noise and stillness. A state
//! machine without a clock.
//!
//! Takes the newest sample of every tick with its time (s); the result is updated twice a second. If the sensor is
//! silent, the loop continues with its last sample, so a sample that equals the previous one in every number does not
//! count as new. A rig does not report the status of its sensor (throttled, over range); the effects on rate, noise and
//! gravity are checked here. Memory is bounded; a sample that is not finite is counted and otherwise ignored.

use nalgebra::Vector3;

use super::{GravitySessionSettings, session::field_of, still::StillInterval};
use crate::frames::{GRAVITY_M_S2, WristSample};

/// Length of a measuring interval, s. A compromise, because a longer one delays the verdict and a shorter one does not
/// contain slow noise.
const BLOCK_S: f64 = 0.5;
/// If ticks are farther apart than this, the screen has missed some; that time does not count as silence of the sensor,
/// s.
const HOLE_S: f64 = 0.020;
/// Minimum rate of samples as a fraction of the loop's rate: a lower rate would be felt as steps and lag.
const RATE_FRACTION: f64 = 0.9;
/// Maximum noise per sample and axis at which a still tool is recognised as still: the mean over 20 ms at 1 kHz must
/// stay within [`super::StillSettings::force_n`] (0.08 N) at 3.5 standard deviations. A good sensor has 0.01 to 0.05 N.
const FORCE_NOISE_N: f64 = 0.10;
/// Maximum noise of the accelerometer, for [`super::StillSettings::field_m_s2`], m/s^2. A good accelerometer has 0.01
/// to 0.05.
const ACCELERATION_NOISE_M_S2: f64 = 0.12;
/// Maximum relative deviation of the accelerometer's reading at rest from gravity: a larger deviation cannot be the
/// local gravity, which varies by 0.5 % over the earth, and means a wrong unit or a damaged device.
const GRAVITY_FRACTION: f64 = 0.05;
/// Stillness is evaluated in steps of 20 ms, and the first sample is one tick late, so the measured rest may be too
/// short by this time, s.
const REST_ROUNDING_S: f64 = 0.045;
/// A swinging tool is still for a moment at its turning points, but not for this long, s.
const REST_S: f64 = 0.2;
/// Minimum number of samples in an interval for an estimate of the noise: the standard deviation is then known within
/// about 16 % (`1 / sqrt(2 n)`), so that a good sensor is not refused.
const SAMPLES_MIN: f64 = 20.0;

#[derive(Clone, Debug, PartialEq)]
pub enum CheckState {
    /// Not enough samples yet, or another check must pass first.
    Waiting,
    Good,
    Bad {
        /// The cause, with the measured value.
        cause: String,
        /// The remedy, for the operator.
        cure: &'static str,
    },
}

#[derive(Clone, Debug, PartialEq)]
pub struct PrecheckResult {
    pub name: &'static str,
    /// Measured value, for the screen; empty without a value.
    pub measured: String,
    pub state: CheckState,
}

impl PrecheckResult {
    fn of(name: &'static str, measured: String, state: CheckState) -> Self {
        Self { name, measured, state }
    }
}

fn bad(cause: impl Into<String>, cure: &'static str) -> CheckState {
    CheckState::Bad { cause: cause.into(), cure }
}

/// Measured value as text, and state of the check.
type PrecheckFinding = (String, CheckState);

/// Deviation of vectors from their mean, and between consecutive ones.
#[derive(Clone, Copy, Debug, Default)]
struct PrecheckSpread {
    first: Vector3<f64>,
    last: Vector3<f64>,
    count: f64,
    sum: Vector3<f64>,
    squares: Vector3<f64>,
    steps: Vector3<f64>,
}

impl PrecheckSpread {
    fn add(&mut self, value: &Vector3<f64>) {
        if self.count == 0.0 {
            self.first = *value;
            self.last = *value;
        }
        // Relative to the first value, because a large bias would reduce the precision of a small noise.
        let offset = value - self.first;
        let step = value - self.last;
        self.last = *value;
        self.count += 1.0;
        self.sum += offset;
        self.squares += offset.component_mul(&offset);
        self.steps += step.component_mul(&step);
    }

    fn mean(&self) -> Vector3<f64> {
        self.first + self.sum / self.count.max(1.0)
    }

    fn deviation(&self) -> Vector3<f64> {
        let mean = self.sum / self.count.max(1.0);
        // Rounding can make the difference of sums slightly negative.
        (self.squares / self.count.max(1.0) - mean.component_mul(&mean)).map(|variance| variance.max(0.0).sqrt())
    }

    /// Returns the standard deviation of white noise from these differences between samples; slow motion does not
    /// affect it.
    fn roughness(&self) -> Vector3<f64> {
        // Half the mean square step equals the variance of white noise, and hardly contains a slow motion.
        (self.steps / (2.0 * (self.count - 1.0).max(1.0))).map(f64::sqrt)
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct PrecheckBlock {
    span_s: f64,
    fresh: u32,
    repeated: u32,
    poisoned: u32,
    oriented: u32,
    still: bool,
    force_n: PrecheckSpread,
    acceleration_m_s2: PrecheckSpread,
}

impl PrecheckBlock {
    fn orientation(&self, use_arm: bool) -> PrecheckFinding {
        let state = if self.oriented == self.fresh {
            CheckState::Good
        } else if use_arm {
            bad("the arm does not report the sensor's orientation", "connect the arm, or use the accelerometer")
        } else {
            bad(
                "the accelerometer sends no data",
                "sensors of the first generation have no accelerometer: use the arm's orientation",
            )
        };
        (String::new(), state)
    }

    fn gravity(&self) -> PrecheckFinding {
        if self.acceleration_m_s2.count < SAMPLES_MIN {
            return (String::new(), CheckState::Waiting);
        }
        let norm_m_s2 = self.acceleration_m_s2.mean().norm();
        let measured = format!("{norm_m_s2:.2} m/s^2");
        let off = (norm_m_s2 / GRAVITY_M_S2 - 1.0).abs();
        let state = if off < GRAVITY_FRACTION {
            CheckState::Good
        } else {
            bad(format!("{measured} instead of 9.81 m/s^2"), "hold it still; check its range and units")
        };
        (measured, state)
    }

    fn force_noise(&self) -> PrecheckFinding {
        let spread = &self.force_n;
        // A working channel never repeats exactly over a whole interval.
        if spread.count >= SAMPLES_MIN && spread.steps.min() == 0.0 {
            let state = bad(
                "one of its axes always reads the same value",
                "that channel is defective or out of range: remove the load; if it stays, have the sensor repaired",
            );
            return (String::new(), state);
        }
        let cure = "check shield and earth of the cable, keep it away from motors, lower the sensor's filter frequency";
        noise(spread, self.still, FORCE_NOISE_N, "N", cure)
    }

    fn acceleration_noise(&self) -> PrecheckFinding {
        let cure = "look for motors and fans that shake the arm; check the accelerometer's range and filter";
        noise(&self.acceleration_m_s2, self.still, ACCELERATION_NOISE_M_S2, "m/s^2", cure)
    }
}

/// The check: takes samples, returns lines for the screen.
#[derive(Clone, Debug)]
pub struct Precheck {
    settings: GravitySessionSettings,
    still: StillInterval,
    /// Time for which the tool has been still, s; `None` while it moves, or before this can be determined.
    rested_s: Option<f64>,
    newest: Option<WristSample>,
    last_s: f64,
    block: PrecheckBlock,
    measured: Option<PrecheckBlock>,
}

impl Precheck {
    /// Creates a check for a session with these settings.
    pub fn new(settings: GravitySessionSettings) -> Self {
        let block = PrecheckBlock::default();
        let still = StillInterval::new(settings.still);
        Self { settings, still, rested_s: None, newest: None, last_s: f64::NAN, block, measured: None }
    }

    /// Adds the sample of one tick (`None` if it is missing) at time `t_s` (s, increasing). Allocates nothing.
    pub fn step(&mut self, sample: Option<&WristSample>, t_s: f64) {
        let step_s = t_s - self.last_s;
        self.last_s = t_s;
        // Time that the screen missed says nothing about the sensor.
        let counts = step_s > 0.0 && step_s <= HOLE_S;
        if !counts {
            self.newest = sample.copied();
            return;
        }
        self.block.span_s += step_s;
        match sample {
            None => self.disturb(),
            Some(sample) if !sample.is_finite() => {
                self.block.poisoned += 1;
                self.disturb();
            }
            Some(sample) if self.newest.as_ref() == Some(sample) => self.block.repeated += 1,
            Some(sample) => self.take(sample, t_s),
        }
        self.newest = sample.copied();
        // The tolerance is for the rounding of a sum of milliseconds.
        if self.block.span_s >= BLOCK_S - 1e-9 {
            self.block.still = self.rested_s.is_some_and(|rested_s| rested_s >= BLOCK_S - REST_ROUNDING_S);
            self.measured = Some(std::mem::take(&mut self.block));
        }
    }

    fn disturb(&mut self) {
        self.still.reset();
        self.rested_s = None;
    }

    fn take(&mut self, sample: &WristSample, t_s: f64) {
        self.block.fresh += 1;
        self.block.force_n.add(&sample.raw.force_n);
        if let Some(acceleration_m_s2) = &sample.acceleration_m_s2 {
            self.block.acceleration_m_s2.add(acceleration_m_s2);
        }
        if let Some(field) = field_of(&self.settings, sample) {
            self.block.oriented += 1;
            let fraction = self.still.step(sample, &field, t_s);
            self.rested_s = fraction.map(|fraction| fraction * self.settings.still.time_s);
        }
    }

    /// Returns the state of all checks, for a loop of this rate (Hz). Allocates, so call it on the screen's thread.
    pub fn checks(&self, rate_hz: f64) -> Vec<PrecheckResult> {
        let block = self.measured.unwrap_or_default();
        let report =
            |finding: PrecheckFinding| if block.fresh == 0 { (String::new(), CheckState::Waiting) } else { finding };
        let mut lines = vec![("sensor", self.delivery()), ("rate", self.rate(rate_hz))];
        lines.push(("orientation", report(block.orientation(self.settings.use_arm))));
        if !self.settings.use_arm {
            lines.push(("gravity", report(block.gravity())));
        }
        lines.push(("force noise", report(block.force_noise())));
        if !self.settings.use_arm {
            lines.push(("accelerometer noise", report(block.acceleration_noise())));
        }
        lines.push(("stillness", report(self.stillness())));
        lines.into_iter().map(|(name, (measured, state))| PrecheckResult::of(name, measured, state)).collect()
    }

    pub fn passed(&self, rate_hz: f64) -> bool {
        self.checks(rate_hz).iter().all(|check| check.state == CheckState::Good)
    }

    fn delivery(&self) -> PrecheckFinding {
        let state = match self.measured {
            None => CheckState::Waiting,
            Some(PrecheckBlock { poisoned, fresh, repeated, .. }) if poisoned > 0 => {
                let all = poisoned + fresh + repeated;
                bad(
                    format!("{poisoned} of {all} samples contain a non-finite number"),
                    "check the cable and the sensor's own status, then restart its driver",
                )
            }
            Some(PrecheckBlock { fresh: 0, repeated: 0, .. }) => {
                bad("no samples arrive", "check its power, its cable and its address")
            }
            Some(PrecheckBlock { fresh: 0, .. }) => {
                bad("the sensor repeats the same reading", "switch it off and on, then restart its driver")
            }
            Some(_) => CheckState::Good,
        };
        (String::new(), state)
    }

    fn rate(&self, rate_hz: f64) -> PrecheckFinding {
        let Some(block) = self.measured else { return (String::new(), CheckState::Waiting) };
        let measured_hz = f64::from(block.fresh) / block.span_s;
        let measured = format!("{measured_hz:.0} Hz of the loop's {rate_hz:.0} Hz");
        let state = if measured_hz >= RATE_FRACTION * rate_hz {
            CheckState::Good
        } else {
            bad(
                measured.clone(),
                "raise the sensor's output rate, relieve its bus, check it for lost packets, or lower rate_hz of the rig",
            )
        };
        (measured, state)
    }

    fn stillness(&self) -> PrecheckFinding {
        let state = match (self.rested_s, self.still.is_still()) {
            (Some(rested_s), _) if rested_s >= REST_S => CheckState::Good,
            (Some(_), _) | (None, None) => CheckState::Waiting,
            (None, Some(_)) => bad("force or orientation is not still", "release the tool and bring the arm to rest"),
        };
        (String::new(), state)
    }
}

/// Evaluates the noise of the worst axis. While the tool moves, only the part that motion cannot explain is evaluated,
/// and reported only if it is too large by itself: motion must not hide noise that looks like motion.
fn noise(spread: &PrecheckSpread, still: bool, limit: f64, unit: &str, cure: &'static str) -> PrecheckFinding {
    let deviation = spread.deviation().max();
    let roughness = spread.roughness().max();
    let worst = if still { deviation } else { roughness };
    let measured = format!("{worst:.3} {unit}");
    let state = if spread.count < SAMPLES_MIN {
        CheckState::Waiting
    } else if worst > limit {
        bad(format!("{measured} per sample and axis, more than the plausible {limit:.2} {unit}"), cure)
    } else if still {
        CheckState::Good
    } else {
        CheckState::Waiting
    };
    (measured, state)
}

#[cfg(test)]
#[path = "precheck_tests.rs"]
mod tests;
