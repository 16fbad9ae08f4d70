//! Removes gravity from every sample, even while the tool moves.
//!
//! An accelerometer at the sensor measures gravity and motion together, and so does the sensor: acceleration of the
//! tool adds a force `m a` to its weight. The models with gain or mass remove both, as long as the accelerometer's
//! reading is not delayed against the force, so its low-pass should be no slower than its noise requires. What remains
//! is due to the rotation of the tool about the accelerometer (`com x` angular acceleration, and the centripetal part).
//! Mean error per axis measured in simulation (0.4 kg tool, centre of mass 60 mm off, tilting +-29 and +-11 degrees at
//! 0.2 and 0.5 Hz, moving by 20 mm, 0.05 m/s^2 noise): 0.025 N without filter, 0.021 N at 2 ms, 0.020 N at 5 ms, 0.031
//! N at 20 ms, 0.062 N at 50 ms; with the same motion two and a half times as fast: 0.108, 0.108, 0.109, 0.129, 0.202
//! N. On the simulated rig (0.04 N noise of the force, no inertia) 0, 2, 5 and 20 ms leave 41.8, 40.4, 40.2 and 40.0 mN
//! rms per axis at rest and 41.7, 40.5, 40.8 and 50.6 mN in motion. The default is 2 ms. Orientations from the arm have
//! almost no noise and are not filtered.

use nalgebra::Vector3;

use super::{GravityModel, GravitySource};
use crate::frames::{Wrench, WristSample};

/// Default time constant, within 2 % of the best one measured, s.
pub const DEFAULT_TIME_CONSTANT_S: f64 = 0.002;

/// A model with a first-order low-pass on the gravity vector. Steps allocate nothing.
#[derive(Clone, Debug)]
pub struct Compensator {
    model: GravityModel,
    /// Time constant of the low-pass, s; `None` without a filter.
    time_constant_s: Option<f64>,
    period_s: f64,
    field_m_s2: Option<Vector3<f64>>,
}

impl Compensator {
    /// Creates a compensator for samples of this nominal period (s). A time constant (s) that is zero, negative or not
    /// finite means no filter.
    pub fn new(model: GravityModel, time_constant_s: f64, period_s: f64) -> Self {
        // The arm's orientation has almost no noise; a filter would only add delay.
        let usable = model.source == GravitySource::Imu && time_constant_s > 0.0 && time_constant_s.is_finite();
        Self { model, time_constant_s: usable.then_some(time_constant_s), period_s, field_m_s2: None }
    }

    pub const fn model(&self) -> &GravityModel {
        &self.model
    }

    pub const fn reset(&mut self) {
        self.field_m_s2 = None;
    }

    /// Same as [`step_after`](Self::step_after) for a sample one period after the last one.
    pub fn step(&mut self, sample: &WristSample) -> Option<Wrench> {
        self.step_after(self.period_s, sample)
    }

