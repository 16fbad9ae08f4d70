//! Driver and emulator over this computer's network.

use std::time::{Duration, Instant};

use nima_devices::{
    ConnectionState, Device as _, DeviceError, Health, Loss,
    ati::{AtiDriver, AtiSettings},
    discovery::probe_named,
};
use nima_testing::real_time::judged;

use super::EmulatedAti;
use crate::emulators::{EmulatedFault, EmulatorThread, bota::slow_motion};

fn serving(of: EmulatedAti) -> (EmulatorThread, AtiSettings) {
    let serving = of.with(slow_motion()).serve().unwrap();
    let settings = AtiSettings::at(&serving.endpoint).unwrap();
    (serving, settings)
}

/// Polls for this long; returns the largest force, N, and the health.
fn run(driver: &mut AtiDriver, begin: Instant, length: Duration) -> (f64, Health) {
    let end = Instant::now() + length;
    let mut largest_n = 0.0;
    while Instant::now() < end {
        if let Some(reading) = driver.poll(begin.elapsed().as_secs_f64()) {
            largest_n = f64::max(largest_n, reading.value.wrench.force_n.norm());
        }
        std::thread::sleep(Duration::from_micros(500));
    }
    (largest_n, *driver.health())
}

#[test]
fn every_record_arrives_in_newtons_whatever_the_units_of_the_sensor() {
    judged(|| {
        for units in [["N", "N-m"], ["lbf", "lbf-in"]] {
            let (_serving, settings) =
                serving(EmulatedAti { units: units.map(str::to_owned), ..EmulatedAti::default() });
            let mut driver = AtiDriver::open(&settings).unwrap();
            assert_eq!(driver.identity().serial, "FT00001");
            let (largest_n, health) = run(&mut driver, Instant::now(), Duration::from_millis(300));
            assert!(health.readings > 200 && health.lost + health.damaged + health.refused == 0, "{health:?}");
            // The emulator counts a million per unit: a tool of 0.4 kg weighs 3.9 N, in pounds as many counts are more.
            let unit_n = if units[0] == "N" { 1.0 } else { 4.448 };
            assert!((3.0 * unit_n..6.5 * unit_n).contains(&largest_n), "{units:?}: {largest_n}");
        }
    });
}

#[test]
fn every_fault_is_reported() {
    judged(|| {
        for (fault, expected) in [
            (EmulatedFault::Silence, Loss::Silent),
            (EmulatedFault::BadChecksum, Loss::Corrupt),
            (EmulatedFault::WrongFrame, Loss::Corrupt),
            (EmulatedFault::Freeze, Loss::Implausible),
            (EmulatedFault::DeviceFault, Loss::Device { code: 0x8000_0000 }),
        ] {
            let (serving, settings) = serving(EmulatedAti::default());
            let mut driver = AtiDriver::open(&settings).unwrap();
            let begin = Instant::now();
            run(&mut driver, begin, Duration::from_millis(50));
            serving.faults.set(fault);
            let (_, health) = run(&mut driver, begin, Duration::from_millis(150));
            assert_eq!(health.standing, ConnectionState::Lost(expected), "{fault:?}");
            serving.faults.set(EmulatedFault::None);
            drop(driver);
            assert!(AtiDriver::open(&settings).is_ok(), "it is found again after {fault:?}");
        }
    });
}

#[test]
fn a_probe_finds_it_and_says_what_is_wrong() {
    judged(|| {
        let (serving, settings) = serving(EmulatedAti::default());
        let probe = |text: &str| probe_named(text).unwrap().probe(Duration::from_millis(800));
        let found = probe(&format!("ati={}", serving.endpoint)).unwrap();
        assert_eq!((found.identity.serial.as_str(), found.standing), ("FT00001", ConnectionState::Connected));
        assert!(found.readings > 20, "{found:?}");
        let other = AtiSettings { serial_number: Some("FT9".to_owned()), ..settings.clone() };
        assert!(matches!(AtiDriver::open(&other).unwrap_err(), DeviceError::OtherSerial { .. }));
        let by_counts = AtiSettings { counts_per_n: Some(1e6), counts_per_nm: Some(1e6), http_port: 1, ..settings };
        assert!(AtiDriver::open(&by_counts).is_ok(), "without its pages");
        drop(serving);
        assert!(AtiDriver::open(&by_counts).is_err());
        assert!(probe("ati=127.0.0.1 rdt=1 http=1").is_err());
        assert!(matches!(probe("ati=192.0.2.1").unwrap_err(), DeviceError::Example { .. }));
    });
    let (_serving, settings) =
        serving(EmulatedAti { units: ["stone".to_owned(), "N-m".to_owned()], ..EmulatedAti::default() });
    let unit = AtiDriver::open(&settings).unwrap_err();
    assert!(unit.to_string().contains("stone"), "{unit}");
}
