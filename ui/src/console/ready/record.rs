//! The record of a ready check.

use nima_machine::{
    ready::{Entry, Session, State},
    rig::Roster,
};
use nima_recording::store::{CheckedDevice, CheckedItem, Outcome, READY_CHECK, ReadyRecord, utc_now};

use crate::language::{self, Language};
use crate::words::{cause_words, check_name, lacks_words, unit};

/// The devices of a rig with their reported serial numbers.
pub(crate) fn devices_of(roster: &Roster) -> Vec<CheckedDevice> {
    let device = |entry: &nima_machine::rig::RosterEntry| CheckedDevice {
        name: entry.name().to_owned(),
        driver: entry.driver.clone(),
        serial: entry.view.report().identity.map(|identity| identity.serial).unwrap_or_default(),
    };
    roster.iter().map(device).collect()
}

/// The record of this check on the rig of this file, by this person.
pub(crate) fn record(session: &Session, rig_file: &str, by: &str, roster: &Roster) -> ReadyRecord {
    // Files are in English, whatever the language of the window.
    let item =
        |entry: &Entry| language::with(Language::English, || item(&check_name(entry.check), &entry.state, roster));
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

fn item(check: &str, state: &State, roster: &Roster) -> CheckedItem {
    let blank = CheckedItem {
        check: check.to_owned(),
        outcome: Outcome::NotReached,
        value: None,
        limit: None,
        unit: None,
        cause: None,
        cure: None,
    };
    match state {
        State::Waiting | State::Asking(_) => blank,
        State::Passed(figure) => CheckedItem {
            outcome: Outcome::Passed,
            value: Some(figure.value),
            limit: Some(figure.limit),
            unit: Some(unit(figure.unit).to_owned()).filter(|unit| !unit.is_empty()),
            ..blank
        },
        State::Failed(cause) => {
            let [cause, cure] = cause_words(cause, roster);
            CheckedItem { outcome: Outcome::Failed, cause: Some(cause), cure: Some(cure), ..blank }
        }
        State::LeftOut(lacks) => {
            CheckedItem { outcome: Outcome::LeftOut, cause: Some(lacks_words(*lacks).to_owned()), ..blank }
        }
    }
}
