//! Code that runs in a tick must not allocate.
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
mod tip_force;
mod training;
mod whole_loop;
