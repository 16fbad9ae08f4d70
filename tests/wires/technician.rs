//! The simulated technician at the emulated arms, over the wires: all actions are visible only through the drivers.
//! `calibrate_rig::from_boxes_to_first_touch` (commands) does every calibration of both arms.
#![cfg(target_os = "linux")]
use std::time::{Duration, Instant};

use nima_core::calibration::gravity::{GravitySession, GravitySessionSettings};
use nima_devices::ARM_JOINTS;
use nima_emulation::emulated::EmulatedRig;
use nima_machine::{
    config::RigConfig,
    messages::Tick,
    rig::{Prompt, RigSettings, SIDES, Side},
    runtime::LoopHandle,
};
use nima_simulation::{
    SimulationPlan,
    scene::Scene,
    screen::{PersonTask, Screen},
};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{elsewhere, started};

/// Number of poses at each arm.
const POSES: usize = 3;
/// An arm is at rest if its joints rotate by no more than this, rad, in this time, s.
const STILL_RAD: f64 = 1e-4;
const STILL_S: f64 = 0.3;

/// An emulated rig and the loop over its wires.
pub(super) struct Fixture {
    pub(super) rig: EmulatedRig,
    handle: LoopHandle,
    newest: [Option<Tick>; SIDES],
}

impl Fixture {
    /// Creates the loop of these devices, idle, over the emulators of `rig`.
    pub(super) fn start(rig: EmulatedRig, devices: &RigSettings) -> Self {
        let config = RigConfig { devices: Some(devices.clone()), ..RigConfig::load("emulated").unwrap() };
        let scene = Scene::load("peg_transfer").unwrap();
        let plan = SimulationPlan { rig: config, scene, calibrations: Default::default(), engage: false };
        let handle = nima_simulation::start(&plan).unwrap();
        Self { rig, handle, newest: [None; SIDES] }
    }

    /// Reads every tick of a side until `good`; returns whether this happened in time.
    pub(super) fn until(&mut self, side: Side, within: Duration, mut good: impl FnMut(&Self, &Tick) -> bool) -> bool {
        let begin = Instant::now();
        while begin.elapsed() < within {
            let mut ticks = Vec::new();
            self.handle.drain_ticks(|tick| ticks.push(*tick));
            self.handle.drain_events(|_| {});
            for tick in ticks {
                self.newest[tick.side.index()] = Some(tick);
                if tick.side == side && good(self, &tick) {
                    return true;
                }
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        false
    }

    pub(super) fn show(&self, side: Side, task: PersonTask, prompt: Prompt) {
        self.rig.technician().reads(&Screen { side, task, prompt });
    }

    /// Waits until the arm of this side has not moved for a while: the technician has then carried it to the start.
    pub(super) fn rests(&mut self, side: Side) {
        let mut at_rad = [f64::INFINITY; ARM_JOINTS];
        let mut since_s = 0.0;
        self.until(side, Duration::from_secs(20), |bench, tick| {
            let joint_rad = bench.rig.truth(side).unwrap().joint_rad;
            let moved = joint_rad.iter().zip(&at_rad).any(|(now, then)| (now - then).abs() > STILL_RAD);
            if moved {
                at_rad = joint_rad;
                since_s = tick.t_s;
            }
            tick.t_s - since_s > STILL_S
        });
    }

    /// Returns whether the loop's state has the instrument through its trocar.
    fn is_in_trocar(tick: &Tick) -> bool {
        tick.calibration.wrist.as_ref().is_some_and(|sample| sample.insertion_m.is_some_and(|depth_m| depth_m > 0.0))
    }
}

#[test]
#[ignore = "twenty seconds in real time, also within each calibration: `./dev walk` runs it"]
fn the_technician_takes_poses_at_the_arm_that_is_calibrated_and_puts_the_instrument_back() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = elsewhere(folder.path());
    judged(|| {
        let mut bench = Fixture::start(started(&devices), &devices);
        for side in Side::ALL {
            let other = bench.rig.truth(side.other()).unwrap().joint_rad;
            let mut session = GravitySession::new(GravitySessionSettings::default());
            let taken = bench.until(side, Duration::from_secs(40), |bench, tick| {
                let target = session.target().unwrap();
                bench.show(side, PersonTask::Gravity, Prompt::Hold { world_from_s1: target.world_from_s1() });
                if let Some(sample) = &tick.calibration.wrist {
                    session.step(sample, tick.t_s);
                }
                session.poses().len() == POSES
            });
            assert!(taken, "{side:?}: {} poses", session.poses().len());
            assert!(!Fixture::is_in_trocar(&bench.newest[side.index()].unwrap()), "{side:?}: it is out of the trocar");
            let still = bench.rig.truth(side.other()).unwrap().joint_rad;
            assert_eq!(other.map(f64::to_bits), still.map(f64::to_bits), "{side:?}: he is at one arm only");
            bench.show(side, PersonTask::Surgery, Prompt::Rest);
            let back = bench.until(side, Duration::from_secs(20), |_, tick| Fixture::is_in_trocar(tick));
            assert!(back, "{side:?}: the instrument is not in its trocar again");
            // The technician has left, so the arm rests.
            bench.rests(side);
        }
    });
}
