//! The set-up page: devices, calibrations and ready check of each arm.

use crate::language::{Text, text_format, word};

pub const TITLE: Text = Text::of("Set-up", "Einrichtung");
pub const MEANING: Text = Text::of(
    "For every arm: devices, calibrations and ready check, with their state and its reason. Press a tile to go there",
    "Für jeden Arm: Geräte, Kalibrierungen und Startprüfung, mit Zustand und Grund. Eine Kachel drücken führt dorthin",
);
pub const OPEN: Text = Text::of("Set-up…", "Einrichtung…");
pub const BACK: Text = Text::of("Back to the set-up", "Zurück zur Einrichtung");
pub const SHOW: Text = Text::of("Show", "Zeigen");
pub const RUN: Text = Text::of("Run", "Ausführen");
pub const SIMULATED: Text = Text::of("Simulated", "Simuliert");
pub const READY_TILE: Text = Text::of("Ready check", "Startprüfung");
pub const NEVER_CHECKED: Text = Text::of("never run", "nie durchgeführt");
pub const MAKE: Text = Text::of("Calibrate", "Kalibrieren");
pub const REDO: Text = Text::of("Recalibrate", "Neu kalibrieren");
pub const NEVER: Text = Text::of("not calibrated", "nicht kalibriert");
pub const NOT_WATCHED: Text = Text::of("not monitored", "nicht überwacht");
pub const FOR_TRAINING_ONLY: Text = Text::of(
    "used for training only",
    "nur für das Training \
 genutzt",
);
pub const NOT_USED: Text = Text::of("used for less than 10 s since the start", "seit dem Start unter 10 s genutzt");
pub const IN_FILE: Text = Text::of("in the rig file", "in der Aufbaudatei");
pub const OTHER_IN_FILE: Text =
    Text::of("the rig file now has different values", "die Aufbaudatei hat jetzt andere Werte");
pub const UNCHECKED: Text = Text::of("trained but not checked", "trainiert, aber nicht geprüft");
pub const HANDLE: Text = Text::of("View, handle", "Bildlage, Handgerät");
pub const FUTURE: Text = Text::of("in the future", "in der Zukunft");

pub fn all_connected(devices: usize) -> String {
    text_format!("all {devices} connected", "alle {devices} verbunden")
}

pub fn check_passed(day: &str) -> String {
    text_format!("passed on {day}", "bestanden am {day}")
}

pub fn check_failed(day: &str) -> String {
    text_format!("not passed on {day}", "nicht bestanden am {day}")
}

/// Returns the lines of a reason that have no room.
pub fn more(count: usize) -> String {
    text_format!("and {count} more", "und {count} weitere")
}

/// Returns how many steps of the set-up are done, and the least time of the others.
pub fn progress(done: usize, all: usize, minutes: u64) -> String {
    if done == all {
        return text_format!("{done} of {all} done", "{done} von {all} erledigt");
    }
    text_format!(
        "{done} of {all} done, at least {minutes} min left",
        "{done} von {all} erledigt, mindestens noch {minutes} min"
    )
}

/// A check of another day, or of other devices.
pub fn check_outdated(day: &str) -> String {
    text_format!(
        "passed on {day}, but not today with these devices",
        "bestanden am {day}, aber nicht heute mit diesen Geräten"
    )
}

/// Returns the accessible name of a tile.
pub fn button(verb: &str, arm: &str, calibration: &str) -> String {
    let after = arm.to_lowercase();
    text_format!("{verb} {arm} arm, {calibration}", "{verb}: Arm {after}, {calibration}")
}

pub fn of_arm(sensor: &str, tool: &str) -> String {
    text_format!("Sensor {sensor}, {tool}", "Sensor {sensor}, {tool}")
}

pub fn made(day: &str, age: &str) -> String {
    format!("{day}, {age}")
}

pub fn days(days: u64) -> String {
    match days {
        0 => word("less than a day old", "weniger als einen Tag alt").to_owned(),
        1 => word("1 day old", "1 Tag alt").to_owned(),
        _ => text_format!("{days} days old", "{days} Tage alt"),
    }
}

pub fn verdict(verdict: &str, error: &str) -> String {
    if error.is_empty() {
        verdict.to_owned()
    } else {
        text_format!("{verdict}, held-out error {error}", "{verdict}, Testfehler {error}")
    }
}

pub fn overridden(verdict: &str, name: &str) -> String {
    text_format!("{verdict}, accepted by {name}", "{verdict}, übernommen von {name}")
}

pub fn checked(day: &str, found: &str) -> String {
    text_format!("ready check on {day}: {found}", "Startprüfung vom {day}: {found}")
}

/// Returns the fractions of the time with force, 0 to 1, in which the network was outside its training data and not
/// used.
pub fn in_use(outside: f64, without: f64) -> String {
    let fractions = text_format!(
        "outside its training data {:.0} % of the time, not used {:.0} %",
        "{:.0} % der Zeit außerhalb des Trainings, {:.0} % nicht genutzt",
        100.0 * outside,
        100.0 * without
    );
    let much = without >= 0.02 || outside >= 0.3;
    if much {
        text_format!("{fractions}: record more data where you work", "{fractions}: im Arbeitsbereich mehr aufzeichnen")
    } else {
        fractions
    }
}

pub fn newton(newton: f64) -> String {
    format!("{newton:.3} N")
}

pub fn within(value: f64, limit: f64, unit: &str) -> String {
    text_format!("{value:.2} {unit}, limit {limit:.2}", "{value:.2} {unit}, Grenze {limit:.2}")
}
