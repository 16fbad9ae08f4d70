//! Tests of the driver with the emulated device, through the stub library and its socket.

mod exchange;
mod faults;
mod troubles;

use std::{
    cell::RefCell,
    path::PathBuf,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use nalgebra::{UnitQuaternion, Vector3};
use nima_devices::{
    ConnectionState, Device, HandleReading, TimedReading,
    force_dimension::{
        ForceAnswer, ForceDimensionDriver, ForceDimensionSettings, HandleEvent, open, status::ForceOffCause,
    },
};
use nima_testing::real_time::{judged, too_busy};

use super::*;
use crate::emulators::EmulatorThread;

thread_local! {
    /// Folders of this test's copies, deleted with its thread. A loaded library stays usable without its file.
    static COPIES: RefCell<Vec<tempfile::TempDir>> = const { RefCell::new(Vec::new()) };
}

/// Returns a separate copy of the stub library for each test, so that it sees only this test's devices.
pub(super) fn library() -> PathBuf {
    let built = stand_in().expect("cargo builds the stand-in library before the tests");
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("libdrd.so.3");
    std::fs::copy(built, &copy).unwrap();
    COPIES.with_borrow_mut(|copies| copies.push(folder));
    copy
}

/// The next state of the hand, and the last output of the motors.
#[derive(Clone, Default)]
pub(super) struct Hand {
    pub(super) state: Arc<Mutex<HandState>>,
    pub(super) applied: Arc<Mutex<MotorOutput>>,
}

impl Hand {
    pub(super) fn body(&self) -> impl ForceDimensionBody {
        let hand = self.clone();
        let mut wobble = 0_u32;
        move |_: f64, applied: &MotorOutput| {
            *hand.applied.lock().unwrap() = *applied;
            let mut state = *hand.state.lock().unwrap();
            // No hand is perfectly still.
            wobble = wobble.wrapping_add(1);
            state.position_m.z += f64::from(wobble % 7) * 1e-7;
            state
        }
    }

    pub(super) fn applied(&self) -> MotorOutput {
        *self.applied.lock().unwrap()
    }

    pub(super) fn set(&self, change: impl FnOnce(&mut HandState)) {
        change(&mut self.state.lock().unwrap());
    }
}

/// Returns an emulated device with a hand, and settings to connect to it.
pub(super) fn rig(emulator: EmulatedForceDimension) -> (EmulatorThread, Hand, ForceDimensionSettings) {
    let hand = Hand::default();
    let serving = emulator.with(hand.body()).serve().unwrap();
    let settings = ForceDimensionSettings {
        library: Some(library()),
        emulator: Some(serving.endpoint.parse().unwrap()),
        ..ForceDimensionSettings::default()
    };
    (serving, hand, settings)
}

/// Polls once per millisecond until `good`; false after five seconds.
pub(super) fn until(
    driver: &mut ForceDimensionDriver,
    mut good: impl FnMut(&mut ForceDimensionDriver, Option<TimedReading<HandleReading>>) -> bool,
) -> bool {
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(5) {
        let reading = driver.poll(now_s());
        if good(driver, reading) {
            return true;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    false
}

pub(super) fn now_s() -> f64 {
    static BEGIN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64()
}

fn turn_on(driver: &mut ForceDimensionDriver) {
    driver.enable_force();
    assert!(until(driver, |driver, _| driver.take_event() == Some(HandleEvent::ForceOn)), "force comes on");
}

/// Switches force on and commands 1 N along x until it reaches the hand.
fn push(driver: &mut ForceDimensionDriver, hand: &Hand) {
    turn_on(driver);
    assert!(until(driver, |driver, _| {
        driver.set_force(Vector3::x(), 0.0);
        hand.applied().force_n.x == 1.0
    }));
}

#[test]
fn it_connects_and_reads_what_the_hand_does_without_a_gap() {
    judged(|| {
        let (_serving, hand, settings) =
            rig(EmulatedForceDimension { serial: 4711, ..EmulatedForceDimension::default() });
        let turn = UnitQuaternion::from_euler_angles(0.3, -0.2, 0.5);
        hand.set(|state| {
            state.position_m = Vector3::new(0.01, -0.02, 0.03);
            state.orientation = turn;
            state.gripper_rad = 0.25;
            state.buttons = 4;
        });
        let mut driver = open(&settings).unwrap();
        assert_eq!(driver.identity().product, "omega.7");
        assert_eq!((driver.identity().serial.as_str(), driver.identity().firmware.as_str()), ("4711", "3.2"));
        assert_eq!(driver.velocity_threshold(), Some(2000), "the threshold of the device is unchanged");
        assert_eq!(hand.applied().mode, FirmwareMode::Brake, "connected is not engaged");
        let mut newest = None;
        assert!(until(&mut driver, |driver, reading| {
            newest = reading.or(newest);
            driver.health().readings > 600
        }));
        let reading = newest.unwrap().value;
        assert!((reading.position_m - Vector3::new(0.01, -0.02, 0.03)).norm() < 1e-6);
        assert!(reading.orientation.unwrap().angle_to(&turn) < 1e-7);
        assert!((reading.gripper_rad.unwrap() - 0.25).abs() < 1e-12);
        assert!(reading.velocity_m_s.unwrap().norm() < 1e-3);
        assert_eq!(reading.buttons, 4);
        assert_eq!((driver.health().standing, driver.health().lost), (ConnectionState::Connected, 0));
        assert!(driver.status().brake && !driver.status().force && driver.status().gravity);
        println!("{:?} {:?}", driver.health(), driver.counters());
    });
}

/// If a round is this late, little remains of the half period for which the handle waits.
const LATE: Duration = Duration::from_micros(200);

/// Counts readings in this many rounds of a loop with a period of 1.2 ms, a fifth slower than the handle's own cycle.
fn readings_in(driver: &mut ForceDimensionDriver, rounds: u32, mut each: impl FnMut(&mut ForceDimensionDriver)) -> u64 {
    driver.poll(now_s());
    let before = driver.health().readings;
    let begin = Instant::now();
    let mut late = 0;
    for round in 1..=rounds {
        let due = begin + Duration::from_micros(1200) * round;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        late += u32::from(due.elapsed() > LATE);
        driver.poll(now_s());
        each(driver);
    }
    // A handle waits for a loop that is late by up to half a period, no longer.
    if late * 50 > rounds {
        too_busy();
    }
    driver.health().readings - before
}

#[test]
fn its_cycle_keeps_step_with_the_loop_and_goes_on_without_one() {
    judged(|| {
        let (_serving, _hand, settings) = rig(EmulatedForceDimension::default());
        let mut driver = open(&settings).unwrap();
        let led = readings_in(&mut driver, 200, |driver| {
            assert_eq!(driver.set_force(Vector3::zeros(), 0.0), ForceAnswer::Taken);
        });
        assert!((196..=206).contains(&led), "{led} readings in 200 rounds: one for each");
        let alone = readings_in(&mut driver, 200, |_| ());
        assert!((230..=244).contains(&alone), "{alone} readings in 240 ms");
    });
}

#[test]
fn velocity_is_that_of_the_hand() {
    judged(|| {
        let emulator = EmulatedForceDimension::default();
        let moving = |now_s: f64, _: &MotorOutput| HandState {
            position_m: Vector3::new(0.3 * (now_s % 0.4 - 0.2), 0.0, 0.0),
            ..HandState::default()
        };
        let serving = emulator.with(moving).serve().unwrap();
        let emulator = Some(serving.endpoint.parse().unwrap());
        let mut driver =
            open(&ForceDimensionSettings { library: Some(library()), emulator, ..ForceDimensionSettings::default() })
                .unwrap();
        let mut speeds = Vec::new();
        assert!(until(&mut driver, |_, reading| {
            speeds.extend(reading.and_then(|reading| reading.value.velocity_m_s).map(|velocity| velocity.x));
            speeds.len() > 300
        }));
        speeds.sort_by(f64::total_cmp);
        let middle = speeds[speeds.len() / 2];
        assert!((middle - 0.3).abs() < 0.01, "{middle} m/s");
    });
}

#[test]
fn a_left_handed_gripper_opens_in_the_positive_sense_too() {
    judged(|| {
        let (_serving, hand, settings) = rig(EmulatedForceDimension {
            kind: ForceDimensionKind::Omega7 { left_handed: true },
            ..EmulatedForceDimension::default()
        });
        hand.set(|state| state.gripper_rad = 0.25);
        let mut driver = open(&settings).unwrap();
        assert!(until(&mut driver, |_, reading| {
            reading.is_some_and(|reading| (reading.value.gripper_rad.unwrap() - 0.25).abs() < 1e-12)
        }));
    });
}

#[test]
fn force_reaches_the_hand_only_while_it_is_enabled_and_never_beyond_the_limits() {
    judged(|| {
        let (_serving, hand, settings) = rig(EmulatedForceDimension::default());
        let mut driver = open(&settings).unwrap();
        let pushed = Vector3::new(1.0, -2.0, 0.5);
        for _ in 0..30 {
            assert_eq!(driver.set_force(pushed, 1.0), ForceAnswer::Taken);
            driver.poll(now_s());
            std::thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(hand.applied().force_n.norm(), 0.0, "not enabled, no force");
        turn_on(&mut driver);
        assert_eq!(
            (hand.applied().mode, hand.applied().force_n.norm()),
            (FirmwareMode::Force, 0.0),
            "on, and zero until asked"
        );
        assert!(until(&mut driver, |driver, _| {
            driver.set_force(pushed, 1.0);
            hand.applied().force_n == pushed && hand.applied().gripper_n == 1.0
        }));
        for huge in [20.0, 1e18, f64::MAX] {
            assert_eq!(driver.set_force(Vector3::new(0.0, huge, 0.0), -huge), ForceAnswer::Clamped);
        }
        assert!(until(&mut driver, |driver, _| {
            driver.set_force(Vector3::new(0.0, 1e18, 0.0), -1e18);
            (hand.applied().force_n - Vector3::new(0.0, 12.0, 0.0)).norm() < 1e-9 && hand.applied().gripper_n == -8.0
        }));
        assert_eq!(driver.set_force(Vector3::new(f64::NAN, 0.0, 0.0), 0.0), ForceAnswer::NotFinite);
        assert_eq!(driver.set_force(Vector3::zeros(), f64::INFINITY), ForceAnswer::NotFinite);
        assert!(until(&mut driver, |driver, _| {
            driver.set_force(Vector3::new(f64::NAN, 0.0, 0.0), 0.0);
            hand.applied().force_n.norm() == 0.0
        }));
        driver.disable_force();
        assert!(until(&mut driver, |_, _| hand.applied().mode == FirmwareMode::Brake));
        let off = HandleEvent::ForceOff { cause: ForceOffCause::Software };
        assert!(until(&mut driver, |driver, _| driver.take_event() == Some(off)));
        drop(driver);
    });
}

#[test]
fn a_force_that_is_not_said_again_ends() {
    judged(|| {
        let (_serving, hand, settings) = rig(EmulatedForceDimension::default());
        let mut driver = open(&settings).unwrap();
        push(&mut driver, &hand);
        assert!(until(&mut driver, |_, _| hand.applied().force_n.norm() == 0.0));
        assert_eq!(hand.applied().mode, FirmwareMode::Force, "zero, not off: the device is still spoken to");
        assert!(until(&mut driver, |driver, _| driver.counters().stale_commands > 0));
    });
}

#[test]
fn saturated_motors_are_counted_and_are_no_failure() {
    judged(|| {
        let (_serving, hand, settings) =
            rig(EmulatedForceDimension { motor_limit_n: 5.0, ..EmulatedForceDimension::default() });
        let mut driver = open(&settings).unwrap();
        turn_on(&mut driver);
        assert!(until(&mut driver, |driver, _| {
            driver.set_force(Vector3::new(0.0, 0.0, 9.0), 0.0);
            driver.counters().saturated > 3
        }));
        assert!((hand.applied().force_n.norm() - 5.0).abs() < 1e-9);
        assert_eq!(driver.health().standing, ConnectionState::Connected);
    });
}

#[test]
fn the_device_takes_force_away_and_says_why_and_only_a_command_brings_it_back() {
    judged(|| {
        let (_serving, hand, settings) = rig(EmulatedForceDimension::default());
        let mut driver = open(&settings).unwrap();
        turn_on(&mut driver);
        hand.set(|state| state.force_button = true);
        let button = HandleEvent::ForceOff { cause: ForceOffCause::Button };
        assert!(until(&mut driver, |driver, _| driver.take_event() == Some(button)));
        assert!(!driver.is_force_wanted() && hand.applied().mode == FirmwareMode::Brake);
        hand.set(|state| state.force_button = false);
        turn_on(&mut driver);
        let begin = Instant::now();
        let fast = HandleEvent::ForceOff { cause: ForceOffCause::Velocity };
        assert!(until(&mut driver, |driver, _| {
            let moved_m = 2.5 * begin.elapsed().as_secs_f64();
            hand.set(|state| state.position_m.x = moved_m.min(0.8));
            driver.take_event() == Some(fast)
        }));
        assert!(until(&mut driver, |driver, _| driver.counters().force_cut == 2));
        assert_eq!(driver.health().standing, ConnectionState::Connected);
    });
}

#[test]
fn two_devices_are_told_apart_by_their_serial_numbers() {
    judged(|| {
        let (_one, one_hand, settings) = rig(EmulatedForceDimension { serial: 1, ..EmulatedForceDimension::default() });
        let two_hand = Hand::default();
        let two = EmulatedForceDimension { serial: 2, ..EmulatedForceDimension::default() }
            .with(two_hand.body())
            .serve()
            .unwrap();
        let mut first = open(&ForceDimensionSettings { serial: Some(1), ..settings.clone() }).unwrap();
        let emulator = Some(two.endpoint.parse().unwrap());
        let mut second = open(&ForceDimensionSettings { serial: Some(2), emulator, ..settings }).unwrap();
        one_hand.set(|state| state.position_m.x = 0.01);
        two_hand.set(|state| state.position_m.x = 0.02);
        for (driver, x) in [(&mut first, 0.01), (&mut second, 0.02)] {
            assert!(until(driver, |_, reading| reading.is_some_and(|reading| reading.value.position_m.x == x)));
        }
        assert_eq!((first.identity().serial.as_str(), second.identity().serial.as_str()), ("1", "2"));
    });
}
