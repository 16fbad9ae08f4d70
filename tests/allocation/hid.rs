//! Test: polling a cap or a pedal allocates nothing, whatever data arrive, and also when the device is lost.
#![cfg(target_os = "linux")]

use std::time::{Duration, Instant};

use nima_devices::{
    CapReading, ConnectionState, Device, Loss, PedalReading,
    hid::{CapDriver, CapSettings, PedalDriver, PedalSettings},
};
use nima_emulation::emulators::{
    EmulatedFault,
    hid::{CapBody, CapModel, PedalBody, PedalModel, cap, pedal},
};
use nima_testing::real_time::{alone, judged};

use crate::counting::calls;

/// Polls for some time; returns the allocations of this thread and the number of readings.
fn polled(device: &mut impl Device, length: Duration) -> (u64, u32) {
    let before = calls();
    let begin = Instant::now();
    let mut readings = 0;
    while begin.elapsed() < length {
        readings += u32::from(device.poll(begin.elapsed().as_secs_f64()).is_some());
        std::thread::sleep(Duration::from_millis(1));
    }
    (calls() - before, readings)
}

#[test]
fn polling_allocates_nothing_while_good_damaged_and_lost() {
    let _alone = alone();
    judged(|| {
        let moving = |now_s: f64| CapReading { buttons: (now_s * 20.0) as u32 & 1, ..CapReading::default() };
        let cap = cap(None, CapModel::Split, CapBody::moved_by(moving)).serve().unwrap();
        let stepping = |now_s: f64| PedalReading { pressed: (now_s * 20.0) as u32 & 1 };
        let pedal = pedal(None, PedalModel::Keyboard, PedalBody::pressed_by(stepping)).serve().unwrap();
        let mut cap_driver =
            CapDriver::open(&CapSettings { source: cap.endpoint.clone(), ..CapSettings::default() }).unwrap();
        let settings = PedalSettings { source: pedal.endpoint.clone(), ..PedalSettings::default() };
        let mut pedal_driver = PedalDriver::open(&settings).unwrap();
        for (fault, speaks) in
            [(EmulatedFault::None, true), (EmulatedFault::Garbage, true), (EmulatedFault::Disconnect, false)]
        {
            cap.faults.set(fault);
            pedal.faults.set(fault);
            std::thread::sleep(Duration::from_millis(30));
            let (allocated, readings) = polled(&mut cap_driver, Duration::from_millis(400));
            assert_eq!(allocated, 0, "cap, {fault:?}");
            assert!(readings > 0 || !speaks);
            let (allocated, readings) = polled(&mut pedal_driver, Duration::from_millis(400));
            assert_eq!(allocated, 0, "pedal, {fault:?}");
            assert!(readings > 0 || !speaks);
        }
        assert_eq!(cap_driver.health().standing, ConnectionState::Lost(Loss::Disconnected));
        let before = calls();
        drop(std::hint::black_box(vec![1_u8; 10]));
        assert_eq!(calls() - before, 2, "the counter counts");
    });
}
