//! The loop's process is killed during a contact: the watchdogs of the devices must remove the force and hold the arm.
#![cfg(target_os = "linux")]
use std::{
    fs,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

use nima_core::impedance::Mode;
use nima_emulation::{
    emulated::{Truth, provide_handles},
    emulators::force_dimension::FirmwareMode as Motors,
};
use nima_machine::{
    config::RigConfig,
    rig::{RigSettings, Side},
};
use nima_simulation::SimulationPlan;
use nima_testing::real_time::{alone, judged};
use nima_tests::{
    emulated::{right_arm, started},
    plan,
};

/// Environment variable with the rig file of the process that is killed.
const RIG: &str = "NIMA_TEST_RIG";
/// Watchdog of the handle in the rig file, s.
const WATCHDOG_S: f64 = 0.020;
/// Watchdog of the emulated arm, s.
const ARM_WATCHDOG_S: f64 = 0.050;
/// Allowance for a shared computer, s.
const SLACK_S: f64 = 0.030;

/// The process that is killed; started by the test below.
#[test]
#[ignore = "run by the other test, which kills it"]
fn the_loop_of_another_process() {
    let Ok(rig) = std::env::var(RIG) else { return };
    provide_handles();
    let plan = SimulationPlan { rig: RigConfig::load(&rig).unwrap(), ..plan("peg_transfer") };
    let _handle = nima_simulation::start(&plan).unwrap();
    std::thread::sleep(Duration::from_mins(1));
}

/// Returns a rig that presses on tissue and holds still, so that the hand feels a steady force.
fn pressing_rig(devices: RigSettings) -> RigConfig {
    let mut rig = RigConfig { devices: Some(devices), mode: Mode::Dfr, ..RigConfig::load("emulated").unwrap() };
    rig.gates.static_hold = true;
    rig
}

struct Killed(Child);

impl Drop for Killed {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

#[test]
#[ignore = "real lines in real time: `./dev test` runs it alone"]
fn a_killed_process_leaves_no_force_in_the_hand() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = right_arm(folder.path());
        let rig = started(&devices);
        let rig_file = folder.path().join("rig.toml");
        fs::write(&rig_file, toml::to_string(&pressing_rig(devices)).unwrap()).unwrap();
        let truth = || rig.truth(Side::Right).unwrap();
        let loop_of_another_process = || {
            let child = Command::new(std::env::current_exe().unwrap())
                .args(["killed::the_loop_of_another_process", "--exact", "--ignored"])
                .env(RIG, &rig_file)
                .stdout(Stdio::null())
                .spawn();
            Killed(child.unwrap())
        };
        let until = |within: Duration, good: &dyn Fn(&Truth) -> bool| {
            let begin = Instant::now();
            while begin.elapsed() < within {
                if good(&truth()) {
                    return Some(begin.elapsed().as_secs_f64());
                }
                std::thread::sleep(Duration::from_micros(200));
            }
            None
        };
        // A busy computer may stall the loop before there is a contact: then it has stopped, and the test restarts it.
        let feels = |child: Killed| {
            until(Duration::from_secs(8), &|truth| truth.applied.force_n.norm() > 0.5 && truth.servoing).map(|_| child)
        };
        let mut child = (0..4).find_map(|_| feels(loop_of_another_process())).expect("the hand feels something");
        child.0.kill().unwrap();
        let free_s = until(Duration::from_secs(1), &|truth| truth.applied.mode != Motors::Force).expect("no force");
        let held_s = free_s + until(Duration::from_secs(1), &|truth| !truth.servoing).expect("the arm holds");
        println!("killed: no force after {:.1} ms, the arm holds after {:.1} ms", free_s * 1e3, held_s * 1e3);
        assert!(truth().applied.force_n.norm() < 1e-12);
        assert!(free_s < WATCHDOG_S + SLACK_S && held_s < ARM_WATCHDOG_S + 2.0 * SLACK_S, "{free_s} s, {held_s} s");
    });
}
