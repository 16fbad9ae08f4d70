//! Code that runs in a tick allocates nothing.
//!
//! The counter counts for the thread that asks, but tests on wires must not wait for a core: each test holds `alone`.

mod bota;
mod counting;
mod dynamixel;
mod force_dimension;
mod hid;
mod kinematics;
mod kinova;
mod ndi;
mod tip_force;
mod whole_loop;
