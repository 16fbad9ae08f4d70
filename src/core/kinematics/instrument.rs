//! What hangs on the flange, where the base stands, and the pose of both together.
//!
//! `flange_from_s1` is the place of the wrist sensor; its z axis runs along the shaft, `shaft_m` from the sensor's origin to the tip.

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::gen3::{Chain, Joints};
use crate::frames::from_roll_pitch_yaw_deg;

/// How the arm is mounted and what it carries. All of it is measured on the rig: there is no default.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmSettings {
    /// Place of the arm's base in the workspace frame, m; zero where the workspace frame is that base.
    #[serde(default)]
    pub base_m: Vector3<f64>,
    /// Roll, pitch, yaw of `world_from_base`, degrees.
    #[serde(default)]
    pub base_deg: Vector3<f64>,
    /// Origin of the wrist sensor as seen from the flange, m.
    pub sensor_m: Vector3<f64>,
    /// Roll, pitch, yaw of `flange_from_s1`, degrees.
    pub sensor_deg: Vector3<f64>,
    /// From the sensor's origin along its z axis to the tip, m.
    pub shaft_m: f64,
}

/// Why an arm cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum ArmError {
    /// A length or angle is not finite.
    #[error("the arm's {field} is not a finite number: measure it and write it into the rig file")]
    NotFinite { field: &'static str },
    /// A shaft without length, or longer than any instrument.
    #[error("the shaft's length is {shaft_m} m: it must be above 0 and at most 1 m, from the sensor to the tip")]
    ShaftLength { shaft_m: f64 },
}

/// An arm with its instrument.
///
/// ```
/// use nalgebra::Vector3;
/// use nima_core::kinematics::{Arm, ArmError, ArmSettings, Joints};
///
/// let zero = Vector3::zeros();
/// let settings = ArmSettings { base_m: zero, base_deg: zero, sensor_m: zero, sensor_deg: zero, shaft_m: 0.4 };
/// let pose = Arm::new(&settings)?.pose(&Joints::zeros());
/// let s1_m = pose.world_from_s1.translation.vector;
/// assert!(((pose.tip_m - s1_m).norm() - 0.4).abs() < 1e-12, "the tip is a shaft's length from the sensor");
/// assert!(Arm::new(&ArmSettings { shaft_m: f64::NAN, ..settings }).is_err());
/// # Ok::<(), ArmError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Arm {
    world_from_base: IsometryMatrix3<f64>,
    flange_from_s1: IsometryMatrix3<f64>,
    shaft_m: f64,
}

impl Arm {
    /// Takes the settings in.
    ///
    /// # Errors
    /// When a number is not finite or the shaft's length is not in (0, 1] m.
    pub fn new(settings: &ArmSettings) -> Result<Self, ArmError> {
        let ArmSettings { base_m, base_deg, sensor_m, sensor_deg, shaft_m } = settings;
        let vectors = [("base_m", base_m), ("base_deg", base_deg), ("sensor_m", sensor_m), ("sensor_deg", sensor_deg)];
        for (field, vector) in vectors {
            if !vector.iter().all(|x| x.is_finite()) {
                return Err(ArmError::NotFinite { field });
            }
        }
        // Written so that NaN is refused too.
        if !(*shaft_m > 0.0 && *shaft_m <= 1.0) {
            return Err(ArmError::ShaftLength { shaft_m: *shaft_m });
        }
        Ok(Self {
            world_from_base: isometry(base_m, base_deg),
            flange_from_s1: isometry(sensor_m, sensor_deg),
            shaft_m: *shaft_m,
        })
    }

    /// From the sensor to the tip, m.
    pub const fn shaft_m(&self) -> f64 {
        self.shaft_m
    }

    /// Where the base stands.
    pub const fn world_from_base(&self) -> &IsometryMatrix3<f64> {
        &self.world_from_base
    }

    /// Where the wrist sensor sits.
    pub const fn flange_from_s1(&self) -> &IsometryMatrix3<f64> {
        &self.flange_from_s1
    }

