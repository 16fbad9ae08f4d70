//! The Camera wizard.

use nima_endoscope::Bend;
use nima_words::language::{Text, text_format, word};

pub(super) const STEP_CHECK_HOVER: Text =
    Text::of("Checks the endoscope image and the board", "Prüft Endoskopbild und Tafel");
pub(super) const STEP_VIEWS: Text = Text::of("Views", "Ansichten");
pub(super) const STEP_VIEWS_HOVER: Text = Text::of(
    "Show the board to the camera at different positions and tilts",
    "Der Kamera die Tafel an verschiedenen Orten und mit verschiedenen Neigungen zeigen",
);
pub(super) const STEP_LENS: Text = Text::of("Lens", "Objektiv");
pub(super) const STEP_LENS_HOVER: Text =
    Text::of("The lens found, and whether it can be used", "Was bestimmt wurde und ob es verwendbar ist");
pub(super) const STEP_TOUCH: Text = Text::of("Position", "Lage");
pub(super) const STEP_TOUCH_HOVER: Text = Text::of(
    "Touch corners of the board with the instrument's tip",
    "Ecken der Tafel mit der Instrumentenspitze berühren",
);
pub(super) const CHECKS_TITLE: Text = Text::of("Before you begin", "Vor dem Beginn");
pub(super) const CHECKS_HOVER: Text = Text::of("What the wizard needs", "Was der Assistent braucht");
pub(super) const TASK: Text = Text::of(
    "Focus the endoscope at its working distance, and do not change focus or zoom from now on",
    "Endoskop auf den Arbeitsabstand scharfstellen, danach Schärfe und Zoom nicht mehr ändern",
);
pub(super) const CHECK_ENDOSCOPE: Text = Text::of(
    "Endoscope in the rig file",
    "Endoskop in der \
 Aufbaudatei",
);
pub(super) const NO_ENDOSCOPE: Text =
    Text::of("add [endoscope] with its url to the rig file", "[endoscope] mit url in der Aufbaudatei ergänzen");
pub(super) const CHECK_IMAGE: Text = Text::of("Image", "Bild");
pub(super) const NO_IMAGE: Text =
    Text::of("no image received; see the Devices panel for the cause", "kein Bild empfangen; Grund im Panel Geräte");
pub(super) const BOARD_TITLE: Text = Text::of("Board", "Tafel");
pub(super) const BOARD_HOVER: Text = Text::of(
    "A flat checkerboard, completely visible at the working distance",
    "Ein ebenes Schachbrettmuster, im Arbeitsabstand ganz sichtbar",
);
pub(super) const CORNERS: Text = Text::of("Inner corners", "Innere Ecken");
pub(super) const CORNERS_HOVER: Text = Text::of(
    "Points where four squares meet, counted along both sides: one number odd, the other even",
    "Wo vier Felder zusammenstoßen, längs beider Seiten: eine Zahl ungerade, die andere gerade",
);
pub(super) const SQUARE: Text = Text::of("Side of a square", "Feldseite");
pub(super) const SQUARE_HOVER: Text = Text::of(
    "Measure it on the printout (mm). It determines the accuracy of the camera position.",
    "Auf dem Ausdruck messen (mm). Davon hängt die Genauigkeit der Kameralage ab.",
);
pub(super) const PRINT: Text = Text::of(
    "To print one: nima calibrate board --board 9x6 --square-mm 10 --out board.svg",
    "Zum Drucken: nima calibrate board --board 9x6 --square-mm 10 --out board.svg",
);
pub(super) const KEEP: Text = Text::of(
    "Keep the lens of the rig file, find only the position",
    "Objektiv der Aufbaudatei übernehmen, nur Lage bestimmen",
);
pub(super) const KEEP_HOVER: Text = Text::of(
    "Use this if the endoscope was moved but focus and zoom are unchanged",
    "Wenn das Endoskop bewegt, aber weder Schärfe noch Zoom geändert wurden",
);
pub(super) const LENS_IS_KEPT: Text =
    Text::of("The lens of the rig file is kept", "Das Objektiv der Aufbaudatei bleibt");
