//! The rig with its real drivers, on emulated devices and real interfaces, in real time.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod connecting;
mod device_faults;
mod emulated_rig;
mod endoscope;
mod external;
mod frames;
mod haply;
mod killed;
mod one_core;
mod other_arm;
mod raw_readings;
mod rig_diagnosis;
mod sides;
mod sides_ready;
mod technician;
mod watchdogs;
