//! The driver and the emulated handle over a pseudo-terminal.

use std::time::{Duration, Instant};

use nalgebra::Vector3;
use nima_devices::{
    ConnectionState, Device as _, DeviceError, Leader as _, Lever, Loss,
    discovery::probe_named,
    haply::{HaplyDriver, HaplySettings},
};
use nima_testing::real_time::judged;

use super::{EmulatedHaply, HapticForce};
use crate::emulators::{EmulatedFault, EmulatorThread};

fn serving() -> (EmulatorThread, HapticForce) {
    let felt = HapticForce::default();
    (EmulatedHaply::default().with(felt.on_a_circle()).serve().unwrap(), felt)
}

/// Runs a loop with a tick every millisecond and this force until `good`, or for this long; returns whether `good` was
/// reached.
fn run(
    driver: &mut HaplyDriver,
    begin: Instant,
    force_n: Vector3<f64>,
    within: Duration,
    good: impl Fn(&HaplyDriver) -> bool,
) -> bool {
    let since = Instant::now();
    while since.elapsed() < within {
        driver.poll(begin.elapsed().as_secs_f64());
        driver.set_force(force_n, 0.0);
        if good(driver) {
            return true;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    false
}

#[test]
fn the_hand_feels_the_force_and_gives_way_and_the_lever_reaches_it_without_the_loop() {
    judged(|| {
        let (serving, felt) = serving();
        let begin = Instant::now();
        let mut driver = HaplyDriver::open(&HaplySettings::at(serving.endpoint.as_str())).unwrap();
        assert_eq!(driver.identity().serial, "049D");
        let lever = Lever::default();
        driver.attach(&lever);
        let push_n = Vector3::new(0.0, 0.0, 3.0);
        let second = Duration::from_secs(1);
        run(&mut driver, begin, push_n, Duration::from_millis(50), |_| false);
        assert_eq!(felt.force_n(), Vector3::zeros(), "it is not switched on");
        driver.switch_force(true);
        assert!(run(&mut driver, begin, push_n, second, |_| felt.force_n() == push_n));
        let mut highest_m = 0.0_f64;
        for _ in 0..100 {
            if let Some(reading) = driver.poll(begin.elapsed().as_secs_f64()) {
                highest_m = highest_m.max(reading.value.position_m.z);
            }
            driver.set_force(push_n, 0.0);
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!((highest_m - 0.01).abs() < 1e-4, "3 N on 300 N/m: {highest_m} m");
        let rate_hz = driver.health().rate_hz;
        // The loop of this test sleeps for a millisecond between two ticks.
        assert!(rate_hz > 300.0 || driver.health().readings < 300, "{rate_hz} Hz");
        // From here on the loop has stopped.
        assert!(lever.pull());
        std::thread::sleep(Duration::from_millis(20));
        assert_eq!(felt.force_n(), Vector3::zeros());
        driver.switch_force(true);
        assert!(run(&mut driver, begin, push_n, second, |_| felt.force_n() == push_n));
        drop(driver);
        std::thread::sleep(Duration::from_millis(20));
        assert_eq!(felt.force_n(), Vector3::zeros(), "closing takes the force away");
        assert!(lever.pull());
        let again = HaplyDriver::open(&HaplySettings::at(serving.endpoint.as_str()));
        assert!(again.is_ok(), "the lever of a closed one holds no line: {:?}", again.err());
    });
}

#[test]
fn every_fault_is_told_or_harmless() {
    judged(|| {
        for (fault, expected) in [
            (EmulatedFault::Loss, None),
            (EmulatedFault::Delay, Some(Loss::Silent)),
            (EmulatedFault::Freeze, None),
            (EmulatedFault::Silence, Some(Loss::Silent)),
            (EmulatedFault::BadChecksum, None),
            (EmulatedFault::WrongFrame, Some(Loss::Corrupt)),
            (EmulatedFault::Disconnect, Some(Loss::Disconnected)),
            (EmulatedFault::DeviceFault, None),
            (EmulatedFault::NotANumber, Some(Loss::Implausible)),
        ] {
            let (serving, _) = serving();
            let begin = Instant::now();
            let mut driver = HaplyDriver::open(&HaplySettings::at(serving.endpoint.as_str())).unwrap();
            run(&mut driver, begin, Vector3::zeros(), Duration::from_millis(60), |_| false);
            serving.faults.set(fault);
            run(&mut driver, begin, Vector3::zeros(), Duration::from_millis(120), |_| false);
            let loss = match driver.health().standing {
                ConnectionState::Lost(loss) => Some(loss),
                _ => None,
            };
            assert_eq!(loss, expected, "{fault:?}: {:?}", driver.health());
            serving.faults.set(EmulatedFault::None);
            std::thread::sleep(Duration::from_millis(80));
            drop(driver);
            let opens = (0..20).any(|_| {
                std::thread::sleep(Duration::from_millis(10));
                HaplyDriver::open(&HaplySettings::at(serving.endpoint.as_str())).is_ok()
            });
            assert!(opens, "after {fault:?}");
        }
    });
}

#[test]
fn noise_between_the_answers_is_skipped_or_told_and_never_a_position() {
    judged(|| {
        let (serving, _) = serving();
        let begin = Instant::now();
        let mut driver = HaplyDriver::open(&HaplySettings::at(serving.endpoint.as_str())).unwrap();
        serving.faults.set(EmulatedFault::Garbage);
        let since = Instant::now();
        while since.elapsed() < Duration::from_millis(300) {
            if let Some(reading) = driver.poll(begin.elapsed().as_secs_f64()) {
                assert!(reading.value.position_m.norm() < 1.2, "{reading:?}");
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(driver.health().skipped_bytes > 0);
    });
}

#[test]
fn a_probe_finds_it_and_tells_what_is_wrong() {
    judged(|| {
        let (serving, _) = serving();
        let probe = |text: &str| probe_named(text).unwrap().probe(Duration::from_millis(800));
        let found = probe(&format!("haply={}", serving.endpoint)).unwrap();
        assert_eq!((found.identity.serial.as_str(), found.standing), ("049D", ConnectionState::Connected));
        assert!(found.readings > 20, "{found:?}");
        let held = HaplyDriver::open(&HaplySettings::at(serving.endpoint.as_str())).unwrap();
        assert!(matches!(probe(&format!("haply={}", serving.endpoint)), Err(DeviceError::Busy { .. })));
        drop(held);
        serving.faults.set(EmulatedFault::Silence);
        assert!(matches!(probe(&format!("haply={}", serving.endpoint)), Err(DeviceError::Silent { .. })));
        assert!(matches!(probe("haply=/no/such/port"), Err(DeviceError::Absent { .. })));
    });
}
