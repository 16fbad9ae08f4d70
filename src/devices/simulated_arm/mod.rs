//! An arm without hardware: joints that follow their commands with a first-order lag. It has no
//! protocol and no emulator.
//!
//! For tests of a handle and a sensor without an arm. Commands are checked like those of the real arm
//! ([`Guard`](crate::kinova::limits::Guard)); servoing starts one tick after the request. Angles in rad. The caller
//! gives the time with every poll.

mod driver;
mod settings;

pub use driver::SimulatedArmDriver;
pub use settings::SimulatedArmSettings;
