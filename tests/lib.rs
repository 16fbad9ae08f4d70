//! What tests across crates share: an emulated rig away from its fixed places, and a gravity calibration.
//!
//! The tests themselves are three programs beside this file: `machine` on the virtual clock, `wires` in real time with emulated devices, and
//! `allocation`, which counts allocations.
#![expect(clippy::unwrap_used, clippy::missing_panics_doc, reason = "a test fails by panicking")]

#[cfg(unix)]
pub mod emulated;
pub mod gravity;
