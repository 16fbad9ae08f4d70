//! Simulated readings of the wrist sensor, its inertial unit, the tracker and the sensor under the tissue.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use nima_core::{
    frames::{GRAVITY_M_S2, Wrench, WristSample, from_roll_pitch_yaw_deg},
    noise::Noise,
};

use crate::scene::{TissueSensor, WristModel as WristConfig};

/// Forces on the instrument, N (`world`), by point of action.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WristLoads {
    /// Tissue on the tip.
    pub(super) tip_n: Vector3<f64>,
    /// Torque of the object in the jaws, about the tip, N m.
    pub(super) twist_nm: Vector3<f64>,
    /// Body wall on the shaft, and the depth of the tip beyond the wall, m.
    pub(super) wall: Option<(Vector3<f64>, f64)>,
    /// A person's hand, at the tool's centre of mass.
    pub(super) touch_n: Vector3<f64>,
    /// A person leaning on the stand of the tissue; only the sensor under the tissue measures this.
    pub(super) stand_n: Vector3<f64>,
}

#[derive(Clone, Debug)]
pub(super) struct Wrist {
    config: WristConfig,
    tissue_sensor: Option<TissueSensor>,
    noise: Noise,
}

impl Wrist {
    pub(super) fn new(config: &WristConfig, tissue_sensor: Option<TissueSensor>, seed: u64) -> Self {
        Self { config: config.clone(), tissue_sensor, noise: Noise::new(seed) }
    }

    fn white(&mut self, sigma: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| sigma * self.noise.gaussian())
    }

    pub(super) fn measure(&mut self, world_from_s1: &UnitQuaternion<f64>, loads: &WristLoads) -> WristSample {
        let mut sample = WristSample::of(self.wrench(world_from_s1, loads));
        sample.world_from_s1 = Some(*world_from_s1);
        sample.insertion_m = loads.wall.map(|(_, depth_m)| depth_m);
        sample.acceleration_m_s2 = self.config.imu.map(|imu| {
            let up = if imu.reads_gravity { -GRAVITY_M_S2 } else { GRAVITY_M_S2 };
            let imu_from_s1 = from_roll_pitch_yaw_deg(&imu.s1_from_imu_deg).inverse();
            let support = imu_from_s1 * (world_from_s1.inverse() * Vector3::new(0.0, 0.0, up));
            support + imu.bias_m_s2 + self.white(imu.noise_m_s2)
        });
        if let Some(sensor) = self.tissue_sensor {
            self.add_experiment(&mut sample, world_from_s1, loads, &sensor);
        }
        sample
    }

    fn wrench(&mut self, world_from_s1: &UnitQuaternion<f64>, loads: &WristLoads) -> Wrench {
        let s1_from_world = world_from_s1.inverse();
        let weight_n = s1_from_world * Vector3::new(0.0, 0.0, -GRAVITY_M_S2 * self.config.tool_mass_kg);
        let at_com_n = weight_n + s1_from_world * loads.touch_n;
        let tip_n = s1_from_world * loads.tip_n;
        let (wall_n, depth_m) = loads.wall.map_or((Vector3::zeros(), 0.0), |(n, depth)| (s1_from_world * n, depth));
        let along = |m: f64| Vector3::new(0.0, 0.0, m);
        let force_n = at_com_n + tip_n + wall_n;
        let torque_nm = self.config.com_m.cross(&at_com_n)
            + along(self.config.shaft_m).cross(&tip_n)
            + s1_from_world * loads.twist_nm
            + along(self.config.shaft_m - depth_m).cross(&wall_n);
        let WristConfig { gain, force_bias_n, torque_bias_nm, force_noise_n, torque_noise_nm, .. } = self.config;
        Wrench {
            force_n: force_n.component_mul(&gain) + force_bias_n + self.white(force_noise_n),
            torque_nm: torque_nm + torque_bias_nm + self.white(torque_noise_nm),
        }
    }

    /// Adds marker, camera and the sensor under the tissue.
    fn add_experiment(
        &mut self,
        sample: &mut WristSample,
        world_from_s1: &UnitQuaternion<f64>,
        loads: &WristLoads,
        sensor: &TissueSensor,
    ) {
        let world_from_m = world_from_s1 * from_roll_pitch_yaw_deg(&sensor.s1_from_m_deg);
        let wobble = UnitQuaternion::from_scaled_axis(self.white(sensor.tracker_noise_deg.to_radians()));
        sample.world_from_m = Some(world_from_m);
        sample.m_from_c = Some(wobble * world_from_m.inverse() * from_roll_pitch_yaw_deg(&sensor.world_from_c_deg));
        let s2_from_world = from_roll_pitch_yaw_deg(&sensor.world_from_s2_deg).inverse();
        let sign = if sensor.reads_tissue { -1.0 } else { 1.0 };
        sample.tissue_n = Some(s2_from_world * (loads.tip_n + loads.stand_n) * sign + self.white(sensor.noise_n));
    }
}

