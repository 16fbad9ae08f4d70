//! Simulation of hand, tissue, arm, and a person at the arm.
//!
//! Takes the loop's outputs and returns what a rig would measure (m, N, workspace frame). A scene lists the parts of a
//! simulation; parts that are not listed are not computed. Values that are not finite are ignored.

pub mod camera;
mod carrying;
mod desk;
mod feeling;
mod hand;
mod held;
mod person;
pub mod physics;
mod plan;
mod playing;
pub mod scene;
pub mod screen;
mod searching;
mod threading;
mod tissue;
mod trocar;
mod watched;
mod world;
mod worlds;
mod wrist;

pub use desk::Desk;
pub use hand::Hand;
pub use person::Person;
pub use plan::{Plan, run_virtual, run_virtual_on, start, start_on, start_simulated, start_watched};
pub use tissue::Tissue;
pub use trocar::Trocar;
pub use watched::{LoopSeen, MARKS_MAX, Mark, Moment, RINGS_MAX, Training, Watched};
pub use world::{Touch, World};
pub use worlds::Worlds;