pub(super) const VIEWS_TITLE: Text = Text::of("Show the board", "Tafel zeigen");
pub(super) const VIEWS_HOVER: Text = Text::of(
    "A view is captured automatically when the whole board is held still at a new position",
    "Wird automatisch aufgenommen, sobald die ganze Tafel an einem neuen Ort stillhält",
);
pub(super) const PROGRESS: Text = Text::of("Views", "Ansichten");
pub(super) const REMOVE_LAST: Text = Text::of("Remove the last view", "Letzte Ansicht entfernen");
pub(super) const VIEWS_NOTE: Text = Text::of(
    "Views are captured automatically. Any other position is good too. Continue when all views are captured.",
    "Aufnahme erfolgt automatisch. Jeder andere Ort ist auch gut. Weiter, wenn alle aufgenommen sind.",
);
pub(super) const LOOKING: Text = Text::of("waiting for an image", "wartet auf ein Bild");
pub(super) const SEEN: Text = Text::of("board detected", "Tafel erkannt");
pub(super) const CALCULATING: Text = Text::of("No views yet", "Noch keine Ansichten");
pub(super) const LENS_TITLE: Text = Text::of("Lens", "Objektiv");
pub(super) const LENS_HOVER: Text = Text::of(
    "The lens that best explains the corners of all views",
    "Das Objektiv, das die Ecken aller Ansichten am besten erklärt",
);
pub(super) const LENS_GOOD: Text = Text::of("it predicts held-out views", "es sagt zurückgehaltene Ansichten voraus");
pub(super) const VIEWS_USED: Text = Text::of("Views used", "Verwendet");
pub(super) const VIEWS_USED_HOVER: Text = Text::of(
    "Blurred, repeated and contradicting views are left out",
    "Unscharfe, wiederholte und widersprüchliche Ansichten sind ausgelassen",
);
pub(super) const COVERAGE: Text = Text::of("Image covered", "Bild abgedeckt");
pub(super) const COVERAGE_HOVER: Text = Text::of(
    "Fraction of the bright image area in which corners were seen; distortion is known only there",
    "Anteil des hellen Bildes, in dem Ecken lagen; nur dort ist die Verzeichnung bekannt",
);
pub(super) const HELD_OUT: Text = Text::of("Held-out error", "Testfehler");
pub(super) const HELD_OUT_MAX: Text = Text::of("Largest held-out error", "Größter Testfehler");
pub(super) const HELD_OUT_HOVER: Text = Text::of(
    "Distance between corners and their prediction by a lens that was found without their view, px",
    "Abstand der Ecken von der Vorhersage eines Objektivs, das ohne ihre Ansicht bestimmt wurde, px",
);
pub(super) const FITTED: Text = Text::of("Fit error", "Fitfehler");
pub(super) const FITTED_HOVER: Text = Text::of(
    "The same for the views from which the lens was found, root mean square, px",
    "Dasselbe für die Ansichten, aus denen das Objektiv bestimmt wurde, quadratisches Mittel, px",
);
pub(super) const TILT: Text = Text::of("Tilt", "Neigung");
pub(super) const TILT_HOVER: Text =
    Text::of("Largest angle between the boards of two views", "Größter Winkel zwischen den Tafeln zweier Ansichten");
pub(super) const FOCAL: Text = Text::of("Focal length", "Brennweite");
pub(super) const FOCAL_DOWN: Text = Text::of("Focal length (vertical)", "Brennweite senkrecht");
pub(super) const FOCAL_HOVER: Text = Text::of("With its standard deviation, px", "Mit Standardabweichung, px");
pub(super) const CENTRE: Text = Text::of("Centre", "Mitte");
pub(super) const CENTRE_HOVER: Text = Text::of(
    "Point where the optical axis meets the image, from the upper left corner, px",
    "Wo die optische Achse das Bild trifft, ab der linken oberen Ecke, px",
);
pub(super) const BEND: Text = Text::of("Distortion", "Verzeichnung");
pub(super) const BEND_HOVER: Text = Text::of(
    "A term that does not improve held-out views is zero",
    "Ein Term ohne Nutzen auf zurückgehaltenen Ansichten ist null",
);
pub(super) const TOUCH_TITLE: Text = Text::of("Touch the board", "Tafel berühren");
pub(super) const TOUCH_HOVER: Text = Text::of(
    "The touched corners give the position of the board in the workspace, and thereby that of the camera",
    "Die berührten Ecken ergeben die Lage der Tafel im Arbeitsraum und damit die der Kamera",
);
pub(super) const LAY_DOWN: Text = Text::of(
    "Put the board down within reach of the tip, and take your hands away",
    "Tafel in Reichweite der Spitze ablegen und Hände wegnehmen",
);
pub(super) const ALL_TOUCHED: Text = Text::of("All corners are touched", "Alle Ecken sind berührt");
pub(super) const MOVED: Text = Text::of(
    "The board or the endoscope has moved: put the board down and touch its corners again",
    "Tafel oder Endoskop hat sich bewegt: Tafel ablegen und neu berühren",
);
pub(super) const TOUCHED: Text = Text::of("Tip is on the corner", "Spitze ist auf der Ecke");
pub(super) const TOUCHED_HOVER: Text = Text::of(
    "Records the tip position; hold the tip still for 0.3 s",
    "Übernimmt den Ort der Spitze; dazu 0.3 s stillhalten",
);
pub(super) const TOUCHED_DISABLED: Text =
    Text::of("Hold the tip still on the marked corner", "Spitze an der markierten Ecke stillhalten");
