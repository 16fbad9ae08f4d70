//! A gravity calibration for tests that need one, taken as a technician would.

use nima::{
    calibration::{
        gravity::{GravityRecord, GravitySession, SessionSettings},
        store::utc_now,
    },
    config::Scene,
    device::{Outputs, Prompt, Sensed},
    sim::World,
};

/// A gravity calibration taken sample by sample on its own scene.
pub(crate) fn gravity() -> GravityRecord {
    let scene = Scene::load("gravity").unwrap();
    let (mut world, mut session) = (World::new(&scene, 1000.0), GravitySession::new(SessionSettings::default()));
    for tick in 1..90_000 {
        let Some(target) = session.target() else { break };
        let t_s = f64::from(tick) * 1e-3;
        let prompt = Prompt::Hold { kbf_from_s1: target.kbf_from_s1() };
        let Sensed::AtWrist(sample) = world.exchange(t_s, &Outputs { prompt, ..Outputs::SAFE }).unwrap().sensed else {
            panic!("a calibration scene without a wrist");
        };
        session.step(&sample, t_s);
    }
    let wrist = scene.wrist.unwrap();
    session.report().unwrap().record(&wrist.serial, &wrist.tool, &utc_now()).unwrap()
}
