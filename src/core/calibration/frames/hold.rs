//! Computes the mean over a pose that is held still, with bounded memory.

use nalgebra::{Isometry3, Vector3};

use super::FrameSample;
use crate::{calibration::rotation_mean::RotationMean, frames::Wrench};

/// A sample farther than this from the mean of the pose ends the pose: six standard deviations of a tracker, m and rad.
const SAMPLE_M: f64 = 1.5e-3;
/// Both limits are required, because a marker on a long lever moves while the tool turns in place.
const SAMPLE_RAD: f64 = 0.004;
/// Maximum difference between the means of the two halves: a slow motion hides in the noise of single samples, m and
/// rad.
const HALVES_M: f64 = 0.5e-3;
const HALVES_RAD: f64 = 0.0014;
/// A longer gap between samples ends a pose, s, because the tool may have moved in the meantime, and the mean would mix
/// two poses.
const GAP_S: f64 = 0.2;
const POSES: usize = 5;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum HoldState {
    /// The pose moved by this much since the hold started.
    Moved { by_m: f64, by_rad: f64 },
    /// Not long enough yet: the fraction of the required time.
    Share(f64),
    /// Held long enough: the mean.
    Long(Box<FrameSample>),
}

#[derive(Clone, Copy, Debug, Default)]
struct HoldSums {
    count: f64,
    poses: [Option<(Vector3<f64>, RotationMean)>; POSES],
    wrench: Option<Wrench>,
    first: FrameSample,
}

impl HoldSums {
    fn of(sample: &FrameSample) -> Self {
        let poses = sample.poses().map(|pose| pose.map(|_| (Vector3::zeros(), RotationMean::default())));
        let mut sums = Self { count: 0.0, poses, wrench: sample.wrench.map(|_| Wrench::default()), first: *sample };
        sums.add(sample);
        sums
    }

    /// Adds a sample; a part that is missing in one sample is missing in the mean.
    fn add(&mut self, sample: &FrameSample) {
        self.count += 1.0;
        for (sum, pose) in self.poses.iter_mut().zip(sample.poses()) {
            *sum = sum.zip(pose).map(|((place_m, mut turn), pose)| {
                turn.add(&pose.rotation);
                (place_m + pose.translation.vector, turn)
            });
        }
        self.wrench = self.wrench.zip(sample.wrench).map(|(sum, wrench)| Wrench {
            force_n: sum.force_n + wrench.force_n,
            torque_nm: sum.torque_nm + wrench.torque_nm,
        });
    }

    fn merge(mut self, other: &Self) -> Self {
        self.count += other.count;
        for (sum, more) in self.poses.iter_mut().zip(&other.poses) {
            *sum = sum.zip(*more).map(|((place_m, mut turn), (more_m, more))| {
                turn.merge(&more);
                (place_m + more_m, turn)
            });
        }
        self.wrench = self.wrench.zip(other.wrench).map(|(sum, more)| Wrench {
            force_n: sum.force_n + more.force_n,
            torque_nm: sum.torque_nm + more.torque_nm,
        });
        self
    }

    fn mean(&self) -> FrameSample {
        let fraction = 1.0 / self.count.max(1.0);
        let poses = self.poses.map(|sums| {
            let (place_m, turn) = sums?;
            Some(Isometry3::from_parts((place_m * fraction).into(), turn.mean()?))
        });
        let wrench =
            self.wrench.map(|sum| Wrench { force_n: sum.force_n * fraction, torque_nm: sum.torque_nm * fraction });
        FrameSample { wrench, ..self.first.with_poses(&poses) }
    }
}

#[derive(Clone, Debug)]
pub(super) struct PoseHold {
    time_s: f64,
    /// `None` before the first sample; the second half begins after half of the time.
    halves: Option<(HoldSums, Option<HoldSums>)>,
    since_s: f64,
    last_s: f64,
}

impl PoseHold {
    pub(super) const fn new(time_s: f64) -> Self {
        Self { time_s, halves: None, since_s: 0.0, last_s: 0.0 }
    }

    pub(super) fn reset(&mut self) {
        self.halves = None;
    }

    /// Adds a finite sample at time `t_s` (s, increasing). Only poses that this calibration needs (`watched`) must be
    /// still.
    pub(super) fn step(&mut self, sample: &FrameSample, watched: [bool; POSES], t_s: f64) -> HoldState {
        // Without a holding time every sample is a pose.
        if self.time_s <= 0.0 {
            return HoldState::Long(Box::new(*sample));
        }
        let follows = t_s > self.last_s && t_s - self.last_s <= GAP_S;
        self.last_s = t_s;
        let Some((first, second)) = self.halves.as_mut().filter(|_| follows) else {
            self.halves = Some((HoldSums::of(sample), None));
            self.since_s = t_s;
            return HoldState::Share(0.0);
        };
        let mean = first.mean();
        let (by_m, by_rad) = apart(&mean, sample, watched);
        if by_m > SAMPLE_M || by_rad > SAMPLE_RAD {
            self.halves = None;
            return HoldState::Moved { by_m, by_rad };
        }
        let fraction = (t_s - self.since_s) / self.time_s;
        match second {
            Some(second) => second.add(sample),
            None if fraction < 0.5 => first.add(sample),
            None => *second = Some(HoldSums::of(sample)),
        }
        if fraction < 1.0 {
            return HoldState::Share(fraction);
        }
        let first = *first;
        let second = *second;
        self.halves = None;
        let Some(second) = second else { return HoldState::Share(0.0) };
        let (by_m, by_rad) = apart(&mean, &second.mean(), watched);
        if by_m > HALVES_M || by_rad > HALVES_RAD {
            return HoldState::Moved { by_m, by_rad };
        }
        HoldState::Long(Box::new(first.merge(&second).mean()))
    }
}

/// Returns the largest differences of the watched poses, m and rad.
fn apart(a: &FrameSample, b: &FrameSample, watched: [bool; POSES]) -> (f64, f64) {
    let pairs = a.poses().into_iter().zip(b.poses()).zip(watched).filter(|(_, watched)| *watched);
    pairs.filter_map(|((a, b), _)| a.zip(b)).fold((0.0, 0.0), |(by_m, by_rad): (f64, f64), (a, b)| {
        let travel_m = (a.translation.vector - b.translation.vector).norm();
        (by_m.max(travel_m), by_rad.max(a.rotation.angle_to(&b.rotation)))
    })
}
