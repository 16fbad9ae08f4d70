//! How to arrange the panels; the name of each is with its texts.

use crate::language::{Text, text_format};

pub const ALL_CLOSED: Text = Text::of(
    "All panels are closed; open them in the View menu",
    "Alle Panels sind geschlossen; im Menü Ansicht \
     öffnen",
);
pub const DRAG_HOVER: Text = Text::of(
    "Drag the title to move the panel; right-click it for its own window",
    "Am Titel ziehen verschiebt das Panel; Rechtsklick öffnet ein eigenes Fenster",
);
pub const OPEN_WINDOW: Text = Text::of("Open in its own window", "In eigenem Fenster öffnen");
pub const OPEN_WINDOW_HOVER: Text = Text::of(
    "Opens the panel in its own window, for a second monitor; closing that window returns it",
    "Öffnet das Panel in einem eigenen Fenster, etwa auf einem zweiten Bildschirm; wird es geschlossen, kehrt das Panel \
     zurück",
);
pub const CLOSE_WINDOW: Text = Text::of("Back to the main window", "Zurück ins Hauptfenster");
pub const CLOSE_WINDOW_HOVER: Text = Text::of(
    "Closes this window and returns the panel to its place in the main window",
    "Schließt dieses Fenster und zeigt das Panel an seinem Platz im Hauptfenster",
);
pub const FIELD_IN_VIEW: Text =
    Text::of("This view shows the field in the main window", "Diese Ansicht zeigt das Feld im Hauptfenster");
pub const LOCKED: Text = Text::of(
    "A page in the main window is using the machine: the controls here are disabled",
    "Die Seite im Hauptfenster benutzt die Maschine: die Bedienelemente hier ruhen",
);

/// Returns the title of the window of a panel.
pub fn window_title(panel: &str) -> String {
    text_format!("{panel} \u{2013} NIMA Console", "{panel} \u{2013} NIMA Console")
}

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
    "Layout with every panel: prediction error, degrees, timing and gates are visible too",
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
