//! Haply Inverse3 and Minverse: haptic handles with three axes, over their serial line on USB.
//!
//! - Input: position (m) and velocity (m/s) of the grip, in the device's axes, from a centre that the rig file names.
//!   There is no orientation, no gripper and no button: those of a `VerseGrip` are another device.
//! - Output: force (N), at most what the rig file allows. The device answers each force with its position, so a tick is
//!   one question and one answer; there is no checksum, so an answer counts only with possible numbers.
//! - Force is zero while it is not wanted, when the handle is lost or closed, and when the supervisor pulls the lever, which
//!   writes to the line itself. What the device does when its line falls silent is not documented.
//! - The device is lost after 20 ms without an answer, ten impossible answers in a row, or a line without a valid one.
//!
//! The codes are those of the manufacturer's own client (`HaplyHardwareAPI`); `tests/peers` holds the two together. The
//! emulated device is `nima_simulation::emulators::haply`.

pub mod codec;
mod driver;
mod opening;
mod settings;

#[cfg(test)]
mod tests;

pub use driver::{Driver, SILENCE_S};
pub use settings::{CENTRE_M, FORCE_LIMIT_N, Settings};
