//! The View menu.

use crate::language::{Text, text_format};

pub const VIEW: Text = Text::of("View", "Ansicht");
pub const PALETTE: Text = Text::of("Colours", "Farben");
pub const DARK: Text = Text::of("Dark", "Dunkel");
pub const LIGHT: Text = Text::of("Light", "Hell");
pub const COLOUR_BLIND: Text = Text::of("Colours for colour-blind users", "Farben für Farbenblinde");
pub const COLOUR_BLIND_HOVER: Text = Text::of(
    "Blue and orange instead of green, which many people cannot distinguish from red",
    "Blau und Orange statt Grün, das viele nicht von Rot unterscheiden",
);
pub const TOUCH: Text = Text::of("Large controls for touch", "Große Elemente für Finger");
pub const TOUCH_HOVER: Text = Text::of(
    "Buttons, sliders and scroll bars that a finger can hit; the text keeps its size",
    "Schaltflächen, Regler und Rollbalken, die ein Finger trifft; der Text behält seine Größe",
);
pub const LANGUAGE: Text = Text::of("Language", "Sprache");
pub const SIZE: Text =
    Text::of("Text and control size (Ctrl + and Ctrl -)", "Größe von Text und Elementen (Ctrl + und Ctrl -)");
pub const SIZE_NOTE: Text = Text::of("Limited to what fits in this window", "Soweit es in dieses Fenster passt");
pub const VIEW_HOVER: Text = Text::of(
    "Light or dark colours, size, sound, alarms, glossary, tour and panels",
    "Helle oder dunkle Farben, Größe, Ton, Alarme, Glossar, Rundgang und Panels",
);
pub const SOUND_HOVER: Text = Text::of(
    "Ten pulses for an alarm, three for a warning, repeated until it is acknowledged",
    "Zehn Töne bei Alarm, drei bei Warnung, wiederholt bis zum Quittieren",
);
pub const SOUND: Text = Text::of("Alarm sound", "Alarmton");
pub const IMAGE: Text = Text::of("Endoscope image", "Endoskopbild");
pub const BRIGHTNESS: Text = Text::of("Brightness", "Helligkeit");
pub const CONTRAST: Text = Text::of("Contrast", "Kontrast");
pub const GAMMA: Text = Text::of("Gamma", "Gamma");
pub const CROP: Text = Text::of("Crop", "Zuschnitt");
pub const CROP_HOVER: Text = Text::of(
    "Amount cut off at the edges of the camera image: left, top, right, bottom",
    "Was an den Rändern des Originalbilds wegfällt: links, oben, rechts, unten",
);
pub const EDGES: [Text; 4] = [
    Text::of("Crop at the left", "Links abschneiden"),
    Text::of("Crop at the top", "Oben abschneiden"),
    Text::of("Crop at the right", "Rechts abschneiden"),
    Text::of("Crop at the bottom", "Unten abschneiden"),
];
pub const FORCES_OF_NOW: Text =
    Text::of("Draw current forces, ahead of the image", "Aktuelle Kräfte zeichnen, dem Bild voraus");
pub const FORCES_OF_NOW_HOVER: Text = Text::of(
    "Draws the forces at the current tip positions. Otherwise the forces belong to the time of the image and are \
     drawn on the visible tips.",
    "Zeichnet die Kräfte an den jetzigen Orten der Spitzen. Sonst gehören die Kräfte zum Zeitpunkt des Bildes \
     und liegen auf den sichtbaren Spitzen.",
);
pub const IMAGE_PLAIN: Text = Text::of("Show the unmodified image", "Originalbild zeigen");
pub const IMAGE_PLAIN_HOVER: Text = Text::of(
    "With the camera's own brightness and colours, not cropped",
    "Mit Helligkeit und Farben der Kamera, nicht zugeschnitten",
);
pub const RECORDS_IMAGE: Text = Text::of("Record the endoscope image", "Endoskopbild aufzeichnen");
pub const RECORDS_IMAGE_HOVER: Text = Text::of(
    "In sessions, as the camera sends it: about 60 to 200 MB more per minute",
    "In Sitzungen, so wie die Kamera es sendet: etwa 60 bis 200 MB mehr pro Minute",
);
pub const LAYOUT: Text = Text::of("Layout", "Layout");
pub const LAYOUT_HOVER: Text = Text::of(
    "Positions of the panels: built in, or your own, saved by name",
    "Anordnung der Panels: eingebaut oder eigene, unter einem Namen gesichert",
);
pub const LAYOUT_NAME: Text = Text::of("Name of this layout", "Name dieses Layouts");
pub const SAVE_LAYOUT: Text = Text::of("Save", "Sichern");
pub const SAVE_LAYOUT_HOVER: Text = Text::of(
    "Saves the current positions of the panels under this name",
    "Sichert die jetzige Anordnung der Panels unter diesem Namen",
);
pub const NAME_LAYOUT_FIRST: Text = Text::of("Enter a name first", "Erst einen Namen eingeben");
pub const PANELS: Text = Text::of("Panels", "Panels");
pub const PANELS_HOVER: Text = Text::of(
    "Drag a panel's title to move it, drag an edge to resize it",
    "Titel ziehen verschiebt ein Panel, Rand ziehen ändert die Größe",
);
pub const PANEL_OPEN_HOVER: Text = Text::of("Open: click to close it", "Offen: Klick schließt es");
pub const PANEL_CLOSED_HOVER: Text =
    Text::of("Closed: click to open it where it was", "Geschlossen: Klick öffnet es am alten Platz");
pub const RESET_LAYOUT_HOVER: Text = Text::of(
    "Opens all panels in the original positions of this layout",
    "Öffnet alle Panels am ursprünglichen Platz dieses Layouts",
);

/// Returns the accessible name of the button that removes a saved layout.
pub fn remove_layout(name: &str) -> String {
    text_format!("Remove layout {name}", "Layout {name} entfernen")
}
