//! The parts of a scene at the wrist: sensor and tool, trocar, the sensor under the tissue, and the person at the arm.

use nalgebra::Vector3;
use nima_machine::config::{ConfigError, Ranges};
use serde::{Deserialize, Serialize};

/// Physics of a force-torque sensor (`s1`) between arm and instrument, and of the tool on it. Their identities are in
/// the rig file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WristModel {
    /// Mass of the tool on the sensor, kg.
    pub tool_mass_kg: f64,
    /// Centre of mass, m (`s1`).
    pub com_m: Vector3<f64>,
    /// From the sensor's origin along the shaft (z of `s1`) to the tip, m.
    pub shaft_m: f64,
    /// Reading without any load, N.
    pub force_bias_n: Vector3<f64>,
    /// Reading without any load, Nm.
    pub torque_bias_nm: Vector3<f64>,
    /// Scale factors of the force readings along x, y, z; 1 is correct.
    pub gain: Vector3<f64>,
    /// Standard deviation of white noise per sample and axis, N.
    pub force_noise_n: f64,
    /// Standard deviation of white noise per sample and axis, Nm.
    pub torque_noise_nm: f64,
    /// The inertial unit inside; first-generation serial sensors have none.
    pub imu: Option<Imu>,
}

/// The accelerometer inside the wrist sensor. At rest it reads `+g` away from the ground, opposite to the tool's
/// weight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Imu {
    /// Mounting inside the sensor: roll, pitch, yaw of `s1_from_imu`, degrees.
    pub s1_from_imu_deg: Vector3<f64>,
    /// Constant error, m/s^2 (`imu`).
    pub bias_m_s2: Vector3<f64>,
    /// Standard deviation of white noise per sample and axis, m/s^2.
    pub noise_m_s2: f64,
    /// Whether it reads towards the ground instead, as with some drivers.
    #[serde(default)]
    pub reads_gravity: bool,
}

/// Friction and support where the instrument passes the body wall.
///
/// Along the shaft the `LuGre` model (Canudas de Wit et al. 1995): elastic while sticking, breaks away at `static_n`,
/// slides at `coulomb_n` plus a viscous part; both increase with the lateral load. Across the shaft, the wall
/// straightens a tilted shaft, with friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrocarModel {
    /// Sliding friction along the shaft, N.
    pub coulomb_n: f64,
    /// Breakaway friction, N; not below `coulomb_n`.
    pub static_n: f64,
    /// Stribeck velocity: at this speed most of the static part is gone, m/s.
    pub stribeck_m_s: f64,
    /// Viscous friction along the shaft, N s/m.
    pub viscous_n_s_m: f64,
    /// Stretch of the seal before it slides, m.
    pub presliding_m: f64,
    /// Additional friction per N of lateral load.
    pub friction_per_load: f64,
    /// Lateral force of the wall per unit of tilt (sine of the angle from straight down), N.
    pub wall_n: f64,
    /// Sliding friction across the shaft, N.
    pub across_n: f64,
}

/// The sensor under the tissue (`s2`), the tracker's camera and the instrument's marker; only present during
/// calibration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TissueSensor {
    /// Orientation of the sensor: roll, pitch, yaw of `world_from_s2`, degrees.
    pub world_from_s2_deg: Vector3<f64>,
    /// Orientation of the camera: roll, pitch, yaw of `world_from_c`, degrees.
    pub world_from_c_deg: Vector3<f64>,
    /// Orientation of the marker on the instrument: roll, pitch, yaw of `s1_from_m`, degrees.
    pub s1_from_m_deg: Vector3<f64>,
    /// Standard deviation of white noise per sample and axis, N.
    pub noise_n: f64,
    /// Standard deviation of the tracker's orientation about each axis, degrees.
    pub tracker_noise_deg: f64,
    /// Whether it measures the force on the tissue instead of the force on the instrument, like a balance.
    #[serde(default)]
    pub reads_tissue: bool,
}

/// A person who guides the arm by hand and follows the instructions on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PersonModel {
    /// A mistake that the person makes, to test that the resulting data are refused.
    pub flaw: Option<Flaw>,
}

/// Mistakes that calibrations must detect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Flaw {
    /// Keeps a hand on the tool while the sensor is read.
    Touches,
    /// Never holds still.
    Trembles,
    /// Leaves the tool where it is, whatever orientation is requested.
    KeepsOneOrientation,
    /// Pushes along one line, whatever direction is requested.
    PushesOneLine,
    /// Pushes within one plane, whatever direction is requested.
    PushesOnePlane,
    /// Works only straight below the trocar, whatever position is requested.
    WorksInOnePlace,
    /// Leans on the tissue's stand at times, so that the two sensors measure different forces.
    LeansOnTheStand,
}

