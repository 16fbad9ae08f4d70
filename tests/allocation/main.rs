//! Code that runs in a tick must not allocate, or make a system call that can wait.
//!
//! The counter counts per thread, but tests with real connections must not wait for a processor core, so each test
//! holds `alone`.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod ati;
mod bota;
mod counting;
mod device_rig;
mod dynamixel;
mod external;
mod force_dimension;
mod haply;
mod hid;
mod kinematics;
mod kinova;
mod ndi;
mod network;
mod remote;
mod rings;
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod system_calls;
mod tip_force;
mod training;
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
mod watched_calls;
mod whole_loop;
