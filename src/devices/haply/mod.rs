//! Haply Inverse3 and Minverse: haptic handles with three axes, over a serial connection on USB.
//!
//! - Input: position (m) and velocity (m/s) of the grip, in the device's axes, relative to a centre in the rig file.
//!   There is no orientation, gripper or button: a `VerseGrip`, which has them, is a separate device.
//! - Output: force (N), limited by the rig file. The device answers each force with its position, so a tick is one
//!   request and one answer; there is no checksum, so an answer counts only with possible numbers.
//! - Force is zero while it is not wanted, when the handle is lost or closed, and when the supervisor pulls the lever,
//!   which writes to the connection itself. The device's reaction to a silent connection is not documented.
//! - The device is lost after 20 ms without an answer, ten impossible answers in a row, or data without a valid answer.
//!
//! The codes come from the manufacturer's own client (`HaplyHardwareAPI`); `tests/peers` compares both. The emulated
//! device is `nima_simulation::emulators::haply`.

pub mod codec;
mod driver;
mod opening;
mod settings;

#[cfg(test)]
mod tests;

pub use driver::{HaplyDriver, SILENCE_S};
pub use settings::{CENTRE_M, FORCE_LIMIT_N, HaplySettings};
