//! Texts shared by all calibration wizards.

use std::path::Path;

use crate::language::{Text, text_format};
use crate::report_text::within;

pub(crate) const LAST_STEP: Text = Text::of("This is the last step", "Das ist der letzte Schritt");
pub(crate) const FIRST_STEP: Text = Text::of("This is the first step", "Das ist der erste Schritt");
pub(crate) const NOTHING_RECORDED: Text = Text::of("Nothing is recorded yet", "Noch nichts aufgezeichnet");
pub(crate) const NEEDS_CHECKS: Text = Text::of(
    "A check has not passed yet",
    "Eine Prüfung ist noch nicht \
 bestanden",
);
pub(in crate::console) const OPTIONS_HOVER: Text = Text::of(
    "Leave both off unless your rig is known to need them or the result asks for them",
    "Beide aus lassen, außer der Aufbau braucht sie sicher oder das Ergebnis verlangt es",
);
pub(in crate::console) const OPTIONS_TITLE: Text = Text::of("How this rig is built", "Bauweise dieses Aufbaus");
pub(in crate::console) const SO_FAR: Text = Text::of("So far", "Bisher");
pub(crate) const STEP_CHECK: Text = Text::of("Check", "Prüfen");
pub(in crate::console) const STEP_RESULT: Text = Text::of("Result", "Ergebnis");
pub(crate) const STEP_SAVE: Text = Text::of("Save", "Speichern");
pub(in crate::console) const STEP_SAVE_HOVER: Text = Text::of(
    "Saves the result for this sensor and this tool, with its errors",
    "Speichert das Ergebnis mit seinen Fehlern für diesen Sensor und dieses Instrument",
);
pub(crate) const STEP_SAVE_IN_RIG_HOVER: Text = Text::of(
    "Writes the lens and the camera position to the rig file",
    "Schreibt Objektiv und Lage in die Aufbaudatei",
);
pub(in crate::console) const GRAVITY: Text = Text::of("Gravity", "Schwerkraft");
pub(in crate::console) const CORRESPONDENCE: Text = Text::of("Correspondence", "Korrespondenz");
pub(in crate::console) const CAMERA: Text = Text::of("Camera", "Kamera");
pub(in crate::console) const CAMERA_MEANING: Text = Text::of(
    "Finds the endoscope's lens and position, so that forces are drawn at the visible tip",
    "Bestimmt Objektiv und Lage des Endoskops, damit Kräfte dort erscheinen, wo die Spitze zu sehen ist",
);
pub(in crate::console) const TIP_FORCE: Text = Text::of("Tip force", "Kraft an der Spitze");
pub(in crate::console) const GRAVITY_MEANING: Text = Text::of(
    "Removes the tool's weight and the sensor's bias from the wrist force",
    "Entfernt Instrumentengewicht und Sensor-Nullpunkt aus der Handgelenkkraft",
);
pub(in crate::console) const CORRESPONDENCE_MEANING: Text = Text::of(
    "Finds the rotation between the sensor under the tissue and the sensor at the wrist",
    "Findet die Drehung zwischen dem Sensor unter dem Gewebe und dem Sensor am Handgelenk",
);
pub(in crate::console) const TIP_FORCE_MEANING: Text = Text::of(
    "Trains a network to remove the trocar's friction from the wrist force",
    "Trainiert ein Netz, das die Trokarreibung aus der Handgelenkkraft entfernt",
);
pub(in crate::console) const BACK: Text = Text::of("Back", "Zurück");
pub(in crate::console) const NEXT: Text = Text::of("Next", "Weiter");
pub(in crate::console) const START_OVER: Text = Text::of("Start over", "Neu beginnen");
pub(in crate::console) const START_OVER_HOVER: Text =
    Text::of("Deletes all data recorded in this wizard", "Löscht alle in diesem Assistenten aufgezeichneten Daten");
pub(in crate::console) const SAVE_HOVER: Text = Text::of(
    "The file is valid only for this sensor and tool, and contains the measured errors",
    "Die Datei gilt nur für diesen Sensor und dieses Instrument und enthält die gemessenen Fehler",
);
pub(in crate::console) const SENSOR: Text = Text::of("Sensor", "Sensor");
pub(in crate::console) const SENSOR_HOVER: Text =
    Text::of("Serial number of the wrist sensor", "Seriennummer des Handgelenksensors");
