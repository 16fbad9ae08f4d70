//! Input of a frame calibration: poses of flange, marker and handle, and the wrench at the wrist.

use nalgebra::{Isometry3, Vector3};
use serde::{Deserialize, Serialize};

use super::FrameError;
use crate::{calibration::gravity, frames::Wrench};

/// A position farther away than this cannot belong to a rig, m: the numbers are probably in millimetres.
const FARTHEST_M: f64 = 10.0;

/// Measurements of one moment, or the means over a still pose. Quantities that a rig does not measure are `None`.
///
/// The poses of the other side are not used for a fit. They reveal whether two markers or two arms were confused.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameSample {
    /// Pose of the arm's flange in the frame of the arm's base, m, from the joints ([`crate::kinematics::JointChain`]).
    pub base_from_flange: Option<Isometry3<f64>>,
    /// Pose of the other arm's flange, in that arm's own base frame.
    pub other_base_from_flange: Option<Isometry3<f64>>,
    /// Pose of the instrument's marker in the tracker camera's frame, m.
    pub c_from_m: Option<Isometry3<f64>>,
    /// Pose of the other instrument's marker in the same frame.
    pub c_from_other_m: Option<Isometry3<f64>>,
    /// Pose of the haptic handle in the leader's frame, m.
    pub leader_from_handle: Option<Isometry3<f64>>,
    /// Unprocessed wrench on the wrist sensor (`s1`), N and Nm.
    pub wrench: Option<Wrench>,
}

/// The part that moves during the recording of a calibration, and the frame in which it is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Carrier {
    /// The instrument's marker, in the frame of the tracker's camera (`c_from_m`).
    Marker,
    /// The arm's flange, in the frame of the arm's base (`base_from_flange`).
    Flange,
    /// The handle, in the leader's frame (`leader_from_handle`).
    Handle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationSource {
    Flange,
    /// The tracker, with the marker in view.
    Marker,
    Handle,
    Wrench,
}

impl Carrier {
    pub const fn source(self) -> CalibrationSource {
        match self {
            Self::Marker => CalibrationSource::Marker,
            Self::Flange => CalibrationSource::Flange,
            Self::Handle => CalibrationSource::Handle,
        }
    }
}

impl FrameSample {
    /// Converts a gravity pose whose orientation came from the arm, with the mount `flange_from_s1` that was active
    /// then and the mounting of the base; returns `None` for a pose by the accelerometer. Only its orientation and
    /// force may be used.
    pub fn of_gravity_pose(
        pose: &gravity::GravityPose,
        flange_from_s1: &nalgebra::UnitQuaternion<f64>,
        world_from_base: &nalgebra::UnitQuaternion<f64>,
    ) -> Option<Self> {
        let gravity::Orientation::Arm(world_from_s1) = pose.orientation else { return None };
        let base_from_flange = world_from_base.inverse() * world_from_s1 * flange_from_s1.inverse();
        // A gravity pose has no position; only its rotation is used.
        let pose_m = Isometry3::from_parts(Vector3::zeros().into(), base_from_flange);
        Some(Self { base_from_flange: Some(pose_m), wrench: Some(pose.wrench), ..Self::default() })
    }

    pub const fn pose(&self, carrier: Carrier) -> Option<&Isometry3<f64>> {
        match carrier {
            Carrier::Marker => self.c_from_m.as_ref(),
            Carrier::Flange => self.base_from_flange.as_ref(),
            Carrier::Handle => self.leader_from_handle.as_ref(),
        }
    }

    pub(super) const fn pose_mut(&mut self, carrier: Carrier) -> Option<&mut Isometry3<f64>> {
        match carrier {
            Carrier::Marker => self.c_from_m.as_mut(),
            Carrier::Flange => self.base_from_flange.as_mut(),
            Carrier::Handle => self.leader_from_handle.as_mut(),
        }
    }

    /// Returns the pose of the same carrier on the other side; the other handle is not available.
    pub(super) const fn other_pose(&self, carrier: Carrier) -> Option<&Isometry3<f64>> {
        match carrier {
            Carrier::Marker => self.c_from_other_m.as_ref(),
            Carrier::Flange => self.other_base_from_flange.as_ref(),
            Carrier::Handle => None,
        }
    }

    pub(super) const fn has(&self, source: CalibrationSource) -> bool {
        match source {
            CalibrationSource::Marker => self.c_from_m.is_some(),
            CalibrationSource::Flange => self.base_from_flange.is_some(),
            CalibrationSource::Handle => self.leader_from_handle.is_some(),
            CalibrationSource::Wrench => self.wrench.is_some(),
        }
    }

    pub(super) fn poses(&self) -> [Option<Isometry3<f64>>; 5] {
        [
            self.base_from_flange,
            self.other_base_from_flange,
            self.c_from_m,
            self.c_from_other_m,
            self.leader_from_handle,
        ]
    }

    /// Returns the sample with these poses, in the order of [`Self::poses`].
    pub(super) const fn with_poses(self, poses: &[Option<Isometry3<f64>>; 5]) -> Self {
        let [base_from_flange, other_base_from_flange, c_from_m, c_from_other_m, leader_from_handle] = *poses;
        Self { base_from_flange, other_base_from_flange, c_from_m, c_from_other_m, leader_from_handle, ..self }
    }

    /// Returns whether every number is finite and every rotation has length one.
    pub fn is_finite(&self) -> bool {
        let sound = |pose: &Isometry3<f64>| {
            // A quaternion of another length is a damaged number, not a rotation.
            let unit = (pose.rotation.coords.norm() - 1.0).abs() < 1e-6;
            unit && pose.translation.vector.iter().all(|x| x.is_finite())
        };
        self.poses().iter().flatten().all(sound) && self.wrench.is_none_or(|wrench| wrench.is_finite())
    }

    fn farthest_m(&self) -> f64 {
        self.poses().iter().flatten().map(|pose| pose.translation.vector.norm()).fold(0.0, f64::max)
    }
}

/// Refuses samples that lack a source or are not valid measurements.
pub(super) fn check(samples: &[FrameSample], needs: &[CalibrationSource]) -> Result<(), FrameError> {
    for (index, sample) in samples.iter().enumerate() {
        if let Some(&from) = needs.iter().find(|&&source| !sample.has(source)) {
            return Err(FrameError::Missing { index, from });
        }
        if !sample.is_finite() {
            return Err(FrameError::NotFinite { index });
        }
        let place_m = sample.farthest_m();
        if place_m > FARTHEST_M {
            return Err(FrameError::NotPlausible { index, place_m });
        }
    }
    Ok(())
}
