//! A Gen3 with a typical instrument, a marker on it and a tracker next to it, all with known frames and noise.

use std::sync::OnceLock;

use nalgebra::{Isometry3, Point3, SMatrix, SVector, Translation3, UnitQuaternion, Vector3};

use crate::{
    calibration::frames::{Carrier, FrameSample},
    frames::from_roll_pitch_yaw_deg,
    kinematics::{Arm, ArmSettings, JOINTS, Joints},
    noise::Noise,
};

/// A pose with the shaft through [`TROCAR_M`].
const READY_RAD: [f64; JOINTS] = [2.38, -1.34, -1.37, 1.91, -1.28, 1.68, 0.92];
pub(crate) const TROCAR_M: Vector3<f64> = Vector3::new(0.4, 0.0, -0.1);
pub(crate) const TIP_IN_FLANGE_M: Vector3<f64> = Vector3::new(0.0, 0.0, 0.48);
/// Noise of the tracker per axis: 0.25 mm and 0.02 degrees.
pub(crate) const NOISE_M: f64 = 0.25e-3;
pub(crate) const NOISE_RAD: f64 = 0.02 * std::f64::consts::PI / 180.0;

pub(crate) fn arm() -> Arm {
    let zero = Vector3::zeros();
    let sensor_m = Vector3::new(0.0, 0.0, 0.06);
    Arm::new(&ArmSettings { base_m: zero, base_deg: zero, sensor_m, sensor_deg: zero, shaft_m: 0.42 }).unwrap()
}

pub(crate) fn pose(place_m: [f64; 3], angles_deg: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(place_m), from_roll_pitch_yaw_deg(&angles_deg.into()))
}

pub(crate) fn flange_from_m() -> Isometry3<f64> {
    pose([0.03, -0.045, 0.08], [25.0, -70.0, 110.0])
}

pub(crate) fn base_from_c() -> Isometry3<f64> {
    pose([1.3, 0.7, 0.9], [-115.0, 10.0, 140.0])
}

/// Returns joint angles with the tip here and the shaft in this direction; `None` if the arm cannot reach it. Newton's
/// method with damping.
fn reached(tip_m: &Vector3<f64>, direction: &Vector3<f64>) -> Option<Joints> {
    let arm = arm();
    let mut joints = Joints::from(READY_RAD);
    for _ in 0..100 {
        let at = arm.pose(&joints);
        let mut error = SVector::<f64, 6>::zeros();
        error.fixed_rows_mut::<3>(0).copy_from(&(tip_m - at.tip_m));
        error.fixed_rows_mut::<3>(3).copy_from(&(at.direction.cross(direction) * 0.3));
        if error.norm() < 1e-12 {
            return Some(joints);
        }
        let mut slopes = at.chain.jacobian(&at.tip_m);
        for i in 3..6 {
            slopes.row_mut(i).scale_mut(0.3);
        }
        let square = slopes * slopes.transpose() + SMatrix::<f64, 6, 6>::identity() * 1e-9;
        joints += slopes.transpose() * square.cholesky()?.solve(&error) * 0.7;
    }
    None
}

/// Flange poses, all of which the arm reaches.
type Pool = Vec<Isometry3<f64>>;

fn flange(joints: &Joints) -> Isometry3<f64> {
    let flange = arm().pose(joints).chain.world_from_flange;
    Isometry3::from_parts(flange.translation, flange.rotation.into())
}

fn pool(seed: u64, cone_deg: f64, tip_m: impl Fn(&Vector3<f64>, &mut Noise) -> Vector3<f64>) -> Pool {
    let mut noise = Noise::new(seed);
    let mut poses = Vec::new();
    while poses.len() < 300 {
        let tilt = cone_deg.to_radians() * noise.uniform().sqrt();
        let turn = std::f64::consts::TAU * noise.uniform();
        let direction = Vector3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), -tilt.cos());
        let Some(mut joints) = reached(&tip_m(&direction, &mut noise), &direction) else { continue };
        // The last joint turns the instrument about its shaft; the marker must stay in view.
        joints[6] += (noise.uniform() - 0.5) * 100_f64.to_radians();
        poses.push(flange(&joints));
    }
    poses
}

/// Returns the shaft through the trocar, tilted by up to 20 degrees, 5 to 20 cm deep.
pub(crate) fn through_trocar() -> &'static Pool {
    static POOL: OnceLock<Pool> = OnceLock::new();
    POOL.get_or_init(|| pool(1, 20.0, |d, noise| TROCAR_M + d * (0.05 + 0.15 * noise.uniform())))
}

/// Returns the tip in a dimple, the shaft tilted by up to 30 degrees.
pub(crate) fn in_dimple() -> &'static Pool {
    static POOL: OnceLock<Pool> = OnceLock::new();
    POOL.get_or_init(|| pool(2, 30.0, |_, _| TROCAR_M - Vector3::z() * 0.1))
}

pub(crate) struct Rig {
    pub(crate) noise: Noise,
}

impl Rig {
    pub(crate) fn new(seed: u64) -> Self {
        Self { noise: Noise::new(seed) }
    }

    pub(crate) fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.noise.gaussian() * size)
    }

    pub(crate) fn noisy(&mut self, pose: &Isometry3<f64>) -> Isometry3<f64> {
        let place_m = pose.translation.vector + self.vector(NOISE_M);
        Isometry3::from_parts(place_m.into(), pose.rotation * UnitQuaternion::from_scaled_axis(self.vector(NOISE_RAD)))
    }

    /// Returns the measures with this flange pose, and with the other arm at a different pose.
    pub(crate) fn sample(&mut self, base_from_flange: &Isometry3<f64>) -> FrameSample {
        let other = through_trocar()[(self.noise.uniform() * 300.0) as usize];
        let seen = |flange: &Isometry3<f64>| base_from_c().inverse() * flange * flange_from_m();
        let other_seen = pose([0.2, -0.3, 0.1], [0.0, 20.0, 75.0]) * seen(&other);
        FrameSample {
            base_from_flange: Some(*base_from_flange),
            other_base_from_flange: Some(other),
            c_from_m: Some(self.noisy(&seen(base_from_flange))),
            c_from_other_m: Some(self.noisy(&other_seen)),
            ..FrameSample::default()
        }
    }

    /// Returns the samples of this many poses from a pool.
    pub(crate) fn samples(&mut self, pool: &[Isometry3<f64>], count: usize) -> Vec<FrameSample> {
        let any = |rig: &mut Self| pool[(rig.noise.uniform() * pool.len() as f64) as usize];
        (0..count).map(|_| any(self)).collect::<Vec<_>>().iter().map(|at| self.sample(at)).collect()
    }
}

/// Returns the tip in the flange's or the marker's frame, m.
pub(crate) fn tip_in(carrier: Carrier) -> Vector3<f64> {
    match carrier {
        Carrier::Marker => (flange_from_m().inverse() * Point3::from(TIP_IN_FLANGE_M)).coords,
        _ => TIP_IN_FLANGE_M,
    }
}

/// Returns a flange pose with the tip here and this orientation of the flange.
pub(crate) fn with_tip_at(tip_m: &Vector3<f64>, turn: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts((tip_m - turn * TIP_IN_FLANGE_M).into(), turn)
}

/// Returns the flange's orientation with the shaft down.
pub(crate) fn shaft_down() -> UnitQuaternion<f64> {
    from_roll_pitch_yaw_deg(&Vector3::new(180.0, 0.0, 0.0))
}

/// Returns the value below which 95 % of the values lie.
pub(crate) fn p95(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() * 95 / 100]
}
