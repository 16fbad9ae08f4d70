//! The wizards of the frame calibrations: sensor mount, tip, hand-eye, table, view, trocar.

use crate::language::{Text, text_format, word};

pub const MOUNT: Text = Text::of("Sensor mount", "Sensormontage");
pub const TIP: Text = Text::of("Tip", "Spitze");
pub const HAND_EYE: Text = Text::of("Hand-eye", "Hand-Auge");
pub const TABLE: Text = Text::of("Table", "Tisch");
pub const VIEW: Text = Text::of("View", "Bildlage");
pub const TROCAR: Text = Text::of("Trocar", "Trokar");
pub const MOUNT_MEANING: Text = Text::of(
    "Checks the orientation of the wrist sensor on the arm's flange",
    "Prüft die Orientierung des Handgelenksensors am Flansch des Arms",
);
pub const TIP_MEANING: Text = Text::of(
    "Finds the instrument's tip in the frame of the arm's flange",
    "Bestimmt die Instrumentenspitze im Flanschsystem des Arms",
);
pub const HAND_EYE_MEANING: Text = Text::of(
    "Finds where the marker is on the instrument, and where the tracker is relative to the arm",
    "Bestimmt, wo der Marker am Instrument sitzt und wo der Tracker relativ zum Arm steht",
);
pub const TABLE_MEANING: Text = Text::of(
    "Finds origin and plane of the workspace from points touched with the tip",
    "Bestimmt Ursprung und Ebene des Arbeitsraums aus Punkten, die die Spitze berührt",
);
pub const VIEW_MEANING: Text = Text::of(
    "Finds how the endoscope image is rotated relative to arm and handle",
    "Bestimmt, wie das Endoskopbild gegen Arm und Handgerät verdreht ist",
);
pub const TROCAR_MEANING: Text =
    Text::of("Finds the point about which the instrument pivots", "Bestimmt den Punkt, um den das Instrument schwenkt");

