//! A device connected by a user's program: a handle, an arm or a force sensor, over UDP, without Rust.
//!
//! - Input: readings in SI units in the device's own frame; output: forces (N) or joint angles (rad). One datagram each
//!   way per period ([`codec`]), on the loopback unless the rig file names another computer.
//! - The first sender is the peer until it is lost; datagrams of others are dropped. At most [`READS_MAX`] are read in
//!   one tick, and a sender with more pending datagrams delivers nothing in that tick.
//! - Each datagram names the newest one that its sender has received, so the age of a reading is bounded without
//!   comparing clocks. A reading that is too old, repeated or out of order is counted and never passed on.
//! - The device is lost when its program closes its socket, or after `silence_ms` without a fresh reading, ten
//!   consecutive damaged or impossible datagrams, or a fault that it reports. The program must have its own watchdog
//!   and reports the watchdog's time in every datagram; a handle or an arm with a longer time than the rig file allows
//!   is refused.
//!
//! `docs/external-device.md` describes the protocol and the clients in C and Python; the clients are in
//! `assets/external`.

mod arm;
pub mod codec;
mod handle;
mod line;
mod opening;
mod sensor;
mod settings;

#[cfg(test)]
mod tests;

pub use arm::ExternalArm;
pub use handle::ExternalHandle;
pub use line::READS_MAX;
pub use sensor::ExternalSensor;
pub use settings::{ExternalKind, ExternalSettings};
