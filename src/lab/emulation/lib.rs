//! Emulation: an emulator for every device on its real interface, and all devices of a rig file around simulated
//! worlds.
//!
//! The measured values of [`emulators`] come from a closure, a test or a world. [`emulated`] connects one for every
//! device of a rig file to the worlds of `nima_simulation`. The loop reaches them only through its drivers; no product
//! code depends on this crate.

#[cfg(test)]
#[cfg(target_os = "linux")]
mod desk_tests;
pub mod emulated;
pub mod emulators;
#[cfg(test)]
#[cfg(unix)]
mod simulated_arm_tests;
