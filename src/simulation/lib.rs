//! Simulation: hand, tissue, arm, a person at the arm, and an emulator for every device on its real interface.
//!
//! Takes the loop's outputs and returns what a rig would measure (m, N, workspace frame). A scene lists what a
//! simulation contains; what it does not list is not computed. [`emulated`] connects emulators for every device of a
//! rig file to such worlds. Values that are not finite are ignored.
#![warn(missing_docs)]

mod carrying;
mod desk;
pub mod emulated;
pub mod emulators;
mod feeling;
mod hand;
mod held;
mod person;
mod plan;
mod playing;
pub mod scene;
mod searching;
#[cfg(test)]
#[cfg(unix)]
mod simulated_arm_tests;
mod threading;
mod tissue;
mod trocar;
mod watched;
mod world;
mod worlds;
mod wrist;

pub use desk::Desk;
pub use hand::Hand;
pub use plan::{Plan, run_virtual, run_virtual_on, start, start_on, start_simulated, start_watched};
pub use tissue::Tissue;
pub use trocar::Trocar;
pub use watched::{LoopSeen, MARKS_MAX, Mark, Moment, RINGS_MAX, Training, Watched};
pub use world::World;
pub use worlds::Worlds;
