//! The wizard that removes the weight of the tool.

use crate::language::{Text, text_format};

pub const STEP_CHECK_HOVER: Text = Text::of(
    "Checks that the sensor sends good data and that nothing touches the tool",
    "Prüft, ob der Sensor gute Daten sendet und nichts das Instrument berührt",
);
pub const STEP_POSES: Text = Text::of("Poses", "Posen");
pub const STEP_POSES_HOVER: Text = Text::of(
    "Twelve orientations of the tool, so that gravity pulls in all directions",
    "Zwölf Orientierungen des Instruments, damit die Schwerkraft von allen Seiten zieht",
);
pub const STEP_RESULT_HOVER: Text = Text::of(
    "The fitted model, tested on poses that were not used to fit it",
    "Das angepasste Modell, getestet an Posen, die nicht in den Fit eingingen",
);
pub const STEP_FREE_MOTION: Text = Text::of("Free motion", "Freie Bewegung");
pub const STEP_FREE_MOTION_HOVER: Text = Text::of(
    "The final test: a tool that moves freely through the air must read zero force",
    "Der Schlusstest: frei in der Luft bewegt muss das Instrument null Kraft anzeigen",
);
pub const NEEDS_POSES: Text = Text::of("At least six poses are needed", "Mindestens sechs Posen sind nötig");
pub const NEEDS_MODEL: Text = Text::of(
    "No model to test: go back and record more poses",
    "Kein Modell zum Testen: zurückgehen und mehr Posen aufzeichnen",
);
pub const NEEDS_FREE_MOTION: Text = Text::of("Move the tool freely first", "Zuerst das Instrument frei bewegen");
pub const CHECKS_TITLE: Text = Text::of("Before the first pose", "Vor der ersten Pose");
pub const CHECKS_HOVER: Text = Text::of(
    "All checks must pass before poses are recorded",
    "Erst wenn alle Prüfungen bestanden sind, werden Posen \
     aufgezeichnet",
);
pub const CHECKS_TASK: Text = Text::of(
    "Take the instrument out of the trocar and release it: nothing may touch the tool",
    "Instrument aus dem Trokar nehmen und loslassen: nichts darf es berühren",
);
pub const OPTION_BY_ARM: Text = Text::of(
    "Take the orientation from the arm, not from the accelerometer",
    "Orientierung vom Arm nehmen, nicht vom Beschleunigungssensor",
);
pub const OPTION_BY_ARM_HOVER: Text = Text::of(
    "For sensors without an accelerometer. The arm must report the orientation of its wrist.",
    "Für Sensoren ohne Beschleunigungssensor. Der Arm muss die Orientierung seines Handgelenks melden.",
);
pub const OPTION_FLIP_IMU: Text = Text::of(
    "The accelerometer's vector points down at rest, not up",
    "Der Vektor des Beschleunigungssensors zeigt in Ruhe nach unten, nicht nach oben",
);
pub const OPTION_FLIP_IMU_HOVER: Text = Text::of(
    "Some drivers report gravity (down) instead of the force that supports the sensor (up). Poses already \
    recorded are kept.",
    "Manche Treiber melden die Schwerkraft (unten) statt der Kraft, die den Sensor trägt (oben). Aufgezeichnete Posen \
     bleiben erhalten.",
);
pub const POSE_TITLE: Text = Text::of("Move to this pose", "Pose einnehmen");
pub const POSE_HOVER: Text = Text::of(
    "Turn the tool as the outline shows, release it, and wait until the bar is full",
    "Instrument drehen, wie der Umriss zeigt, loslassen und warten, bis der Balken voll ist",
);
pub const POSES_COMPLETE: Text =
    Text::of("All poses recorded: continue to the result", "Alle Posen aufgezeichnet: weiter zum Ergebnis");
