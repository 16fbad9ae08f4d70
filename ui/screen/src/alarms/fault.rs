//! Alarms of faults, which name the device or arm concerned.

use nima_machine::{
    messages::Fault,
    rig::{RigPart, Side},
};
use nima_words::{
    report_text::{Remedy as _, part_name},
    text,
};

use super::{Alarm, AlarmKind, AlarmPriority, Signs};

/// Returns the alarm of a fault. A watchdog that the ready check trips on purpose must not look like a real fault.
pub(super) fn fault_alarm(t_s: f64, fault: Fault, signs: &Signs) -> Alarm {
    if signs.tested.is_some_and(|watchdog| watchdog.raises(fault)) {
        return Alarm {
            kind: AlarmKind::Tested,
            priority: AlarmPriority::Low,
            cause: text::alarms::tested(fault.cause()),
            cure: text::alarms::TESTED_CURE.get().to_owned(),
        };
    }
    Alarm {
        kind: AlarmKind::Fault(fault),
        priority: AlarmPriority::High,
        cause: text::alarms::fault(&cause_of(fault, signs), t_s),
        cure: fault.cure().to_owned(),
    }
}

/// Returns the cause of a fault, with the name of the device or arm concerned.
fn cause_of(fault: Fault, signs: &Signs) -> String {
    match &signs.fault_device {
        Some(name) => text::alarms::fault_of(name, fault.cause()),
        None => of_arm(fault.cause(), signs.fault_side),
    }
}

/// Adds the name of the arm, if there are two.
pub(super) fn of_arm(cause: &str, side: Option<Side>) -> String {
    side.map_or_else(|| cause.to_owned(), |side| text::alarms::fault_of(&part_name(RigPart::Arm(side)), cause))
}
