//! The wizard that finds the rotation between the wrist sensor and the tissue sensor.

use crate::language::{Text, text_format};

pub const STEP_CHECK_HOVER: Text = Text::of(
    "Checks that all sensors send data and read zero without contact",
    "Prüft, ob alle Sensoren Daten senden und ohne Kontakt null anzeigen",
);
pub const STEP_PUSHES: Text = Text::of("Pushes", "Drücken");
pub const STEP_PUSHES_HOVER: Text = Text::of(
    "Push the tissue with the tool in many directions, so that both sensors measure the same force",
    "Mit dem Instrument in viele Richtungen auf das Gewebe drücken, sodass beide Sensoren dieselbe Kraft messen",
);
pub const STEP_RESULT_HOVER: Text = Text::of(
    "The rotation between the sensors, tested on pushes that were not used to fit it",
    "Die Drehung zwischen den Sensoren, getestet an Drücken, die nicht in den Fit eingingen",
);
pub const NEEDS_WRIST_SENSOR: Text =
    Text::of("The wrist sensor sends no data: connect it", "Der Handgelenksensor sendet keine Daten: verbinden");
pub const NEEDS_GRAVITY: Text =
    Text::of("Gravity is not calibrated: calibrate it first", "Schwerkraft nicht kalibriert: zuerst kalibrieren");
pub const NEEDS_REST: Text =
    Text::of("First leave both sensors at rest, without contact", "Zuerst beide Sensoren ohne Kontakt ruhen lassen");
pub const NEEDS_PUSHES: Text = Text::of("At least six pushes are needed", "Mindestens sechsmal drücken");
pub const NEEDS_ROTATION: Text = Text::of(
    "There is no result to save: go back and record more pushes",
    "Kein Ergebnis zum Speichern: zurückgehen und öfter drücken",
);
pub const CHECKS_TITLE: Text = Text::of("Before the first push", "Vor dem ersten Druck");
pub const CHECKS_HOVER: Text = Text::of(
    "All four checks must pass before pushes are recorded",
    "Erst wenn alle vier Prüfungen bestanden sind, wird aufgezeichnet",
);
pub const CHECKS_TASK: Text = Text::of(
    "Put the tissue on its sensor, without the body wall. Nothing may touch the tool or the tissue yet.",
    "Gewebe ohne Bauchdecke auf seinen Sensor legen. Noch darf nichts Instrument oder Gewebe berühren.",
);
pub const CHECK_WRIST: Text = Text::of("Force at the wrist", "Kraft am Handgelenk");
pub const CHECK_TISSUE: Text = Text::of("Force under the tissue", "Kraft unter dem Gewebe");
pub const CHECK_TRACKER: Text = Text::of("Arm and tracker", "Arm und Tracker");
pub const CHECK_TRACKER_UNUSED: Text = Text::of("Arm and tracker (not used)", "Arm und Tracker (nicht verwendet)");
pub const CHECK_REST: Text = Text::of("No contact", "Kein Kontakt");
pub const OPTION_FLIP: Text = Text::of(
    "The sensor under the tissue reports the force on the tissue, not the force on the tool",
    "Der Sensor unter dem Gewebe meldet die Kraft auf das Gewebe, nicht die auf das Instrument",
);
pub const OPTION_FLIP_HOVER: Text = Text::of(
    "Needed for a scale, for example: the two sensors then report opposite forces. Recorded pushes are kept.",
    "Nötig etwa bei einer Waage: die Sensoren melden dann entgegengesetzte Kräfte. Aufgezeichnetes bleibt \
     erhalten.",
);
pub const OPTION_NO_TRACKER: Text = Text::of(
    "No tracker: the wrist keeps the same orientation during all pushes",
    "Kein Tracker: das Handgelenk behält beim Drücken stets seine Orientierung",
);
pub const OPTION_NO_TRACKER_HOVER: Text = Text::of(
    "The result is then valid for this orientation of the wrist only",
    "Das Ergebnis gilt dann nur für diese Orientierung des Handgelenks",
);
pub const PUSH_TITLE: Text = Text::of("Push in this direction", "In diese Richtung drücken");
pub const PUSH_HOVER: Text = Text::of(
    "Push the tissue, hold for half a second, then release. The push is recorded when you release.",
    "Auf das Gewebe drücken, eine halbe Sekunde halten, dann loslassen. Beim Loslassen wird aufgezeichnet.",
);
pub const PHASE_WRIST_SILENT: Text =
    Text::of("the wrist sensor sends no data; connect it", "der Handgelenksensor sendet keine Daten; verbinden");
