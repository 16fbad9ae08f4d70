//! Everything simulated: hand, tissue, arm, the person at it, and an emulator for every device on its real wire.
//!
//! Takes the loop's outputs and gives what a rig would measure (m, N, workspace frame). A scene lists what a simulation contains; what it
//! does not list is not computed. [`emulated`] puts an emulator for every device of a rig file around such worlds. Bad input: what is not
//! finite is ignored.
#![warn(missing_docs)]

#[cfg(unix)]
mod desk;
pub mod emulated;
pub mod emulators;
mod hand;
mod person;
mod plan;
pub mod scene;
#[cfg(test)]
#[cfg(unix)]
mod simulated_arm_tests;
mod tissue;
mod trocar;
mod world;
mod worlds;
mod wrist;

#[cfg(unix)]
pub use desk::Desk;
pub use hand::Hand;
pub use plan::{Plan, run_virtual, start, start_on, start_simulated};
pub use tissue::Tissue;
pub use trocar::Trocar;
pub use world::World;
pub use worlds::Worlds;
