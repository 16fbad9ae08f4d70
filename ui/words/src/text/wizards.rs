//! Texts shared by all calibration wizards.

use std::path::Path;

use crate::language::{Text, text_format};
use crate::report_text::within;

pub const LAST_STEP: Text = Text::of("This is the last step", "Das ist der letzte Schritt");
pub const FIRST_STEP: Text = Text::of("This is the first step", "Das ist der erste Schritt");
pub const NOTHING_RECORDED: Text = Text::of("Nothing is recorded yet", "Noch nichts aufgezeichnet");
pub const NEEDS_CHECKS: Text = Text::of(
    "A check has not passed yet",
    "Eine Prüfung ist noch nicht \
 bestanden",
);
pub const OPTIONS_HOVER: Text = Text::of(
    "Leave both off unless your rig is known to need them or the result asks for them",
    "Beide aus lassen, außer der Aufbau braucht sie sicher oder das Ergebnis verlangt es",
);
pub const OPTIONS_TITLE: Text = Text::of("How this rig is built", "Bauweise dieses Aufbaus");
pub const SO_FAR: Text = Text::of("So far", "Bisher");
pub const STEP_CHECK: Text = Text::of("Check", "Prüfen");
pub const STEP_RESULT: Text = Text::of("Result", "Ergebnis");
pub const STEP_SAVE: Text = Text::of("Save", "Speichern");
pub const STEP_SAVE_HOVER: Text = Text::of(
    "Saves the result for this sensor and this tool, with its errors",
    "Speichert das Ergebnis mit seinen Fehlern für diesen Sensor und dieses Instrument",
);
pub const STEP_SAVE_IN_RIG_HOVER: Text = Text::of(
    "Writes the lens and the camera position to the rig file",
    "Schreibt Objektiv und Lage in die Aufbaudatei",
);
pub const GRAVITY: Text = Text::of("Gravity", "Schwerkraft");
pub const CORRESPONDENCE: Text = Text::of("Correspondence", "Korrespondenz");
pub const CAMERA: Text = Text::of("Camera", "Kamera");
pub const CAMERA_MEANING: Text = Text::of(
    "Finds the endoscope's lens and position, so that forces are drawn at the visible tip",
    "Bestimmt Objektiv und Lage des Endoskops, damit Kräfte dort erscheinen, wo die Spitze zu sehen ist",
);
pub const TIP_FORCE: Text = Text::of("Tip force", "Kraft an der Spitze");
pub const GRAVITY_MEANING: Text = Text::of(
    "Removes the tool's weight and the sensor's bias from the wrist force",
    "Entfernt Instrumentengewicht und Sensor-Nullpunkt aus der Handgelenkkraft",
);
pub const CORRESPONDENCE_MEANING: Text = Text::of(
    "Finds the rotation between the sensor under the tissue and the sensor at the wrist",
    "Findet die Drehung zwischen dem Sensor unter dem Gewebe und dem Sensor am Handgelenk",
);
pub const TIP_FORCE_MEANING: Text = Text::of(
    "Trains a network to remove the trocar's friction from the wrist force",
    "Trainiert ein Netz, das die Trokarreibung aus der Handgelenkkraft entfernt",
);
pub const BACK: Text = Text::of("Back", "Zurück");
pub const NEXT: Text = Text::of("Next", "Weiter");
pub const START_OVER: Text = Text::of("Start over", "Neu beginnen");
pub const START_OVER_HOVER: Text =
    Text::of("Deletes all data recorded in this wizard", "Löscht alle in diesem Assistenten aufgezeichneten Daten");
