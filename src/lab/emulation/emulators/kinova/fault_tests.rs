//! Tests of every emulated fault: detected in time, and over when it is removed. Also measures the cycle.

use std::{
    thread::sleep,
    time::{Duration, Instant},
};

use nima_devices::{
    ConnectionState, Device as _, DeviceSlot, Health, Loss,
    kinova::{KinovaDriver, KinovaSettings, faults, open},
};

use nima_testing::real_time::judged;

use super::driver_tests::{Ticking, patient, started};
use crate::emulators::EmulatedFault;

/// Returns whether a fault has its expected effect.
fn is_noticed(fault: EmulatedFault, health: &Health, before: &Health) -> bool {
    let lost_by = |loss: Loss| health.standing == ConnectionState::Lost(loss);
    match fault {
        EmulatedFault::Loss => health.lost > before.lost,
        EmulatedFault::Reorder => health.out_of_order > before.out_of_order,
        EmulatedFault::Garbage => health.damaged > before.damaged,
        EmulatedFault::Delay | EmulatedFault::Silence => lost_by(Loss::Silent),
        EmulatedFault::Freeze => lost_by(Loss::Silent) && health.out_of_order > before.out_of_order,
        EmulatedFault::BadChecksum | EmulatedFault::WrongFrame => lost_by(Loss::Corrupt),
        EmulatedFault::Disconnect => lost_by(Loss::Disconnected),
        EmulatedFault::DeviceFault => lost_by(Loss::Device { code: faults::MAXIMUM_TORQUE }),
        EmulatedFault::NotANumber => lost_by(Loss::Implausible),
        EmulatedFault::None
        | EmulatedFault::Repeat
        | EmulatedFault::Block
        | EmulatedFault::EndOfRange
        | EmulatedFault::Jump
        | EmulatedFault::Black
        | EmulatedFault::Torn
        | EmulatedFault::Late
        | EmulatedFault::WrongSize
        | EmulatedFault::OtherFormat
        | EmulatedFault::Moved => true,
    }
}

#[test]
fn every_loss_is_told_within_twenty_milliseconds_of_loop_time() {
    judged(|| {
        for fault in EmulatedFault::ALL {
            if matches!(fault, EmulatedFault::Loss | EmulatedFault::Garbage) {
                // These faults are random; another test covers them.
                continue;
            }
            let (serving, settings) = started(patient());
            let mut ticking = Ticking::open(&settings);
            assert!(ticking.until(500, |ticking| ticking.driver.health().readings > 10));
            let before = *ticking.driver.health();
            serving.faults.set(fault);
            let noticed = ticking.until(1000, |ticking| is_noticed(fault, ticking.driver.health(), &before));
            assert!(noticed, "{fault:?}: {:?}", ticking.driver.health());
            // Counted from the last good reading, because the emulator may send one or two more before the fault shows.
            // One tick is the poll that detects the exceeded limit.
            let age_s = ticking.driver.health().age_s(ticking.now_s);
            assert!(age_s < 0.0215, "{fault:?} took {age_s} s");
        }
    });
}

/// Runs a slot until `good`.
fn until(
    slot: &mut DeviceSlot<KinovaDriver>,
    begin: Instant,
    good: impl Fn(&mut DeviceSlot<KinovaDriver>) -> bool,
) -> bool {
    let end = Instant::now() + Duration::from_secs(5);
    while Instant::now() < end {
        slot.poll(begin.elapsed().as_secs_f64());
        if good(slot) {
            return true;
        }
        sleep(Duration::from_millis(1));
    }
    false
}

#[test]
fn every_fault_is_noticed_and_passes_without_a_restart() {
    // A delay on a busy machine looks like silence, which would hide the expected reason.
    judged(|| {
        let (serving, settings) = started(patient());
        let settings = KinovaSettings { timeout_s: 0.4, ..settings };
        let mut slot = DeviceSlot::start("kinova", move || open(&settings)).unwrap();
        let begin = Instant::now();
        let connected = |slot: &mut DeviceSlot<KinovaDriver>| slot.health().standing == ConnectionState::Connected;
        for fault in EmulatedFault::ALL {
            assert!(until(&mut slot, begin, connected), "before {fault:?}: {:?}", slot.view().report());
            let before = *slot.health();
            serving.faults.set(fault);
            let noticed = |slot: &mut DeviceSlot<KinovaDriver>| is_noticed(fault, slot.health(), &before);
            assert!(until(&mut slot, begin, noticed), "{fault:?}: {:?}", slot.health());
            serving.faults.set(EmulatedFault::None);
        }
        assert!(until(&mut slot, begin, connected), "after all");
    });
}

#[test]
#[ignore = "prints figures, takes ten seconds: `./dev figures` runs it"]
fn figures_of_the_cycle() {
    let (_serving, settings) = started(patient());
    let mut driver = open(&settings).unwrap();
    let begin = Instant::now();
    let mut longest = Duration::ZERO;
    let mut total = Duration::ZERO;
    let mut polls = 0_u32;
    let mut next = Duration::ZERO;
    while begin.elapsed() < Duration::from_secs(10) {
        let from = Instant::now();
        driver.poll(begin.elapsed().as_secs_f64());
        let took = from.elapsed();
        longest = longest.max(took);
        total += took;
        polls += 1;
        if polls == 100 {
            driver.enter_low_level().unwrap();
        }
        next += Duration::from_millis(1);
        sleep(next.saturating_sub(begin.elapsed()));
    }
    let health = driver.health();
    println!("{polls} polls, mean {:?}, longest {longest:?}; {health:?}", total / polls);
    assert_eq!(health.standing, ConnectionState::Connected);
}
