//! The emulated rig with the real drivers: every device delivers at its address, and the sensor measures the effects of
//! the arm's motion.
#![cfg(target_os = "linux")]
use std::time::{Duration, Instant};

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{
    frames::from_roll_pitch_yaw_deg,
    kinematics::{Arm, Inverse, Rcm, find},
    signal::PidGains,
};
use nima_devices::{ConnectionState, Device, DeviceError, bota, dynamixel, force_dimension, hid, kinova, ndi};
use nima_emulation::{
    emulated::{EmulatedRig, HandFrame},
    emulators::EmulatedFault,
};
use nima_machine::{
    config::RigConfig,
    rig::{ArmSet, DeviceRig, Outputs, Rig as _, RigSettings, SIDES, Side, ViewOrientation},
};
use nima_simulation::scene::Scene;
use nima_testing::real_time::{alone, judged, too_busy};
use nima_tests::emulated::{DEVICES, elsewhere, right_arm, started};

/// Polls once per millisecond until the condition is true.
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

fn delivers<D: Device>(what: &str, opened: Result<D, DeviceError>) {
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
    assert_eq!(names, DEVICES);
    // Delays caused by a busy machine look like damage.
    judged(|| {
        std::thread::scope(|scope| {
            for side in Side::ALL {
                let set = devices.arm(side).unwrap();
                scope.spawn(move || delivers("handle", force_dimension::open(set.handle.force_dimension().unwrap())));
                scope.spawn(move || delivers("arm", kinova::open(set.arm.kinova().unwrap())));
                scope.spawn(move || delivers("sensor", bota::BotaDriver::open(set.sensor.bota().unwrap())));
                if let Some(servos) = &set.servos {
                    scope.spawn(move || delivers("servos", dynamixel::open(servos)));
                }
            }
            scope.spawn(|| {
                delivers(
                    "tissue sensor",
                    bota::BotaDriver::open(devices.tissue_sensor.as_ref().unwrap().bota().unwrap()),
                );
            });
            scope.spawn(|| delivers("tracker", ndi::NdiDriver::open(devices.tracker.as_ref().unwrap())));
        });
    });
    let mut pedal = hid::PedalDriver::open(devices.pedal.as_ref().unwrap()).unwrap();
    rig.press(1);
    until(&mut pedal, "pedal", |_, reading| reading.is_some_and(|reading| reading.pressed == 1));
}

#[test]
fn a_second_rig_at_the_same_places_is_refused_and_a_new_one_comes_after_the_first() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = RigSettings { left: None, ..elsewhere(folder.path()) };
        let scene = Scene::load("peg_transfer").unwrap();
        let first = started(&devices);
        let refused = EmulatedRig::start(&devices, &scene, &[HandFrame::default(); 2]).unwrap_err();
        assert!(refused.to_string().contains("right handle"), "{refused}");
        drop(first);
        let second = started(&devices);
        assert!(second.servings().iter().all(|device| device.serving.is_serving()));
    });
}

/// Depth to which the tip presses, m.
const DEPTH_M: f64 = 0.005;

