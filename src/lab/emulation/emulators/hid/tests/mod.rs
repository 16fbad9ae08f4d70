use std::{
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use nima_devices::{
    CapReading, ConnectionState, Device, DeviceError, DeviceSlot, Health, Loss, PedalReading, TimedReading,
    hid::{CapDriver, CapSettings, HeldValue, HidIdentity, PedalDriver, PedalSettings, RELEASE_AFTER_S},
    transport::{MemoryDatagrams, TransportDatagrams as _},
};
use nima_testing::real_time::judged;

use crate::emulators::{
    EmulatedFault, EmulatorThread,
    hid::{self, CapBody, CapModel, PedalBody, PedalModel, cap, spacenavd},
};

mod pedals;

fn deflected() -> CapReading {
    CapReading { translation: Vector3::new(0.5, -0.2, 0.8), rotation: Vector3::new(0.1, 0.4, -1.0), buttons: 2 }
}

fn same(one: &CapReading, other: &CapReading) -> bool {
    // One count is 1/350.
    (one.translation - other.translation).amax() < 2e-3
        && (one.rotation - other.rotation).amax() < 2e-3
        && one.buttons == other.buttons
}

/// Returns a pedal whose switches follow a number.
fn pedal(model: PedalModel) -> (EmulatorThread, Arc<AtomicU32>) {
    let pressed = Arc::new(AtomicU32::new(0));
    let foot = Arc::clone(&pressed);
    let body = PedalBody::pressed_by(move |_| PedalReading { pressed: foot.load(Ordering::Acquire) });
    (hid::pedal(None, model, body).serve().unwrap(), pressed)
}

fn still_cap(model: CapModel) -> EmulatorThread {
    cap(None, model, CapBody::moved_by(|_| deflected())).serve().unwrap()
}

fn cap_settings(serving: &EmulatorThread) -> CapSettings {
    CapSettings { source: serving.endpoint.clone(), ..CapSettings::default() }
}

fn pedal_settings(serving: &EmulatorThread) -> PedalSettings {
    PedalSettings { source: serving.endpoint.clone(), ..PedalSettings::default() }
}

/// Polls every millisecond until `done`, for at most 3 s; returns the elapsed time, s.
fn until<D: Device>(
    device: &mut D,
    mut done: impl FnMut(&mut D, Option<TimedReading<D::Reading>>) -> bool,
) -> Option<f64> {
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(3) {
        let reading = device.poll(begin.elapsed().as_secs_f64());
        if done(device, reading) {
            return Some(begin.elapsed().as_secs_f64());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    None
}

fn until_slot<D: Device + 'static>(
    slot: &mut DeviceSlot<D>,
    begin: Instant,
    mut done: impl FnMut(&Health, Option<TimedReading<D::Reading>>) -> bool,
) -> bool {
    let end = Instant::now() + Duration::from_secs(4);
    while Instant::now() < end {
        let reading = slot.poll(begin.elapsed().as_secs_f64());
        if done(slot.health(), reading) {
            return true;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    false
}

#[test]
fn both_kinds_of_cap_arrive_whole_at_their_rates() {
    judged(|| {
        for (model, rate_hz) in [(CapModel::Split, 125.0), (CapModel::Combined, 62.5)] {
            let serving = still_cap(model);
            let mut driver = CapDriver::open(&cap_settings(&serving)).unwrap();
            assert_eq!(driver.health().standing, ConnectionState::Connected);
            assert!(driver.identity().product.contains("Space") && driver.identity().serial == "EMULATED");
            let mut newest = CapReading::default();
            until(&mut driver, |driver, reading| {
                newest = reading.map_or(newest, |reading| reading.value);
                driver.health().rate_hz > 0.0
            })
            .unwrap();
            // Buttons are sent only when they change, so the client has missed earlier changes.
            assert!(same(&newest, &CapReading { buttons: newest.buttons, ..deflected() }), "{newest:?}");
            let Health { rate_hz: rate, lost, damaged, refused, .. } = *driver.health();
            assert!(rate > 0.5 * rate_hz && rate < 1.3 * rate_hz, "{model:?}: {rate} Hz");
            assert_eq!((lost, damaged, refused), (0, 0, 0));
        }
    });
}

#[test]
fn every_axis_may_be_turned_the_other_way() {
    judged(|| {
        let serving = still_cap(CapModel::Combined);
        let settings = CapSettings { invert: [true, false, false, false, false, true], ..cap_settings(&serving) };
        let mut driver = CapDriver::open(&settings).unwrap();
        let mut expected = deflected();
        expected.translation.x *= -1.0;
        expected.rotation.z *= -1.0;
        let found = |_: &mut CapDriver, reading: Option<TimedReading<CapReading>>| {
            reading.is_some_and(|reading| same(&CapReading { buttons: 2, ..reading.value }, &expected))
        };
        assert!(until(&mut driver, found).is_some());
    });
}

#[test]
fn a_cap_that_falls_silent_while_deflected_lets_go_within_the_watchdogs_time() {
    judged(|| {
        let serving = still_cap(CapModel::Split);
        let mut driver = CapDriver::open(&cap_settings(&serving)).unwrap();
        let both =
            |reading: &CapReading| reading.translation != Vector3::zeros() && reading.rotation != Vector3::zeros();
        until(&mut driver, |_, reading| reading.is_some_and(|reading| both(&reading.value))).unwrap();
        serving.faults.set(EmulatedFault::Silence);
        let took_s = until(&mut driver, |_, reading| {
            reading.is_some_and(|reading| CapReading { buttons: 0, ..reading.value } == CapReading::default())
        });
        assert!(took_s.unwrap() > RELEASE_AFTER_S * 0.5);
        assert_eq!(driver.health().lost, 2, "both halves");
        assert_eq!(driver.health().standing, ConnectionState::Connected, "silence at rest does not count as a loss");
        serving.faults.set(EmulatedFault::None);
        assert!(until(&mut driver, |_, reading| reading.is_some_and(|reading| both(&reading.value))).is_some());
    });
}

#[test]
fn a_cap_at_rest_says_zero_and_then_nothing_and_the_watchdog_stays_quiet() {
    judged(|| {
        let body = |now_s: f64| if now_s < 0.3 { deflected() } else { CapReading::default() };
        let serving = cap(None, CapModel::Combined, CapBody::moved_by(body)).serve().unwrap();
        let mut driver = CapDriver::open(&cap_settings(&serving)).unwrap();
        let mut newest = CapReading::default();
        let mut readings = 0;
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_millis(600) {
            if let Some(reading) = driver.poll(begin.elapsed().as_secs_f64()) {
                newest = reading.value;
                readings += 1;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(readings > 5 && readings < 40, "{readings}");
        assert_eq!(newest, CapReading::default());
        assert_eq!(driver.health().lost, 0);
    });
}

#[test]
fn the_light_is_on_while_connected() {
    judged(|| {
        let light = Arc::new(AtomicU32::new(9));
        let seen = Arc::clone(&light);
        let body = CapBody {
            now: Box::new(|_| deflected()),
            light: Box::new(move |on| seen.store(u32::from(on), Ordering::Release)),
        };
        let serving = cap(None, CapModel::Split, body).serve().unwrap();
        let mut driver = CapDriver::open(&cap_settings(&serving)).unwrap();
        assert!(until(&mut driver, |_, _| light.load(Ordering::Acquire) == 1).is_some());
        drop(driver);
        std::thread::sleep(Duration::from_millis(60));
        assert_eq!(light.load(Ordering::Acquire), 0);
    });
}

/// The driver's expected state under a fault.
type Expected = fn(&Health) -> bool;

const LOST: fn(&Health, Loss) -> bool = |health, loss| health.standing == ConnectionState::Lost(loss);
const CAP_FAULTS: [(EmulatedFault, Expected); 6] = [
    (EmulatedFault::Silence, |health| health.lost > 0),
    (EmulatedFault::Freeze, |health| health.standing == ConnectionState::Connected),
    (EmulatedFault::Garbage, |health| health.damaged > 0),
    (EmulatedFault::WrongFrame, |health| LOST(health, Loss::Corrupt)),
    (EmulatedFault::NotANumber, |health| LOST(health, Loss::Implausible)),
    (EmulatedFault::Disconnect, |health| LOST(health, Loss::Disconnected)),
];

#[test]
fn a_cap_comes_back_from_every_fault_without_a_restart() {
    judged(|| {
        let serving = still_cap(CapModel::Split);
        let settings = cap_settings(&serving);
        let mut slot = DeviceSlot::start("cap", move || CapDriver::open(&settings)).unwrap();
        let begin = Instant::now();
        let mut held = HeldValue::<CapReading>::default();
        for (fault, expected) in CAP_FAULTS {
            assert!(until_slot(&mut slot, begin, |_, reading| reading.is_some()), "before {fault:?}");
            serving.faults.set(fault);
            let set = Instant::now();
            assert!(until_slot(&mut slot, begin, |health, _| expected(health)), "{fault:?}: {:?}", slot.health());
            eprintln!("cap: {fault:?} was seen after {:.0} ms", set.elapsed().as_secs_f64() * 1e3);
            if slot.health().standing != ConnectionState::Connected {
                assert_eq!(held.update(None, slot.health()), CapReading::default(), "a lost cap is at rest");
            }
            serving.faults.set(EmulatedFault::None);
            let moves = |reading: CapReading| reading.translation != Vector3::zeros();
            assert!(
                until_slot(&mut slot, begin, |health, reading| moves(held.update(reading, health))),
                "it does not come back from {fault:?}"
            );
        }
    });
}

#[test]
fn late_lost_and_reordered_reports_leave_a_cap_connected_with_its_values() {
    judged(|| {
        for fault in [EmulatedFault::Delay, EmulatedFault::Loss, EmulatedFault::Reorder] {
            let serving = still_cap(CapModel::Combined);
            serving.faults.set(fault);
            let mut driver = CapDriver::open(&cap_settings(&serving)).unwrap();
            let mut good = 0;
            let enough = |driver: &mut CapDriver, reading: Option<TimedReading<CapReading>>| {
                good += u32::from(
                    reading.is_some_and(|reading| same(&CapReading { buttons: 2, ..reading.value }, &deflected())),
                );
                driver.health().standing == ConnectionState::Connected && good > 10
            };
            assert!(until(&mut driver, enough).is_some(), "{fault:?}");
        }
    });
}

#[test]
fn the_daemon_gives_the_same_values_as_the_cap_itself() {
    judged(|| {
        let serving = spacenavd(
            None,
            CapBody::moved_by(|now_s| if now_s < 0.4 { CapReading { buttons: 0, ..deflected() } } else { deflected() }),
        )
        .serve()
        .unwrap();
        let mut driver = CapDriver::open(&cap_settings(&serving)).unwrap();
        assert!(
            until(&mut driver, |_, reading| reading.is_some_and(|reading| same(&reading.value, &deflected())))
                .is_some()
        );
        serving.faults.set(EmulatedFault::Disconnect);
        assert!(
            until(&mut driver, |driver, _| driver.health().standing == ConnectionState::Lost(Loss::Disconnected))
                .is_some()
        );
    });
}

#[test]
fn a_flood_is_taken_in_pieces() {
    let [here, mut there] = MemoryDatagrams::pair();
    let mut driver = CapDriver::over(Box::new(here), &HidIdentity::default(), &CapSettings::default());
    for _ in 0..1000 {
        there.send(&[1, 100, 0, 0, 0, 0, 0]).unwrap();
    }
    assert!(driver.poll(0.0).is_some());
    assert_eq!(driver.health().readings, 64);
}

#[test]
fn what_cannot_be_opened_says_why() {
    judged(|| {
        let trouble = |source: &str| {
            CapDriver::open(&CapSettings { source: source.to_owned(), ..CapSettings::default() }).err().unwrap()
        };
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name).display().to_string();
        assert!(matches!(trouble(&place("no-node")), DeviceError::Absent { .. }));
        std::fs::write(place("file"), b"").unwrap();
        assert!(matches!(trouble(&place("file")), DeviceError::WrongProduct { .. }), "no hidraw node");
        assert!(matches!(trouble("1234:5678"), DeviceError::Absent { .. }));
        assert!(matches!(trouble("nonsense"), DeviceError::Setting { .. }));
        assert!(matches!(trouble(&format!("emulated:{}", place("none.sock"))), DeviceError::Absent { .. }));
        assert!(matches!(trouble(&format!("spacenavd:{}", place("none.sock"))), DeviceError::Absent { .. }));
        let dead = nima_devices::hid::seqpacket::listen(&folder.path().join("dead.sock")).unwrap();
        assert!(
            matches!(trouble(&format!("emulated:{}", place("dead.sock"))), DeviceError::Silent { .. }),
            "nobody accepts"
        );
        drop(dead);
        assert!(matches!(trouble(&format!("emulated:{}", place("dead.sock"))), DeviceError::NobodyListens { .. }));
        let (serving, _) = pedal(PedalModel::Switches);
        let wrong = trouble(&serving.endpoint);
        assert!(matches!(&wrong, DeviceError::WrongProduct { found, .. } if found.contains("05f3:00ff")), "{wrong}");
        for (keys, clutch, presence) in
            [(vec![], 0, None), (vec![1], 0, None), (vec![5], 8, None), (vec![5], 1, Some(1))]
        {
            let settings = PedalSettings { keys, clutch, presence, ..PedalSettings::default() };
            assert!(matches!(PedalDriver::open(&settings), Err(DeviceError::Setting { .. })), "{settings:?}");
        }
    });
}

#[test]
fn a_node_without_rights_names_the_rule_that_gives_them() {
    let denied = std::io::Error::from(std::io::ErrorKind::PermissionDenied);
    let rule = nima_devices::discovery::rules::of_hidraw(Some((0x046d, 0xc626)));
    let trouble = DeviceError::of_port(std::path::Path::new("/dev/hidraw0"), &denied, &rule);
    assert!(
        trouble.cure().contains(r#"KERNEL=="hidraw*", ATTRS{idVendor}=="046d", ATTRS{idProduct}=="c626""#),
        "{}",
        trouble.cure()
    );
}

#[test]
fn settings_read_from_a_rig_file_and_unknown_keys_do_not() {
    let settings: PedalSettings = toml::from_str("source = \"0c45:7403\"\npresence = 1").unwrap();
    assert_eq!((settings.clutch, settings.presence, settings.keys.len()), (0, Some(1), 3));
    assert!(toml::from_str::<CapSettings>("sorce = \"any\"").is_err());
    assert_eq!(toml::from_str::<CapSettings>("").unwrap(), CapSettings::default());
}
