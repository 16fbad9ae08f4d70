//! Every device of an emulated rig is first diagnosed as in order; then each is made to fail, and the right cause and
//! remedy must be reported in time.
#![cfg(target_os = "linux")]
use std::time::{Duration, Instant};

use nima_devices::{
    Trouble, bota,
    discovery::{Diagnosis, Outcome, TIMEOUT, diagnose},
    force_dimension,
};
use nima_emulation::emulators::{EmulatedFault, force_dimension::Held};
use nima_machine::rig::{Settings, rig_probes};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{elsewhere, started};

fn tried(devices: &Settings) -> Vec<Diagnosis> {
    let of_right = devices.right.as_ref().map(|right| right.sensor.bota().unwrap().transport);
    let right_is_first_generation = of_right == Some(bota::Transport::Gen0);
    let begin = Instant::now();
    let found = diagnose(rig_probes(devices), TIMEOUT);
    assert!(begin.elapsed() < Duration::from_secs(2), "{:?}", begin.elapsed());
    for one in &found {
        // A first-generation sensor restarts when it is opened.
        let starts_anew = one.name == "tissue sensor" || one.name == "right sensor" && right_is_first_generation;
        let most_s = if starts_anew { 2.0 } else { 1.0 };
        assert!(one.took_s < most_s, "{one:?}");
        println!("{:14} {:4.0} ms {}", one.name, one.took_s * 1e3, words(one));
    }
    found
}

fn words(one: &Diagnosis) -> String {
    match &one.outcome {
        Outcome::Connected(found) => {
            format!("connected: {}, {:?} Hz, {} lost", found.identity.product, found.rate_hz, found.lost)
        }
        Outcome::Trouble { cause, cure, .. } => format!("{cause} -> {cure}"),
    }
}

fn trouble<'a>(found: &'a [Diagnosis], name: &str) -> &'a Trouble {
    let one = found.iter().find(|one| one.name == name).unwrap();
    match &one.outcome {
        Outcome::Trouble { trouble, cure, .. } => {
            assert!(cure.len() > 10, "{one:?}");
            trouble
        }
        Outcome::Connected(_) => panic!("{name} is well: {one:?}"),
    }
}

/// Asserts the kind of trouble of each device.
macro_rules! assert_told {
    ($found:expr, $($name:literal => $kind:pat),+ $(,)?) => {{
        let found = &$found;
        $(assert!(matches!(trouble(found, $name), $kind), "{}: {:?}", $name, trouble(found, $name));)+
    }};
}

/// Whether all are connected at their expected rates.
fn all_well(found: &[Diagnosis]) -> bool {
    found.iter().all(|one| match &one.outcome {
        Outcome::Trouble { .. } => false,
        Outcome::Connected(connected) => {
            // Devices that are polled, or report only changes, have no inherent rate.
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
    assert_told!(found,
        "right handle" => Trouble::Absent { .. },
        "left arm" => Trouble::NobodyListens { .. },
        "right sensor" => Trouble::Absent { .. },
        "left sensor" => Trouble::NobodyListens { .. },
        "right servos" => Trouble::Absent { .. },
        "tissue sensor" => Trouble::Absent { .. },
        "pedal" => Trouble::Absent { .. },
    );
    assert!(found.iter().all(|one| matches!(one.outcome, Outcome::Trouble { .. })), "{found:?}");
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
        assert_told!(found,
            "right handle" => Trouble::SdkMissing { .. },
            "right arm" => Trouble::RefusedLogin { .. },
            "right sensor" => Trouble::WrongProduct { .. },
            "right servos" => Trouble::WrongBaud { .. },
            "left handle" => Trouble::Absent { .. },
            "left sensor" => Trouble::OtherSerial { .. },
            "tissue sensor" => Trouble::WrongBaud { .. },
            "tracker" => Trouble::File { .. },
        );
        let mut other = devices;
        other.right.as_mut().unwrap().servos.as_mut().unwrap().servos[2].model = Some("XM540-W270".to_owned());
        assert_told!(tried(&other), "right servos" => Trouble::WrongProduct { .. });
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
        assert_told!(tried(&devices),
            "right handle" => Trouble::Absent { .. },
            "right arm" => Trouble::Silent { .. },
            "right sensor" => Trouble::Silent { .. },
            "right servos" => Trouble::Silent { .. },
            "left sensor" => Trouble::Silent { .. },
            "tissue sensor" => Trouble::Silent { .. },
            "tracker" => Trouble::Silent { .. },
        );
        all(EmulatedFault::DeviceFault);
        assert_told!(tried(&devices),
            "right handle" => Trouble::DeviceFault { .. },
            "right arm" => Trouble::DeviceFault { .. },
            "right sensor" => Trouble::DeviceFault { .. },
            "right servos" => Trouble::DeviceFault { .. },
            "left sensor" => Trouble::DeviceFault { .. },
            "tissue sensor" => Trouble::DeviceFault { .. },
            "tracker" => Trouble::DeviceFault { .. },
        );
    });
}

#[test]
fn a_device_in_use_and_one_that_waits_for_calibration_are_reported() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let mut devices =
            Settings { left: None, tracker: None, endoscope: None, pedal: None, ..elsewhere(folder.path()) };
        let rig = started(&devices);
        let right = devices.right.as_ref().unwrap();
        let sensor = bota::Driver::open(right.sensor.bota().unwrap()).unwrap();
        let held = (sensor, force_dimension::open(right.handle.force_dimension().unwrap()).unwrap());
        assert_told!(tried(&devices),
            "right sensor" => Trouble::Busy { .. },
            "right handle" => Trouble::Busy { .. },
        );
        drop((held, rig));
        let waiting = nima_emulation::emulators::force_dimension::Emulated {
            serial: 77,
            reset: true,
            ..nima_emulation::emulators::force_dimension::Emulated::default()
        };
        let serving = waiting.with(Held::default().body()).serve().unwrap();
        let handle = devices.right.as_mut().unwrap().handle.force_dimension_mut().unwrap();
        handle.serial = Some(77);
        handle.emulator = Some(serving.endpoint.parse().unwrap());
        assert_told!(tried(&devices), "right handle" => Trouble::NotReady { .. });
    });
}
