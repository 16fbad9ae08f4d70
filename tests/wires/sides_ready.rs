//! The ready check over the wires distinguishes right and left by motion: the technician moves the right instrument,
//! and its own arm and marker must follow. The rig has no hand-eye calibration, so nothing else can distinguish them.
#![cfg(target_os = "linux")]
use std::time::{Duration, Instant};

use nima_machine::{
    config::RigConfig,
    messages::LoopState,
    ready::{CheckSubject, PersonRequest, ReadyArm, ReadyCause, ReadyPoint, ReadySession, ReadyState},
    rig::{Prompt, SIDES, Side, SideSwap},
};
use nima_simulation::{
    SimulationPlan,
    scene::Scene,
    screen::{PersonTask, Screen},
};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{at_tip, started};

const TIMEOUT: Duration = Duration::from_secs(40);
const OWN: ReadyPoint = ReadyPoint::Own(Side::Right);

/// Returns the result of the item, with the markers swapped or not.
fn found(are_exchanged: bool) -> ReadyState {
    let folder = tempfile::tempdir().unwrap();
    let devices = at_tip(folder.path());
    let emulated = started(&devices);
    if are_exchanged {
        emulated.exchange_markers();
    }
    let rig = RigConfig { devices: Some(devices), ..RigConfig::load("emulated").unwrap() };
    let scene = Scene::load("peg_transfer").unwrap();
    let plan = SimulationPlan { rig: rig.clone(), scene, calibrations: Default::default(), engage: false };
    let handle = nima_simulation::start(&plan).unwrap();
    let arms = [(); SIDES].map(|()| Some(ReadyArm { at_wrist: false, gravity: None, has_person: true }));
    let parts = handle.roster().iter().map(|entry| entry.part).collect();
    let gates_in_file = Some(rig.gates);
    let mut session = ReadySession::new(CheckSubject { rig, arms, parts, gates_in_file, is_date_behind: false });
    let technician = emulated.technician();
    let begin = Instant::now();
    loop {
        std::thread::sleep(Duration::from_millis(5));
        handle.drain_ticks(|tick| {
            assert!(tick.rendering.rendered_n.norm() == 0.0 && tick.state != LoopState::Engaged);
            session.tick(tick);
        });
        handle.gauges().for_each(|gauges| session.gauges(&gauges));
        if let Some(healths) = handle.healths() {
            session.healths(&healths);
        }
        session.look(begin.elapsed().as_secs_f64());
        let task =
            if session.ask() == PersonRequest::Move(Side::Right) { PersonTask::Gravity } else { PersonTask::Surgery };
        technician.reads(&Screen { side: Side::Right, task, prompt: Prompt::Rest });
        let state = session.list().iter().find(|entry| entry.check == OWN).unwrap().state;
        if matches!(state, ReadyState::Passed(_) | ReadyState::Failed(_)) {
            return state;
        }
        assert!(begin.elapsed() <= TIMEOUT, "{:?}", session.list());
    }
}

#[test]
#[ignore = "ten seconds of real time: `./dev test` runs it alone"]
fn a_marker_that_follows_the_other_instrument_is_told_as_exchanged() {
    let _alone = alone();
    judged(|| assert_eq!(found(true), ReadyState::Failed(ReadyCause::Exchanged(SideSwap::Markers))));
}

#[test]
#[ignore = "ten seconds of real time, and the first day by commands passes the same check: `./dev walk` runs it"]
fn an_instrument_with_its_own_arm_and_marker_passes() {
    let _alone = alone();
    judged(|| assert!(matches!(found(false), ReadyState::Passed(_))));
}
