//! Tests: every device of an emulated rig is first diagnosed as working; then each is made to fail, and the correct
//! cause and remedy must be reported in time.
#![cfg(target_os = "linux")]
use std::time::{Duration, Instant};

use nima_devices::{
    DeviceError, bota,
    discovery::{DiscoveryDiagnosis, TIMEOUT, TestOutcome, diagnose},
    force_dimension,
};
use nima_emulation::emulators::{EmulatedFault, force_dimension::EmulatedHand};
use nima_machine::rig::{RigSettings, rig_probes};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{elsewhere, started};

fn tried(devices: &RigSettings) -> Vec<DiscoveryDiagnosis> {
    let of_right = devices.right.as_ref().map(|right| right.sensor.bota().unwrap().transport);
    let right_is_first_generation = of_right == Some(bota::Transport::Gen0);
    let begin = Instant::now();
    let found = diagnose(rig_probes(devices), TIMEOUT);
    // A device that does not answer is waited for as long as the rig would wait: 8 s for a first-generation sensor.
    assert!(begin.elapsed() < Duration::from_secs(10), "{:?}", begin.elapsed());
    for one in &found {
        // A first-generation sensor restarts when it is opened.
        let starts_anew = one.name == "tissue sensor" || one.name == "right sensor" && right_is_first_generation;
        let is_connected = matches!(one.outcome, TestOutcome::Connected(_));
        let max_s = if starts_anew { 2.0 } else { 1.0 } + if is_connected { 0.0 } else { 8.0 };
        assert!(one.took_s < max_s, "{one:?}");
        println!("{:14} {:4.0} ms {}", one.name, one.took_s * 1e3, words(one));
    }
    found
}

fn words(one: &DiscoveryDiagnosis) -> String {
    match &one.outcome {
        TestOutcome::Connected(found) => {
            format!("connected: {}, {:?} Hz, {} lost", found.identity.product, found.rate_hz, found.lost)
        }
        TestOutcome::Trouble { cause, cure, .. } => format!("{cause} -> {cure}"),
    }
}

fn trouble<'a>(found: &'a [DiscoveryDiagnosis], name: &str) -> &'a DeviceError {
    let one = found.iter().find(|one| one.name == name).unwrap();
    match &one.outcome {
        TestOutcome::Trouble { trouble, cure, .. } => {
            assert!(cure.len() > 10, "{one:?}");
            trouble
        }
        TestOutcome::Connected(_) => panic!("{name} is well: {one:?}"),
    }
}

/// Asserts the kind of trouble of each device.
macro_rules! assert_reported {
    ($found:expr, $($name:literal => $kind:pat),+ $(,)?) => {{
        let found = &$found;
        $(assert!(matches!(trouble(found, $name), $kind), "{}: {:?}", $name, trouble(found, $name));)+
    }};
}

/// Returns whether all are connected at their expected rates.
fn all_well(found: &[DiscoveryDiagnosis]) -> bool {
    found.iter().all(|one| match &one.outcome {
        TestOutcome::Trouble { .. } => false,
        TestOutcome::Connected(connected) => {
            // Devices that are polled, or that report only changes, have no fixed rate.
            let usual_hz = match one.name.as_str() {
                "tracker" => Some(60.0),
                "tissue sensor" => Some(800.0),
                "right sensor" | "left sensor" | "right handle" | "left handle" => Some(1000.0),
                _ => None,
            };
            let within = |usual_hz: f64| connected.rate_hz.is_some_and(|hz| hz > 0.7 * usual_hz && hz < 1.3 * usual_hz);
            connected.damaged == 0 && !connected.identity.product.is_empty() && usual_hz.is_none_or(within)
        }
    })
}

#[test]
fn a_running_rig_is_reported_without_trouble() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = elsewhere(folder.path());
        let rig = started(&devices);
        // On a busy computer a device may seem silent at times.
        let tries: Vec<_> = (0..5).map(|_| tried(&devices)).take_while(|found| !all_well(found)).collect();
        assert!(tries.len() < 5, "{:#?}", tries.last());
        let served: Vec<_> = rig.servings().iter().map(|device| device.name.clone()).collect();
        let names: Vec<_> = tried(&devices).into_iter().map(|one| one.name).collect();
        assert_eq!(names, served, "the same devices by the same names");
    });
}

#[test]
fn a_rig_that_does_not_run_is_reported_device_by_device() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let found = tried(&elsewhere(folder.path()));
    assert_reported!(found,
        "right handle" => DeviceError::Absent { .. },
        "left arm" => DeviceError::NobodyListens { .. },
        "right sensor" => DeviceError::Absent { .. },
        "left sensor" => DeviceError::NobodyListens { .. },
        "right servos" => DeviceError::Absent { .. },
        "tissue sensor" => DeviceError::Absent { .. },
        "pedal" => DeviceError::Absent { .. },
    );
    assert!(found.iter().all(|one| matches!(one.outcome, TestOutcome::Trouble { .. })), "{found:?}");
}

