//! The record of a ready check.

use nima_machine::{
    ready::{ReadyEntry, ReadySession, ReadyState},
    rig::Roster,
};
use nima_recording::store::{CheckedDevice, CheckedItem, PointOutcome, READY_CHECK, ReadyRecord, utc_now};
use nima_words::{
    language::{self, Language},
    report_text::{cause_text, check_name, lacks_text, unit},
};

/// Returns the devices of a rig with their reported serial numbers.
pub fn devices_of(roster: &Roster) -> Vec<CheckedDevice> {
    let device = |entry: &nima_machine::rig::RosterEntry| CheckedDevice {
        name: entry.name().to_owned(),
        driver: entry.driver.clone(),
        serial: entry.view.report().identity.map(|identity| identity.serial).unwrap_or_default(),
    };
    roster.iter().map(device).collect()
}

/// Returns the record of this check on the rig of this file, by this person.
pub fn record(session: &ReadySession, rig_file: &str, by: &str, roster: &Roster) -> ReadyRecord {
    // Files are in English, whatever the language of the window.
    let item =
        |entry: &ReadyEntry| language::with(Language::English, || item(&check_name(entry.check), &entry.state, roster));
    ReadyRecord {
        kind: READY_CHECK.to_owned(),
        date: utc_now(),
        software: env!("CARGO_PKG_VERSION").to_owned(),
        rig: session.subject().rig.name.clone(),
        rig_file: rig_file.to_owned(),
        by: by.trim().to_owned(),
        passed: session.has_passed(),
        took_s: (session.took_s() * 10.0).round() / 10.0,
        devices: devices_of(roster),
        items: session.list().iter().map(item).collect(),
    }
}

fn item(check: &str, state: &ReadyState, roster: &Roster) -> CheckedItem {
    let blank = CheckedItem {
        check: check.to_owned(),
        outcome: PointOutcome::NotReached,
        value: None,
        limit: None,
        unit: None,
        cause: None,
        cure: None,
    };
    match state {
        ReadyState::Waiting | ReadyState::Asking(_) => blank,
        ReadyState::Passed(figure) => CheckedItem {
            outcome: PointOutcome::Passed,
            value: Some(figure.value),
            limit: Some(figure.limit),
            unit: Some(unit(figure.unit).to_owned()).filter(|unit| !unit.is_empty()),
            ..blank
        },
        ReadyState::Failed(cause) => {
            let [cause, cure] = cause_text(cause, roster);
            CheckedItem { outcome: PointOutcome::Failed, cause: Some(cause), cure: Some(cure), ..blank }
        }
        ReadyState::LeftOut(lacks) => {
            CheckedItem { outcome: PointOutcome::LeftOut, cause: Some(lacks_text(*lacks).to_owned()), ..blank }
        }
    }
}
