//! The wizard that removes the weight of the tool.

use crate::language::{Text, text_format};

pub(in crate::console) const STEP_CHECK_HOVER: Text = Text::of(
    "Checks that the sensor sends good data and that nothing touches the tool",
    "Prüft, ob der Sensor gute Daten sendet und nichts das Instrument berührt",
);
pub(in crate::console) const STEP_POSES: Text = Text::of("Poses", "Posen");
pub(in crate::console) const STEP_POSES_HOVER: Text = Text::of(
    "Twelve orientations of the tool, so that gravity pulls in all directions",
    "Zwölf Orientierungen des Instruments, damit die Schwerkraft von allen Seiten zieht",
);
pub(in crate::console) const STEP_RESULT_HOVER: Text = Text::of(
    "The fitted model, tested on poses that were not used to fit it",
    "Das angepasste Modell, getestet an Posen, die nicht in den Fit eingingen",
);
pub(in crate::console) const STEP_FREE_MOTION: Text = Text::of("Free motion", "Freie Bewegung");
pub(in crate::console) const STEP_FREE_MOTION_HOVER: Text = Text::of(
    "The final test: a tool that moves freely through the air must read zero force",
    "Der Schlusstest: frei in der Luft bewegt muss das Instrument null Kraft anzeigen",
);
pub(in crate::console) const NEEDS_POSES: Text =
    Text::of("At least six poses are needed", "Mindestens sechs Posen sind nötig");
pub(in crate::console) const NEEDS_MODEL: Text = Text::of(
    "No model to test: go back and record more poses",
    "Kein Modell zum Testen: zurückgehen und mehr Posen aufzeichnen",
);
pub(in crate::console) const NEEDS_FREE_MOTION: Text =
    Text::of("Move the tool freely first", "Zuerst das Instrument frei bewegen");
pub(in crate::console) const CHECKS_TITLE: Text = Text::of("Before the first pose", "Vor der ersten Pose");
pub(in crate::console) const CHECKS_HOVER: Text = Text::of(
    "All checks must pass before poses are recorded",
    "Erst wenn alle Prüfungen bestanden sind, werden Posen \
     aufgezeichnet",
);
pub(in crate::console) const CHECKS_TASK: Text = Text::of(
    "Take the instrument out of the trocar and release it: nothing may touch the tool",
    "Instrument aus dem Trokar nehmen und loslassen: nichts darf es berühren",
);
pub(in crate::console) const OPTION_BY_ARM: Text = Text::of(
    "Take the orientation from the arm, not from the accelerometer",
    "Orientierung vom Arm nehmen, nicht vom Beschleunigungssensor",
);
pub(in crate::console) const OPTION_BY_ARM_HOVER: Text = Text::of(
    "For sensors without an accelerometer. The arm must report the orientation of its wrist.",
    "Für Sensoren ohne Beschleunigungssensor. Der Arm muss die Orientierung seines Handgelenks melden.",
);
pub(in crate::console) const OPTION_FLIP_IMU: Text = Text::of(
    "The accelerometer's vector points down at rest, not up",
    "Der Vektor des Beschleunigungssensors zeigt in Ruhe nach unten, nicht nach oben",
);
pub(in crate::console) const OPTION_FLIP_IMU_HOVER: Text = Text::of(
    "Some drivers report gravity (down) instead of the force that supports the sensor (up). Poses already \
    recorded are kept.",
    "Manche Treiber melden die Schwerkraft (unten) statt der Kraft, die den Sensor trägt (oben). Aufgezeichnete Posen \
     bleiben erhalten.",
);
pub(in crate::console) const POSE_TITLE: Text = Text::of("Move to this pose", "Pose einnehmen");
pub(in crate::console) const POSE_HOVER: Text = Text::of(
    "Turn the tool as the outline shows, release it, and wait until the bar is full",
    "Instrument drehen, wie der Umriss zeigt, loslassen und warten, bis der Balken voll ist",
);
pub(in crate::console) const POSES_COMPLETE: Text =
    Text::of("All poses recorded: continue to the result", "Alle Posen aufgezeichnet: weiter zum Ergebnis");
