//! Emulation: an emulator for every device on its real interface, and all devices of a rig file around simulated worlds.
//!
//! [`emulators`] are fed by a closure, a test or a world with what a device would measure. [`emulated`] connects one for every device of a
//! rig file to the worlds of `nima_simulation`. The loop reaches them through its drivers alone; nothing of the product names this crate.

#[cfg(test)]
#[cfg(target_os = "linux")]
mod desk_tests;
pub mod emulated;
pub mod emulators;
#[cfg(test)]
#[cfg(unix)]
mod simulated_arm_tests;
