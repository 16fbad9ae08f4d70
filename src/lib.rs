//! The machine of NIMA Console: everything between a surgeon's hand and the tissue, without a screen.
//!
//! Rooms know only the rooms below them:
//! `files, statistics, frames, signal` < `kinematics, calibration, tip_force, impedance, safety` < `device, sim` < `teleop` <
//! `runtime` < `recording, study`.
//! SI units inside (m, s, N, rad); a name carries its unit and frame where the type does not.

pub mod calibration;
pub mod config;
pub mod device;
pub mod files;
pub mod frames;
pub mod impedance;
pub mod kinematics;
pub mod recording;
pub mod runtime;
pub mod safety;
pub mod signal;
pub mod sim;
pub mod statistics;
pub mod study;
pub mod teleop;
pub mod tip_force;
