//! Tests of faults while the driver connects: each has its own cause.

use std::{
    io::{Read as _, Write as _},
    net::TcpListener,
    time::Duration,
};

use nima_core::kinematics::ArmModel;
use nima_devices::{
    ARM_JOINTS, DeviceError,
    discovery::probe_named,
    kinova::{FaultClearing, KinovaSettings, open, open_clearing},
};
use nima_machine::config::urdf::{ChainEnds, chain_of};
use nima_testing::real_time::judged;

use super::driver_tests::{Ticking, patient, started, started_with};
use crate::emulators::{
    EmulatedFault,
    kinova::{EmulatedKinova, StandIn},
};

#[test]
fn every_trouble_while_opening_has_its_cause() {
    judged(|| {
        let trouble = |arm: EmulatedKinova, change: fn(&mut KinovaSettings)| {
            let (serving, mut settings) = started(arm);
            settings.timeout_s = 0.5;
            change(&mut settings);
            let trouble = open(&settings).map(|_| ()).unwrap_err();
            assert!(serving.is_serving() && !trouble.cure().is_empty());
            trouble
        };
        let same = |_: &mut KinovaSettings| {};
        let refused = trouble(patient(), |settings| settings.password = "wrong".to_owned());
        assert!(matches!(refused, DeviceError::RefusedLogin { user, .. } if user == "admin"));
        let refused = trouble(patient(), |settings| settings.user = "nobody".to_owned());
        assert!(matches!(refused, DeviceError::RefusedLogin { user, .. } if user == "nobody"));
        let other = trouble(EmulatedKinova { joints: 6, ..patient() }, same);
        assert!(matches!(other, DeviceError::WrongProduct { found, .. } if found == "arm with 6 joints"));
        let exchanged = trouble(EmulatedKinova { serial: "KP-2".to_owned(), ..patient() }, |settings| {
            settings.serial_number = Some("KP-1".to_owned());
        });
        assert!(matches!(exchanged, DeviceError::OtherSerial { found, .. } if found == "KP-2"));
        let starting = trouble(EmulatedKinova { idle_state: 3, ..patient() }, same);
        assert!(matches!(starting, DeviceError::NotReady { mode, .. } if mode == "initialisation"));
        let nobody =
            |change: fn(&mut KinovaSettings)| matches!(trouble(patient(), change), DeviceError::NobodyListens { .. });
        assert!(nobody(|settings| settings.tcp_port = 1) && nobody(|settings| settings.udp_port = 1));
        let setting =
            |change: fn(&mut KinovaSettings)| matches!(trouble(patient(), change), DeviceError::Setting { .. });
        assert!(setting(|settings| settings.speed_fraction = 1.5) && setting(|settings| settings.lead_rad = f64::NAN));
    });
}

#[test]
fn a_silent_arm_and_a_stranger_at_its_port_are_told_apart() {
    judged(|| {
        let (serving, settings) = started(patient());
        let settings = KinovaSettings { timeout_s: 0.3, ..settings };
        serving.faults.set(EmulatedFault::Silence);
        assert!(matches!(open(&settings).unwrap_err(), DeviceError::Silent { .. }));
        serving.faults.set(EmulatedFault::DeviceFault);
        let fault = open(&settings).unwrap_err();
        assert!(
            matches!(&fault, DeviceError::DeviceFault { words, .. } if words.contains("joint 3: too much torque")),
            "{fault}"
        );
        let stranger = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let tcp_port = stranger.local_addr().unwrap().port();
        let answering = std::thread::spawn(move || {
            let (mut stream, _) = stranger.accept().unwrap();
            let mut buffer = [0; 256];
            assert!(stream.read(&mut buffer).unwrap() > 0);
            stream.write_all(b"HTTP/1.1 400 Bad Request\r\n\r\n").unwrap();
        });
        let trouble = open(&KinovaSettings { tcp_port, ..settings }).unwrap_err();
        assert!(matches!(&trouble, DeviceError::WrongProduct { .. }), "{trouble}");
        answering.join().unwrap();
    });
}

/// Returns the shipped model of a Gen3 with six joints.
pub(in crate::emulators) fn six_joints() -> ArmModel {
    let text = include_str!("../../../../../assets/arms/gen3-6dof.urdf");
    let ends = ChainEnds { base_link: "base_link", flange_link: "end_effector_link" };
    ArmModel::new(&chain_of(text, ends, 2.0).unwrap()).unwrap()
}

#[test]
fn a_gen3_with_six_joints_is_led_by_its_description_and_no_other_arm_is() {
    judged(|| {
        let model = six_joints();
        let (_serving, settings) = started(patient());
        let other = open_clearing(&settings, &model, &FaultClearing::default()).unwrap_err();
        assert!(matches!(other, DeviceError::WrongProduct { found, .. } if found == "arm with 7 joints"));
        let body = StandIn::at([0.3; ARM_JOINTS]);
        let (_serving, settings) = started_with(EmulatedKinova { joints: 6, ..patient() }, body);
        let found =
            probe_named(&format!("kinova={} tcp={} udp={}", settings.host, settings.tcp_port, settings.udp_port))
                .unwrap()
                .probe(Duration::from_secs(5))
                .unwrap();
        assert!(found.readings > 0 && found.identity.serial == patient().serial, "without a rig file: {found:?}");
        let driver = open_clearing(&settings, &model, &FaultClearing::default()).unwrap();
        let mut ticking = Ticking { driver, now_s: 0.0, reading: None };
        ticking.enter_low_level();
        let begin_rad = *ticking.driver.command_rad();
        let mut target_rad = begin_rad.map(|rad| rad + 0.05);
        target_rad[6] = 0.0;
        for _ in 0..200 {
            ticking.lead(&target_rad);
        }
        let reading = ticking.latest();
        assert!(reading.servoing && reading.joint_rad[6].abs() < 1e-12, "{reading:?}");
        let miss_rad = |joint: usize| (reading.joint_rad[joint] - target_rad[joint]).abs();
        assert!((0..6).all(|joint| miss_rad(joint) < 1e-3), "{reading:?}");
    });
}
