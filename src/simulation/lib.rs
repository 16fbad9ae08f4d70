//! Simulation of hand, tissue, arm, and a person at the arm.
//!
//! Takes the loop's outputs and returns what a rig would measure (m, N, workspace frame). A scene lists the parts of a
//! simulation; parts that are not listed are not computed. Values that are not finite are ignored.

pub mod camera;
mod force_response;
mod hand;
mod hand_task;
mod haptic_input;
mod input_devices;
mod object_feed;
mod palpation_task;
pub mod physics;
mod plan;
mod ring_task;
pub mod scene;
pub mod screen;
mod simulated_person;
mod tissue;
mod training_task;
mod trocar;
mod wire_task;
mod world;
mod worlds;
mod wrist;

pub use hand::Hand;
pub use input_devices::InputDevices;
pub use object_feed::{LoopObservation, MARKS_MAX, ObjectFeed, ObjectMoment, PlaceMark, RINGS_MAX, Training};
pub use plan::{SimulationPlan, run_virtual, run_virtual_on, start, start_on, start_simulated, start_watched};
pub use simulated_person::Person;
pub use tissue::Tissue;
pub use trocar::Trocar;
pub use world::{HandForces, World};
pub use worlds::Worlds;
