//! From the hand to the arm's joints: hand-eye mapping, remote centre of motion, Kinova Gen3.
//!
//! Takes the hand's pose (m, in the leader's frame) and the measured joint angles (rad); returns commanded joint angles
//! (rad), one step per tick, with the shaft through the trocar. Lengths in m, angles in rad, everything in the
//! workspace frame `world` unless the name says otherwise. Invalid settings are refused at construction, with the
//! reason. A tick always has a result: the nearest permitted position, or standing still. Nothing in a tick allocates,
//! waits or loops without bound.
//!
//! `HandEye::step` → target of the tip → `Inverse::step` → joint angles. To start: find a pose with [`find`], move
//! there, then call `Inverse::new`.

mod gen3;
mod hand_eye;
mod instrument;
mod inverse;
mod limits;
mod pace;
mod posture;
mod rcm;
mod ready;
mod start;
#[cfg(test)]
mod tests;
mod velocity;
mod wrist;

pub use gen3::{ACCELERATION_RAD_S2, Chain, JOINTS, Joints, LIMIT_RAD, SPEED_RAD_S, limit_margin_rad};
pub use hand_eye::{Hand, HandEye, Mapping, MappingError, Target, view_from_omega, world_from_tracked_view};
pub use instrument::{Arm, ArmError, ArmSettings, Pose};
pub use inverse::{Inverse, KEEP_OFF_RAD, Measures, START_MISS_M, Step};
pub use limits::JointLimits;
pub use rcm::{Confined, Rcm, RcmError, RcmSettings, Shaft};
pub use ready::{Ready, ReadyError, find};
pub use start::StartError;
pub use wrist::{Jaws, PITCH_MAX_RAD};
