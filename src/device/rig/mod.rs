//! The devices of a rig together: what the rig file says of them.

mod settings;

pub use settings::{ArmSet, SensorPlace, Settings};
