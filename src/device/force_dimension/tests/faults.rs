//! Every emulated fault: what the driver makes of it, and that it comes back through its slot without a restart.

use super::*;
use crate::device::{Loss, Slot, emulation::EmulatedFault};

/// What a fault leads to.
enum Expected {
    Lost(Loss),
    /// Goes on, with failed calls counted.
    Disturbed,
}

fn expected(fault: EmulatedFault) -> Expected {
    match fault {
        EmulatedFault::Delay | EmulatedFault::Freeze | EmulatedFault::Silence => Expected::Lost(Loss::Silent),
        EmulatedFault::BadChecksum | EmulatedFault::WrongFrame => Expected::Lost(Loss::Corrupt),
        EmulatedFault::Disconnect => Expected::Lost(Loss::Disconnected),
        EmulatedFault::DeviceFault => Expected::Lost(Loss::Device { code: 109 }),
        EmulatedFault::NotANumber => Expected::Lost(Loss::Implausible),
        _ => Expected::Disturbed,
    }
}

fn wait(slot: &mut Slot<Driver>, good: impl Fn(&Slot<Driver>, bool) -> bool) -> bool {
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

fn goes_through(faults: &[EmulatedFault]) {
    let (serving, hand, settings) = rig(Emulator::default());
    let mut slot = Slot::start("handle", move || open(&settings)).unwrap();
    let view = slot.view();
    for fault in faults {
        assert!(wait(&mut slot, |_, reading| reading), "delivers before {fault:?}: {:?}", view.report().trouble);
        // A loss must also end the force.
        slot.device().unwrap().enable_force();
        assert!(wait(&mut slot, |_, _| hand.applied().mode == Mode::Force));
        let (begin_s, failed) = (slot.health().newest_s.unwrap(), slot.health().damaged);
        serving.faults.set(*fault);
        match expected(*fault) {
            Expected::Lost(loss) => {
                assert!(
                    wait(&mut slot, |slot, _| slot.health().standing == Standing::Lost(loss)),
                    "{fault:?} leads to {loss:?}, not to {:?}",
                    slot.health()
                );
                println!("{fault:?}: {loss:?} {:.1} ms after the last reading", slot.health().age_s(now_s()) * 1e3);
                println!("    told {:.1} ms after the fault", (now_s() - begin_s) * 1e3);
                assert!(wait(&mut slot, |_, _| hand.applied().mode == Mode::Brake), "{fault:?}: brakes are on");
            }
            Expected::Disturbed => {
                assert!(wait(&mut slot, |slot, _| slot.health().damaged > failed + 3), "{fault:?}: failures count");
            }
        }
        serving.faults.set(EmulatedFault::None);
    }
    assert!(wait(&mut slot, |_, reading| reading), "delivers again: {:?}", view.report().trouble);
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
