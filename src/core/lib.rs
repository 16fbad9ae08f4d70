//! Everything between a measurement and a force.
//!
//! Takes samples of motion (m) and force (N) and the time (s); gives forces, models and verdicts. It knows no file, no device, no
//! thread and no clock, and nothing in a tick allocates. SI units inside (m, s, N, rad); a name carries its unit and frame where the
//! type does not.
#![warn(missing_docs)]

pub mod calibration;
pub mod frames;
pub mod impedance;
pub mod kinematics;
pub mod noise;
pub mod safety;
pub mod signal;
pub mod statistics;
pub mod tip_force;