pub const POSE_PROGRESS: Text = Text::of("Pose", "Pose");
pub const DIRECTIONS_IMAGE: Text = Text::of("Directions of gravity", "Schwerkraftrichtungen");
pub const DIRECTIONS: Text = Text::of("Directions", "Richtungen");
pub const SO_FAR_HOVER: Text = Text::of(
    "The model is updated after each pose, from the sixth pose on",
    "Das Modell wird ab der sechsten Pose nach jeder Pose erneuert",
);
pub const POSES_HOVER: Text = Text::of("Poses recorded so far", "Bisher aufgezeichnete Posen");
pub const SO_FAR_EMPTY: Text =
    Text::of("The first result appears after the sixth pose", "Das erste Ergebnis erscheint nach der sechsten Pose");
pub const REMOVE_LAST: Text = Text::of("Remove the last pose", "Letzte Pose entfernen");
pub const NO_RESULT_HOVER: Text =
    Text::of("No model could be fitted to the poses", "Kein Modell ließ sich an die Posen anpassen");
pub const NO_POSES: Text =
    Text::of("No poses yet: go back and record some", "Noch keine Posen: zurückgehen und aufzeichnen");
pub const FREE_MOTION_TITLE: Text = Text::of("Move the tool freely", "Instrument frei bewegen");
pub const FREE_MOTION_HOVER: Text = Text::of(
    "Force that remains after gravity is removed. Nothing may touch the tool; it should read near 0 N.",
    "Restkraft nach Abzug der Schwerkraft. Nichts darf das Instrument berühren; Soll nahe 0 N.",
);
pub const FREE_MOTION_TASK: Text = Text::of(
    "Turn the tool slowly in all directions without touching anything. Expected: near 0 N.",
    "Instrument langsam in alle Richtungen drehen, ohne etwas zu berühren. Soll: nahe 0 N.",
);
pub const MEAN: Text = Text::of("Mean", "Mittel");
pub const MEAN_HOVER: Text = Text::of("Mean magnitude of the remaining force", "Mittlerer Betrag der Restkraft");
pub const P95_HOVER: Text = Text::of(
    "95 % of all samples, noise included, are below this value",
    "95 % aller Messwerte, samt Rauschen, liegen darunter",
);
pub const TILT: Text = Text::of("Tilt covered", "Neigung abgedeckt");
pub const TILT_HOVER: Text = Text::of(
    "How far the tool was tilted; at least 45 degrees are needed",
    "Wie weit das Instrument gekippt wurde; mindestens 45 Grad sind nötig",
);
pub const PASSED: Text = Text::of("Passed", "Bestanden");
pub const NOT_PASSED: Text = Text::of("Not passed yet", "Noch nicht bestanden");
pub const MEASURE_AGAIN: Text = Text::of("Measure again", "Neu messen");
pub const PROOF: Text =
    Text::of("Accepted, and passed the test in free motion", "Angenommen, Test in freier Bewegung bestanden");
pub const PHASE_NO_SAMPLE: Text =
    Text::of("no valid data from the wrist sensor", "keine gültigen Daten vom Handgelenksensor");
pub const PHASE_MOVING: Text =
    Text::of("moving; hold the tool still in this pose", "bewegt sich; Instrument in dieser Pose stillhalten");
pub const PHASE_DISTURBED: Text = Text::of(
    "the force changes although the tool is still: something touches it; release it",
    "die Kraft ändert sich, obwohl das Instrument ruht: etwas berührt es; loslassen",
);
pub const PHASE_SAME_POSE: Text = Text::of(
    "already recorded here; turn the tool to the pose shown",
    "hier schon aufgezeichnet; Instrument in die gezeigte Pose drehen",
);
pub const PHASE_RECORDING: Text = Text::of("still; recording", "ruht; wird aufgezeichnet");
pub const COVERAGE: Text = Text::of("Coverage", "Abdeckung");
pub const COVERAGE_HOVER: Text = Text::of(
    "Fraction of all directions that have a pose within 45 degrees, 0 to 1",
    "Anteil aller Richtungen mit einer Pose innerhalb von 45 Grad, 0 bis 1",
);
pub const MASS: Text = Text::of("Mass", "Masse");
pub const MASS_HOVER: Text =
    Text::of("Total mass mounted on the sensor", "Masse von allem, was am Sensor montiert ist");
