//! A device that a program of the lab brings: a handle, an arm or a force sensor, over UDP, without Rust.
//!
//! - Input: readings in SI units in the device's own frame; output: forces (N) or joint angles (rad). One datagram each
//!   way per period ([`codec`]), on the loopback unless the rig file names another computer.
//! - Whoever sends first is the peer, until it is lost; datagrams of others are dropped. At most [`READS_MAX`] are read
//!   in one tick, and who has more waiting than that delivers nothing in this tick.
//! - Each datagram names the newest one that its sender has heard, so the age of a reading is bounded without comparing
//!   clocks. A reading that is too old, repeated or out of order is counted and never handed on.
//! - The device is lost when its program closes its socket, or after `silence_ms` without a fresh reading, ten damaged
//!   or impossible datagrams in a row, or a fault that it reports itself. The program must have a watchdog of its own and
//!   tells its time in every datagram; a handle or an arm with a longer one than the rig file allows is refused.
//!
//! The wire and the clients in C and Python are described in `docs/external-device.md`; the clients are in
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

pub use arm::Arm;
pub use handle::Handle;
pub use line::READS_MAX;
pub use sensor::Sensor;
pub use settings::{Kind, Settings};
