//! The emulated rig with the real drivers: every device delivers at its place, and what the arm does the sensor feels.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "common/emulated.rs"]
mod emulated;

use std::time::{Duration, Instant};

use emulated::{alone, elsewhere, started};
use nalgebra::Vector3;
use nima::{
    config::Scene,
    device::{Device, Side, Trouble, bota, dynamixel, force_dimension, hid, kinova, ndi, rig::Settings},
    kinematics::{Arm, Inverse, Rcm},
    sim::emulated::{EmulatedRig, HandFrame},
};

/// Polls once a millisecond until something is so.
fn until<D: Device>(device: &mut D, what: &str, mut good: impl FnMut(&mut D, Option<D::Reading>) -> bool) {
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(3) {
        let reading = device.poll(begin.elapsed().as_secs_f64()).map(|stamped| stamped.value);
        if good(device, reading) {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("{what}: {:?}", device.health());
}

fn delivers<D: Device>(what: &str, opened: Result<D, Trouble>) {
    let mut device = opened.unwrap_or_else(|trouble| panic!("{what}: {trouble}"));
    until(&mut device, what, |device, _| device.health().readings >= 20);
    let health = *device.health();
    assert_eq!((health.damaged, health.refused), (0, 0), "{what}: {health:?}");
}

#[test]
fn every_device_of_the_embedded_rig_delivers_at_its_place() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = elsewhere(folder.path());
    let rig = started(&devices);
    let names: Vec<_> = rig.servings().iter().map(|device| device.name.as_str()).collect();
    let expected = [
        "right handle",
        "right arm",
        "right sensor",
        "right servos",
        "left handle",
        "left arm",
        "left sensor",
        "tissue sensor",
        "tracker",
        "pedal",
    ];
    assert_eq!(names, expected);
    std::thread::scope(|scope| {
        for side in Side::ALL {
            let set = devices.arm(side).unwrap();
            scope.spawn(move || delivers("handle", force_dimension::open(&set.handle)));
            scope.spawn(move || delivers("arm", kinova::open(&set.arm)));
            scope.spawn(move || delivers("sensor", bota::Driver::open(&set.sensor)));
            if let Some(servos) = &set.servos {
                scope.spawn(move || delivers("servos", dynamixel::open(servos)));
            }
        }
        scope.spawn(|| delivers("tissue sensor", bota::Driver::open(devices.tissue_sensor.as_ref().unwrap())));
        scope.spawn(|| delivers("tracker", ndi::Driver::open(devices.tracker.as_ref().unwrap())));
    });
    let mut pedal = hid::PedalDriver::open(devices.pedal.as_ref().unwrap()).unwrap();
    rig.press(1);
    until(&mut pedal, "pedal", |_, reading| reading.is_some_and(|reading| reading.pressed == 1));
}

#[test]
fn a_second_rig_at_the_same_places_is_refused_and_a_new_one_comes_after_the_first() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = Settings { left: None, ..elsewhere(folder.path()) };
    let scene = Scene::load("peg_transfer").unwrap();
    let first = started(&devices);
    let refused = EmulatedRig::start(&devices, &scene, &[HandFrame::default(); 2]).unwrap_err();
    assert!(refused.to_string().contains("right handle"), "{refused}");
    drop(first);
    let second = started(&devices);
    assert!(second.servings().iter().all(|device| device.serving.is_serving()));
    let mut person = scene;
    person.person = Some(nima::config::Person::default());
    let told = EmulatedRig::start(&devices, &person, &[HandFrame::default(); 2]).unwrap_err().to_string();
    assert!(told.contains("person"), "{told}");
}

#[test]
fn the_sensor_feels_what_the_arm_presses() {
    const DEPTH_M: f64 = 0.005;
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = Settings { left: None, tissue_sensor: None, tracker: None, pedal: None, ..elsewhere(folder.path()) };
    let rig = started(&devices);
    let set = devices.right.as_ref().unwrap();
    let mut arm = kinova::open(&set.arm).unwrap();
    let mut sensor = bota::Driver::open(&set.sensor).unwrap();
    let mut joint_rad = None;
    until(&mut arm, "arm", |_, reading| {
        joint_rad = reading.map(|reading| reading.joint_rad).or(joint_rad);
        joint_rad.is_some()
    });
    let (model, rcm) = (Arm::new(&set.mount).unwrap(), Rcm::new(&set.rcm).unwrap());
    let mut inverse = Inverse::new(model, rcm, 1e-3, &joint_rad.unwrap().into()).unwrap();
    let above_m = rig.truth(Side::Right).unwrap().tip_m;
    let pressing_m = Vector3::new(above_m.x, above_m.y, -DEPTH_M);
    arm.enter_low_level().unwrap();
    // Down within a second, a moment there, and up again.
    let (begin, mut tick, mut felt, mut after) = (Instant::now(), 0_u32, Vec::new(), Vec::new());
    while tick < 3500 {
        let t_s = begin.elapsed().as_secs_f64();
        arm.poll(t_s);
        let newest = sensor.poll(t_s).map(|stamped| stamped.value);
        while f64::from(tick) * 1e-3 < t_s {
            let share = (f64::from(tick) * 1e-3).min(1.0) - (f64::from(tick) * 1e-3 - 2.0).clamp(0.0, 1.0);
            inverse.step(&(above_m + (pressing_m - above_m) * share));
            tick += 1;
        }
        arm.aim(&(*inverse.joint_rad()).into()).ok();
        if let Some(reading) = newest {
            let kbf_from_s1 = rig.truth(Side::Right).unwrap().kbf_from_s1;
            let force_n = kbf_from_s1 * reading.wrench.force_n;
            if (1500..2000).contains(&tick) {
                felt.push(force_n.z);
            } else if tick > 3300 {
                after.push(force_n.norm());
            }
        }
        std::thread::sleep(Duration::from_micros(500));
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let tissue = Scene::load("peg_transfer").unwrap().tissue.unwrap();
    let law_n = tissue.stiffness * DEPTH_M.powf(tissue.exponent);
    assert!(felt.len() > 300 && after.len() > 100, "{} {}", felt.len(), after.len());
    assert!((mean(&felt) / law_n - 1.0).abs() < 0.2, "felt {} N, the law gives {law_n} N", mean(&felt));
    assert!(mean(&after) < 0.1, "released: {} N", mean(&after));
}
