//! Every emulated fault, in virtual time: the resulting loss or counter, its delay, and the recovery.

use nima_devices::{
    ConnectionState, Device as _, Loss,
    dynamixel::{DynamixelDriver, GoalResult, HardwareError, ServoFault, WaitClock as _},
    transport::MemoryBytes,
};

use super::world::Fixture;
use crate::emulators::EmulatedFault;

fn running() -> (Fixture, DynamixelDriver<MemoryBytes>) {
    let mut bench = Fixture::usual();
    let mut driver = bench.open().unwrap();
    bench.run(&mut driver, 0.5).unwrap();
    let health = driver.health();
    assert_eq!((health.lost, health.damaged, health.refused, health.out_of_order), (0, 0, 0, 0));
    (bench, driver)
}

/// Polls at 1 kHz until the device is lost; returns the loss, and the time since the last good reading.
fn until_lost(bench: &Fixture, driver: &mut DynamixelDriver<MemoryBytes>) -> Option<(Loss, f64)> {
    let begin_s = bench.now_s();
    while bench.now_s() - begin_s < 1.0 {
        bench.poll(driver, 1e-3);
        if let ConnectionState::Lost(loss) = driver.health().standing {
            return Some((loss, bench.now_s() - begin_s));
        }
    }
    None
}

#[test]
fn each_fault_is_told_in_time_and_a_new_opening_brings_it_back() {
    let overload = ServoFault { id: 1, error: HardwareError(HardwareError::OVERLOAD) };
    for (fault, expected) in [
        (EmulatedFault::Delay, Loss::Silent),
        (EmulatedFault::Freeze, Loss::Silent),
        (EmulatedFault::Silence, Loss::Silent),
        (EmulatedFault::BadChecksum, Loss::Corrupt),
        (EmulatedFault::WrongFrame, Loss::Corrupt),
        (EmulatedFault::DeviceFault, Loss::Device { code: overload.code() }),
        (EmulatedFault::NotANumber, Loss::Implausible),
    ] {
        let (mut bench, mut driver) = running();
        bench.fault(fault);
        let (loss, after_s) = until_lost(&bench, &mut driver).unwrap();
        assert_eq!(loss, expected, "{fault:?}");
        assert!(after_s <= 0.0225, "{fault:?} after {after_s} s");
        assert!(bench.poll(&mut driver, 1e-3).is_none(), "lost stays lost");
        drop(driver);
        bench.fault(EmulatedFault::None);
        bench.world.borrow_mut().pass(0.1);
        if fault == EmulatedFault::DeviceFault {
            assert!(bench.open().is_err(), "a servo that shut down needs the command");
            bench.reboots.ask(0);
        }
        let mut driver = bench.open().unwrap();
        assert!(bench.run(&mut driver, 0.1).is_some(), "{fault:?}");
    }
}

#[test]
fn faults_that_spare_some_answers_are_counted() {
    let (bench, mut driver) = running();
    bench.fault(EmulatedFault::Loss);
    bench.run(&mut driver, 0.05);
    // Two missing answers in a row are tolerated, three count as silence; both are counted.
    until_lost(&bench, &mut driver);
    assert!(driver.health().lost > 0, "{:?}", driver.health());

    let (bench, mut driver) = running();
    bench.fault(EmulatedFault::Garbage);
    until_lost(&bench, &mut driver);
    assert!(driver.health().skipped_bytes > 0, "{:?}", driver.health());

    let (bench, mut driver) = running();
    bench.fault(EmulatedFault::Reorder);
    until_lost(&bench, &mut driver);
    assert!(driver.health().out_of_order > 0 && driver.health().lost > 0, "{:?}", driver.health());
}

#[test]
fn a_cut_line_is_told_at_once() {
    let (bench, mut driver) = running();
    bench.world.borrow().end.cut();
    assert!(bench.poll(&mut driver, 1e-3).is_none());
    assert_eq!(driver.health().standing, ConnectionState::Lost(Loss::Disconnected));
}

#[test]
fn a_caller_that_pauses_has_not_lost_the_servos() {
    let (bench, mut driver) = running();
    for pause_s in [0.05, 1.0, 40.0] {
        bench.poll(&mut driver, pause_s);
        assert!(bench.run(&mut driver, 0.05).is_some());
        assert_eq!(driver.health().standing, ConnectionState::Connected, "{pause_s} s");
    }
}

#[test]
fn a_bus_that_falls_quiet_stops_the_servos_and_that_is_told() {
    let (bench, mut driver) = running();
    driver.set_torque(true);
    bench.run(&mut driver, 0.3);
    assert!(driver.is_torque_on());
    assert_eq!(driver.set_goals(&[1.0; 4]), GoalResult::AsAsked);
    // The caller stalls for longer than the watchdog waits.
    for _ in 0..300 {
        bench.world.borrow_mut().pass(1e-3);
    }
    let stopped_rad = bench.world.borrow().emulator.shaft(0).unwrap().angle_rad;
    bench.world.borrow_mut().pass(0.1);
    let later_rad = bench.world.borrow().emulator.shaft(0).unwrap().angle_rad;
    assert!((later_rad - stopped_rad).abs() < 0.05 && later_rad < 0.9, "{stopped_rad} {later_rad}");
    let (loss, _) = until_lost(&bench, &mut driver).unwrap();
    let Loss::Device { code } = loss else { panic!("{loss:?}") };
    assert_eq!(ServoFault::of_code(code).error.to_string(), "the bus watchdog expired");
}

#[test]
fn a_servo_that_restarts_by_itself_is_not_driven_on_unnoticed() {
    let (bench, mut driver) = running();
    driver.set_torque(true);
    bench.run(&mut driver, 0.5);
    let now_s = bench.now_s();
    bench.world.borrow_mut().emulator.interrupt(2, now_s);
    assert!(until_lost(&bench, &mut driver).is_some(), "it does not answer, or its torque is off");
}

#[test]
fn hardware_errors_have_words() {
    assert_eq!(HardwareError(0x30).to_string(), "electrical shock or too little power, overload");
    assert_eq!(HardwareError(0x02).to_string(), "hardware error 0x02");
    for code in [0x0120, 0xFC81] {
        assert_eq!(ServoFault::of_code(code).code(), code);
    }
    assert_eq!(ServoFault::of_code(0x0308).to_string(), "servo 3: motor encoder failed");
}
