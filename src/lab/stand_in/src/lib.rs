//! Stands in for Force Dimension's `libdrd` (and `libdhd`): exports the symbols of SDK 3.17, with an emulated omega.7 behind them.
//!
//! It is built in two forms: a shared library, which other programs load as the manufacturer's, and a Rust library, by which `nima` has
//! the same functions linked in and needs no file beside it.
//!
//! Where the handle is comes from `nima emulate force-dimension` over a local UDP socket whose address the environment variable
//! `NIMA_EMULATED_HANDLE` names (several devices: several addresses, with commas), or the extra symbol `nimaEmulateHandle`.
//! Without one no device is attached and every call fails as the genuine library's does. Motors, watchdog and velocity threshold
//! live in the emulated device, not here: they work on when the program that loaded this library hangs or dies.
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
mod motion;
pub mod motors;
mod places;
pub mod reading;
pub mod stubs;
pub mod wire;
