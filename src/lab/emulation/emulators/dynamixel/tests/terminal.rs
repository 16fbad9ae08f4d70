//! Driver and emulator over a pseudo-terminal.

use std::time::{Duration, Instant};

use nima_devices::{
    ConnectionState, Device as _, DeviceError, DeviceSlot, Loss,
    discovery::probe_named,
    dynamixel::{DynamixelDriver, DynamixelSettings, Reboots, open, open_with},
};
use nima_testing::real_time::judged;

use super::{
    super::EmulatedDynamixel,
    world::{emulated, settings, with_unsupported},
};
use crate::emulators::{EmulatedFault, Emulator, EmulatorThread};

fn serving(settings_of: &EmulatedDynamixel) -> (EmulatorThread, DynamixelSettings) {
    let serving = settings_of.with(None).unwrap().serve().unwrap();
    let mut settings = DynamixelSettings { port: serving.endpoint.clone(), baud: settings_of.baud, ..settings() };
    // Other programs on this machine may delay either side.
    settings.silence_s = 0.5;
    (serving, settings)
}

#[test]
fn it_delivers_over_the_terminal_without_a_loss() {
    judged(|| {
        let (_serving, settings) = serving(&emulated());
        let mut driver = open(&settings).unwrap();
        assert!(driver.uses_fast_sync_read());
        let begin = Instant::now();
        let mut last = None;
        while begin.elapsed() < Duration::from_millis(800) {
            let now_s = begin.elapsed().as_secs_f64();
            if let Some(reading) = driver.poll(now_s) {
                assert!(last.is_none_or(|last_s| reading.device_s.unwrap() >= last_s));
                last = reading.device_s;
            }
            std::thread::sleep(Duration::from_micros(50));
        }
        let health = driver.health();
        assert!(health.readings > 50, "{health:?}");
        assert_eq!((health.damaged, health.refused, health.skipped_bytes), (0, 0, 0));
        // A pause of this machine may delay an answer, but more than a few are our fault.
        assert!(health.lost + health.out_of_order <= 4, "{health:?}");
    });
}

/// Measures the performance on this machine; the documentation quotes the results.
#[test]
#[ignore = "prints rates, takes 20 s: `./dev figures` runs it"]
fn measure_rate_and_losses() {
    for baud in [1_000_000, 4_000_000] {
        for fast in [true, false] {
            let (_serving, settings) = serving(&EmulatedDynamixel { baud, fast, ..emulated() });
            let mut driver = open(&settings).unwrap();
            let begin = Instant::now();
            let mut polls = 0_u64;
            let mut longest = Duration::ZERO;
            while begin.elapsed() < Duration::from_secs(5) {
                let before = Instant::now();
                driver.poll(begin.elapsed().as_secs_f64());
                longest = longest.max(before.elapsed());
                polls += 1;
                std::thread::yield_now();
            }
            let rate_hz = driver.health().readings as f64 / begin.elapsed().as_secs_f64();
            println!("{baud} fast {fast}: {rate_hz:.0} Hz, {polls} polls, longest {longest:?}, {:?}", driver.health());
        }
    }
}

fn until(
    slot: &mut DeviceSlot<DynamixelDriver>,
    begin: Instant,
    good: impl Fn(&DeviceSlot<DynamixelDriver>) -> bool,
) -> bool {
    let limit = Instant::now() + Duration::from_secs(10);
    while Instant::now() < limit {
        slot.poll(begin.elapsed().as_secs_f64());
        if good(slot) {
            return true;
        }
        std::thread::sleep(Duration::from_micros(300));
    }
    false
}

#[test]
fn a_slot_brings_it_back_after_faults_and_a_cut_line() {
    judged(|| {
        let (serving, mut settings) = serving(&emulated());
        settings.silence_s = 0.1;
        let reboots = Reboots::default();
        let wanted = settings;
        let asked = reboots.clone();
        let mut slot = DeviceSlot::start("servos", move || open_with(&wanted, &asked)).unwrap();
        let begin = Instant::now();
        let connected = |slot: &DeviceSlot<DynamixelDriver>| slot.health().standing == ConnectionState::Connected;
        assert!(until(&mut slot, begin, connected));
        for fault in [EmulatedFault::Disconnect, EmulatedFault::BadChecksum, EmulatedFault::DeviceFault] {
            serving.faults.set(fault);
            assert!(
                until(&mut slot, begin, |slot| matches!(slot.health().standing, ConnectionState::Lost(_))),
                "{fault:?}"
            );
            let ConnectionState::Lost(loss) = slot.health().standing else { unreachable!() };
            match fault {
                EmulatedFault::Disconnect => assert_eq!(loss, Loss::Disconnected),
                EmulatedFault::BadChecksum => assert_eq!(loss, Loss::Corrupt),
                _ => assert!(matches!(loss, Loss::Device { .. })),
            }
            serving.faults.set(EmulatedFault::None);
            if fault == EmulatedFault::DeviceFault {
                reboots.ask(0);
            }
            assert!(until(&mut slot, begin, connected), "{fault:?}: {:?}", slot.view().report().trouble);
        }
        assert!(slot.view().report().opened >= 4);
    });
}

#[test]
fn why_it_cannot_be_opened_is_told() {
    judged(|| {
        let (serving, settings) = serving(&emulated());
        let wrong = DynamixelSettings { baud: 57_600, ..settings.clone() };
        assert_eq!(open(&wrong).err(), Some(DeviceError::WrongBaud { place: settings.port.clone(), baud: 57_600 }));
        let driver = open(&settings).unwrap();
        assert!(matches!(open(&settings).err(), Some(DeviceError::Busy { .. })));
        drop(driver);
        serving.faults.set(EmulatedFault::Silence);
        assert!(matches!(open(&settings).err(), Some(DeviceError::Silent { .. })));
        drop(serving);
        assert_eq!(open(&settings).err(), Some(DeviceError::Absent { place: settings.port.clone() }));
    });
}

#[test]
fn a_probe_names_a_servo_of_an_unsupported_model_by_its_number() {
    judged(|| {
        let bus: Box<dyn Emulator> = Box::new(with_unsupported(&EmulatedDynamixel::default()));
        let serving = bus.serve().unwrap();
        let mut probe = probe_named(&format!("dynamixel={}", serving.endpoint)).unwrap();
        let report = probe.probe(Duration::from_secs(1)).unwrap_err();
        assert!(matches!(report, DeviceError::Unsupported { .. }), "{report:?}");
        let words = report.to_string();
        assert!(words.contains("servo 3") && words.contains("model number 350"), "{words}");
    });
}