pub const VERDICT_HOVER: Text = Text::of(
    "Tested on poses that were not used to fit the model",
    "Getestet an Posen, die nicht in den Fit eingingen",
);
pub const POSES_USED_HOVER: Text = Text::of("Poses used for the fit and the test", "Posen für Fit und Test");
pub const CONDITION: Text = Text::of("Condition", "Kondition");
pub const CONDITION_HOVER: Text = Text::of(
    "Condition number of the fit: how well the poses determine the model, no unit; 1 is best",
    "Konditionszahl des Fits: wie gut die Posen das Modell bestimmen, ohne Einheit; 1 ist am besten",
);
pub const CENTRE_OF_MASS: Text = Text::of("Centre of mass", "Schwerpunkt");
pub const CENTRE_OF_MASS_HOVER: Text = Text::of("In the sensor's frame (s1)", "Im Sensorsystem (s1)");
pub const LEFT_OUT: Text = Text::of("Left out", "Ausgelassen");
pub const LEFT_OUT_HOVER: Text = Text::of(
    "These poses contradict the others: something may have touched the tool",
    "Diese Posen widersprechen den anderen: vielleicht hat etwas das Instrument berührt",
);
pub const MODELS_TITLE: Text = Text::of("Models compared", "Modelle im Vergleich");
pub const MODELS_HOVER: Text = Text::of(
    "Force errors in N. Held out: on poses that were not used to fit the model.",
    "Kraftfehler in N. Test: an Posen, die nicht in den Fit eingingen.",
);
pub const MODEL: Text = Text::of("Model", "Modell");
pub const FITTED_MEAN: Text = Text::of("fitted: mean", "Fit: Mittel");
pub const HELD_OUT_MEAN: Text = Text::of("held out: mean", "Test: Mittel");
pub const NO_READING: Text = Text::of("no reading", "kein Messwert");
pub const P95: Text = Text::of("95 % below", "95 % unter");
pub const UNDETERMINED: Text = Text::of("undetermined", "unbestimmt");
pub const LARGEST: Text = Text::of("largest", "größter");

pub fn pose_taken(number: usize) -> String {
    text_format!("pose {number} recorded", "Pose {number} aufgezeichnet")
}

pub fn touched(by_n: f64) -> String {
    text_format!(
        "{by_n:.1} N too much: something touches the tool; release it",
        "{by_n:.1} N zu viel: etwas berührt das Instrument; loslassen"
    )
}

pub fn was_touched(seconds: f64) -> String {
    text_format!(
        "Something touched the tool for {seconds:.0} s while it was still",
        "Etwas berührte das Instrument {seconds:.0} s lang in Ruhe"
    )
}

pub const WAS_TOUCHED_HOVER: Text = Text::of(
    "The force changed although the tool did not turn. If the verdict is bad, release the tool and press Start \
     over",
    "Die Kraft änderte sich, ohne dass sich das Instrument drehte. Bei schlechtem Urteil Instrument loslassen und Neu \
     beginnen drücken",
);

pub fn left_out(numbers: &str) -> String {
    text_format!("poses {numbers}", "Posen {numbers}")
}

pub fn recorded_of(recorded: usize, asked: usize) -> String {
    text_format!("{recorded} of {asked} recorded", "{recorded} von {asked} aufgezeichnet")
}

pub fn of_allowed(force_n: f64, limit_n: f64) -> String {
    text_format!("{force_n:.2} N of {limit_n} N allowed", "{force_n:.2} N von {limit_n} N erlaubt")
}

pub fn chosen(model: &str) -> String {
    text_format!("{model} (chosen)", "{model} (gewählt)")
}