/// Returns the sensor readings (N, `world`) while the tip presses and after it has been raised; `None` if a device was
/// lost in the meantime, or if the arm does not servo.
fn pressed(rig: &EmulatedRig, set: &ArmSet) -> Option<[Vec<Vector3<f64>>; 2]> {
    let mut arm = kinova::open(set.arm.kinova().unwrap()).unwrap();
    let mut sensor = bota::BotaDriver::open(set.sensor.bota().unwrap()).unwrap();
    let model = Arm::new(&set.mount).unwrap();
    let rcm = Rcm::new(&set.rcm).unwrap();
    let truth = rig.truth(Side::Right).unwrap();
    let mut inverse = Inverse::new(model, rcm, 1e-3, &truth.joint_rad.into()).unwrap();
    let travel_m = Vector3::new(0.0, 0.0, -DEPTH_M - truth.tip_m.z);
    let begin = Instant::now();
    let mut tick = 0_u32;
    let mut felt = [Vec::new(), Vec::new()];
    let mut ticked_s = 0.0;
    let mut servoing = false;
    arm.poll(0.0);
    arm.enter_low_level().unwrap();
    // Down within a second, a pause, and up again.
    while tick < 3500 {
        let t_s = begin.elapsed().as_secs_f64();
        if let Some(reading) = arm.poll(t_s) {
            // An arm that has left its servoing, because a frame was late, does not resume by itself: waiting for it
            // would hide the busy moment in a long attempt.
            if servoing && !reading.value.servoing {
                return None;
            }
            servoing = reading.value.servoing;
        }
        let newest = sensor.poll(t_s).map(|stamped| stamped.value);
        // After a delay on a busy computer, continue the motion without a jump.
        while servoing && ticked_s < t_s {
            let fraction = (f64::from(tick) * 1e-3).min(1.0) - (f64::from(tick) * 1e-3 - 2.0).clamp(0.0, 1.0);
            inverse.step(&(truth.tip_m + travel_m * fraction));
            tick += 1;
            ticked_s = (ticked_s + 1e-3).max(t_s - 5e-3);
        }
        if t_s > if servoing { 30.0 } else { 3.0 } {
            return None;
        }
        arm.aim(&(*inverse.joint_rad()).into()).ok();
        if [arm.health(), sensor.health()].iter().any(|health| matches!(health.standing, ConnectionState::Lost(_))) {
            return None;
        }
        if let Some(reading) = newest {
            let force_n = rig.truth(Side::Right).unwrap().world_from_s1 * reading.wrench.force_n;
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
#[ignore = "commands an arm from an ordinary thread in real time: `./dev test` runs it alone"]
fn the_sensor_feels_what_the_arm_presses() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = right_arm(folder.path());
    judged(|| {
        let felt = pressed(&started(&devices), devices.right.as_ref().unwrap());
        let [pressing, after] = felt.expect("a device was lost, or the arm does not servo");
        let mean = |forces: &[Vector3<f64>]| forces.iter().sum::<Vector3<f64>>() / forces.len() as f64;
        assert!(!pressing.is_empty() && !after.is_empty());
        let tissue = Scene::load("peg_transfer").unwrap().tissue.unwrap();
        let law_n = tissue.stiffness * DEPTH_M.powf(tissue.exponent);
        let felt_n = mean(&pressing).z;
        assert!((felt_n / law_n - 1.0).abs() < 0.2, "felt {felt_n} N, the law gives {law_n} N");
        println!("felt {felt_n:.4} N, the law gives {law_n:.4} N");
        assert!(mean(&after).norm() < 0.1, "released: {}", mean(&after));
    });
}

#[test]
fn both_arms_of_the_embedded_rigs_reach_all_of_their_space() {
    for name in ["emulated", "paper"] {
        let devices = RigConfig::load(name).unwrap().devices.unwrap();
        for side in Side::ALL {
            let set = devices.arm(side).unwrap();
            let arm = Arm::new(&set.mount).unwrap();
            let rcm = Rcm::new(&set.rcm).unwrap();
            // Start position of the scene's hand, at the same distance from the trocar.
            let start_m =
                set.rcm.trocar_m + Vector3::new(if side == Side::Right { -0.03 } else { 0.03 }, 0.042, -0.123);
            let ready = find(&arm, &rcm, &start_m).unwrap();
            println!("{name} {side:?}: {ready:?}");
            assert!(ready.reached >= 1.0 && ready.limit_margin_rad > 0.5, "{name} {side:?}: {ready:?}");
            assert!(ready.dexterity > 0.1 && ready.clearance_m > 0.15, "{name} {side:?}: {ready:?}");
        }
    }
}

#[test]
fn the_tracker_tells_how_the_endoscope_looks_whatever_the_rig_file_has() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let devices = elsewhere(folder.path());
    let emulated = started(&devices);
    let truth = RigConfig::load("emulated").unwrap().teleoperation;
    let world_from_view = from_roll_pitch_yaw_deg(&truth.world_from_view_deg);
    let (mut rig, roster) = DeviceRig::start(&devices, 1e-3, [false; SIDES]).unwrap();
    let begin = Instant::now();
    let mut seen = [None; SIDES];
    // Far longer than needed, even on a busy machine.
    while seen.iter().any(Option::is_none) && begin.elapsed() < Duration::from_mins(2) {
        let inputs = rig.read(begin.elapsed().as_secs_f64());
        for side in Side::ALL {
            if let Some(ViewOrientation::Seen(view)) = inputs[side.index()].map(|inputs| inputs.view) {
                seen[side.index()] = Some(view.angle_to(&world_from_view).to_degrees());
            }
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(seen.iter().all(|apart_deg| apart_deg.is_some_and(|deg| deg < 0.5)), "{seen:?} degrees apart");
    // Calibrations are bound to the serial numbers that the sensors report.
    for (side, number) in [(Side::Right, "SN000901"), (Side::Left, "SN000902")] {
        let of_side: Vec<_> = roster.iter().filter(|entry| entry.force_sensor_of() == Some(side)).collect();
        assert_eq!(of_side.len(), 1);
        assert_eq!(of_side[0].name(), format!("{} sensor", side.word()));
        assert_eq!(of_side[0].view.report().identity.unwrap().serial, number);
    }
    // The tracker sends nothing, so the loop must not assume an orientation of the endoscope.
    assert!(emulated.set_fault("tracker", EmulatedFault::Silence));
    let blind = |rig: &mut DeviceRig| {
        let inputs = rig.read(begin.elapsed().as_secs_f64());
        inputs.iter().flatten().count() == SIDES
            && inputs.iter().flatten().all(|inputs| inputs.view == ViewOrientation::Unseen)
    };
    let since = Instant::now();
    while !blind(&mut rig) {
        assert!(since.elapsed() < Duration::from_mins(2), "the view is still there");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Readings from which the motion of the jaws is judged.
const READINGS: usize = 4000;

/// Motion of the jaws.
#[derive(Clone, Copy, Debug)]
struct JawsShown {
    /// Distance from the commanded orientation over time, root mean square, degrees; infinite if there were too few
    /// readings.
    rms_deg: f64,
    /// Readings of the jaws, up to [`READINGS`].
    readings: usize,
    /// Delay, s: printed with a failure.
    #[expect(dead_code, reason = "read by its Debug form, in the message of a failure")]
    late_s: f64,
    /// 99th percentile of the time between readings, s; 1 to 2 ms on an idle computer.
    period_p99_s: f64,
}

impl JawsShown {
    /// Returns whether the readings were timely and sufficient, so that the results show the PID and not the load of
    /// the computer. Other tests check that the servos answer at all.
    fn is_quiet(&self) -> bool {
        self.period_p99_s < 0.004 && self.readings >= READINGS
    }
}

/// Returns the jaws rotate about all three axes against the load of their cables.
fn jaws_in_motion(devices: &RigSettings) -> JawsShown {
    let (mut rig, _) = DeviceRig::start(devices, 1e-3, [false; SIDES]).unwrap();
    let begin = Instant::now();
    let mut outputs = [Outputs::SAFE; SIDES];
    let mut home = None;
    let mut way: Vec<(UnitQuaternion<f64>, UnitQuaternion<f64>)> = Vec::new();
    let mut since_s = 0.0;
    let mut before_s = 0.0;
    let mut periods_s = Vec::new();
    while way.len() < READINGS && before_s < 15.0 {
        let now_s = begin.elapsed().as_secs_f64();
        periods_s.push(now_s - before_s);
        before_s = now_s;
        rig.write(now_s, &outputs);
        let jaws = rig.read(now_s)[0].and_then(|inputs| inputs.world_from_jaws);
        if let Some(jaws) = jaws {
            let home: UnitQuaternion<f64> = *home.get_or_insert_with(|| {
                since_s = now_s;
                jaws
            });
            let t_s = now_s - since_s;
            let turn = Vector3::new(0.3 * (3.0 * t_s).sin(), 0.25 * (2.2 * t_s).sin(), 0.35 * (2.7 * t_s).sin());
            let asked = home * UnitQuaternion::from_scaled_axis(turn);
            outputs[0] = Outputs { drives: true, world_from_jaws: Some(asked), ..Outputs::SAFE };
            way.push((asked, jaws));
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    periods_s.sort_by(f64::total_cmp);
    let period_p99_s = periods_s[periods_s.len() * 99 / 100];
    let readings = way.len();
    if readings < READINGS {
        return JawsShown { rms_deg: f64::INFINITY, readings, late_s: f64::INFINITY, period_p99_s };
    }
    // Skip the first second, in which the integral part settles.
    let rms_deg = |late: usize| {
        let pairs = way[..way.len() - late].iter().zip(&way[late..]).skip(1000);
        let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), ((asked, _), (_, jaws))| {
            (sum + asked.angle_to(jaws).to_degrees().powi(2), count + 1.0)
        });
        f64::sqrt(sum / count)
    };
    let late = (0..150).min_by(|a, b| rms_deg(*a).total_cmp(&rms_deg(*b))).unwrap();
    let late_s = late as f64 * (begin.elapsed().as_secs_f64() - since_s) / way.len() as f64;
    JawsShown { rms_deg: rms_deg(0), readings, late_s, period_p99_s }
}

/// In real time with real connections: on a computer too busy for timely exchanges the result cannot be judged, which
/// is not a failure.
#[test]
#[ignore = "compares small motions in real time: `./dev test` runs it alone"]
fn the_pid_holds_the_jaws_in_motion_against_their_cables() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let with_pid = right_arm(folder.path());
    let mut without = with_pid.clone();
    let gains = &mut without.right.as_mut().unwrap().jaws.pid;
    *gains = PidGains { proportional: 0.0, integral_per_s: 0.0, derivative_s: 0.0, integral_max: 0.0 };
    let _emulated = started(&with_pid);
    judged(|| {
        let [with_pid, without] = [&with_pid, &without].map(jaws_in_motion);
        println!("with PID {with_pid:?}, without {without:?}");
        if !(with_pid.is_quiet() && without.is_quiet()) {
            too_busy();
        }
        assert!(with_pid.rms_deg < 3.0 && without.rms_deg.is_finite() && with_pid.rms_deg < 0.8 * without.rms_deg);
    });
}
