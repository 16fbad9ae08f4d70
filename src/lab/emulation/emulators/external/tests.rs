//! Driver, probe and emulator over this computer's network.

use std::time::{Duration, Instant};

use nima_core::kinematics::ArmModel;
use nima_devices::{
    ConnectionState, Device as _, DeviceError, Follower as _, Loss,
    discovery::{probe_named, probes},
    external::{ExternalArm, ExternalSettings},
};
use nima_testing::real_time::judged;

use super::*;
use crate::emulators::{
    EmulatorThread,
    kinova::{StandIn, opening_tests::six_joints},
};

fn serving(joints: usize) -> (EmulatorThread, ExternalSettings) {
    let free = std::net::UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let arm = EmulatedExternalArm { listen: free, joints, serial: "E-6".to_owned() };
    let mut at = [0.3; ARM_JOINTS];
    at[joints..].fill(0.0);
    (arm.with(StandIn::at(at)).serve().unwrap(), ExternalSettings::at(free))
}

/// Maximum step of a target between two commands, rad: 0.2 rad/s at 1 kHz.
const STEP_RAD: f64 = 2e-4;

/// Polls for this long, leading all joints to this angle in small steps once the arm follows.
fn lead(arm: &mut ExternalArm, begin: Instant, length: Duration, target_rad: Option<f64>) -> Option<[f64; 7]> {
    let end = Instant::now() + length;
    let mut newest: Option<[f64; ARM_JOINTS]> = None;
    let mut led_rad = None;
    while Instant::now() < end {
        if let Some(reading) = arm.poll(begin.elapsed().as_secs_f64()) {
            newest = Some(reading.value.joint_rad);
        }
        if let (Some(end_rad), Some(measured_rad)) = (target_rad, newest) {
            arm.enter_servoing();
            let mut target: [f64; ARM_JOINTS] = led_rad.unwrap_or(measured_rad);
            for rad in &mut target[..6] {
                *rad += (end_rad - *rad).clamp(-STEP_RAD, STEP_RAD);
            }
            // Refused until the arm reports that it follows.
            led_rad = arm.aim(&target).then_some(target);
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    newest
}

#[test]
fn an_arm_of_six_joints_is_led_and_holds_when_it_is_left() {
    judged(|| {
        let (_serving, settings) = serving(6);
        let mut arm = ExternalArm::open(&settings, &six_joints()).unwrap();
        assert_eq!(arm.identity().serial, "E-6");
        let begin = Instant::now();
        let led = lead(&mut arm, begin, Duration::from_millis(900), Some(0.35)).unwrap();
        assert!(led[..6].iter().all(|rad| (rad - 0.35).abs() < 2e-3) && led[6].to_bits() == 0, "{led:?}");
        drop(arm);
        let mut again = ExternalArm::open(&settings, &six_joints()).unwrap();
        let held = lead(&mut again, Instant::now(), Duration::from_millis(50), None).unwrap();
        assert!(held[..6].iter().all(|rad| (rad - 0.35).abs() < 5e-3), "{held:?}");
    });
}

#[test]
fn a_probe_without_a_rig_reads_an_arm_of_any_number_of_joints_as_a_rig_of_that_arm_does() {
    judged(|| {
        for (joints, model) in [(6, six_joints()), (7, ArmModel::GEN3)] {
            let (_serving, settings) = serving(joints);
            let timeout = Duration::from_millis(600);
            let named = probe_named(&format!("external-arm={}", settings.listen)).unwrap().probe(timeout);
            let in_rig = probes::external_arm("right arm", settings.clone(), model).probe(timeout);
            for found in [named.unwrap(), in_rig.unwrap()] {
                assert_eq!((found.standing, found.identity.serial.as_str()), (ConnectionState::Connected, "E-6"));
                assert!(found.readings > 100, "{joints} joints: {found:?}");
            }
        }
        // A rig that describes another arm still refuses it.
        let (_serving, settings) = serving(6);
        let other = ExternalArm::open(&settings, &ArmModel::GEN3).err().unwrap();
        assert!(matches!(&other, DeviceError::WrongProduct { found, .. } if found.contains("6 joints")), "{other}");
    });
}

#[test]
fn every_fault_is_reported() {
    judged(|| {
        for (fault, expected) in [
            (EmulatedFault::Silence, Loss::Silent),
            (EmulatedFault::BadChecksum, Loss::Corrupt),
            (EmulatedFault::WrongFrame, Loss::Corrupt),
            (EmulatedFault::NotANumber, Loss::Implausible),
            (EmulatedFault::DeviceFault, Loss::Device { code: FAULT.into() }),
        ] {
            let (serving, settings) = serving(6);
            let mut arm = ExternalArm::open(&settings, &six_joints()).unwrap();
            let begin = Instant::now();
            lead(&mut arm, begin, Duration::from_millis(50), None);
            serving.faults.set(fault);
            lead(&mut arm, begin, Duration::from_millis(150), None);
            assert_eq!(arm.health().standing, ConnectionState::Lost(expected), "{fault:?}");
        }
    });
}
