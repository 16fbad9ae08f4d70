//! Names and purposes of the panels, and how to arrange them.

use crate::language::{Text, text_format};

pub const FIELD: Text = Text::of("Field", "Feld");
pub const TRACES: Text = Text::of("Traces", "Verläufe");
pub const FORCE_SPACE: Text = Text::of("Force space", "Kraftraum");
pub const FEEDBACK: Text = Text::of("Feedback", "Rückkopplung");
pub const DEVICES: Text = Text::of("Devices", "Geräte");
pub const CALIBRATION: Text = Text::of("Calibration", "Kalibrierung");
pub const SAFETY: Text = Text::of("Safety", "Sicherheit");
pub const HORIZON: Text = Text::of("Prediction error", "Vorhersagefehler");
pub const DEGREES: Text = Text::of("Degrees", "Grade");
pub const TIMING: Text = Text::of("Timing", "Timing");
pub const LINK: Text = Text::of("Link", "Verbindung");
pub const TRADEOFF: Text = Text::of("Trade-off", "Abwägung");
pub const FIELD_HOVER: Text =
    Text::of("The operating field in 3-D, with the forces drawn as arrows", "Das OP-Feld in 3-D, Kräfte als Pfeile");
pub const TRACES_HOVER: Text = Text::of(
    "Measured and rendered force over time, along x, y and z",
    "Gemessene und dargestellte Kraft über der Zeit, längs x, y und z",
);
pub const FORCE_SPACE_HOVER: Text = Text::of(
    "Measured and rendered force of the last seconds, drawn in 3-D",
    "Gemessene und dargestellte Kraft der letzten Sekunden in 3-D",
);
pub const FEEDBACK_HOVER: Text = Text::of(
    "Sets how the force measured at the instrument becomes the force in the hand",
    "Stellt ein, wie aus der am Instrument gemessenen Kraft die Kraft in der Hand wird",
);
pub const DEVICES_HOVER: Text = Text::of(
    "The devices of this rig. A connected device is not yet engaged.",
    "Die Geräte dieses Aufbaus. Ein verbundenes Gerät ist noch nicht gekoppelt.",
);
pub const CALIBRATION_HOVER: Text = Text::of(
    "Shows how the force at the tip is obtained, and opens the calibrations that it needs",
    "Zeigt, wie die Kraft an der Spitze bestimmt wird, und öffnet die nötigen Kalibrierungen",
);
pub const SAFETY_HOVER: Text = Text::of(
    "Why there is no force: a force passes these gates in this order; a closed gate stops it, a limiting gate reduces \
     it. Below: the states of the interlock",
    "Warum keine Kraft da ist: eine Kraft durchläuft diese Sperren der Reihe nach; eine geschlossene hält sie auf, eine \
     begrenzende verringert sie. Darunter: die Zustände der Verriegelung",
);
pub const HORIZON_HOVER: Text = Text::of(
    "Difference between the force that each mode would render now, before the gates, and the force measured now \
     (N, 3-D distance, mean of the last four seconds). Each mode receives only data as old as the link's delay. \
     All modes are always computed.",
    "Differenz zwischen der Kraft, die jeder Modus jetzt vor den Sperren darstellen würde, und der jetzt \
     gemessenen (N, 3-D-Abstand, Mittel der letzten vier Sekunden). Jeder Modus erhält nur Daten, die so alt \
     sind wie die Verzögerung der Verbindung. Alle Modi werden ständig berechnet.",
);
pub const DEGREES_HOVER: Text = Text::of(
    "Degree N of the polynomial f = M X between motion and force, chosen every tick from the last 300 ms",
    "Grad N des Polynoms f = M X zwischen Bewegung und Kraft, in jedem Takt aus den letzten 300 ms gewählt",
);
pub const TIMING_HOVER: Text = Text::of(
    "How late the control loop wakes up in each period, and how long it computes, since the console was opened \
     (µs)",
    "Wie spät die Regelung in jedem Takt aufwacht und wie lange sie rechnet, seit Öffnen der Konsole (µs)",
);
pub const LINK_HOVER: Text = Text::of(
    "The network between this machine and the machine with the arm: delay, loss, clock, and which console \
     controls the follower",
    "Netzwerk zwischen diesem Rechner und dem des Arms: Verzögerung, Verlust, Uhr, und welche Konsole den \
     Folgearm steuert",
);
pub const TRADEOFF_HOVER: Text = Text::of(
    "Computing time of one tick of identification (µs, on this computer) against the mean prediction \
    error (N), for every mode, degree and window. Measured on a recording of this scene, at the rig's \
    rate and the link's delay.",
    "Rechenzeit eines Identifikationstakts (µs, auf diesem Rechner) über dem mittleren Vorhersagefehler (N), für jeden \
     Modus, Grad und jedes Fenster. Gemessen an einer Aufzeichnung dieser Szene, mit der Rate des Aufbaus und der \
     Verzögerung der Verbindung.",
);
pub const ALL_CLOSED: Text = Text::of(
    "All panels are closed; open them in the View menu",
    "Alle Panels sind geschlossen; im Menü Ansicht \
     öffnen",
);
pub const DRAG_HOVER: Text = Text::of("Drag the title to move the panel", "Am Titel ziehen verschiebt das Panel");

pub const SIMPLE: Text = Text::of("Simple", "Einfach");
pub const SIMPLE_HOVER: Text = Text::of(
    "Layout for the first hour: the field, the forces over time, and the feedback settings; the other panels are tabs",
    "Layout für die erste Stunde: Feld, Kräfte über der Zeit und Rückkopplung; die übrigen Panels sind Reiter",
);
pub const CALIBRATION_LAYOUT: Text = Text::of("Calibration", "Kalibrierung");
pub const CALIBRATION_LAYOUT_HOVER: Text = Text::of(
    "Layout for setting up a rig: calibrations, devices, and the forces over time",
    "Layout für das Einrichten: Kalibrierungen, Geräte und Kräfte über der Zeit",
);
pub const RESEARCH: Text = Text::of("Research", "Forschung");
pub const RESEARCH_HOVER: Text = Text::of(
    "Layout with every panel: prediction error, degrees, timing and gates are in sight too",
    "Layout mit allen Panels: auch Vorhersagefehler, Grade, Timing und Sperren sind im Blick",
);

/// Returns the accessible name of the button that closes a panel.
pub fn close(panel: &str) -> String {
    text_format!("Close {panel}", "{panel} schließen")
}

/// Returns the hover text of that button; `close` from [`close`].
pub fn close_meaning(close: &str) -> String {
    text_format!("{close}; the View menu reopens it.", "{close}; das Menü Ansicht öffnet es wieder.")
}
