//! The Calibration panel: state and errors of the calibrations, and the buttons that open the wizards.

use nima_machine::messages::LoopState;
use nima_recording::store::WristId;

use crate::language::{Text, text_format, word};

pub const NAME: Text = Text::of("Calibration", "Kalibrierung");
pub const MEANING: Text = Text::of(
    "Shows how the force at the tip is obtained, and opens the calibrations that it needs",
    "Zeigt, wie die Kraft an der Spitze bestimmt wird, und öffnet die nötigen Kalibrierungen",
);

pub const NOT_OF_A_SENSOR: Text =
    Text::of("these values belong in the rig file", "diese Werte gehören in die Aufbaudatei");
pub const SETS_IDLE: Text = Text::of(
    "The check and the wizards set the loop to idle",
    "Prüfung und Assistenten setzen die Regelung in den \
     Leerlauf",
);
pub const IS_OPEN: Text = Text::of("Already open", "Schon offen");
pub const CLOSE_WIZARD: Text = Text::of("Back to the monitor", "Zurück zum Monitor");
pub const CLOSE_WIZARD_HOVER: Text = Text::of(
    "The data recorded so far are kept until the wizard is opened again",
    "Bisher aufgezeichnete Daten bleiben bis zum nächsten Öffnen erhalten",
);
pub const GRAVITY: Text = Text::of("Gravity", "Schwerkraft");
pub const CORRESPONDENCE: Text = Text::of("Correspondence", "Korrespondenz");
pub const TIP_FORCE: Text = Text::of("Tip force", "Kraft an der Spitze");
pub const NO_FOLDER: Text = Text::of(
    "no folder for calibration files was found; set NIMA_DATA_DIR",
    "kein Ordner für Kalibrierdateien gefunden; NIMA_DATA_DIR setzen",
);
pub const NOT_NEEDED: Text = Text::of(
    "This scene measures the force at the tip, so it needs no calibration",
    "Diese Szene misst die Kraft an der Spitze, Kalibrierung unnötig",
);
pub const GRAVITY_NONE: Text = Text::of("Gravity: not calibrated", "Schwerkraft: nicht kalibriert");
pub const CORRESPONDENCE_NONE: Text = Text::of("Correspondence: not calibrated", "Korrespondenz: nicht kalibriert");
pub const TIP_FORCE_NONE: Text = Text::of(
    "Tip force: not calibrated",
    "Kraft an der Spitze: nicht \
 kalibriert",
);
pub const TIP_FORCE_UNCHECKED: Text =
    Text::of("Tip force: trained but not checked", "Kraft an der Spitze: trainiert, nicht geprüft");
pub const REMARK_FUTURE_DATE: Text = Text::of(
    "; dated in the future, check this computer's clock",
    "; Datum in der Zukunft, Uhr dieses Rechners prüfen",
);
pub const SENSOR_NOT_CONNECTED: Text = Text::of(
    "The wrist sensor is not connected: its serial number decides which calibrations are used",
    "Handgelenksensor nicht verbunden: seine Seriennummer bestimmt, welche Kalibrierungen gelten",
);
pub const SENSOR_WITHOUT_SERIAL: Text = Text::of(
    "The wrist sensor reports no serial number, so no calibration can be assigned to it: reconnect it",
    "Der Handgelenksensor nennt keine Seriennummer, ihm ist keine Kalibrierung zuzuordnen: neu verbinden",
);
pub const RIG_WITHOUT_SENSOR: Text = Text::of(
    "The rig file names no wrist sensor for this arm: add serial_number and tool to its [simulated] part",
    "Die Aufbaudatei nennt keinen Handgelenksensor für diesen Arm: serial_number und tool in [simulated] ergänzen",
);
pub const NO_SENSOR_TO_SAVE_FOR: Text = Text::of(
    "the serial number of the wrist sensor is unknown; connect the sensor, then save again",
    "Seriennummer des Handgelenksensors unbekannt; Sensor verbinden, dann erneut speichern",
);
pub const ARM_TO_CALIBRATE: Text = Text::of(
    "The wizards calibrate the wrist sensor of this arm",
    "Die Assistenten kalibrieren den Handgelenksensor dieses Arms",
);

/// Returns the reason why no wizard, which sets the loop to idle, can be opened in this state, with the remedy; `None`
/// if one can.
pub fn closed(state: LoopState) -> Option<&'static str> {
    match state {
        LoopState::Idle | LoopState::Engaged => None,
        LoopState::Stopped | LoopState::Faulted(_) => {
            Some(word("The loop is stopped: press Release stop", "Die Regelung ist angehalten: Halt lösen drücken"))
        }
        LoopState::Disconnected => {
            Some(word("A device is missing: see the Devices panel (F2)", "Ein Gerät fehlt: siehe Panel Geräte (F2)"))
        }
        LoopState::Ready => Some(word(
            "About to engage: align hand and tip, or press Stop",
            "Vor dem Koppeln: Hand und Spitze ausrichten, oder Halt drücken",
        )),
        LoopState::Clutched => {
            Some(word("The clutch is pressed: release the pedal", "Kupplung gedrückt: Pedal loslassen"))
        }
    }
}