pub const SAVE_HOVER: Text = Text::of(
    "The file is valid only for this sensor and tool, and contains the measured errors",
    "Die Datei gilt nur für diesen Sensor und dieses Instrument und enthält die gemessenen Fehler",
);
pub const SENSOR: Text = Text::of("Sensor", "Sensor");
pub const SENSOR_HOVER: Text = Text::of("Serial number of the wrist sensor", "Seriennummer des Handgelenksensors");
pub const TOOL: Text = Text::of("Tool", "Instrument");
pub const TOOL_HOVER: Text = Text::of("Tool mounted on the sensor", "Instrument am Sensor");
pub const SAVE_AND_USE: Text = Text::of("Save and use", "Speichern und nutzen");
pub const NOT_PROVEN: Text = Text::of(
    "This calibration is not proven. You can accept it only under your name, which is written to the file.",
    "Diese Kalibrierung ist nicht belegt. Sie lässt sich nur unter eigenem Namen übernehmen; er kommt in die Datei.",
);
pub const YOUR_NAME: Text = Text::of("Your name", "Ihr Name");
pub const REASON: Text = Text::of("Reason", "Grund");
pub const SAVE_ANYWAY: Text = Text::of("Save despite the verdict", "Trotz des Urteils speichern");
pub const SAVE_ANYWAY_DISABLED_HOVER: Text =
    Text::of("Enter a name and a reason first", "Erst Name und Grund eingeben");
pub const POSE_IMAGE: Text = Text::of("Drawing of the required pose", "Zeichnung der einzunehmenden Pose");
pub const POSE_HELD: Text = Text::of("solid: current tool", "voll: Instrument jetzt");
pub const POSE_UNKNOWN: Text =
    Text::of("the arm does not report the tool's orientation", "der Arm meldet die Orientierung des Instruments nicht");
pub const SWITCH_DISABLED_HOVER: Text = Text::of(
    "To change this, press Start over: the recorded data depend on it",
    "Zum Ändern neu beginnen: die aufgezeichneten Daten hängen davon ab",
);
pub const MET: Text = Text::of("met", "erreicht");
pub const FINE: Text = Text::of("passed", "OK");
pub const WAITING: Text = Text::of("waiting", "wartet");
pub const NO_RESULT: Text = Text::of("No result", "Kein Ergebnis");
pub const FOLLOWING_CHECK: Text = Text::of("Next: ready check", "Weiter: Startprüfung");
pub const DONE: Text = Text::of("done", "fertig");
pub const NEEDS_GOAL: Text =
    Text::of("The goal of this step is not met yet", "Das Ziel dieses Schritts ist noch nicht erreicht");
pub const ANYWAY: Text = Text::of("Continue with less", "Mit weniger fortfahren");
pub const ANYWAY_HOVER: Text = Text::of(
    "Continues with what has been recorded so far; the result may be less accurate, or not accepted",
    "Geht mit dem bisher Aufgezeichneten weiter; das Ergebnis kann ungenauer sein oder nicht angenommen werden",
);

pub fn tilt_off(tilt_deg: f64) -> String {
    text_format!(
        "outline: target   solid: current tool   tilt error {tilt_deg:.0} deg",
        "Umriss: Ziel   voll: Instrument jetzt   Neigungsfehler {tilt_deg:.0} deg"
    )
}

pub fn rings_and_discs(name: &str) -> String {
    text_format!("{name} (rings: to do, discs: recorded)", "{name} (Ringe: offen, Scheiben: aufgezeichnet)")
}

pub fn fields_filled(title: &str, filled: usize, fields: usize) -> String {
    text_format!("{title}: {filled} of {fields} fields filled", "{title}: {filled} von {fields} Feldern gefüllt")
}

pub fn met(measured: &str) -> String {
    text_format!("{measured}, passed", "{measured}, OK")
}

pub fn following(arm: &str, calibration: &str) -> String {
    let after = arm.to_lowercase();
    text_format!("Next: {arm} arm, {}", "Weiter: Arm {after}, {}", within(calibration))
}

pub fn title(wizard: &str) -> String {
    text_format!("{wizard} calibration", "Kalibrierung: {wizard}")
}

pub fn step_of(step: usize, steps: usize, meaning: &str) -> String {
    text_format!("Step {step} of {steps}: {meaning}", "Schritt {step} von {steps}: {meaning}")
}

pub fn recorded(name: &str, count: usize) -> String {
    text_format!("{name}: {count} recorded", "{name}: {count} aufgezeichnet")
}

pub fn written(path: &Path) -> String {
    text_format!("Saved in {}", "Gespeichert in {}", path.display())
}
