//! The View menu.

use crate::language::Text;

pub(in crate::console) const VIEW: Text = Text::of("View", "View");
pub(in crate::console) const PALETTE: Text = Text::of("Palette", "Palette");
pub(in crate::console) const DARK: Text = Text::of("Dark", "Dark");
pub(in crate::console) const LIGHT: Text = Text::of("Light", "Light");
pub(in crate::console) const LANGUAGE: Text = Text::of("Language", "Sprache");
pub(in crate::console) const SIZE: Text =
    Text::of("Text and control size (Ctrl + and Ctrl -)", "Text and control size (Ctrl + and Ctrl -)");
pub(in crate::console) const SIZE_NOTE: Text =
    Text::of("Limited to what fits into this window", "Limited to what fits into this window");
pub(in crate::console) const VIEW_HOVER: Text = Text::of(
    "Light or dark colours, size, sound, alarms, glossary, tour and panels",
    "Light or dark colours, size, sound, alarms, glossary, tour and panels",
);
pub(in crate::console) const SOUND_HOVER: Text = Text::of(
    "Ten pulses for an alarm, three for a warning, repeated until it is acknowledged",
    "Ten pulses for an alarm, three for a warning, repeated until it is acknowledged",
);
pub(in crate::console) const SOUND: Text = Text::of("Alarm sound", "Alarm sound");
pub(in crate::console) const PICTURE: Text = Text::of("Endoscope's picture", "Endoscope's picture");
pub(in crate::console) const BRIGHTNESS: Text = Text::of("Brightness", "Brightness");
pub(in crate::console) const CONTRAST: Text = Text::of("Contrast", "Contrast");
pub(in crate::console) const GAMMA: Text = Text::of("Gamma", "Gamma");
pub(in crate::console) const CROP: Text = Text::of("Crop", "Crop");
pub(in crate::console) const CROP_HOVER: Text = Text::of(
    "What is cut off at the edges of the picture as it comes: left, top, right, bottom",
    "What is cut off at the edges of the picture as it comes: left, top, right, bottom",
);
pub(in crate::console) const EDGES: [Text; 4] = [
    Text::of("Crop at the left", "Crop at the left"),
    Text::of("Crop at the top", "Crop at the top"),
    Text::of("Crop at the right", "Crop at the right"),
    Text::of("Crop at the bottom", "Crop at the bottom"),
];
pub(in crate::console) const FORCES_OF_NOW: Text =
    Text::of("Draw forces of now, ahead of the picture", "Draw forces of now, ahead of the picture");
pub(in crate::console) const FORCES_OF_NOW_HOVER: Text = Text::of(
    "At the tips as they are now. Otherwise they are those of the picture's moment, and lie on the tips that are seen.",
    "At the tips as they are now. Otherwise they are those of the picture's moment, and lie on the tips that are seen.",
);
pub(in crate::console) const PICTURE_PLAIN: Text =
    Text::of("Show the picture as it comes", "Show the picture as it comes");
pub(in crate::console) const PICTURE_PLAIN_HOVER: Text = Text::of(
    "With the camera's own brightness and colours, not cropped",
    "With the camera's own brightness and colours, not cropped",
);
pub(in crate::console) const RECORDS_PICTURE: Text =
    Text::of("Record the endoscope's picture", "Record the endoscope's picture");
pub(in crate::console) const RECORDS_PICTURE_HOVER: Text = Text::of(
    "In sessions, as the camera sends it: some 60 to 200 MB a minute more",
    "In sessions, as the camera sends it: some 60 to 200 MB a minute more",
);
pub(in crate::console) const PANELS: Text = Text::of("Panels", "Panels");
pub(in crate::console) const PANELS_HOVER: Text = Text::of(
    "Drag a panel's title to move it, drag an edge to resize it",
    "Drag a panel's title to move it, drag an edge to resize it",
);
pub(in crate::console) const PANEL_OPEN_HOVER: Text = Text::of("Open: click to close it", "Open: click to close it");
pub(in crate::console) const PANEL_CLOSED_HOVER: Text =
    Text::of("Closed: click to open it where it was", "Closed: click to open it where it was");
pub(in crate::console) const RESET_LAYOUT_HOVER: Text =
    Text::of("Opens all panels at their original places", "Opens all panels at their original places");
