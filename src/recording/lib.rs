//! Files: recordings of motion and force, data sets, trained networks, calibrations.
//!
//! Converts between bytes and the checked types of `nima-core`. Every reader refuses what it does not understand and
//! reports the position; every writer writes a temporary file first and renames it.
#![warn(missing_docs)]

pub mod csv;
pub mod messages;
pub mod session;
pub mod store;
pub mod tip_force;
