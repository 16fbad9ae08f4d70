//! Tests of every emulated fault with the driver in its slot: its effect, and the tracker's recovery without a restart.

use std::time::Instant;

use nima_devices::{ConnectionState, DeviceSlot, Loss, TimedReading, TrackerReading, ndi::*};
use nima_testing::real_time::judged;

use super::driver_tests::{BLOCK_FIRMWARE, TEXT_FIRMWARE, definitions, line, network, profile, until};
use crate::emulators::{EmulatedFault, EmulatorThread, ndi::wandering};

/// Effect of a fault on the driver.
#[derive(Debug)]
enum Outcome {
    Lost(&'static [Loss]),
    Lags,
    Disorder,
}

fn outcome(fault: EmulatedFault) -> Outcome {
    use Outcome::{Disorder, Lags, Lost};
    match fault {
        EmulatedFault::None
        | EmulatedFault::Repeat
        | EmulatedFault::Block
        | EmulatedFault::EndOfRange
        | EmulatedFault::Jump
        | EmulatedFault::Delay
        | EmulatedFault::Black
        | EmulatedFault::Torn
        | EmulatedFault::Late
        | EmulatedFault::WrongSize
        | EmulatedFault::OtherFormat
        | EmulatedFault::Moved => Lags,
        EmulatedFault::Reorder => Disorder,
        EmulatedFault::Loss | EmulatedFault::Freeze | EmulatedFault::Silence => Lost(&[Loss::Silent]),
        EmulatedFault::Garbage | EmulatedFault::BadChecksum => Lost(&[Loss::Corrupt, Loss::Silent]),
        EmulatedFault::WrongFrame => Lost(&[Loss::Corrupt]),
        EmulatedFault::Disconnect => Lost(&[Loss::Disconnected]),
        EmulatedFault::DeviceFault => Lost(&[Loss::Device { code: SYSTEM_FAULT + (1 << 3) }]),
        EmulatedFault::NotANumber => Lost(&[Loss::Implausible]),
    }
}

/// Sets one fault on a working slot, checks its effect, removes the fault, and checks that the slot recovers.
fn survives(
    fault: EmulatedFault,
    form: ReplyForm,
    served: &EmulatorThread,
    slot: &mut DeviceSlot<NdiDriver>,
    begin: Instant,
) {
    let delivering =
        |slot: &mut DeviceSlot<NdiDriver>| until(begin, 5.0, |now_s| slot.poll(now_s), |reading| reading.is_some());
    assert!(delivering(slot), "before {fault:?}");
    let before = *slot.health();
    let set = Instant::now();
    served.faults.set(fault);
    let outcome = outcome(fault);
    let shown = std::cell::Cell::new(false);
    // Within noise a good reply arrives occasionally, so the loss takes some time.
    until(
        begin,
        4.0,
        |now_s| {
            slot.poll(now_s);
            let health = slot.health();
            shown.set(match (&outcome, health.standing) {
                (Outcome::Lost(losses), ConnectionState::Lost(loss)) => losses.contains(&loss),
                (Outcome::Lags, _) => health.lost >= before.lost + 4,
                (Outcome::Disorder, _) => health.out_of_order >= before.out_of_order + 4,
                _ => false,
            });
            None
        },
        |_: Option<TimedReading<TrackerReading>>| shown.get(),
    );
    assert!(shown.get(), "{fault:?} over {form:?} gave {:?}, not {outcome:?}", slot.health());
    println!("{fault:?} {form:?}: {outcome:?} after {} ms", set.elapsed().as_millis());
    served.faults.set(EmulatedFault::None);
    assert!(delivering(slot), "after {fault:?}: {:?}, {:?}", slot.health(), slot.view().report().trouble);
}

fn survives_all(served: &EmulatorThread, settings: NdiSettings, form: ReplyForm, faults: &[EmulatedFault]) {
    let mut slot = DeviceSlot::start("tracker", move || NdiDriver::open(&settings)).unwrap();
    let begin = Instant::now();
    for fault in faults {
        survives(*fault, form, served, &mut slot, begin);
    }
}

fn survives_over_a_network(firmware: &str, form: ReplyForm, faults: &[EmulatedFault]) {
    judged(|| {
        let (_folder, tools) = definitions(1);
        let served = profile(firmware).on_network(0, wandering).serve().unwrap();
        survives_all(&served, network(&served, tools), form, faults);
    });
}

#[test]
fn it_survives_a_network_that_loses_and_goes() {
    use EmulatedFault::{Disconnect, Freeze, Loss, Silence};
    survives_over_a_network(BLOCK_FIRMWARE, ReplyForm::Binary, &[Loss, Freeze, Silence, Disconnect]);
}

#[test]
fn it_survives_a_network_that_is_late() {
    survives_over_a_network(BLOCK_FIRMWARE, ReplyForm::Binary, &[EmulatedFault::Delay]);
}

#[test]
fn it_survives_damaged_blocks() {
    use EmulatedFault::{BadChecksum, Garbage, WrongFrame};
    survives_over_a_network(BLOCK_FIRMWARE, ReplyForm::Binary, &[Garbage, BadChecksum, WrongFrame]);
}

#[test]
fn it_survives_damaged_text() {
    use EmulatedFault::{BadChecksum, Garbage, Silence, WrongFrame};
    survives_over_a_network(TEXT_FIRMWARE, ReplyForm::Text, &[Silence, Garbage, BadChecksum, WrongFrame]);
}

#[test]
fn it_survives_a_unit_that_is_wrong() {
    use EmulatedFault::{DeviceFault, NotANumber, Reorder};
    for (firmware, form) in [(BLOCK_FIRMWARE, ReplyForm::Binary), (TEXT_FIRMWARE, ReplyForm::Text)] {
        survives_over_a_network(firmware, form, &[Reorder, DeviceFault, NotANumber]);
    }
}

fn survives_over_a_line(faults: &[EmulatedFault]) {
    judged(|| {
        let (_folder, tools) = definitions(1);
        let served = profile(BLOCK_FIRMWARE).on_line(None, wandering).serve().unwrap();
        survives_all(&served, line(&served, tools), ReplyForm::Binary, faults);
    });
}

#[test]
fn it_survives_a_line_that_is_pulled_out_or_silent() {
    survives_over_a_line(&[EmulatedFault::Disconnect, EmulatedFault::Silence]);
}

#[test]
fn it_survives_noise_on_a_line() {
    survives_over_a_line(&[EmulatedFault::Garbage, EmulatedFault::BadChecksum]);
}
