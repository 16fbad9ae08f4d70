use thiserror::Error;

use super::{arm_model::ArmModel, joint_chain::Joints};

/// Reason why the inverse kinematics cannot start from the arm's current joint angles.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ArmStartError {
    #[error("the period of the inverse kinematics, {period_s} s, is out of range: use more than 0 and at most 0.02 s")]
    Period { period_s: f64 },
    #[error("the shaft of {shaft_m} m is too short for an insertion of {insertion_max_m} m: correct one of them")]
    ShortShaft { shaft_m: f64, insertion_max_m: f64 },
    #[error("joint {joint} of the arm reports a non-finite angle: check the arm's connection")]
    NotFinite {
        /// Counted from 1.
        joint: usize,
    },
    #[error(
        "joint {joint} is at {angle_deg:.1} degrees, beyond its limit of {limit_deg:.1} degrees: move the arm off the limit by hand"
    )]
    AtLimit {
        /// Counted from 1.
        joint: usize,
        angle_deg: f64,
        limit_deg: f64,
    },
    #[error("the shaft's axis misses the trocar by {miss_m:.4} m (limit {max_m} m): move the arm to the ready pose")]
    BesideTrocar {
        /// Distance of the axis from the trocar, m.
        miss_m: f64,
        max_m: f64,
    },
    #[error("the instrument is inserted {insertion_m:.4} m beyond the trocar: insert it into the body before starting")]
    NotInserted {
        /// Along the shaft, m; negative outside the body.
        insertion_m: f64,
    },
}

/// Checks that every angle is finite and within its range.
pub(super) fn check_joints(model: &ArmModel, joint_rad: &Joints) -> Result<(), ArmStartError> {
    for (i, angle) in joint_rad.iter().enumerate().take(model.joints) {
        if !angle.is_finite() {
            return Err(ArmStartError::NotFinite { joint: i + 1 });
        }
        if model.margin_rad(i, *angle) <= 0.0 {
            let [low_rad, high_rad] = model.range_rad(i);
            let limit = if *angle >= high_rad { high_rad } else { low_rad };
            return Err(ArmStartError::AtLimit {
                joint: i + 1,
                angle_deg: angle.to_degrees(),
                limit_deg: limit.to_degrees(),
            });
        }
    }
    Ok(())
}