impl WristModel {
    pub(super) fn validate(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        ranges.positive("wrist.tool_mass_kg", self.tool_mass_kg)?;
        ranges.positive("wrist.shaft_m", self.shaft_m)?;
        ranges.finite("wrist.com_m", &self.com_m)?;
        ranges.finite("wrist.force_bias_n", &self.force_bias_n)?;
        ranges.finite("wrist.torque_bias_nm", &self.torque_bias_nm)?;
        for gain in &self.gain {
            ranges.positive("wrist.gain", *gain)?;
        }
        ranges.not_negative("wrist.force_noise_n", self.force_noise_n)?;
        ranges.not_negative("wrist.torque_noise_nm", self.torque_noise_nm)?;
        self.imu.map_or(Ok(()), |imu| {
            ranges.finite("wrist.imu.s1_from_imu_deg", &imu.s1_from_imu_deg)?;
            ranges.finite("wrist.imu.bias_m_s2", &imu.bias_m_s2)?;
            ranges.not_negative("wrist.imu.noise_m_s2", imu.noise_m_s2)
        })
    }
}

impl TrocarModel {
    pub(super) fn validate(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        ranges.not_negative("trocar.coulomb_n", self.coulomb_n)?;
        ranges.check("trocar.static_n", self.static_n, self.static_n >= self.coulomb_n, "not below coulomb_n")?;
        ranges.positive("trocar.stribeck_m_s", self.stribeck_m_s)?;
        ranges.not_negative("trocar.viscous_n_s_m", self.viscous_n_s_m)?;
        ranges.positive("trocar.presliding_m", self.presliding_m)?;
        ranges.not_negative("trocar.friction_per_load", self.friction_per_load)?;
        ranges.not_negative("trocar.wall_n", self.wall_n)?;
        ranges.not_negative("trocar.across_n", self.across_n)
    }
}

impl TissueSensor {
    pub(super) fn validate(&self, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
        ranges.finite("tissue_sensor.world_from_s2_deg", &self.world_from_s2_deg)?;
        ranges.finite("tissue_sensor.world_from_c_deg", &self.world_from_c_deg)?;
        ranges.finite("tissue_sensor.s1_from_m_deg", &self.s1_from_m_deg)?;
        ranges.not_negative("tissue_sensor.noise_n", self.noise_n)?;
        ranges.not_negative("tissue_sensor.tracker_noise_deg", self.tracker_noise_deg)
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;

    #[test]
    fn infinities_that_cancel_are_refused_with_the_name_of_their_vector() {
        const UP: f64 = f64::INFINITY;
        const DOWN: f64 = f64::NEG_INFINITY;
        let mut scene = Scene::load("correspondence").unwrap();
        scene.tissue = Scene::load("palpation").unwrap().tissue;
        let refused = |edit: fn(&mut Scene), key: &str| {
            let mut scene = scene.clone();
            edit(&mut scene);
            let message = scene.validate().unwrap_err().to_string();
            assert!(message.contains(key), "{key} is not in: {message}");
        };
        refused(|scene| scene.targets_m[0].y = f64::NAN, "targets_m");
        refused(|scene| scene.tissue.as_mut().unwrap().size_m[0] = f64::NAN, "tissue.size_m");
        refused(|scene| scene.wrist.as_mut().unwrap().com_m = [UP, DOWN, 0.0].into(), "wrist.com_m is inf");
        refused(|scene| scene.wrist.as_mut().unwrap().force_bias_n.y = f64::NAN, "wrist.force_bias_n is NaN");
        refused(|scene| scene.wrist.as_mut().unwrap().torque_bias_nm.z = UP, "wrist.torque_bias_nm");
        refused(|scene| scene.wrist.as_mut().unwrap().gain.y = UP, "wrist.gain");
        refused(|scene| scene.wrist.as_mut().unwrap().gain.z = f64::NAN, "wrist.gain");
        refused(|scene| scene.wrist.as_mut().unwrap().imu.as_mut().unwrap().bias_m_s2.x = DOWN, "wrist.imu.bias_m_s2");
        let turned =
            |scene: &mut Scene| scene.tissue_sensor.as_mut().unwrap().world_from_c_deg = [DOWN, UP, 1.0].into();
        refused(turned, "tissue_sensor.world_from_c_deg is -inf");
    }
}