pub const MOUNT_BEFORE: Text = Text::of(
    "Take the instrument out of the trocar; nothing may touch it. Recording begins with the next step.",
    "Instrument aus dem Trokar nehmen; nichts darf es berühren. Die Aufzeichnung beginnt mit dem nächsten Schritt.",
);
pub const MOUNT_TASK: Text = Text::of(
    "Hold the tool still in each orientation until it is recorded",
    "Instrument in jeder Orientierung stillhalten, bis sie aufgezeichnet ist",
);
pub const TIP_BEFORE: Text = Text::of(
    "Take the instrument out of the trocar, and put its tip into a dimple that cannot move, such as a screw's recess. \
     Recording begins with the next step.",
    "Instrument aus dem Trokar nehmen und die Spitze in eine feste Mulde setzen, etwa einen Schraubenkopf. Die \
     Aufzeichnung beginnt mit dem nächsten Schritt.",
);
pub const TIP_TASK: Text = Text::of(
    "Tilt by 20 to 30 degrees in all directions, and turn about the shaft. Hold each pose still for half a second. \
     The tip must stay in the dimple.",
    "Nach allen Seiten um 20 bis 30 Grad kippen und um den Schaft drehen. Jede Pose eine halbe Sekunde stillhalten. \
     Die Spitze muss in der Mulde bleiben.",
);
pub const HAND_EYE_BEFORE: Text = Text::of(
    "Take the instrument out of the trocar, and turn its marker towards the tracker. Keep the other arm and its \
     marker at rest. Recording begins with the next step.",
    "Instrument aus dem Trokar nehmen und seinen Marker zum Tracker drehen. Den anderen Arm und seinen Marker \
     ruhen lassen. Die Aufzeichnung beginnt mit dem nächsten Schritt.",
);
pub const HAND_EYE_TASK: Text = Text::of(
    "Tilt and turn the instrument in every pose, also about its shaft; moving without turning does not help. \
     Hold each pose still for half a second.",
    "Instrument in jeder Pose kippen und drehen, auch um den Schaft; Verschieben ohne Drehen nützt nichts. Jede Pose \
     eine halbe Sekunde stillhalten.",
);
pub const TABLE_BEFORE: Text = Text::of(
    "Clear the table, and mark its origin, a point along x and a point on the side of y, about 10 cm apart. Put the \
     tip on the origin. Recording begins with the next step.",
    "Tisch räumen und markieren: Ursprung, einen Punkt längs x und einen auf der Seite von y, etwa 10 cm auseinander. \
     Spitze auf den Ursprung setzen. Die Aufzeichnung beginnt mit dem nächsten Schritt.",
);
pub const TABLE_TASK: Text = Text::of(
    "Touch each point with the tip and hold still for half a second. If a wrong point was recorded, remove it.",
    "Jeden Punkt mit der Spitze berühren und eine halbe Sekunde stillhalten. Falsch aufgezeichnete Punkte entfernen.",
);
pub const VIEW_BEFORE: Text = Text::of(
    "Bring the tip to the middle of the endoscope image and hold it still. Recording begins with the next step.",
    "Spitze in die Mitte des Endoskopbilds bringen und stillhalten. Die Aufzeichnung beginnt mit dem nächsten Schritt.",
);
pub const VIEW_TASK: Text = Text::of(
    "Look only at the image. Move the tip about 3 cm each time, then hold still for half a second.",
    "Nur auf das Bild sehen. Spitze jeweils etwa 3 cm bewegen, dann eine halbe Sekunde stillhalten.",
);
pub const VIEW_HANDLE_BEFORE: Text = Text::of(
    "Hold the handle still in the middle of its range. Recording begins with the next step.",
    "Handgerät in der Mitte seines Bereichs stillhalten. Die Aufzeichnung beginnt mit dem nächsten Schritt.",
);
pub const VIEW_HANDLE_TASK: Text = Text::of(
    "Look only at the image. Move the handle about 3 cm each time, as if the tip followed, then hold still for \
     half a second.",
    "Nur auf das Bild sehen. Handgerät jeweils etwa 3 cm bewegen, als folgte die Spitze, dann eine halbe Sekunde \
     stillhalten.",
);
pub const TROCAR_BEFORE: Text = Text::of(
    "Insert the instrument through the trocar; keep the tip clear of tissue. Recording begins with the next step.",
    "Instrument durch den Trokar führen; die Spitze frei von Gewebe halten. Die Aufzeichnung beginnt mit dem \
     nächsten Schritt.",
);
pub const TROCAR_TASK: Text = Text::of(
    "Pivot the instrument by 10 degrees or more in all directions, at several depths. Lines are recorded \
     while it moves.",
    "Instrument in mehreren Tiefen nach allen Seiten um 10 Grad oder mehr schwenken. Linien werden in der Bewegung \
     aufgezeichnet.",
);

pub const POSES: Text = Text::of("poses", "Posen");
pub const POINTS: Text = Text::of("points", "Punkte");
pub const PLACES: Text = Text::of("places", "Orte");
pub const LINES: Text = Text::of("lines", "Linien");

pub const BY_TRACKER: Text = Text::of(
    "Measure with the tracker instead of the arm's joints",
    "Mit dem Tracker statt mit den Armgelenken messen",
);
pub const BY_TRACKER_HOVER: Text = Text::of(
    "The tracker detects motion of the patient's trocar; the joints of an arm with a configured trocar cannot \
     show it",
    "Der Tracker erkennt Bewegungen des Trokars am Patienten; die Gelenke eines Arms mit fest eingestelltem \
     Trokar zeigen sie nicht",
);
pub const BY_HANDLE: Text = Text::of("Move the handle instead of the tip", "Handgerät statt Spitze bewegen");
pub const BY_HANDLE_HOVER: Text = Text::of(
    "Do both, one after the other: a motion of the handle to the right then moves the tip to the right in the image",
    "Beides nacheinander tun: dann bewegt das Handgerät nach rechts die Spitze im Bild nach rechts",
);
pub const NEEDS_HAND_EYE: Text = Text::of("Complete the hand-eye calibration first", "Zuerst Hand-Auge kalibrieren");

