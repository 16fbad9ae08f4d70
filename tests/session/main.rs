//! Sessions: recorded and replayed, bit for bit.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod another_build;
#[cfg(target_os = "linux")]
mod bad_disk;
mod bench;
mod clocks;
mod faults;
mod file;
mod images;
mod long;
mod network;
mod objects;
mod round_trip;
mod unknown_force;
