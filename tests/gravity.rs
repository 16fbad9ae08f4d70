//! A gravity calibration for tests, recorded like a technician's.

use nima_core::calibration::gravity::{GravityRecord, GravitySession, GravitySessionSettings};
use nima_machine::{
    config::RigConfig,
    rig::{Outputs, Prompt, SensedForce, Side},
};
use nima_recording::store::utc_now;
use nima_simulation::{World, scene::Scene};

/// Returns a gravity calibration recorded sample by sample in its own scene.
pub fn gravity() -> GravityRecord {
    let scene = Scene::load("gravity").unwrap();
    let mut world = World::new(&scene, 1000.0);
    let mut session = GravitySession::new(GravitySessionSettings::default());
    for tick in 1..90_000 {
        let Some(target) = session.target() else { break };
        let t_s = f64::from(tick) * 1e-3;
        let prompt = Prompt::Hold { world_from_s1: target.world_from_s1() };
        let SensedForce::AtWrist(sample) = world.exchange(t_s, &Outputs { prompt, ..Outputs::SAFE }).unwrap().sensed
        else {
            panic!("a calibration scene without a wrist");
        };
        session.step(&sample, t_s);
    }
    let wrist = RigConfig::load("simulated").unwrap().simulated_wrist(Side::Right).cloned().unwrap();
    session.report().unwrap().record(&wrist.serial_number, &wrist.tool, &utc_now()).unwrap()
}