pub const PIVOT: Text = Text::of("Turn about the tip, then hold still", "Um die Spitze drehen, dann stillhalten");
pub const TURN: Text = Text::of(
    "Tilt and turn, then hold still",
    "Kippen und drehen, dann \
 stillhalten",
);
pub const PIVOT_IN_TROCAR: Text = Text::of("Pivot in the trocar, without a pause", "Im Trokar schwenken, ohne Pause");
pub const TOUCH_ORIGIN: Text = Text::of("Touch the origin", "Ursprung berühren");
pub const TOUCH_X: Text = Text::of("Touch the point along x", "Punkt längs x berühren");
pub const TOUCH_Y: Text = Text::of("Touch the point on the side of y", "Punkt auf der Seite von y berühren");
pub const TOUCH_FURTHER: Text =
    Text::of("Touch any other point of the table", "Einen weiteren Punkt des Tischs berühren");
pub const HOLD_STILL: Text = Text::of("Hold still where you begin", "Am Anfangsort stillhalten");
pub const THE_TIP: Text = Text::of("Tip", "Spitze");
pub const THE_HANDLE: Text = Text::of("Handle", "Handgerät");
pub const ALL_RECORDED: Text =
    Text::of("All recorded: release, then press Next", "Alles aufgezeichnet: loslassen und Weiter drücken");
pub const PAUSED: Text = Text::of("paused", "Pause");

pub const STEP_CHECK_HOVER: Text =
    Text::of("Checks that all required devices send data", "Prüft, ob alle nötigen Geräte Daten senden");
pub const STEP_RECORD: Text = Text::of("Record", "Aufzeichnen");
pub const STEP_RECORD_HOVER: Text =
    Text::of("Follow the instructions until everything is recorded", "Anweisungen folgen, bis alles aufgezeichnet ist");
pub const STEP_RESULT_HOVER: Text = Text::of(
    "The result, its errors, and the changes to the rig file",
    "Ergebnis, seine Fehler, und was es in der Aufbaudatei ändert",
);
pub const STEP_SAVE_HOVER: Text = Text::of(
    "Saves the record and writes the values into the rig file; its comments stay",
    "Speichert das Protokoll und schreibt die Werte in die Aufbaudatei; Kommentare bleiben",
);
pub const CHECKS_TITLE: Text = Text::of("Before the recording", "Vor der Aufzeichnung");
pub const CHECKS_HOVER: Text =
    Text::of("All required devices must send data first", "Alle nötigen Geräte müssen zuerst Daten senden");
pub const CHECK_ARM: Text = Text::of("Joints of the arm", "Gelenke des Arms");
pub const CHECK_MARKER: Text = Text::of("Marker visible to the tracker", "Marker im Sichtfeld des Trackers");
pub const CHECK_HANDLE: Text = Text::of("Position of the handle", "Position des Handgeräts");
pub const CHECK_WRENCH: Text = Text::of("Force at the wrist", "Kraft am Handgelenk");
pub const CHECK_IMAGE: Text = Text::of("Endoscope image", "Endoskopbild");
pub const NO_IMAGE: Text = Text::of(
    "this rig has no endoscope: enter the address of its image on the start page (F6)",
    "dieser Aufbau hat kein Endoskop: auf der Startseite (F6) die Adresse seines Bildes eintragen",
);
pub const OPTIONS_TITLE: Text = Text::of("How to measure", "Messverfahren");
pub const OPTIONS_HOVER: Text = Text::of("Leave this off unless you need it", "Nur bei Bedarf einschalten");
pub const NEEDS_ARM: Text = Text::of("This rig has no arm with joints", "Dieser Aufbau hat keinen Arm mit Gelenken");
pub const NO_ARM: Text = Text::of(
    "This rig has no arm with joints: choose a rig with devices on the start page, for example the emulated rig",
    "Dieser Aufbau hat keinen Arm mit Gelenken: auf der Startseite einen Aufbau mit Geräten wählen, etwa den \
     emulierten",
);
pub const RECORD_TITLE: Text = Text::of("Do this now", "Jetzt");
pub const RECORD_HOVER: Text =
    Text::of("What to do until everything is recorded", "Was zu tun ist, bis alles aufgezeichnet ist");
