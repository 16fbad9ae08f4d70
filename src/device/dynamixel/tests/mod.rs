//! Tests of the codec, the emulator and the driver, each against the other and against vectors from the reference.

mod faults;
mod messages;
mod opening;
mod packets;
mod servos;
#[cfg(unix)]
mod terminal;
mod world;
