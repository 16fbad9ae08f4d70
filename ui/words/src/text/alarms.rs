//! Alarms: their causes and remedies, the alarm strip, and the list of recent alarms.

use nima_machine::messages::LoopState;

use crate::language::{Text, text_format};

pub const ALARM: Text = Text::of("Alarm", "Alarm");
pub const WARNING: Text = Text::of("Warning", "Warnung");
pub const NOTE: Text = Text::of("Note", "Hinweis");
pub const STOP_STUCK_CAUSE: Text =
    Text::of("The stop has not reached the control loop", "Der Halt hat die Regelung nicht erreicht");
pub const STOP_STUCK_CURE: Text = Text::of(
    "Press the arm's own emergency stop to cut its power",
    "Not-Halt am Arm drücken, um ihn stromlos zu schalten",
);
pub const LOOP_SILENT_CAUSE: Text = Text::of(
    "The control loop has stopped sending data; the screen shows its last state",
    "Die Regelung sendet keine Daten mehr; die Anzeige zeigt den letzten Stand",
);
pub const LOOP_SILENT_CURE: Text = Text::of(
    "Press the arm's own emergency stop, then restart the console",
    "Not-Halt am Arm drücken, dann Konsole neu starten",
);
pub const PERIODS_MISSED_CURE: Text = Text::of(
    "Close other programs, or grant real-time priority (see the Timing panel, F2)",
    "Andere Programme schließen oder Echtzeit-Priorität erteilen (siehe Panel Timing, F2)",
);
pub const BIAS_MOVED_CURE: Text = Text::of(
    "Make sure nothing touches the tool; if the alarm stays, calibrate gravity again",
    "Sicherstellen, dass nichts das Instrument berührt; bleibt der Alarm, Schwerkraft neu kalibrieren",
);
pub const SHOW_ALL: Text = Text::of("All alarms (F5)", "Alle Alarme (F5)");
pub const SHOW_ALL_HOVER: Text = Text::of(
    "The last alarms with their times, including those that have ended",
    "Die letzten Alarme mit Zeiten, auch beendete",
);
pub const ACKNOWLEDGE: Text = Text::of("Acknowledge (A)", "Quittieren (A)");
pub const ACKNOWLEDGED_HOVER: Text =
    Text::of("Acknowledged; the cause is still present", "Quittiert; die Ursache besteht noch");
pub const LIST_NOTE: Text = Text::of(
    "The last 50 alarms, active ones first, then newest first. In brackets the time on the loop's own clock, as in the traces.",
    "Die letzten 50 Alarme, aktive zuerst, dann neueste. In Klammern die Zeit auf der Uhr der Regelung wie in den Verläufen.",
);
pub const COPY: Text = Text::of("Copy list", "Liste kopieren");
pub const COPY_HOVER: Text = Text::of(
    "Copies all alarms with times and remedies as text",
    "Kopiert alle Alarme mit Zeiten und Abhilfen als Text",
);
pub const LIST_EMPTY: Text = Text::of("No alarms so far", "Bisher keine Alarme");
pub const ACKNOWLEDGE_HOVER: Text = Text::of(
    "Stops the flashing and the sound. The alarm stays until its cause is gone. A new alarm of the same \
    or a higher priority flashes and sounds again.",
    "Beendet Blinken und Ton. Der Alarm bleibt, bis seine Ursache behoben ist. Ein neuer Alarm gleicher oder höherer \
     Priorität blinkt und tönt wieder.",
);
pub const LIST_TITLE: Text = Text::of("Alarms", "Alarme");
pub const ACKNOWLEDGED_REMARK: Text = Text::of(", acknowledged", ", quittiert");
pub const NOW: Text = Text::of("now", "jetzt");
pub const ENDED: Text = Text::of("ended", "beendet");
pub const PRESENT: Text = Text::of("still present", "besteht noch");
pub const DEVICE_MISSING_CURE: Text = Text::of(
    "The console reconnects it automatically; check its cable and its power",
    "Die Konsole verbindet es von selbst wieder; Kabel und Stromversorgung prüfen",
);

/// Returns the fault with the time of its first report, s on the loop's clock.
pub fn fault(cause: &str, t_s: f64) -> String {
    text_format!("{cause} (at {t_s:.1} s)", "{cause} (bei {t_s:.1} s)")
}

