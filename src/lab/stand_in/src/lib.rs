//! A stub of Force Dimension's `libdrd` (and `libdhd`): exports the symbols of SDK 3.17, with an emulated omega.7
//! behind them.
//!
//! Built in two forms: a shared library, which other programs load as the manufacturer's, and a Rust library, which
//! links the same functions into `nima` so that it needs no separate file.
//!
//! The pose of the handle comes from `nima emulate force-dimension` over a local UDP socket. Its address is in the
//! environment variable `NIMA_EMULATED_HANDLE` (several devices: several addresses, separated by commas), or is set by
//! the extra symbol `nimaEmulateHandle`. Without one no device is attached, and every call fails like the genuine
//! library's. Motors, watchdog and velocity threshold are in the emulated device, not here: they keep working when the
//! program that loaded this library hangs or dies.
//!
//! Symbols that neither our driver nor `forcedimension-core` uses return -1 with error 10 (feature not implemented). Units as in the SDK:
//! m, N, rad (or degrees by name), 125 us for the watchdog.
#![expect(unsafe_code, reason = "C symbols with C pointers")]
#![allow(non_snake_case, missing_docs, reason = "the names and their meaning are the SDK's")]
#![allow(clippy::missing_safety_doc, reason = "as in C: a pointer is null or points to as many values as the SDK says")]

pub mod devices;
pub mod drd;
pub mod errors;
mod handle;
pub mod motors;
mod outputs;
pub mod reading;
mod reading_history;
pub mod stubs;
pub mod wire;
