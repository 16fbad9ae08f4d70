//! Shared by tests across crates: a plan of the simulated rig, an emulated rig with other addresses, and a gravity calibration.
//!
//! The tests are three programs: `machine` on the virtual clock, `wires` in real time with emulated devices, and
//! `allocation`, which counts allocations.
#![expect(clippy::unwrap_used, clippy::missing_panics_doc, reason = "a test fails by panicking")]

#[cfg(unix)]
pub mod emulated;
pub mod gravity;
pub mod studies;

use nima_machine::config::RigConfig;
use nima_simulation::{SimulationPlan, scene::Scene};

/// Returns the simulated rig in this scene, without calibrations; it engages by itself. The methods of others can be
/// chosen in it.
pub fn plan(scene: &str) -> SimulationPlan {
    nima_baselines::provide();
    SimulationPlan {
        rig: RigConfig::load("simulated").unwrap(),
        scene: Scene::load(scene).unwrap(),
        calibrations: Default::default(),
        engage: true,
    }
}
