//! The endoscope image.

use std::time::Duration;

use crate::language::{Text, text_format, word};

pub const WAITING: Text = Text::of("Waiting for the endoscope image", "Wartet auf das Endoskopbild");
pub const ENDOSCOPE: Text = Text::of("Endoscope", "Endoskop");
pub const STILL: Text = Text::of("Still image", "Einzelbild, unbewegt");
pub const BLACK: Text = Text::of("Image is black", "Bild ist schwarz");
pub const BLACK_CURE: Text = Text::of(
    "Switch on the light source and remove the lens cap",
    "Lichtquelle einschalten und Kappe vom Objektiv nehmen",
);
pub const FROZEN_CURE: Text =
    Text::of("This image is old. Check the camera and its cable.", "Dieses Bild ist alt. Kamera und Kabel prüfen.");
pub const LATE_CURE: Text = Text::of(
    "Move slowly. Connect the camera to its own port, or set a smaller image.",
    "Langsam bewegen. Kamera an einen eigenen Anschluss legen oder ein kleineres Bild einstellen.",
);
pub const DAMAGED_CURE: Text = Text::of(
    "An earlier image may be shown. Check the camera's image format and cable.",
    "Gezeigt wird evtl. ein früheres Bild. Bildformat und Kabel der Kamera prüfen.",
);
pub const SIZE_CURE: Text = Text::of(
    "Set the camera to the image size in the rig file. Until then no forces are drawn.",
    "Kamera auf die Größe der Aufbaudatei stellen. Bis dahin erscheinen keine Kräfte.",
);
pub const FORCES_DRAWN: Text =
    Text::of("Forces are drawn at the tips; O hides them", "Kräfte an den Spitzen; O blendet sie aus");
pub const FORCES_AHEAD: Text =
    Text::of("Current forces, ahead of the image; O hides them", "Aktuelle Kräfte, dem Bild voraus; O blendet sie aus");
pub const FORCES_HIDDEN: Text =
    Text::of("Forces are hidden; O draws them at the tips", "Kräfte ausgeblendet; O zeigt sie an den Spitzen");
pub const BASE_MISSING: Text = Text::of(
    "the image that it depends on is not in the session",
    "das Bild, auf dem es aufbaut, fehlt in der Sitzung",
);
pub const NOT_RECORDED: Text = Text::of(
    "Not in the session: only JPEG and H.264 images are recorded",
    "Nicht in der Sitzung: nur JPEG und H.264 werden aufgezeichnet",
);
pub const LEFT_HALF: Text = Text::of("Left image; V shows the right image", "Linkes Bild; V zeigt das rechte");
pub const RIGHT_HALF: Text = Text::of("Right image; V shows both", "Rechtes Bild; V zeigt beide");
pub const RIGHT_WITHOUT_FORCES: Text = Text::of(
    "Right image without forces: the rig file has no endoscope.baseline_m; V shows both",
    "Rechtes Bild ohne Kräfte: endoscope.baseline_m fehlt in der Aufbaudatei; V zeigt beide",
);
pub const BOTH_HALVES: Text = Text::of("Both images; V shows the left image", "Beide Bilder; V zeigt das linke");
pub const NO_CAMERA: Text = Text::of(
    "No forces are drawn: the rig file has no [endoscope.camera]",
    "Keine Kräfte im Bild: [endoscope.camera] fehlt in der Aufbaudatei",
);

pub const NO_MARKER: Text = Text::of(
    "No forces are drawn: the tracker does not see the endoscope's marker, or there is no hand-eye calibration",
    "Keine Kräfte im Bild: Der Tracker sieht den Marker des Endoskops nicht, oder die Hand-Auge-Kalibrierung fehlt",
);
pub const NO_PLACE: Text = Text::of(
    "No forces are drawn: the camera position is unknown; calibrate the camera",
    "Keine Kräfte im Bild: Lage der Kamera unbekannt; Kamera kalibrieren",
);

pub fn forces_off(off_px: f64) -> String {
    text_format!(
        "Forces are drawn {off_px:.0} px or more away from the tips: calibrate the camera; O hides them",
        "Kräfte liegen {off_px:.0} px oder mehr neben den Spitzen: Kamera kalibrieren; O blendet sie aus"
    )
}

pub fn frozen(stood: Duration) -> String {
    text_format!(
        "Image is frozen: no new image for {:.1} s",
        "Bild steht: seit {:.1} s nichts Neues",
        stood.as_secs_f64()
    )
}

pub fn late(late: Duration) -> String {
    text_format!("Image is {} ms old", "Bild ist {} ms alt", 10 * (late.as_millis() / 10))
}

pub fn damaged(why: &str) -> String {
    text_format!("Image is damaged: {why}", "Bild ist beschädigt: {why}")
}

/// Returns the sizes in px.
pub fn size([width, height]: [usize; 2], [wanted_width, wanted_height]: [usize; 2]) -> String {
    text_format!(
        "Image is {width} x {height} pixels, not {wanted_width} x {wanted_height}",
        "Bild hat {width} x {height} Pixel, nicht {wanted_width} x {wanted_height}"
    )
}

pub fn lost(why: &str) -> String {
    text_format!("Image is lost: {why}", "Bild verloren: {why}")
}

pub fn refused(why: &str) -> String {
    text_format!("No image: {why}", "Kein Bild: {why}")
}

/// Remedy for an unusable address.
pub const REFUSED_CURE: Text =
    Text::of("Correct endoscope.url in the rig file", "endoscope.url in der Aufbaudatei korrigieren");

pub fn figures(age: Duration, rate_hz: f64) -> String {
    text_format!("{} ms old, {rate_hz:.0} images per second", "{} ms alt, {rate_hz:.0} Bilder/s", age.as_millis())
}

pub fn recorded(age: Duration) -> String {
    text_format!("Recorded image, {} ms old then", "Aufgezeichnetes Bild, damals {} ms alt", age.as_millis())
}

pub const SEARCHING: Text = Text::of("Searching for the image at this time", "Sucht das Bild dieses Moments");

pub fn none_then(why: Option<&str>) -> String {
    why.map_or_else(
        || {
            word("No image in the two seconds before this time", "Kein Bild in den zwei Sekunden vor diesem Moment")
                .to_owned()
        },
        |why| text_format!("The image at this time cannot be read: {why}", "Bild dieses Moments nicht lesbar: „{why}“"),
    )
}

pub fn zoomed(zoom: f32) -> String {
    text_format!(
        "Zoom {zoom:.1}; drag to move, double-click to show all",
        "Zoom {zoom:.1}; Ziehen verschiebt, Doppelklick zeigt alles"
    )
}

pub fn tip(side: &str) -> String {
    let after = side.to_lowercase();
    text_format!("{side} tip", "Spitze {after}")
}

pub fn image(standing: &str) -> String {
    text_format!("Endoscope image: {standing}", "Endoskopbild: {standing}")
}

/// Image without a problem.
pub const LIVE: Text = Text::of("live", "live");

pub fn force(size_n: f64) -> String {
    format!("{size_n:.1} N")
}
