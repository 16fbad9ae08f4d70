//! Shared by tests across crates: an emulated rig with other addresses, and a gravity calibration.
//!
//! The tests are three programs: `machine` on the virtual clock, `wires` in real time with emulated devices, and
//! `allocation`, which counts allocations.
#![expect(clippy::unwrap_used, clippy::missing_panics_doc, reason = "a test fails by panicking")]

#[cfg(unix)]
pub mod emulated;
pub mod gravity;
