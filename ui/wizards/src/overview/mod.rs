//! The page of the set-up of a rig: a tile for each step of each arm.

mod page;
mod tiles;

pub use page::overview_ui;
pub use tiles::SetupStep;

pub use nima_calibrations::overview::{ArmOverview, following, overview};