    /// Where everything is at these joint angles (rad).
    pub fn pose(&self, joint_rad: &Joints) -> Pose {
        let chain = Chain::new(&self.world_from_base, joint_rad);
        let world_from_s1 = chain.world_from_flange * self.flange_from_s1;
        let axis = |i: usize| world_from_s1.rotation.matrix().column(i).into_owned();
        let direction = axis(2);
        let tip_m = world_from_s1.translation.vector + direction * self.shaft_m;
        Pose { chain, across: [axis(0), axis(1)], direction, tip_m, world_from_s1 }
    }
}

fn isometry(place_m: &Vector3<f64>, angles_deg: &Vector3<f64>) -> IsometryMatrix3<f64> {
    let rotation: Rotation3<f64> = from_roll_pitch_yaw_deg(angles_deg).to_rotation_matrix();
    IsometryMatrix3::from_parts(Translation3::from(*place_m), rotation)
}

/// Arm and instrument at one set of joint angles, all in `world`.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    /// The joints.
    pub chain: Chain,
    /// The wrist sensor.
    pub world_from_s1: IsometryMatrix3<f64>,
    /// Directions of the sensor's x and y, across the shaft.
    pub across: [Vector3<f64>; 2],
    /// Direction of the shaft towards the tip, unit length.
    pub direction: Vector3<f64>,
    /// Workspace frame.
    pub tip_m: Vector3<f64>,
}

impl Pose {
    /// Orientation of the wrist sensor, as [`crate::frames::WristSample`] carries it.
    pub fn orientation(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&self.world_from_s1.rotation)
    }

    /// How far the tip is beyond a point (m) along the shaft, m.
    pub fn insertion_m(&self, trocar_m: &Vector3<f64>) -> f64 {
        (self.tip_m - trocar_m).dot(&self.direction)
    }

    /// From a point to the nearest place on the shaft's axis, m; its norm is how far the axis misses the point.
    pub fn axis_miss_m(&self, trocar_m: &Vector3<f64>) -> Vector3<f64> {
        let way_m = self.tip_m - trocar_m;
        way_m - self.direction * way_m.dot(&self.direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> ArmSettings {
        ArmSettings {
            base_m: Vector3::new(-0.4, 0.1, 0.0),
            base_deg: Vector3::new(0.0, 0.0, 30.0),
            sensor_m: Vector3::new(0.0, 0.01, 0.06),
            sensor_deg: Vector3::new(0.0, 0.0, 15.0),
            shaft_m: 0.42,
        }
    }

    #[test]
    fn the_tip_is_where_chain_adapter_and_shaft_put_it() {
        let arm = Arm::new(&settings()).unwrap();
        // Stretched upwards: the flange looks up, so the tip is the adapter and the shaft above it.
        let pose = arm.pose(&Joints::zeros());
        assert!((pose.direction - Vector3::z()).norm() < 1e-12);
        assert!((pose.tip_m.z - (1.187_385 + 0.06 + 0.42)).abs() < 1e-9);
        let flange = pose.chain.world_from_flange;
        let by_hand = flange * nalgebra::Point3::new(0.0, 0.01, 0.48);
        assert!((by_hand.coords - pose.tip_m).norm() < 1e-12);
        assert!((pose.orientation() * Vector3::z() - pose.direction).norm() < 1e-12);
    }

    #[test]
    fn the_miss_is_square_to_the_shaft_and_the_insertion_along_it() {
        let pose = Arm::new(&settings()).unwrap().pose(&Joints::from([0.3, -0.5, 1.0, 1.2, -0.4, 0.8, 2.0]));
        let trocar_m = pose.tip_m - pose.direction * 0.12 + pose.across[0] * 0.003;
        assert!((pose.insertion_m(&trocar_m) - 0.12).abs() < 1e-12);
        assert!((pose.axis_miss_m(&trocar_m) + pose.across[0] * 0.003).norm() < 1e-12);
    }

    #[test]
    fn what_is_no_instrument_is_refused() {
        for shaft_m in [0.0, -0.1, 1.5, f64::NAN, f64::INFINITY] {
            assert!(matches!(Arm::new(&ArmSettings { shaft_m, ..settings() }), Err(ArmError::ShaftLength { .. })));
        }
        let broken = ArmSettings { base_deg: Vector3::new(0.0, f64::NAN, 0.0), ..settings() };
        assert_eq!(Arm::new(&broken).unwrap_err(), ArmError::NotFinite { field: "base_deg" });
    }
}