pub(in crate::console) const POSE_PROGRESS: Text = Text::of("Pose", "Pose");
pub(in crate::console) const DIRECTIONS_IMAGE: Text = Text::of("Directions of gravity", "Schwerkraftrichtungen");
pub(in crate::console) const DIRECTIONS: Text = Text::of("Directions", "Richtungen");
pub(in crate::console) const SO_FAR_HOVER: Text = Text::of(
    "The model is updated after each pose, from the sixth pose on",
    "Das Modell wird ab der sechsten Pose nach jeder Pose erneuert",
);
pub(in crate::console) const POSES_HOVER: Text = Text::of("Poses recorded so far", "Bisher aufgezeichnete Posen");
pub(in crate::console) const SO_FAR_EMPTY: Text =
    Text::of("The first result appears after the sixth pose", "Das erste Ergebnis erscheint nach der sechsten Pose");
pub(in crate::console) const REMOVE_LAST: Text = Text::of("Remove the last pose", "Letzte Pose entfernen");
pub(in crate::console) const NO_RESULT_HOVER: Text =
    Text::of("No model could be fitted to the poses", "Kein Modell ließ sich an die Posen anpassen");
pub(in crate::console) const NO_POSES: Text =
    Text::of("No poses yet: go back and record some", "Noch keine Posen: zurückgehen und aufzeichnen");
pub(in crate::console) const FREE_MOTION_TITLE: Text = Text::of("Move the tool freely", "Instrument frei bewegen");
pub(in crate::console) const FREE_MOTION_HOVER: Text = Text::of(
    "Force that remains after gravity is removed. Nothing may touch the tool; it should read near 0 N.",
    "Restkraft nach Abzug der Schwerkraft. Nichts darf das Instrument berühren; Soll nahe 0 N.",
);
pub(in crate::console) const FREE_MOTION_TASK: Text = Text::of(
    "Turn the tool slowly in all directions without touching anything. Expected: near 0 N.",
    "Instrument langsam in alle Richtungen drehen, ohne etwas zu berühren. Soll: nahe 0 N.",
);
pub(in crate::console) const MEAN: Text = Text::of("Mean", "Mittel");
pub(in crate::console) const MEAN_HOVER: Text =
    Text::of("Mean magnitude of the remaining force", "Mittlerer Betrag der Restkraft");
pub(in crate::console) const P95_HOVER: Text = Text::of(
    "95 % of all samples, noise included, are below this value",
    "95 % aller Messwerte, samt Rauschen, liegen darunter",
);
pub(in crate::console) const TILT: Text = Text::of("Tilt covered", "Neigung abgedeckt");
pub(in crate::console) const TILT_HOVER: Text = Text::of(
    "How far the tool was tilted; at least 45 degrees are needed",
    "Wie weit das Instrument gekippt wurde; mindestens 45 Grad sind nötig",
);
pub(in crate::console) const PASSED: Text = Text::of("Passed", "Bestanden");
pub(in crate::console) const NOT_PASSED: Text = Text::of("Not passed yet", "Noch nicht bestanden");
pub(in crate::console) const MEASURE_AGAIN: Text = Text::of("Measure again", "Neu messen");
pub(in crate::console) const PROOF: Text =
    Text::of("Accepted, and passed the test in free motion", "Angenommen, Test in freier Bewegung bestanden");
pub(in crate::console) const PHASE_NO_SAMPLE: Text =
    Text::of("no valid data from the wrist sensor", "keine gültigen Daten vom Handgelenksensor");
pub(in crate::console) const PHASE_MOVING: Text =
    Text::of("moving; hold the tool still in this pose", "bewegt sich; Instrument in dieser Pose stillhalten");
pub(in crate::console) const PHASE_DISTURBED: Text = Text::of(
    "the force changes although the tool is still: something touches it; release it",
    "die Kraft ändert sich, obwohl das Instrument ruht: etwas berührt es; loslassen",
);
pub(in crate::console) const PHASE_SAME_POSE: Text = Text::of(
    "already recorded here; turn the tool to the pose shown",
    "hier schon aufgezeichnet; Instrument in die gezeigte Pose drehen",
);
pub(in crate::console) const PHASE_RECORDING: Text = Text::of("still; recording", "ruht; wird aufgezeichnet");
pub(in crate::console) const COVERAGE: Text = Text::of("Coverage", "Abdeckung");
pub(in crate::console) const COVERAGE_HOVER: Text = Text::of(
    "Fraction of all directions that have a pose within 45 degrees, 0 to 1",
    "Anteil aller Richtungen mit einer Pose innerhalb von 45 Grad, 0 bis 1",
);
pub(in crate::console) const MASS: Text = Text::of("Mass", "Masse");
pub(in crate::console) const MASS_HOVER: Text =
    Text::of("Total mass mounted on the sensor", "Masse von allem, was am Sensor montiert ist");
