//! Files: recordings of motion and force, sessions, data sets, trained networks, calibrations.
//!
//! Converts between bytes and the checked types of `nima-core`. Every reader refuses what it cannot interpret and
//! reports the position. Every writer writes a temporary file first and renames it, except the writer of a session,
//! whose file is valid at every moment while it grows.

pub mod bag;
pub mod csv;
pub mod messages;
pub mod session;
pub mod store;
pub mod tip_force;