pub const PUSH_PROGRESS: Text = Text::of("Push", "Druck");
pub const DIRECTIONS_IMAGE: Text = Text::of("Push directions", "Druckrichtungen");
pub const SO_FAR_HOVER: Text = Text::of(
    "The result is updated after each push, from the sixth push on",
    "Das Ergebnis wird ab dem sechsten Druck nach jedem Druck erneuert",
);
pub const RECORDED: Text = Text::of("Recorded", "Aufgezeichnet");
pub const RECORDED_HOVER: Text = Text::of("Pushes recorded so far", "Bisher aufgezeichnete Drücke");
pub const SO_FAR_EMPTY: Text =
    Text::of("The first result appears after the sixth push", "Das erste Ergebnis erscheint nach dem sechsten Druck");
pub const REMOVE_LAST: Text = Text::of("Remove the last push", "Letzten Druck entfernen");
pub const NO_RESULT_HOVER: Text =
    Text::of("No rotation could be fitted to the pushes", "Keine Drehung ließ sich anpassen");
pub const TOO_FEW: Text =
    Text::of("Too few pushes: go back and record more", "Zu wenige: zurückgehen und öfter drücken");
pub const PROOF: Text = Text::of("Accepted on held-out pushes", "Auf Testdaten angenommen");
pub const PHASE_READY: Text = Text::of("ready; push now", "bereit; jetzt drücken");
pub const VERDICT_HOVER: Text = Text::of(
    "Tested on pushes that were not used to fit the rotation",
    "Getestet an Drücken, die nicht in den Fit eingingen",
);
pub const PUSHES_HOVER: Text = Text::of(
    "Number of recorded pushes, and how many of them were not used",
    "Zahl der aufgezeichneten Drücke, davon nicht verwendet",
);
pub const SPREAD: Text = Text::of("Spread", "Streuung");
pub const SPREAD_HOVER: Text = Text::of(
    "How evenly the pushes point in all directions: second and third axis relative to the first. 1 is \
    even, 0 means that an axis is missing.",
    "Wie gleichmäßig die Druckrichtungen verteilt sind: zweite und dritte Achse relativ zur ersten. 1 ist gleichmäßig, \
     bei 0 fehlt eine Achse.",
);
pub const ROTATION_HOVER: Text =
    Text::of("Roll, pitch and yaw in degrees (Rz Ry Rx)", "Roll-, Nick- und Gierwinkel in Grad (Rz Ry Rx)");
pub const UNCERTAINTY: Text = Text::of("Uncertainty", "Unsicherheit");
pub const UNCERTAINTY_HOVER: Text =
    Text::of("Expected error of the rotation, as an angle", "Erwarteter Fehler der Drehung, als Winkel");
