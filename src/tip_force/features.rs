//! What a network reads, made of a stream of wrist samples: the same for recording a data set and in the live loop.
//!
//! Takes the gravity-free wrench (N, Nm, `s1`), the wrist's orientation and its depth through the trocar, at the time of
//! each sample (s); gives one row of [`DEFAULT_INPUTS`]. Friction remembers which way the instrument moved last, so this
//! part has a memory; until it is filled, and after any hole in the samples, there is no row. Allocates nothing.

use super::DEFAULT_INPUTS;
use crate::frames::{Wrench, WristSample};

/// How many inputs a row has.
pub const LIVE_INPUTS: usize = DEFAULT_INPUTS.len();

/// Time constants and widths. A network must be used with those that its data were recorded with: everything but the study
/// that chose them uses the default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeatureSettings {
    /// Time constant of the low-pass over the wrench, s: its delay buys less noise.
    pub wrench_s: f64,
    /// Time constant of the low-pass over the speed, s.
    pub speed_s: f64,
    /// Half width of the stop operator, m: more than the seal stretches before it slides.
    pub travel_m: f64,
}

impl Default for FeatureSettings {
    fn default() -> Self {
        Self { wrench_s: 0.005, speed_s: 0.005, travel_m: 0.001 }
    }
}

/// A hole between two samples that is longer than this, s, empties the memory.
const HOLE_S: f64 = 0.020;

/// Why there is no row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRow {
    /// The sample lacks the wrist's orientation or its depth through the trocar, or is not finite.
    Missing,
    /// The instrument has not moved far enough to know which way the trocar's friction pulls.
    NotMoved,
}

/// The memory. One per wrist sensor.
#[derive(Clone, Debug)]
pub struct Features {
    settings: FeatureSettings,
    last: Option<Last>,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    t_s: f64,
    wrench: Wrench,
    insertion_m: f64,
    speed_m_s: f64,
    travel_m: f64,
    /// The stop has been touched: from there on its place no longer depends on where it began.
    known: bool,
}

impl Features {
    /// An empty memory.
    pub const fn new(settings: FeatureSettings) -> Self {
        Self { settings, last: None }
    }

    /// Forgets everything.
    pub const fn reset(&mut self) {
        self.last = None;
    }

    /// The row of this sample. Call with every sample, in order.
    pub fn step(&mut self, t_s: f64, gravity_free: &Wrench, sample: &WristSample) -> Result<[f32; LIVE_INPUTS], NoRow> {
        let (Some(kbf_from_s1), Some(insertion_m)) = (sample.kbf_from_s1, sample.insertion_m) else {
            self.last = None;
            return Err(NoRow::Missing);
        };
        let finite = gravity_free.is_finite() && sample.is_finite() && t_s.is_finite();
        if !finite {
            self.last = None;
            return Err(NoRow::Missing);
        }
        let now = match self.last {
            Some(last) if t_s > last.t_s && t_s - last.t_s <= HOLE_S => {
                self.advance(&last, t_s, gravity_free, insertion_m)
            }
            _ => Last { t_s, wrench: *gravity_free, insertion_m, speed_m_s: 0.0, travel_m: 0.0, known: false },
        };
        self.last = Some(now);
        if !now.known {
            return Err(NoRow::NotMoved);
        }
        let (f, t, q) = (now.wrench.force_n, now.wrench.torque_nm, kbf_from_s1);
        let row = [f.x, f.y, f.z, t.x, t.y, t.z, q.w, q.i, q.j, q.k, now.insertion_m, now.speed_m_s, now.travel_m];
        Ok(row.map(|value| value as f32))
    }

    fn advance(&self, last: &Last, t_s: f64, wrench: &Wrench, insertion_m: f64) -> Last {
        let FeatureSettings { wrench_s, speed_s, travel_m } = self.settings;
        let (dt_s, way_m) = (t_s - last.t_s, insertion_m - last.insertion_m);
        // First order, exact for a value that stands still over the step.
        let share = |time_constant_s: f64| 1.0 - (-dt_s / time_constant_s).exp();
        let smooth = share(wrench_s);
        let travel = last.travel_m + way_m;
        Last {
            t_s,
            wrench: Wrench {
                force_n: last.wrench.force_n + (wrench.force_n - last.wrench.force_n) * smooth,
                torque_nm: last.wrench.torque_nm + (wrench.torque_nm - last.wrench.torque_nm) * smooth,
            },
            insertion_m,
            speed_m_s: last.speed_m_s + (way_m / dt_s - last.speed_m_s) * share(speed_s),
            travel_m: travel.clamp(-travel_m, travel_m),
            known: last.known || travel.abs() >= travel_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};

    use super::*;

    fn sample(insertion_m: f64) -> WristSample {
        WristSample {
            kbf_from_s1: Some(UnitQuaternion::identity()),
            insertion_m: Some(insertion_m),
            ..WristSample::of(Wrench::default())
        }
    }

    fn column(name: &str) -> usize {
        DEFAULT_INPUTS.iter().position(|column| *column == name).unwrap()
    }

    #[test]
    fn the_way_since_turning_back_is_kept_and_bounded() {
        let mut features = Features::new(FeatureSettings::default());
        let wrench = Wrench { force_n: Vector3::new(1.0, 2.0, 3.0), torque_nm: Vector3::zeros() };
        let mut t_s = 0.0;
        let mut go = |from_m: f64, to_m: f64| {
            let mut row = Err(NoRow::Missing);
            for i in 0..=100 {
                t_s += 1e-3;
                row = features.step(t_s, &wrench, &sample(from_m + (to_m - from_m) * f64::from(i) / 100.0));
            }
            row
        };
        assert_eq!(go(0.1, 0.1005), Err(NoRow::NotMoved), "half the width proves nothing");
        let inwards = go(0.1005, 0.104).unwrap();
        assert!((inwards[column("presliding_m")] - 1e-3).abs() < 1e-9);
        assert!((inwards[column("insertion_speed_m_s")] - 0.035).abs() < 1e-3);
        assert!((inwards[column("fy_n")] - 2.0).abs() < 1e-6);
        let turning = go(0.104, 0.1035).unwrap();
        assert!((turning[column("presliding_m")] - 0.5e-3).abs() < 1e-8);
        let outwards = go(0.1035, 0.100).unwrap();
        assert!((outwards[column("presliding_m")] + 1e-3).abs() < 1e-9);
    }

    #[test]
    fn holes_and_poison_empty_the_memory() {
        let mut features = Features::new(FeatureSettings::default());
        let wrench = Wrench::default();
        assert!(features.step(0.0, &wrench, &sample(0.1)).is_err());
        assert!(features.step(0.01, &wrench, &sample(0.102)).is_ok());
        assert_eq!(features.step(0.05, &wrench, &sample(0.102)), Err(NoRow::NotMoved), "40 ms without a sample");
        assert!(features.step(0.06, &wrench, &sample(0.1)).is_ok());
        assert_eq!(features.step(0.061, &wrench, &sample(f64::NAN)), Err(NoRow::Missing));
        assert_eq!(features.step(0.062, &wrench, &sample(0.1)), Err(NoRow::NotMoved));
        assert!(features.step(0.063, &wrench, &sample(0.102)).is_ok());
        assert!(features.step(0.063, &wrench, &sample(0.102)).is_err(), "time that does not rise");
        let mut without = sample(0.1);
        without.insertion_m = None;
        assert_eq!(features.step(0.064, &wrench, &without), Err(NoRow::Missing));
    }
}
