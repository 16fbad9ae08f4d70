//! The emulated rig with the real drivers: every device delivers at its place, and what the arm does the sensor feels.
#![cfg(target_os = "linux")]
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "common/emulated.rs"]
mod emulated;

use std::time::{Duration, Instant};

use emulated::{alone, elsewhere, started};
use nalgebra::Vector3;
use nima::{
    config::{Rig, Scene},
    device::{
        Device, Side, Standing, Trouble, bota, dynamixel, force_dimension, hid, kinova, ndi,
        rig::{ArmSet, Settings},
    },
    kinematics::{Arm, Inverse, Rcm, find},
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

/// How deep the tip presses, m.
const DEPTH_M: f64 = 0.005;
/// A machine under load lets devices in real time look lost; then it is tried again.
const ATTEMPTS: usize = 5;

/// What the sensor feels (N, `kbf`) while the tip presses and after it has gone up again; `None` where a device was lost on the way.
fn pressed(rig: &EmulatedRig, set: &ArmSet) -> Option<[Vec<Vector3<f64>>; 2]> {
    let (mut arm, mut sensor) = (kinova::open(&set.arm).unwrap(), bota::Driver::open(&set.sensor).unwrap());
    let (model, rcm) = (Arm::new(&set.mount).unwrap(), Rcm::new(&set.rcm).unwrap());
    let truth = rig.truth(Side::Right).unwrap();
    let mut inverse = Inverse::new(model, rcm, 1e-3, &truth.joint_rad.into()).unwrap();
    let way_m = Vector3::new(0.0, 0.0, -DEPTH_M - truth.tip_m.z);
    let (begin, mut tick, mut felt) = (Instant::now(), 0_u32, [Vec::new(), Vec::new()]);
    arm.poll(0.0);
    arm.enter_low_level().unwrap();
    // Down within a second, a moment there, and up again.
    while tick < 3500 {
        let t_s = begin.elapsed().as_secs_f64();
        arm.poll(t_s);
        let newest = sensor.poll(t_s).map(|stamped| stamped.value);
        while f64::from(tick) * 1e-3 < t_s {
            let share = (f64::from(tick) * 1e-3).min(1.0) - (f64::from(tick) * 1e-3 - 2.0).clamp(0.0, 1.0);
            inverse.step(&(truth.tip_m + way_m * share));
            tick += 1;
        }
        arm.aim(&(*inverse.joint_rad()).into()).ok();
        if [arm.health(), sensor.health()].iter().any(|health| matches!(health.standing, Standing::Lost(_))) {
            return None;
        }
        if let Some(reading) = newest {
            let force_n = rig.truth(Side::Right).unwrap().kbf_from_s1 * reading.wrench.force_n;
            match tick {
                1500..2000 => felt[0].push(force_n),
                3300.. => felt[1].push(force_n),
                _ => {}
            }
        }
        std::thread::sleep(Duration::from_micros(500));
    }
    Some(felt)
}

#[test]
fn the_sensor_feels_what_the_arm_presses() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = Settings { left: None, tissue_sensor: None, tracker: None, pedal: None, ..elsewhere(folder.path()) };
    let felt = (0..ATTEMPTS).find_map(|_| pressed(&started(&devices), devices.right.as_ref().unwrap()));
    let [pressing, after] = felt.expect("the devices were lost every time");
    let mean = |forces: &[Vector3<f64>]| forces.iter().sum::<Vector3<f64>>() / forces.len() as f64;
    assert!(!pressing.is_empty() && !after.is_empty());
    let tissue = Scene::load("peg_transfer").unwrap().tissue.unwrap();
    let law_n = tissue.stiffness * DEPTH_M.powf(tissue.exponent);
    let felt_n = mean(&pressing).z;
    assert!((felt_n / law_n - 1.0).abs() < 0.2, "felt {felt_n} N, the law gives {law_n} N");
    println!("felt {felt_n:.4} N, the law gives {law_n:.4} N");
    assert!(mean(&after).norm() < 0.1, "released: {}", mean(&after));
}

#[test]
fn both_arms_of_the_embedded_rigs_reach_all_of_their_space() {
    for name in ["emulated", "paper"] {
        let devices = Rig::load(name).unwrap().devices.unwrap();
        for side in Side::ALL {
            let set = devices.arm(side).unwrap();
            let (arm, rcm) = (Arm::new(&set.mount).unwrap(), Rcm::new(&set.rcm).unwrap());
            // Where the hand of the scene begins, as far from the trocar.
            let start_m =
                set.rcm.trocar_m + Vector3::new(if side == Side::Right { -0.03 } else { 0.03 }, 0.042, -0.123);
            let ready = find(&arm, &rcm, &start_m).unwrap();
            println!("{name} {side:?}: {ready:?}");
            assert!(ready.reached >= 1.0 && ready.limit_margin_rad > 0.5, "{name} {side:?}: {ready:?}");
            assert!(ready.dexterity > 0.1 && ready.clearance_m > 0.15, "{name} {side:?}: {ready:?}");
        }
    }
}
