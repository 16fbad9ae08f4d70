//! Watchdogs triggered on purpose over the wires: the real emergency releases of handle and arm are called, nothing is
//! lost, and the arm engages afterwards as before.
use std::time::{Duration, Instant};

use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState, Tick, Watchdog},
    runtime::LoopHandle,
};
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{right_arm, started};

/// Waits for such a tick; in a state without drives no force may be commanded.
fn until(handle: &LoopHandle, what: &str, good: impl Fn(&Tick) -> bool) {
    let began = Instant::now();
    let mut newest = None;
    while !newest.as_ref().is_some_and(&good) {
        let state = newest.as_ref().map(|tick: &Tick| tick.state);
        assert!(began.elapsed() <= Duration::from_secs(10), "never came: {what}; {state:?}");
        handle.drain_ticks(|tick| {
            let driven = tick.state.permits().drives;
            assert!(
                driven || tick.rendering.rendered_n.norm() == 0.0,
                "{what}: {} N",
                tick.rendering.rendered_n.norm()
            );
            newest = Some(*tick);
        });
        handle.drain_events(|_| {});
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn every_watchdog_bites_in_idle_twice_and_the_arm_engages_afterwards() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = right_arm(folder.path());
    judged(|| {
        let _rig = started(&devices);
        let config = RigConfig { devices: Some(devices.clone()), ..RigConfig::load("emulated").unwrap() };
        let scene = Scene::load("peg_transfer").unwrap();
        let plan = SimulationPlan { rig: config, scene, calibrations: Default::default(), engage: false };
        let handle = nima_simulation::start(&plan).unwrap();
        let is = |state: LoopState| move |tick: &Tick| tick.state == state;
        // It starts idle, before its devices are connected.
        until(&handle, "a second of samples", |tick| tick.state == LoopState::Idle && tick.t_s > 2.0);
        for watchdog in Watchdog::ALL.into_iter().chain(Watchdog::ALL) {
            assert!(handle.send(Command::TestWatchdog(watchdog)));
            let bitten = |tick: &Tick| matches!(tick.state, LoopState::Faulted(fault) if watchdog.raises(fault));
            until(&handle, "its fault", bitten);
            // The data arrive again.
            std::thread::sleep(Duration::from_millis(50));
            assert!(handle.send(Command::ReleaseStop));
            until(&handle, "released", is(LoopState::Idle));
        }
        std::thread::sleep(Duration::from_millis(100));
        assert!(handle.send(Command::Engage));
        until(&handle, "engaged", is(LoopState::Engaged));
    });
}
