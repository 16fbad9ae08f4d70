//! The instrument on the flange, the mounting of the base, and the pose of arm and instrument.
//!
//! `flange_from_s1` is the pose of the wrist sensor; its z axis runs along the shaft, and `shaft_m` is the distance
//! from the sensor's origin to the tip.

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{
    arm_model::{ArmModel, ArmModelError},
    joint_chain::{JointChain, Joints},
};
use crate::{frames::from_roll_pitch_yaw_deg, units};

/// Mounting of the arm and geometry of its instrument. All values are measured on the rig, so there are no defaults.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmSettings {
    /// Position of the arm's base in the workspace frame, m; zero if the workspace frame is the base's frame.
    #[serde(default)]
    pub base_m: Vector3<f64>,
    /// Roll, pitch, yaw of `world_from_base`, degrees.
    #[serde(default)]
    pub base_deg: Vector3<f64>,
    /// Origin of the wrist sensor in the frame of the flange, m.
    pub sensor_m: Vector3<f64>,
    /// Roll, pitch, yaw of `flange_from_s1`, degrees.
    pub sensor_deg: Vector3<f64>,
    /// Distance from the sensor's origin along its z axis to the tip, m.
    pub shaft_m: f64,
}

/// Maximum distance of an arm's base from the origin of the workspace, m: far more than a room needs.
const BASE_MAX_M: f64 = 10.0;
/// Maximum distance of the sensor from the flange, m.
const SENSOR_MAX_M: f64 = 0.5;
const SHAFT_MAX_M: f64 = 1.0;

/// Reason why the settings of an arm are invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ArmError {
    #[error("the arm's {field} is not a finite number: measure it and enter it in the rig file")]
    NotFinite { field: &'static str },
    #[error("the arm's {field} is {distance_m} m long: {}", units::length_remedy(*.distance_m, *.max_m))]
    TooFar { field: &'static str, distance_m: f64, max_m: f64 },
    #[error(
        "the shaft length of {shaft_m} m is out of range: it is the distance from the sensor to the tip, above 0; {}",
        units::length_remedy(*.shaft_m, SHAFT_MAX_M)
    )]
    ShaftLength { shaft_m: f64 },
    #[error("the joints of the arm are not known: load the rig from its file")]
    NoModel,
    #[error(transparent)]
    Model(#[from] ArmModelError),
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
    model: ArmModel,
    world_from_base: IsometryMatrix3<f64>,
    flange_from_s1: IsometryMatrix3<f64>,
    shaft_m: f64,
}

impl Arm {
    /// Creates a Gen3 with seven joints from checked settings.
    ///
    /// # Errors
    /// [`ArmError`] if a number is not finite, or no plausible length in m.
    pub fn new(settings: &ArmSettings) -> Result<Self, ArmError> {
        let ArmSettings { base_m, base_deg, sensor_m, sensor_deg, shaft_m } = settings;
        let vectors = [("base_m", base_m), ("base_deg", base_deg), ("sensor_m", sensor_m), ("sensor_deg", sensor_deg)];
        for (field, vector) in vectors {
            if !vector.iter().all(|x| x.is_finite()) {
                return Err(ArmError::NotFinite { field });
            }
        }
        for (field, vector, max_m) in [("base_m", base_m, BASE_MAX_M), ("sensor_m", sensor_m, SENSOR_MAX_M)] {
            let distance_m = vector.norm();
            if distance_m > max_m {
                return Err(ArmError::TooFar { field, distance_m, max_m });
            }
        }
        // Written so that NaN is rejected too.
        if !(*shaft_m > 0.0 && *shaft_m <= SHAFT_MAX_M) {
            return Err(ArmError::ShaftLength { shaft_m: *shaft_m });
        }
        Ok(Self {
            model: ArmModel::GEN3,
            world_from_base: isometry(base_m, base_deg),
            flange_from_s1: isometry(sensor_m, sensor_deg),
            shaft_m: *shaft_m,
        })
    }

    /// Replaces the Gen3 by another arm in the same mounting.
    #[must_use]
    pub const fn of_model(self, model: ArmModel) -> Self {
        Self { model, ..self }
    }

    pub const fn model(&self) -> &ArmModel {
        &self.model
    }

    /// Returns the distance from the sensor to the tip, m.
    pub const fn shaft_m(&self) -> f64 {
        self.shaft_m
    }

    pub const fn world_from_base(&self) -> &IsometryMatrix3<f64> {
        &self.world_from_base
    }

    pub const fn flange_from_s1(&self) -> &IsometryMatrix3<f64> {
        &self.flange_from_s1
    }

    /// Returns the pose of arm and instrument for these joint angles (rad).
    pub fn pose(&self, joint_rad: &Joints) -> InstrumentPose {
        let chain = JointChain::new(&self.model, &self.world_from_base, joint_rad);
        let world_from_s1 = chain.world_from_flange * self.flange_from_s1;
        let axis = |i: usize| world_from_s1.rotation.matrix().column(i).into_owned();
        let direction = axis(2);
        let tip_m = world_from_s1.translation.vector + direction * self.shaft_m;
        InstrumentPose { chain, across: [axis(0), axis(1)], direction, tip_m, world_from_s1 }
    }
}

fn isometry(place_m: &Vector3<f64>, angles_deg: &Vector3<f64>) -> IsometryMatrix3<f64> {
    let rotation: Rotation3<f64> = from_roll_pitch_yaw_deg(angles_deg).to_rotation_matrix();
    IsometryMatrix3::from_parts(Translation3::from(*place_m), rotation)
}

/// Arm and instrument for one set of joint angles, all in `world`.
#[derive(Clone, Copy, Debug)]
pub struct InstrumentPose {
    pub chain: JointChain,
    pub world_from_s1: IsometryMatrix3<f64>,
    /// Directions of the sensor's x and y, across the shaft.
    pub across: [Vector3<f64>; 2],
    /// Direction of the shaft towards the tip, unit length.
    pub direction: Vector3<f64>,
    pub tip_m: Vector3<f64>,
}

impl InstrumentPose {
    /// Returns the orientation of the wrist sensor, in the form of [`crate::frames::WristSample`].
    pub fn orientation(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&self.world_from_s1.rotation)
    }

    /// Returns the distance of the tip beyond a point (m) along the shaft, m.
    pub fn insertion_m(&self, trocar_m: &Vector3<f64>) -> f64 {
        (self.tip_m - trocar_m).dot(&self.direction)
    }

    /// Returns the vector from a point to the nearest point of the shaft's axis, m; its length is the distance between
    /// axis and point.
    pub fn axis_miss_m(&self, trocar_m: &Vector3<f64>) -> Vector3<f64> {
        let travel_m = self.tip_m - trocar_m;
        travel_m - self.direction * travel_m.dot(&self.direction)
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
        // With the arm stretched upwards the flange points up, so the tip is above it by the lengths of the adapter and
        // the shaft.
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