    /// Returns the wrench of the sample, `dt_s` (s) after the last one, without gravity and bias (`s1`, N and Nm).
    /// Returns `None`, and resets the filter, if the wrench is not finite or the source of orientation is missing, not
    /// finite or defective.
    pub fn step_after(&mut self, dt_s: f64, sample: &WristSample) -> Option<Wrench> {
        // A model that uses the arm's orientation has no filter, so the newest reading counts fully.
        let fraction = self.time_constant_s.map_or(1.0, |time_constant_s| -libm::expm1(-dt_s / time_constant_s));
        let read = self.model.field_m_s2(sample).filter(|_| sample.raw.is_finite());
        // After a sample without an orientation the filter starts again from the next reading.
        self.field_m_s2 = read.map(|read| self.field_m_s2.map_or(read, |old| old + (read - old) * fraction));
        let gravity = self.model.predict(&self.field_m_s2?);
        Some(Wrench {
            force_n: sample.raw.force_n - gravity.force_n,
            torque_nm: sample.raw.torque_nm - gravity.torque_nm,
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};

    use super::*;
    use crate::{
        calibration::{
            AxisStats,
            gravity::{GravitySettings, ModelKind, fit, tests::Tool},
        },
        frames::GRAVITY_M_S2,
    };

    const STEP_S: f64 = 1e-3;

    /// Returns orientation of the sensor and position of the accelerometer (m, world) for a hand that tilts and carries
    /// the tool.
    fn motion(t_s: f64) -> (UnitQuaternion<f64>, Vector3<f64>) {
        let wave = |hz: f64, phase: f64| (std::f64::consts::TAU * 0.4 * hz * t_s + phase).sin();
        let world_from_s1 =
            UnitQuaternion::from_euler_angles(0.5 * wave(0.5, 0.0), 0.2 * wave(1.3, 1.0), 0.3 * wave(0.3, 2.0));
        (world_from_s1, Vector3::new(wave(0.7, 0.0), wave(1.1, 1.0), wave(0.9, 2.0)) * 0.02)
    }

    /// Returns the second time difference of a position.
    fn acceleration_world(place: impl Fn(f64) -> Vector3<f64>, t_s: f64) -> Vector3<f64> {
        (place(t_s + STEP_S) - place(t_s) * 2.0 + place(t_s - STEP_S)) / (STEP_S * STEP_S)
    }

    /// Returns readings of sensor and accelerometer in motion, including inertia.
    fn moving_sample(tool: &mut Tool, t_s: f64) -> WristSample {
        let (world_from_s1, _) = motion(t_s);
        let mut sample = tool.sample(world_from_s1, 0.0, 0.0);
        let gravity_world = Vector3::new(0.0, 0.0, -GRAVITY_M_S2);
        let com_m = tool.com_m;
        let centre_world = acceleration_world(|t| motion(t).1 + motion(t).0 * com_m, t_s);
        let load_s1 = world_from_s1.inverse() * (gravity_world - centre_world) * tool.mass_kg;
        sample.raw.force_n = load_s1 + tool.bias.force_n + tool.vector(0.01);
        sample.raw.torque_nm = com_m.cross(&load_s1) + tool.bias.torque_nm;
        let support_s1 = world_from_s1.inverse() * (acceleration_world(|t| motion(t).1, t_s) - gravity_world);
        sample.acceleration_m_s2 = Some(tool.s1_from_imu.inverse() * support_s1 + tool.vector(0.05));
        sample
    }

    fn error_n(time_constant_s: f64) -> f64 {
        let mut tool = Tool::new(23, 0.4);
        tool.com_m = Vector3::new(0.005, -0.004, 0.06);
        let poses: Vec<_> = (0..12).map(|_| tool.imu_pose(0.005, 1e-3)).collect();
        let report = fit(&poses, &GravitySettings::default()).unwrap();
        let mut compensator =
            Compensator::new(report.fit_of(ModelKind::Physical).unwrap().model, time_constant_s, STEP_S);
        let errors = (0..10_000).map(|i| compensator.step(&moving_sample(&mut tool, f64::from(i) * STEP_S)).unwrap());
        AxisStats::of(errors.map(|wrench| wrench.force_n)).mean_mae()
    }

    #[test]
    fn the_default_time_constant_is_as_good_as_the_best_in_motion() {
        let errors = [0.0, 0.001, 0.002, 0.005, 0.010, 0.020, 0.050].map(|s| (s, error_n(s)));
        println!("{errors:?}");
        let default = error_n(DEFAULT_TIME_CONSTANT_S);
        assert!(errors.iter().all(|(_, error)| default <= *error * 1.03), "{default}: {errors:?}");
        assert!(error_n(0.020) > 1.2 * default, "{errors:?}");
    }

    #[test]
    fn a_gap_starts_the_filter_anew() {
        let mut tool = Tool::new(22, 0.4);
        let poses: Vec<_> = (0..12).map(|_| tool.imu_pose(0.0, 0.0)).collect();
        let model = fit(&poses, &GravitySettings::default()).unwrap().chosen_fit().unwrap().model;
        let mut compensator = Compensator::new(model, 1.0, STEP_S);
        let upright = tool.sample(UnitQuaternion::identity(), 0.0, 0.0);
        let tilted = tool.sample(UnitQuaternion::from_euler_angles(1.0, 0.0, 0.0), 0.0, 0.0);
        assert!(compensator.step(&upright).unwrap().force_n.norm() < 1e-6);
        // The filter has a time constant of one second, so most of the tilt is still missing.
        assert!(compensator.step(&tilted).unwrap().force_n.norm() > 1.0);
        assert!(compensator.step(&WristSample { acceleration_m_s2: None, ..tilted }).is_none());
        assert!(compensator.step(&tilted).unwrap().force_n.norm() < 1e-6);
        for unusable in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut direct = Compensator::new(model, unusable, STEP_S);
            direct.step(&upright);
            assert!(direct.step(&tilted).unwrap().force_n.norm() < 1e-6, "{unusable}");
        }
    }
}
