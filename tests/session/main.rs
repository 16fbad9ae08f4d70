//! Sessions: recorded and replayed, bit for bit.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod another_build;
mod bench;
mod faults;
mod file;
mod network;
mod round_trip;
