//! Detects when force and orientation are still, with bounded memory: running means that are reset by any motion.

use nalgebra::{UnitQuaternion, Vector3};

use crate::{
    calibration::rotation_mean::RotationMean,
    frames::{Wrench, WristSample},
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StillSettings {
    pub time_s: f64,
    /// Maximum deviation of a 20 ms mean of the force from the mean of the interval, N.
    pub force_n: f64,
    /// Maximum deviation of a 20 ms mean of the gravity vector from the mean of the interval, m/s^2.
    pub field_m_s2: f64,
    /// A gap in time longer than this resets the interval, s.
    pub gap_s: f64,
}

impl Default for StillSettings {
    fn default() -> Self {
        Self { time_s: 1.0, force_n: 0.08, field_m_s2: 0.10, gap_s: 0.05 }
    }
}

/// Length of the short means, s: a mean of 20 samples at 1 kHz, so that the noise of single samples does not count as
/// motion.
const SHORT_S: f64 = 0.020;

#[derive(Clone, Copy, Debug, Default)]
struct StillSums {
    count: f64,
    wrench: Wrench,
    field: Vector3<f64>,
    /// Number of samples with an orientation from the arm, and the sum of these orientations.
    turned: f64,
    world_from_s1: RotationMean,
}

impl StillSums {
    fn add(&mut self, sample: &WristSample, field: &Vector3<f64>) {
        self.count += 1.0;
        self.wrench.force_n += sample.raw.force_n;
        self.wrench.torque_nm += sample.raw.torque_nm;
        self.field += field;
        if let Some(world_from_s1) = &sample.world_from_s1 {
            self.turned += 1.0;
            self.world_from_s1.add(world_from_s1);
        }
    }

    fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.wrench.force_n += other.wrench.force_n;
        self.wrench.torque_nm += other.wrench.torque_nm;
        self.field += other.field;
        self.turned += other.turned;
        self.world_from_s1.merge(&other.world_from_s1);
    }

    fn mean(&self) -> (Wrench, Vector3<f64>) {
        let fraction = 1.0 / self.count.max(1.0);
        let wrench = Wrench { force_n: self.wrench.force_n * fraction, torque_nm: self.wrench.torque_nm * fraction };
        (wrench, self.field * fraction)
    }
}

#[derive(Clone, Debug)]
pub(super) struct StillInterval {
    settings: StillSettings,
    short: StillSums,
    short_since_s: f64,
    whole: StillSums,
    since_s: f64,
    last_s: Option<f64>,
    moved: Option<bool>,
    field_moved_s: f64,
}

impl StillInterval {
    pub(super) fn new(settings: StillSettings) -> Self {
        let nothing = StillSums::default();
        Self {
            settings,
            short: nothing,
            short_since_s: 0.0,
            whole: nothing,
            since_s: 0.0,
            last_s: None,
            moved: None,
            field_moved_s: 0.0,
        }
    }

    pub(super) fn reset(&mut self) {
        self.short = StillSums::default();
        self.whole = StillSums::default();
        self.last_s = None;
    }

    /// Returns whether the last short mean was still; `None` before the first one.
    pub(super) fn is_still(&self) -> Option<bool> {
        self.moved.map(|moved| !moved)
    }

    /// Returns whether the tool is being moved although, for the last half second, only its force has changed.
    pub(super) fn only_force_moved(&self) -> bool {
        // The orientation has been still for half a second, so only a touch can have moved the force.
        self.moved == Some(true) && self.last_s.is_some_and(|last| last - self.field_moved_s > 0.5)
    }

    /// Returns the means over the interval: wrench (`s1`) and gravity vector (m/s^2, source's frame).
    pub(super) fn mean(&self) -> Option<(Wrench, Vector3<f64>)> {
        (self.whole.count > 0.0).then(|| self.whole.mean())
    }

    /// Returns the mean orientation from the arm over the interval; `None` unless every sample had an orientation.
    pub(super) fn mean_world_from_s1(&self) -> Option<UnitQuaternion<f64>> {
        // A mean of some of the samples would belong to another time.
        self.whole.world_from_s1.mean().filter(|_| self.whole.turned >= self.whole.count)
    }

    /// Adds a sample; returns the fraction of the required time (1 or more: still long enough), `None` while the tool
    /// moves.
    pub(super) fn step(&mut self, sample: &WristSample, field: &Vector3<f64>, t_s: f64) -> Option<f64> {
        // A gap, or a clock that was set back, starts a new interval.
        if !self.last_s.is_some_and(|last| t_s > last && t_s - last <= self.settings.gap_s) {
            self.reset();
            self.short_since_s = t_s;
            self.since_s = t_s;
            self.field_moved_s = t_s;
        }
        self.last_s = Some(t_s);
        self.short.add(sample, field);
        if t_s - self.short_since_s >= SHORT_S {
            self.close_short(t_s);
        }
        (self.moved == Some(false)).then(|| (self.short_since_s - self.since_s) / self.settings.time_s)
    }

    fn close_short(&mut self, t_s: f64) {
        let (wrench, field) = self.short.mean();
        let far = self.whole.count > 0.0 && {
            let (mean, mean_field) = self.whole.mean();
            let turned = (field - mean_field).norm() > self.settings.field_m_s2;
            if turned {
                self.field_moved_s = t_s;
            }
            turned || (wrench.force_n - mean.force_n).norm() > self.settings.force_n
        };
        // The interval starts again with this short mean.
        if far {
            self.whole = StillSums::default();
            self.since_s = t_s;
        }
        self.moved = Some(far);
        self.whole.merge(&self.short);
        self.short = StillSums::default();
        self.short_since_s = t_s;
    }
}
