//! Human interface devices: six-axis caps (`SpaceMouse`) and foot pedals.
//!
//! Reports come from one of four sources behind [`TransportDatagrams`](super::transport::TransportDatagrams): a hidraw node (found by its
//! ids or opened by its path), the socket of this project's emulator, the socket of `spacenavd`, or a pair in memory
//! (tests). A device at rest cannot be distinguished from a dead one: both are silent. Therefore a switch is pressed
//! only by a report that has arrived, and unreadable, damaged, lost or outdated data count as released and as zero
//! ([`HeldValue`], [`RELEASE_AFTER_S`]).
//!
//! A pedal that is a keyboard also types into the focused window unless the udev rules of `nima devices --udev-rules`
//! are installed. A pedal must never be the only emergency stop.

pub mod cap_codec;
mod cap_driver;
mod driver;
mod models;
pub mod pedal_codec;
mod pedal_driver;
mod raw;
#[cfg(target_os = "linux")]
pub mod seqpacket;
pub mod source;
pub mod spacenavd;

#[cfg(test)]
mod tests;

pub use cap_codec::RELEASE_AFTER_S;
pub use cap_driver::{CapDriver, CapSettings};
pub use driver::HeldValue;
pub use models::{HidKind, HidModel, MODELS, known};
pub use pedal_driver::{PedalDriver, PedalRoles, PedalSettings};
pub use source::{HidIdentity, HidSource};