/// Returns the button that opens a wizard; the wizard's name is in lower case.
pub fn calibrate(wizard: &str) -> String {
    text_format!("Calibrate {wizard}…", "{wizard} kalibrieren…")
}

pub fn opens(meaning: &str) -> String {
    text_format!("{meaning}\nThe loop is set to idle", "{meaning}\nDie Regelung geht in den Leerlauf")
}

pub fn source(words: &str) -> String {
    text_format!("Tip force: {words}", "Kraft an der Spitze: {words}")
}

pub fn arm(side: &str) -> String {
    let after = side.to_lowercase();
    text_format!("{side} arm", "Arm {after}")
}

pub fn bound_to(sensor: &str, tool: &str) -> String {
    text_format!("Sensor {sensor}, {tool}", "Sensor {sensor}, {tool}")
}

pub fn other_sensors_are_calibrated(sensor: &str, tool: &str, others: &str) -> String {
    text_format!(
        "Sensor {sensor} has no gravity calibration with {tool}; sensor {others} has one: connect that sensor, or \
         calibrate this one.",
        "Sensor {sensor} hat keine Schwerkraft-Kalibrierung mit {tool}, Sensor {others} hat eine: jenen verbinden oder \
         diesen kalibrieren."
    )
}

pub fn sensors_are_exchanged(right: &WristId, left: &WristId) -> String {
    text_format!(
        "The right and left sensors, or their tools in the rig file, are swapped: {} is calibrated with {}, and \
         {} with {}. Swap the cables, or press Swap sensors in the Devices panel (F2).",
        "Rechter und linker Sensor oder ihre Instrumente in der Aufbaudatei sind vertauscht: {} ist mit {} kalibriert \
         und {} mit {}: Kabel tauschen, oder im Panel Geräte (F2) Sensoren tauschen.",
        right.serial_number,
        left.tool,
        left.serial_number,
        right.tool
    )
}

pub fn not_active(what: &str, why: &str) -> String {
    text_format!(
        "{what}: the saved calibration is not used: {why}",
        "{what}: gespeicherte Kalibrierung nicht verwendet: \
     {why}"
    )
}

pub fn saved(path: &std::path::Path) -> String {
    text_format!("Saved and in use: {}", "Gespeichert, aktiv: {}", path.display())
}

pub fn gravity(day: &str, poses: usize, error_n: f64, remarks: &str) -> String {
    text_format!(
        "Gravity: {day}, {poses} poses, held-out error {error_n:.3} N{remarks}",
        "Schwerkraft: {day}, {poses} Posen, Testfehler {error_n:.3} N{remarks}"
    )
}

pub fn bias_checked(found_at: &str, words: &str) -> String {
    text_format!("Bias, checked at {found_at} UTC: {words}", "Nullpunkt, geprüft um {found_at} UTC: {words}")
}

pub fn bias(words: &str) -> String {
    text_format!("Bias: {words}", "Nullpunkt: {words}")
}

pub fn correspondence(day: &str, pairs: usize, error_n: f64, known_to_deg: f64, remarks: &str) -> String {
    text_format!(
        "Correspondence: {day}, {pairs} pushes, held-out error {error_n:.3} N, uncertainty {known_to_deg:.2} \
         deg{remarks}",
        "Korrespondenz: {day}, {pairs}-mal gedrückt, Testfehler {error_n:.3} N, Unsicherheit {known_to_deg:.2} \
         deg{remarks}"
    )
}

pub fn tip_force(day: &str, rows: usize, error_n: f64, remarks: &str) -> String {
    text_format!(
        "Tip force: {day}, {rows} rows, error on new data {error_n:.3} N{remarks}",
        "Kraft an der Spitze: {day}, {rows} Zeilen, Fehler auf neuen Daten {error_n:.3} N{remarks}"
    )
}

pub fn days_old(days: u64) -> String {
    text_format!("; {days} days old, calibrate again", "; {days} Tage alt, neu kalibrieren")
}

pub fn not_proven(name: &str) -> String {
    text_format!("; NOT PROVEN, accepted by {name}", "; NICHT BELEGT, übernommen von {name}")
}

pub fn not_opened(reason: &str) -> String {
    text_format!("Not opened: {reason}", "Nicht geöffnet: {reason}")
}

pub fn still_in_the_experiment(reason: &str) -> String {
    text_format!("Could not return to the monitor: {reason}", "Rückkehr zum Monitor nicht möglich: {reason}")
}

pub fn active_after_restart(saved: &str, reason: &str) -> String {
    text_format!(
        "{saved}. It will be used after the next start: {reason}",
        "{saved}. Gilt ab dem nächsten Start: {reason}"
    )
}

pub fn not_saved(reason: &str) -> String {
    text_format!("Not saved: {reason}", "Nicht gespeichert: {reason}")
}

pub fn not_started_again(error: &impl std::fmt::Display) -> String {
    text_format!(
        "the control loop could not be restarted: {error}",
        "die Regelung ließ sich nicht neu starten: {error}"
    )
}
