//! Still poses of the tool, and checks of their validity.

use nalgebra::{UnitQuaternion, Vector3};

use super::{GravityError, GravitySource, model::arm_field_m_s2};
use crate::frames::Wrench;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// Mean reading of the accelerometer at rest (`imu`), m/s^2.
    Imu(Vector3<f64>),
    /// `world_from_s1` from the arm.
    Arm(UnitQuaternion<f64>),
}

/// A still pose: means over the time in which the tool was still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GravityPose {
    /// Mean wrench as read (`s1`), N and Nm.
    pub wrench: Wrench,
    /// Whether the torque was measured; otherwise it is ignored.
    pub has_torque: bool,
    pub orientation: Orientation,
}

impl GravityPose {
    pub const fn source(&self) -> GravitySource {
        match self.orientation {
            Orientation::Imu(_) => GravitySource::Imu,
            Orientation::Arm(_) => GravitySource::Arm,
        }
    }
}

/// One equation: the gravity vector in the source's frame (m/s^2) and the wrench that was read (`s1`).
#[derive(Clone, Copy, Debug)]
pub(super) struct GravityRow {
    pub(super) field_m_s2: Vector3<f64>,
    pub(super) wrench: Wrench,
    /// Place in the order of recording, from -1 to 1.
    pub(super) place: f64,
}

/// Interpretations of an orientation; all but `AsGiven` are common mistakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OrientationReading {
    AsGiven,
    Opposite,
    InverseRotation,
}

/// Returns the rows of these poses under this interpretation.
pub(super) fn rows(poses: &[GravityPose], imu_sign: i8, reading: OrientationReading) -> Vec<GravityRow> {
    let field = |pose: &GravityPose| match (pose.orientation, reading) {
        (Orientation::Imu(acceleration), OrientationReading::Opposite) => acceleration * f64::from(imu_sign),
        (Orientation::Imu(acceleration), _) => acceleration * -f64::from(imu_sign),
        (Orientation::Arm(world_from_s1), OrientationReading::AsGiven) => arm_field_m_s2(&world_from_s1),
        (Orientation::Arm(world_from_s1), OrientationReading::Opposite) => -arm_field_m_s2(&world_from_s1),
        (Orientation::Arm(world_from_s1), OrientationReading::InverseRotation) => {
            arm_field_m_s2(&world_from_s1.inverse())
        }
    };
    let place = |i: usize| 2.0 * i as f64 / (poses.len() - 1).max(1) as f64 - 1.0;
    let row =
        |(i, pose): (usize, &GravityPose)| GravityRow { field_m_s2: field(pose), wrench: pose.wrench, place: place(i) };
    poses.iter().enumerate().map(row).collect()
}

/// Refuses invalid poses; returns their common source.
pub(super) fn checked(poses: &[GravityPose]) -> Result<GravitySource, GravityError> {
    let source = poses.first().ok_or(GravityError::NoPoses)?.source();
    for (index, pose) in poses.iter().enumerate() {
        if pose.source() != source {
            return Err(GravityError::MixedSources { index });
        }
        let orientation_fits = match pose.orientation {
            Orientation::Imu(acceleration) => acceleration.iter().all(|x| x.is_finite()),
            Orientation::Arm(rotation) => rotation.coords.iter().all(|x| x.is_finite()),
        };
        let torque_fits = !pose.has_torque || pose.wrench.torque_nm.iter().all(|x| x.is_finite());
        if !(orientation_fits && torque_fits && pose.wrench.force_n.iter().all(|x| x.is_finite())) {
            return Err(GravityError::NotFinite { index });
        }
        if let Orientation::Imu(acceleration) = pose.orientation
            && acceleration.norm() < super::model::MIN_FIELD_M_S2
        {
            return Err(GravityError::DeadAccelerometer { index, norm_m_s2: acceleration.norm() });
        }
    }
    Ok(source)
}