/// Returns the orientation of the wrist for a shaft in this direction (`world`, unit length): z along it, x as close to
/// the base's x as possible.
pub(super) fn along_shaft(direction: &Vector3<f64>) -> UnitQuaternion<f64> {
    let side = if direction.x.abs() < 0.99 { Vector3::x() } else { Vector3::y() };
    let x = (side - direction * side.dot(direction)).normalize();
    let y = direction.cross(&x);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_basis_unchecked(&[x, y, *direction]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn quiet(scene: &str) -> (Wrist, WristConfig, Option<TissueSensor>) {
        let scene = Scene::load(scene).unwrap();
        let mut config = scene.wrist.unwrap();
        config.force_noise_n = 0.0;
        config.torque_noise_nm = 0.0;
        config.gain = Vector3::repeat(1.0);
        config.force_bias_n = Vector3::zeros();
        config.torque_bias_nm = Vector3::zeros();
        if let Some(imu) = &mut config.imu {
            imu.noise_m_s2 = 0.0;
            imu.bias_m_s2 = Vector3::zeros();
        }
        let mut tissue_sensor = scene.tissue_sensor;
        if let Some(sensor) = &mut tissue_sensor {
            sensor.noise_n = 0.0;
            sensor.tracker_noise_deg = 0.0;
        }
        (Wrist::new(&config, tissue_sensor, 1), config, tissue_sensor)
    }

    #[test]
    fn weight_is_read_down_and_the_accelerometer_up() {
        let (mut wrist, config, _) = quiet("gravity");
        let sample = wrist.measure(&UnitQuaternion::identity(), &WristLoads::default());
        let weight_n = GRAVITY_M_S2 * config.tool_mass_kg;
        assert!((sample.raw.force_n - Vector3::new(0.0, 0.0, -weight_n)).norm() < 1e-12);
        let by_hand = config.com_m.cross(&Vector3::new(0.0, 0.0, -weight_n));
        assert!((sample.raw.torque_nm - by_hand).norm() < 1e-12);
        let s1_from_imu = from_roll_pitch_yaw_deg(&config.imu.unwrap().s1_from_imu_deg);
        let up = s1_from_imu * sample.acceleration_m_s2.unwrap();
        assert!((up - Vector3::new(0.0, 0.0, GRAVITY_M_S2)).norm() < 1e-12);
    }

    #[test]
    fn both_sensors_feel_the_same_push_and_the_chain_joins_them() {
        let (mut wrist, config, sensor) = quiet("correspondence");
        let world_from_s1 = along_shaft(&Vector3::new(0.2, -0.3, -0.9).normalize());
        let push = Vector3::new(0.5, -1.0, 2.0);
        let loads = WristLoads { tip_n: push, ..WristLoads::default() };
        let sample = wrist.measure(&world_from_s1, &loads);
        let weight_n = world_from_s1.inverse() * Vector3::new(0.0, 0.0, -GRAVITY_M_S2 * config.tool_mass_kg);
        let at_wrist_n = sample.raw.force_n - weight_n;
        let sensor = sensor.unwrap();
        let c_from_s2 = from_roll_pitch_yaw_deg(&sensor.world_from_c_deg).inverse()
            * from_roll_pitch_yaw_deg(&sensor.world_from_s2_deg);
        let at_tissue_n = sample.s1_from_c().unwrap() * (c_from_s2 * sample.tissue_n.unwrap());
        assert!((at_wrist_n - at_tissue_n).norm() < 1e-12, "{at_wrist_n} {at_tissue_n}");
    }

    #[test]
    fn a_force_at_the_tip_and_one_at_the_wall_differ_in_torque() {
        let (mut wrist, config, _) = quiet("isolation");
        let side = Vector3::new(1.0, 0.0, 0.0);
        let mut torque = |loads: &WristLoads| wrist.measure(&UnitQuaternion::identity(), loads).raw.torque_nm.y;
        let none = torque(&WristLoads::default());
        let tip = torque(&WristLoads { tip_n: side, ..WristLoads::default() }) - none;
        let wall = torque(&WristLoads { wall: Some((side, 0.15)), ..WristLoads::default() }) - none;
        assert!((tip - config.shaft_m).abs() < 1e-12 && (wall - (config.shaft_m - 0.15)).abs() < 1e-12);
    }

    #[test]
    fn the_torque_of_what_jaws_hold_reaches_the_wrist_about_the_shaft() {
        let (mut wrist, ..) = quiet("isolation");
        let direction = Vector3::new(0.2, -0.3, -0.9).normalize();
        let mut torque = |loads: &WristLoads| wrist.measure(&along_shaft(&direction), loads).raw.torque_nm;
        let none = torque(&WristLoads::default());
        let twist = torque(&WristLoads { twist_nm: direction * 2e-4, ..WristLoads::default() }) - none;
        assert!((twist - Vector3::new(0.0, 0.0, 2e-4)).norm() < 1e-15, "{twist}");
    }

    #[test]
    fn the_wrist_looks_along_the_shaft() {
        for direction in [-Vector3::z(), Vector3::new(0.3, 0.4, -0.8).normalize(), Vector3::x()] {
            let world_from_s1 = along_shaft(&direction);
            assert!((world_from_s1 * Vector3::z() - direction).norm() < 1e-12);
        }
    }
}