pub const PROGRESS: Text = Text::of("Now", "Jetzt");
pub const COVERAGE: Text = Text::of("Recorded", "Aufgezeichnet");
pub const REMOVE_LAST: Text = Text::of("Remove last", "Letzte entfernen");
pub const PAUSE: Text = Text::of("Pause", "Pause");
pub const GO_ON: Text = Text::of("Resume", "Fortsetzen");
pub const PAUSE_HOVER: Text =
    Text::of("No data are recorded until you press Resume", "Zeichnet nichts auf, bis Fortsetzen gedrückt wird");
pub const NEEDS_MORE: Text = Text::of("Not enough is recorded yet", "Noch nicht genug aufgezeichnet");
pub const NEEDS_RESULT: Text = Text::of(
    "No result to save: go back and record more",
    "Kein Ergebnis zum Speichern: zurückgehen und mehr aufzeichnen",
);
pub const NO_RESULT_HOVER: Text =
    Text::of("Nothing could be computed from the recording", "Aus der Aufzeichnung ließ sich nichts berechnen");
pub const TOO_FEW: Text = Text::of(
    "Too little recorded: go back and record more",
    "Zu wenig aufgezeichnet: zurückgehen und mehr \
     aufzeichnen",
);
pub const VERDICT_HOVER: Text = Text::of(
    "Judged on held-out data, which were not used for the fit",
    "Beurteilt an Daten, die im Fit zurückgehalten wurden",
);
pub const RECORDED_HOVER: Text = Text::of("How many were recorded", "Anzahl der Aufzeichnungen");
pub const LEFT_OUT: Text = Text::of("Left out", "Ausgelassen");
pub const LEFT_OUT_HOVER: Text =
    Text::of("These contradict the others and were not used", "Widersprechen den anderen und wurden nicht verwendet");
pub const HELD_OUT: Text = Text::of("Held-out error", "Testfehler");
pub const HELD_OUT_HOVER: Text = Text::of(
    "Root mean square error on data that were not used for the fit",
    "Quadratisches Mittel der Fehler auf Daten, die nicht in den Fit eingingen",
);
pub const HELD_OUT_MAX: Text = Text::of("Largest held-out error", "Größter Testfehler");
pub const HELD_OUT_MAX_HOVER: Text = Text::of("The largest of these errors", "Der größte dieser Fehler");
pub const FITTED: Text = Text::of("Fit error", "Fitfehler");
pub const FITTED_HOVER: Text =
    Text::of("Root mean square error on the data of the fit", "Quadratisches Mittel der Fehler auf den Daten des Fits");
pub const UNCERTAINTY: Text = Text::of("Uncertainty", "Unsicherheit");
pub const UNCERTAINTY_HOVER: Text =
    Text::of("Half the length of the 95 % interval of the result", "Halbe Länge des 95-%-Intervalls des Ergebnisses");