#[test]
fn wrong_settings_are_reported_with_the_device_that_answers() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = elsewhere(folder.path());
        let _rig = started(&devices);
        let mut wrong = devices.clone();
        let right = wrong.right.as_mut().unwrap();
        right.handle.force_dimension_mut().unwrap().library = Some("/no/such/libdrd.so.3".into());
        right.arm.kinova_mut().unwrap().password = "guess".to_owned();
        right.sensor.bota_mut().unwrap().transport = bota::Transport::Gen0;
        right.servos.as_mut().unwrap().baud = 57_600;
        let left = wrong.left.as_mut().unwrap();
        left.handle.force_dimension_mut().unwrap().serial = Some(9999);
        left.sensor.bota_mut().unwrap().serial_number = Some("12345".to_owned());
        wrong.tissue_sensor.as_mut().unwrap().bota_mut().unwrap().baud = 921_600;
        wrong.tracker.as_mut().unwrap().tools[0] = folder.path().join("none.rom");
        let found = tried(&wrong);
        assert_reported!(found,
            "right handle" => DeviceError::SdkMissing { .. },
            "right arm" => DeviceError::RefusedLogin { .. },
            "right sensor" => DeviceError::WrongProduct { .. },
            "right servos" => DeviceError::WrongBaud { .. },
            "left handle" => DeviceError::Absent { .. },
            "left sensor" => DeviceError::OtherSerial { .. },
            "tissue sensor" => DeviceError::WrongBaud { .. },
            "tracker" => DeviceError::File { .. },
        );
        let mut other = devices;
        other.right.as_mut().unwrap().servos.as_mut().unwrap().servos[2].model = Some("XM540-W270".to_owned());
        assert_reported!(tried(&other), "right servos" => DeviceError::WrongProduct { .. });
    });
}

#[test]
fn silence_and_faults_of_every_device_are_reported() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = elsewhere(folder.path());
        let rig = started(&devices);
        let all = |fault| {
            rig.servings().iter().for_each(|device| device.serving.faults.set(fault));
            // An emulator that waits for its client checks its fault switch once per millisecond.
            std::thread::sleep(Duration::from_millis(20));
        };
        all(EmulatedFault::Silence);
        assert_reported!(tried(&devices),
            "right handle" => DeviceError::Absent { .. },
            "right arm" => DeviceError::Silent { .. },
            "right sensor" => DeviceError::Silent { .. },
            "right servos" => DeviceError::Silent { .. },
            "left sensor" => DeviceError::Silent { .. },
            "tissue sensor" => DeviceError::Silent { .. },
            "tracker" => DeviceError::Silent { .. },
        );
        all(EmulatedFault::DeviceFault);
        assert_reported!(tried(&devices),
            "right handle" => DeviceError::DeviceFault { .. },
            "right arm" => DeviceError::DeviceFault { .. },
            "right sensor" => DeviceError::DeviceFault { .. },
            "right servos" => DeviceError::DeviceFault { .. },
            "left sensor" => DeviceError::DeviceFault { .. },
            "tissue sensor" => DeviceError::DeviceFault { .. },
            "tracker" => DeviceError::DeviceFault { .. },
        );
    });
}

#[test]
fn a_device_in_use_and_one_that_waits_for_calibration_are_reported() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let mut devices =
            RigSettings { left: None, tracker: None, endoscope: None, pedal: None, ..elsewhere(folder.path()) };
        let rig = started(&devices);
        let right = devices.right.as_ref().unwrap();
        let sensor = bota::BotaDriver::open(right.sensor.bota().unwrap()).unwrap();
        let held = (sensor, force_dimension::open(right.handle.force_dimension().unwrap()).unwrap());
        assert_reported!(tried(&devices),
            "right sensor" => DeviceError::Busy { .. },
            "right handle" => DeviceError::Busy { .. },
        );
        drop((held, rig));
        let waiting = nima_emulation::emulators::force_dimension::EmulatedForceDimension {
            serial: 77,
            reset: true,
            ..nima_emulation::emulators::force_dimension::EmulatedForceDimension::default()
        };
        let serving = waiting.with(EmulatedHand::default().body()).serve().unwrap();
        let handle = devices.right.as_mut().unwrap().handle.force_dimension_mut().unwrap();
        handle.serial = Some(77);
        handle.emulator = Some(serving.endpoint.parse().unwrap());
        assert_reported!(tried(&devices), "right handle" => DeviceError::NotReady { .. });
    });
}