pub const CROSS_CHECK: Text = Text::of("Euler cross-check", "Euler-Gegenprobe");
pub const CROSS_CHECK_HOVER: Text = Text::of(
    "Angle between this rotation and the result of the paper's search over Euler angles",
    "Winkel zwischen dieser Drehung und der aus der Euler-Winkel-Suche des Artikels",
);
pub const GAIN: Text = Text::of("Gain", "Verstärkung");
pub const GAIN_HOVER: Text = Text::of(
    "Ratio of the wrist sensor's force to the tissue sensor's force; it should be 1",
    "Verhältnis der Kraft am Handgelenksensor zu der am Gewebesensor; Soll 1",
);
pub const OFFSET: Text = Text::of("Offset", "Offset");
pub const OFFSET_HOVER: Text = Text::of(
    "Constant difference between the two sensors' forces",
    "Konstante Differenz zwischen den Kräften beider Sensoren",
);
pub const OFFSET_OF_WRIST: Text = Text::of("of the wrist sensor", "des Handgelenksensors");
pub const OFFSET_OF_TISSUE: Text = Text::of("of the tissue sensor", "des Gewebesensors");
pub const OFFSET_OF_EITHER: Text = Text::of("of either sensor", "eines der Sensoren");
pub const AGREEMENT_HOVER: Text = Text::of(
    "Errors in N along the axes of the wrist sensor. Held out: on pushes that were not used for the fit. \
    MAE: mean absolute error. SD: standard deviation.",
    "Fehler in N längs der Achsen des Handgelenksensors. Test: an Drücken, die nicht in den Fit eingingen. MAE: \
     mittlerer absoluter Fehler. SD: Standardabweichung.",
);
pub const AGREEMENT_TITLE: Text = Text::of("Agreement per axis", "Übereinstimmung je Achse");
pub const AXIS: Text = Text::of("Axis", "Achse");
pub const FITTED_MAE: Text = Text::of("fitted: MAE", "Fit: MAE");
pub const HELD_OUT_MAE: Text = Text::of("held out: MAE", "Test: MAE");
pub const R2_OVERALL: Text = Text::of("R2 of all axes", "R2 aller Achsen");
pub const R2_OVERALL_HOVER: Text = Text::of(
    "Fraction of the variance that the fit explains; the paper reports 0.95",
    "Vom Fit erklärter Anteil der Varianz; der Artikel nennt 0.95",
);

pub fn taken_of(count: usize, asked: usize) -> String {
    text_format!("{count} recorded, at least {asked} needed", "{count} aufgezeichnet, mindestens {asked} nötig")
}

pub fn pushes(count: usize) -> String {
    text_format!("{count} pushes", "{count}-mal gedrückt")
}

pub fn at_rest(wrist_n: f64, tissue_n: f64) -> String {
    text_format!(
        "wrist {wrist_n:.2} N, tissue {tissue_n:.2} N; touch nothing; if a sensor stays above 0.3 N, set it to zero",
        "Handgelenk {wrist_n:.2} N, Gewebe {tissue_n:.2} N; nichts berühren; bleibt ein Sensor über 0.3 N, ihn auf \
         null setzen"
    )
}

pub fn hold(force_n: f64) -> String {
    text_format!("{force_n:.1} N; hold still", "{force_n:.1} N; stillhalten")
}

pub fn let_go(force_n: f64) -> String {
    text_format!("{force_n:.1} N; enough, release", "{force_n:.1} N; genug, loslassen")
}

pub fn push_taken(number: usize) -> String {
    text_format!("push {number} recorded", "Druck {number} aufgezeichnet")
}

pub fn not_taken(why: &str) -> String {
    text_format!("not recorded: {why}", "nicht aufgezeichnet: {why}")
}

pub fn used(pairs: usize, left_out: usize, weak: usize) -> String {
    text_format!(
        "{pairs}; not used: {left_out} contradictory, {weak} too weak",
        "{pairs}; nicht verwendet: {left_out} widersprüchlich, {weak} zu schwach"
    )
}

pub fn rotation(name: &str) -> String {
    text_format!("Rotation {name}", "Drehung {name}")
}

pub fn agreement(fitted: f64, held_out: f64) -> String {
    text_format!("{fitted:.3} fitted, {held_out:.3} held out", "Fit {fitted:.3}, Test {held_out:.3}")
}