pub(in crate::console) const VERDICT_HOVER: Text = Text::of(
    "Tested on poses that were not used to fit the model",
    "Getestet an Posen, die nicht in den Fit eingingen",
);
pub(in crate::console) const POSES_USED_HOVER: Text =
    Text::of("Poses used for the fit and the test", "Posen für Fit und Test");
pub(in crate::console) const CONDITION: Text = Text::of("Condition", "Kondition");
pub(in crate::console) const CONDITION_HOVER: Text = Text::of(
    "Condition number of the fit: how well the poses determine the model, no unit; 1 is best",
    "Konditionszahl des Fits: wie gut die Posen das Modell bestimmen, ohne Einheit; 1 ist am besten",
);
pub(in crate::console) const CENTRE_OF_MASS: Text = Text::of("Centre of mass", "Schwerpunkt");
pub(in crate::console) const CENTRE_OF_MASS_HOVER: Text =
    Text::of("In the sensor's frame (s1)", "Im Sensorsystem (s1)");
pub(in crate::console) const LEFT_OUT: Text = Text::of("Left out", "Ausgelassen");
pub(in crate::console) const LEFT_OUT_HOVER: Text = Text::of(
    "These poses contradict the others: something may have touched the tool",
    "Diese Posen widersprechen den anderen: vielleicht hat etwas das Instrument berührt",
);
pub(in crate::console) const MODELS_TITLE: Text = Text::of("Models compared", "Modelle im Vergleich");
pub(in crate::console) const MODELS_HOVER: Text = Text::of(
    "Force errors in N. Held out: on poses that were not used to fit the model.",
    "Kraftfehler in N. Test: an Posen, die nicht in den Fit eingingen.",
);
pub(in crate::console) const MODEL: Text = Text::of("Model", "Modell");
pub(in crate::console) const FITTED_MEAN: Text = Text::of("fitted: mean", "Fit: Mittel");
pub(in crate::console) const HELD_OUT_MEAN: Text = Text::of("held out: mean", "Test: Mittel");
pub(in crate::console) const NO_READING: Text = Text::of("no reading", "kein Messwert");
pub(in crate::console) const P95: Text = Text::of("95 % below", "95 % unter");
pub(in crate::console) const UNDETERMINED: Text = Text::of("undetermined", "unbestimmt");
pub(in crate::console) const LARGEST: Text = Text::of("largest", "größter");

pub(in crate::console) fn pose_taken(number: usize) -> String {
    text_format!("pose {number} recorded", "Pose {number} aufgezeichnet")
}

pub(in crate::console) fn touched(by_n: f64) -> String {
    text_format!(
        "{by_n:.1} N too much: something touches the tool; release it",
        "{by_n:.1} N zu viel: etwas berührt das Instrument; loslassen"
    )
}

pub(in crate::console) fn was_touched(seconds: f64) -> String {
    text_format!(
        "Something touched the tool for {seconds:.0} s while it was still",
        "Etwas berührte das Instrument {seconds:.0} s lang in Ruhe"
    )
}

pub(in crate::console) const WAS_TOUCHED_HOVER: Text = Text::of(
    "The force changed although the tool did not turn. If the verdict is bad, release the tool and press Start \
     over",
    "Die Kraft änderte sich, ohne dass sich das Instrument drehte. Bei schlechtem Urteil Instrument loslassen und Neu \
     beginnen drücken",
);

pub(in crate::console) fn left_out(numbers: &str) -> String {
    text_format!("poses {numbers}", "Posen {numbers}")
}

pub(in crate::console) fn recorded_of(recorded: usize, asked: usize) -> String {
    text_format!("{recorded} of {asked} recorded", "{recorded} von {asked} aufgezeichnet")
}

pub(in crate::console) fn of_allowed(force_n: f64, limit_n: f64) -> String {
    text_format!("{force_n:.2} N of {limit_n} N allowed", "{force_n:.2} N von {limit_n} N erlaubt")
}

pub(in crate::console) fn chosen(model: &str) -> String {
    text_format!("{model} (chosen)", "{model} (gewählt)")
}
