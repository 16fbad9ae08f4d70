//! Computation of forces from measurements: identification, rendering, safety, calibration, kinematics.
//!
//! Takes samples of motion (m) and force (N) and the time (s); returns forces, models and verdicts. This crate uses no
//! files, devices, threads or clocks, and nothing in a tick allocates. SI units (m, s, N, rad); a name contains its
//! unit and frame if the type does not.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod calibration;
pub mod frames;
pub mod impedance;
pub mod kinematics;
pub mod limits;
pub mod noise;
pub mod safety;
mod side;
pub mod signal;
pub mod statistics;
pub mod task;
pub mod tip_force;
pub mod units;

pub use side::{SIDES, Side};