pub const TOOL_MASS: Text = Text::of("Tool", "Instrument");
pub const TOOL_MASS_HOVER: Text = Text::of("Mass carried by the sensor", "Masse, die am Sensor hängt");
pub const CHANGE_TITLE: Text = Text::of("Changes to the rig file", "Änderungen in der Aufbaudatei");
pub const CHANGE_HOVER: Text = Text::of(
    "Nothing changes before you save; afterwards you can undo the change",
    "Vor dem Speichern ändert sich nichts; danach ist die Änderung umkehrbar",
);
pub const NO_CHANGE: Text = Text::of("None: the rig file is correct", "Keine: die Aufbaudatei stimmt");
pub const WITHIN_UNCERTAINTY: Text = Text::of(
    "The change is smaller than the uncertainty of the result: the rig file was correct",
    "Die Änderung ist kleiner als die Unsicherheit des Ergebnisses: die Aufbaudatei stimmte",
);
pub const KEY: Text = Text::of("Key", "Schlüssel");
pub const BEFORE: Text = Text::of("Now", "Jetzt");
pub const AFTER: Text = Text::of("New", "Neu");
pub const CHANGE: Text = Text::of("Change", "Änderung");
pub const NOT_GIVEN: Text = Text::of("not set", "nicht gesetzt");
pub const PROOF: Text = Text::of("Accepted on held-out data", "Auf Testdaten angenommen");
pub const UNDO_TITLE: Text = Text::of("Undo", "Rückgängig");
pub const UNDO_CARD_HOVER: Text = Text::of(
    "The record keeps the previous values; they can be restored in the rig file",
    "Das Protokoll bewahrt die vorigen Werte; sie lassen sich in die Aufbaudatei zurückschreiben",
);
pub const UNDO: Text = Text::of("Restore previous values", "Vorige Werte wiederherstellen");
pub const UNDONE: Text =
    Text::of("The previous values are in the rig file again", "Die vorigen Werte stehen wieder in der Aufbaudatei");

pub fn hold(name: &str) -> String {
    text_format!("Hold still: {name}", "Stillhalten: {name}")
}

pub fn moved(what: &str, way: &str) -> String {
    text_format!("{what}: {way}, then hold still", "{what}: {way}, dann stillhalten")
}

pub fn coverage(count: usize, units: &str, missing: Option<&str>) -> String {
    let missing = missing.map_or_else(
        || word("complete", "vollständig").to_owned(),
        |missing| text_format!("still needed: {missing}", "noch nötig: {missing}"),
    );
    format!("{count} {units}; {missing}")
}

pub fn effect(change: Option<[f64; 2]>) -> String {
    change.map_or_else(
        || {
            word(
                "solid: found now; not set in the rig file",
                "durchgezogen: jetzt bestimmt; fehlt in der \
             Aufbaudatei",
            )
            .to_owned()
        },
        |[m, deg]| {
            // A point has no angle, and a rotation has no position.
            let moved = (m > 1e-9).then(|| text_format!("moved by {:.2} mm", "verschoben um {:.2} mm", m * 1e3));
            let turned = (deg > 1e-6).then(|| text_format!("turned by {deg:.2} deg", "gedreht um {deg:.2} deg"));
            let words: Vec<_> = moved.into_iter().chain(turned).collect();
            text_format!(
                "dashed: now   solid: new   {}",
                "gestrichelt: jetzt   durchgezogen: neu   {}",
                words.join(", ")
            )
        },
    )
}

pub fn scale(length_m: f64) -> String {
    text_format!("{} mm", "{} mm", (length_m * 1e4).round() / 10.0)
}

pub fn mount_found(off_deg: f64, agrees: bool) -> String {
    let verdict = if agrees {
        word("it agrees with the rig file", "stimmt mit der Aufbaudatei überein")
    } else {
        word("the rig file is wrong", "die Aufbaudatei ist falsch")
    };
    text_format!(
        "The measured mount differs by {off_deg:.1} deg: {verdict}",
        "Die gemessene Montage weicht um {off_deg:.1} deg ab: {verdict}"
    )
}

pub fn mount_axes(axes: &str) -> String {
    text_format!("The sensor's x, y, z are the rig file's {axes}", "x, y, z des Sensors sind {axes} der Aufbaudatei")
}

pub fn written(record: &std::path::Path, rig: &std::path::Path) -> String {
    text_format!("Saved: {}; in use: {}", "Gespeichert: {}; aktiv: {}", record.display(), rig.display())
}