pub(in crate::console) const TOOL: Text = Text::of("Tool", "Instrument");
pub(in crate::console) const TOOL_HOVER: Text = Text::of("Tool mounted on the sensor", "Instrument am Sensor");
pub(in crate::console) const SAVE_AND_USE: Text = Text::of("Save and use", "Speichern und nutzen");
pub(in crate::console) const NOT_PROVEN: Text = Text::of(
    "This calibration is not proven. You can accept it only under your name, which is written to the file.",
    "Diese Kalibrierung ist nicht belegt. Sie lässt sich nur unter eigenem Namen übernehmen; er kommt in die Datei.",
);
pub(in crate::console) const YOUR_NAME: Text = Text::of("Your name", "Ihr Name");
pub(in crate::console) const REASON: Text = Text::of("Reason", "Grund");
pub(in crate::console) const SAVE_ANYWAY: Text = Text::of("Save despite the verdict", "Trotz des Urteils speichern");
pub(in crate::console) const SAVE_ANYWAY_DISABLED_HOVER: Text =
    Text::of("Enter a name and a reason first", "Erst Name und Grund eingeben");
pub(in crate::console) const POSE_IMAGE: Text =
    Text::of("Drawing of the required pose", "Zeichnung der einzunehmenden Pose");
pub(in crate::console) const POSE_HELD: Text = Text::of("solid: current tool", "voll: Instrument jetzt");
pub(in crate::console) const POSE_UNKNOWN: Text =
    Text::of("the arm does not report the tool's orientation", "der Arm meldet die Orientierung des Instruments nicht");
pub(in crate::console) const SWITCH_DISABLED_HOVER: Text = Text::of(
    "To change this, press Start over: the recorded data depend on it",
    "Zum Ändern neu beginnen: die aufgezeichneten Daten hängen davon ab",
);
pub(in crate::console) const MET: Text = Text::of("met", "erreicht");
pub(in crate::console) const FINE: Text = Text::of("passed", "OK");
pub(in crate::console) const WAITING: Text = Text::of("waiting", "wartet");
pub(in crate::console) const NO_RESULT: Text = Text::of("No result", "Kein Ergebnis");
pub(in crate::console) const FOLLOWING_CHECK: Text = Text::of("Next: ready check", "Weiter: Startprüfung");
pub(in crate::console) const DONE: Text = Text::of("done", "fertig");
pub(in crate::console) const NEEDS_GOAL: Text =
    Text::of("The goal of this step is not met yet", "Das Ziel dieses Schritts ist noch nicht erreicht");
pub(in crate::console) const ANYWAY: Text = Text::of("Continue with less", "Mit weniger fortfahren");
pub(in crate::console) const ANYWAY_HOVER: Text = Text::of(
    "Continues with what is recorded so far; the result may be less accurate, or not accepted",
    "Geht mit dem bisher Aufgezeichneten weiter; das Ergebnis kann ungenauer sein oder nicht angenommen werden",
);

pub(in crate::console) fn tilt_off(tilt_deg: f64) -> String {
    text_format!(
        "outline: target   solid: current tool   tilt error {tilt_deg:.0} deg",
        "Umriss: Ziel   voll: Instrument jetzt   Neigungsfehler {tilt_deg:.0} deg"
    )
}

pub(in crate::console) fn rings_and_discs(name: &str) -> String {
    text_format!("{name} (rings: to do, discs: recorded)", "{name} (Ringe: offen, Scheiben: aufgezeichnet)")
}

pub(in crate::console) fn fields_filled(title: &str, filled: usize, fields: usize) -> String {
    text_format!("{title}: {filled} of {fields} fields filled", "{title}: {filled} von {fields} Feldern gefüllt")
}

pub(in crate::console) fn met(measured: &str) -> String {
    text_format!("{measured}, passed", "{measured}, OK")
}

pub(in crate::console) fn following(arm: &str, calibration: &str) -> String {
    let after = arm.to_lowercase();
    text_format!("Next: {arm} arm, {}", "Weiter: Arm {after}, {}", within(calibration))
}

pub(in crate::console) fn title(wizard: &str, arm: Option<&str>) -> String {
    match arm {
        Some(arm) => text_format!("{wizard} calibration, {arm} arm", "Kalibrierung: {wizard}, Arm {arm}"),
        None => text_format!("{wizard} calibration", "Kalibrierung: {wizard}"),
    }
}

pub(in crate::console) fn step_of(step: usize, steps: usize, meaning: &str) -> String {
    text_format!("Step {step} of {steps}: {meaning}", "Schritt {step} von {steps}: {meaning}")
}

pub(in crate::console) fn recorded(name: &str, count: usize) -> String {
    text_format!("{name}: {count} recorded", "{name}: {count} aufgezeichnet")
}

pub(in crate::console) fn written(path: &Path) -> String {
    text_format!("Saved in {}", "Gespeichert in {}", path.display())
}