/// Returns the next step of the operator while there is no alarm; `closed`: reason why the loop cannot be engaged, a sentence
/// without a full stop.
pub fn next_step(state: LoopState, closed: Option<&str>) -> String {
    match (state, closed) {
        (LoopState::Idle, None) => {
            text_format!(
                "No active alarms. Press Engage to move the arm.",
                "Keine Alarme. Zum Bewegen des Arms koppeln."
            )
        }
        (LoopState::Idle, Some(why)) => {
            text_format!("No active alarms; not engaged. {why}.", "Keine Alarme; nicht gekoppelt. {why}.")
        }
        (LoopState::Stopped, _) => text_format!(
            "No active alarms. Stopped: press Release stop, then Engage.",
            "Keine Alarme. Angehalten: Halt lösen, dann koppeln."
        ),
        _ => text_format!("No active alarms", "Keine Alarme"),
    }
}

pub fn device(name: &str, cause: &str) -> String {
    text_format!("No connection to the {name}: {cause}", "{name} fehlt: {cause}")
}

pub fn device_lost(name: &str, cause: &str) -> String {
    text_format!("Lost connection to the {name}: {cause}", "{name} ausgefallen: {cause}")
}

/// Returns the text about a watchdog that the ready check trips on purpose.
pub fn tested(cause: &str) -> String {
    text_format!(
        "Ready check: the watchdog tripped as intended ({cause})",
        "Startprüfung: der Watchdog hat wie gewollt ausgelöst ({cause})"
    )
}

pub const TESTED_CURE: Text =
    Text::of("Not a fault: press Release stop to continue", "Keine Störung: mit Halt lösen geht es weiter");

pub fn fault_of(name: &str, cause: &str) -> String {
    format!("{cause} ({name})")
}

pub fn periods_missed(percent: f64) -> String {
    text_format!(
        "The control loop misses {percent:.1} % of its periods",
        "Die Regelung versäumt {percent:.1} % ihrer Takte"
    )
}

pub fn bias_moved(by_n: f64) -> String {
    text_format!(
        "The wrist sensor reads {by_n:.2} N without contact: its bias has drifted since the calibration",
        "Der Handgelenksensor misst {by_n:.2} N ohne Kontakt: Nullpunkt seit der Kalibrierung gedriftet"
    )
}

pub fn no_player(players: &str) -> String {
    text_format!(
        "No alarm sound: none of these players is installed: {players}; install one",
        "Kein Alarmton: keines dieser Abspielprogramme ist installiert: {players}; eines installieren"
    )
}

pub const UNCHECKED_CAUSE: Text = Text::of(
    "No ready check has passed with these devices in the last 12 hours",
    "Keine bestandene Startprüfung mit diesen Geräten in den letzten 12 Stunden",
);
pub const UNCHECKED_CURE: Text = Text::of(
    "Press Ready check in the Calibration panel (F2) before you engage",
    "Vor dem Koppeln im Panel Kalibrierung (F2) Startprüfung drücken",
);

pub fn player_failed(status: &impl std::fmt::Display) -> String {
    text_format!("The alarm sound could not be played ({status})", "Alarmton nicht abspielbar ({status})")
}

pub fn player_not_started(error: &impl std::fmt::Display) -> String {
    text_format!("The alarm sound could not be played: {error}", "Alarmton nicht abspielbar: „{error}“")
}

/// Returns the alarm in the strip; `remarks` mention further alarms and the acknowledgement.
pub fn pinned(priority: &str, cause: &str, began: &str, remarks: &str) -> String {
    text_format!("{priority}: {cause}, since {began}{remarks}", "{priority}: {cause}, seit {began}{remarks}")
}

pub fn others(count: usize) -> String {
    text_format!(" (+{count} more)", " (+{count} weitere)")
}

pub fn entry(began: &str, until: &str, priority: &str, standing: &str) -> String {
    text_format!("{began} to {until}: {priority}, {standing}", "{began} bis {until}: {priority}, {standing}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reason is a separate sentence: after a colon its capital letter would look wrong.
    #[test]
    fn the_reason_why_the_loop_is_not_engaged_is_a_separate_sentence() {
        let next = next_step(LoopState::Idle, Some("Close the calibration wizard first"));
        assert_eq!(next, "No active alarms; not engaged. Close the calibration wizard first.");
    }
}