pub(super) const REMOVE_TOUCH: Text = Text::of("Remove the last corner", "Letzte Ecke entfernen");
pub(super) const LAY_ANEW: Text = Text::of("Reposition the board", "Tafel neu ablegen");
pub(super) const LAY_ANEW_HOVER: Text = Text::of(
    "Discards the touched corners and waits until the board is at rest",
    "Verwirft die Berührungen und wartet, bis die Tafel ruht",
);
pub(super) const TIP_STILL: Text = Text::of("the tip is still", "Spitze ruht");
pub(super) const TIP_MOVES: Text =
    Text::of("the tip is moving, or its position is unknown", "Spitze bewegt sich, oder ihr Ort ist unbekannt");
pub(super) const PLACE_OPTIONAL: Text = Text::of(
    "Without this step only the lens is saved, and no forces are drawn in the image",
    "Ohne diesen Schritt wird nur das Objektiv gespeichert, und im Bild erscheinen keine Kräfte",
);
pub(super) const PLACE_GOOD: Text = Text::of("tip and image agree", "Spitze und Bild stimmen überein");
pub(super) const PLACE_HELD_OUT_HOVER: Text = Text::of(
    "Distance in the image between a touched point and its corner, for a camera position found without this \
     point, px",
    "Abstand im Bild zwischen berührtem Punkt und seiner Ecke, mit einer ohne ihn bestimmten Kamera, px",
);
pub(super) const RIGID: Text = Text::of("Flatness", "Ebenheit");
pub(super) const RIGID_HOVER: Text = Text::of(
    "Distance of the touched points from a rigid board, root mean square",
    "Abstand der berührten Punkte von einer starren Tafel, quadratisches Mittel",
);
pub(super) const NEEDS_BOARD: Text = Text::of("The board cannot be used", "Die Tafel ist nicht verwendbar");
pub(super) const NEEDS_VIEWS: Text = Text::of(
    "At least four views are needed; all requested views are better",
    "Mindestens vier Ansichten, besser alle verlangten",
);
pub(super) const NEEDS_LENS: Text = Text::of(
    "No good lens yet: go back and capture more views",
    "Noch kein gutes Objektiv: zurückgehen und mehr Ansichten aufnehmen",
);
pub(super) const NEEDS_PLACE: Text =
    Text::of("No good position yet: touch the marked corners", "Noch keine gute Lage: die markierten Ecken berühren");

pub(super) fn no_board(why: &str) -> String {
    text_format!("No board: {why}", "Keine Tafel: {why}")
}

pub(super) fn views(count: usize, report: &str) -> String {
    text_format!("{count} captured; {report}", "{count} aufgenommen; {report}")
}

pub(super) fn image(report: &str) -> String {
    text_format!("Endoscope image: {report}", "Endoskopbild: {report}")
}

pub(super) fn covered(fraction: f64) -> String {
    text_format!("{:.0} % of the image covered", "{:.0} % des Bildes abgedeckt", 100.0 * fraction)
}

pub(super) fn left_out(number: usize, why: &str) -> String {
    text_format!("View {number} left out: {why}", "Ansicht {number} ausgelassen: {why}")
}

/// Returns a value with its standard deviation, px.
pub(super) fn with_deviation(value: f64, sd: f64) -> String {
    text_format!("{value:.1} ± {sd:.1} px", "{value:.1} ± {sd:.1} px")
}

/// Returns the distortion, with the standard deviation of its first term.
pub(super) fn bend(bend: &Bend, sd: &Bend) -> String {
    let Bend { k1, k2, p1, p2 } = bend;
    format!("k1 {k1:.4} ± {:.4}, k2 {k2:.4}, p1 {p1:.4}, p2 {p2:.4}", sd.k1)
}

pub(super) fn touch(corner: usize) -> String {
    text_format!(
        "Touch the marked corner with the tip (corner {})",
        "Markierte Ecke mit der Spitze berühren (Ecke {})",
        corner + 1
    )
}

pub(super) fn touched(count: usize, tip: &str) -> String {
    text_format!("{count} corners touched; {tip}", "{count} Ecken berührt; {tip}")
}

pub(super) fn proof(lens_px: Option<f64>, place: Option<(f64, bool)>) -> String {
    let lens = lens_px
        .map_or(word("The lens comes from the rig file", "Das Objektiv ist das der Aufbaudatei").to_owned(), |px| {
            text_format!("Held-out corners: {px:.2} px", "Testecken: {px:.2} px")
        });
    let place = match place {
        None => word("position unknown, no forces are drawn", "Lage unbekannt, keine Kräfte im Bild").to_owned(),
        Some((px, true)) => text_format!(
            "touched corners: {px:.1} px; the position follows the endoscope's marker",
            "berührte Ecken: {px:.1} px; die Lage folgt dem Marker des Endoskops"
        ),
        Some((px, false)) => text_format!(
            "touched corners: {px:.1} px; the position is valid until the endoscope is moved",
            "berührte Ecken: {px:.1} px; die Lage gilt, bis das Endoskop bewegt wird"
        ),
    };
    format!("{lens}; {place}")
}
