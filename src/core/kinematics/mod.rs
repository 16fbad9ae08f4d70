//! From the hand to the arm's joints: hand-eye mapping, remote centre of motion, model of the arm.
//!
//! Takes the hand's pose (m, in the leader's frame) and the measured joint angles (rad); returns commanded joint angles
//! (rad), one step per tick, with the shaft through the trocar. Lengths in m, angles in rad, everything in the
//! workspace frame `world` unless the name says otherwise. Invalid settings are refused at construction, with the
//! reason. A tick always has a result: the nearest permitted position, or standing still. Nothing in a tick allocates,
//! waits or loops without bound.
//!
//! `HandEyeCoupling::step` → target of the tip → `Inverse::step` → joint angles. To start: find a pose with [`find`], move
//! there, then call `Inverse::new`.

mod arm_model;
mod gen3;
mod hand_eye;
mod instrument;
mod inverse;
mod joint_chain;
mod limits;
mod posture;
mod rcm;
mod speed_scale;
mod start;
mod start_pose;
#[cfg(test)]
mod tests;
mod velocity;
mod wrist;

pub use arm_model::{ArmChain, ArmModel, ArmModelError, ChainJoint, JOINTS};
pub use gen3::{ACCELERATION_RAD_S2, LIMIT_RAD, SPEED_RAD_S};
pub use hand_eye::{
    HandEyeCoupling, HandPose, MotionMapping, MotionMappingError, TipTarget, view_from_omega, world_from_tracked_view,
};
pub use instrument::{Arm, ArmError, ArmSettings, InstrumentPose};
pub use inverse::{Inverse, InverseStep, KEEP_OFF_RAD, PoseQuality, START_MISS_M};
pub use joint_chain::{JointChain, Joints};
pub use limits::JointLimits;
pub use rcm::{Rcm, RcmCorrection, RcmError, RcmSettings, RcmShaft};
pub use start::ArmStartError;
pub use start_pose::{Ready, ReadyError, find};
pub use wrist::{PITCH_MAX_RAD, WristJaws};
