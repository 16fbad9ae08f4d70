//! Every emulated fault: the driver's reaction, and its recovery in its slot without a restart.

use nima_devices::{DeviceSlot, Health, Loss};
use nima_testing::real_time::judged;

use super::*;
use crate::emulators::EmulatedFault;

/// Effect of a fault.
enum Expected {
    Lost(Loss),
    /// Continues; unanswered calls are counted as lost.
    Lossy,
    /// Continues; invalid answers are counted as damaged.
    Noisy,
}

fn expected(fault: EmulatedFault) -> Expected {
    match fault {
        EmulatedFault::Delay | EmulatedFault::Freeze | EmulatedFault::Silence => Expected::Lost(Loss::Silent),
        EmulatedFault::BadChecksum | EmulatedFault::WrongFrame => Expected::Lost(Loss::Corrupt),
        EmulatedFault::Disconnect => Expected::Lost(Loss::Disconnected),
        EmulatedFault::DeviceFault => Expected::Lost(Loss::Device { code: 109 }),
        EmulatedFault::NotANumber => Expected::Lost(Loss::Implausible),
        EmulatedFault::Loss | EmulatedFault::Reorder => Expected::Lossy,
        _ => Expected::Noisy,
    }
}

fn wait(
    slot: &mut DeviceSlot<ForceDimensionDriver>,
    good: impl Fn(&DeviceSlot<ForceDimensionDriver>, bool) -> bool,
) -> bool {
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(8) {
        let reading = slot.poll(now_s()).is_some();
        if good(slot, reading) {
            return true;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    false
}

/// Attempts per fault: without real-time scheduling, a busy machine occasionally makes a device silent by itself.
const ATTEMPTS: u32 = 6;

fn goes_through(faults: &[EmulatedFault]) {
    judged(|| {
        let (serving, hand, settings) = rig(EmulatedForceDimension::default());
        let mut slot = DeviceSlot::start("handle", move || open(&settings)).unwrap();
        for fault in faults {
            let mut seen = Vec::new();
            let found = (0..ATTEMPTS).any(|_| {
                let found = shows(&mut slot, &hand, &serving, *fault, &mut seen);
                serving.faults.set(EmulatedFault::None);
                found
            });
            assert!(found, "{fault:?} was never seen as it should be: {seen:?}");
        }
        assert!(wait(&mut slot, |_, reading| reading), "delivers again: {:?}", slot.view().report().trouble);
    });
}

/// Sets one fault on a handle that is pushing; returns whether the effect is as expected.
fn shows(
    slot: &mut DeviceSlot<ForceDimensionDriver>,
    hand: &Hand,
    serving: &EmulatorThread,
    fault: EmulatedFault,
    seen: &mut Vec<ConnectionState>,
) -> bool {
    let lost = |slot: &DeviceSlot<ForceDimensionDriver>| matches!(slot.health().standing, ConnectionState::Lost(_));
    assert!(wait(slot, |_, reading| reading), "delivers before {fault:?}: {:?}", slot.view().report().trouble);
    // The force must end when the device is lost, too.
    slot.device().unwrap().enable_force();
    assert!(wait(slot, |slot, _| hand.applied().mode == FirmwareMode::Force || lost(slot)));
    if lost(slot) {
        seen.push(slot.health().standing);
        return false;
    }
    let begin_s = now_s();
    let before = *slot.health();
    serving.faults.set(fault);
    match expected(fault) {
        Expected::Lost(loss) => {
            assert!(wait(slot, |slot, _| lost(slot)), "{fault:?} leads to no loss: {:?}", slot.health());
            let after_ms = (now_s() - begin_s) * 1e3;
            let silent_ms = slot.health().age_s(now_s()) * 1e3;
            println!(
                "{fault:?}: {:?} after {after_ms:.1} ms, {silent_ms:.1} ms without a reading",
                slot.health().standing
            );
            seen.push(slot.health().standing);
            assert!(wait(slot, |_, _| hand.applied().mode == FirmwareMode::Brake), "{fault:?}: brakes are on");
            slot.health().standing == ConnectionState::Lost(loss)
        }
        Expected::Lossy => goes_on(slot, seen, |now| now.lost > before.lost + 3 && now.damaged == before.damaged),
        Expected::Noisy => goes_on(slot, seen, |now| now.damaged > before.damaged + 3),
    }
}

fn goes_on(
    slot: &mut DeviceSlot<ForceDimensionDriver>,
    seen: &mut Vec<ConnectionState>,
    counted: impl Fn(&Health) -> bool,
) -> bool {
    assert!(wait(slot, |slot, _| counted(slot.health()) || matches!(slot.health().standing, ConnectionState::Lost(_))));
    seen.push(slot.health().standing);
    slot.health().standing == ConnectionState::Connected
}

#[test]
fn silence_is_noticed_and_overcome() {
    goes_through(&[EmulatedFault::Silence, EmulatedFault::Freeze]);
}

#[test]
fn lateness_and_damage_are_noticed_and_overcome() {
    goes_through(&[EmulatedFault::Delay, EmulatedFault::BadChecksum]);
}

#[test]
fn wrong_frames_and_a_pulled_cable_are_noticed_and_overcome() {
    goes_through(&[EmulatedFault::WrongFrame, EmulatedFault::Disconnect]);
}

#[test]
fn faults_and_impossible_numbers_are_noticed_and_overcome() {
    goes_through(&[EmulatedFault::DeviceFault, EmulatedFault::NotANumber]);
}

#[test]
fn single_losses_are_counted_and_lived_with() {
    goes_through(&[EmulatedFault::Loss, EmulatedFault::Reorder, EmulatedFault::Garbage]);
}
