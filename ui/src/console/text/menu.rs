//! The View menu.

pub(in crate::console) const VIEW: &str = "View";
pub(in crate::console) const PALETTE: &str = "Palette";
pub(in crate::console) const DARK: &str = "Dark";
pub(in crate::console) const LIGHT: &str = "Light";
pub(in crate::console) const SIZE: &str = "Text and control size (Ctrl + and Ctrl -)";
pub(in crate::console) const SIZE_NOTE: &str = "Limited to what fits into this window";
pub(in crate::console) const VIEW_HOVER: &str = "Light or dark colours, size, sound, alarms, glossary, tour and panels";
pub(in crate::console) const SOUND_HOVER: &str =
    "Ten pulses for an alarm, three for a warning, repeated until it is acknowledged";
pub(in crate::console) const SOUND: &str = "Alarm sound";
pub(in crate::console) const PICTURE: &str = "Endoscope's picture";
pub(in crate::console) const BRIGHTNESS: &str = "Brightness";
pub(in crate::console) const CONTRAST: &str = "Contrast";
pub(in crate::console) const GAMMA: &str = "Gamma";
pub(in crate::console) const CROP: &str = "Crop";
pub(in crate::console) const CROP_HOVER: &str =
    "What is cut off at the edges of the picture as it comes: left, top, right, bottom";
pub(in crate::console) const EDGES: [&str; 4] =
    ["Crop at the left", "Crop at the top", "Crop at the right", "Crop at the bottom"];
pub(in crate::console) const FORCES_OF_NOW: &str = "Draw forces of now, ahead of the picture";
pub(in crate::console) const FORCES_OF_NOW_HOVER: &str =
    "At the tips as they are now. Otherwise they are those of the picture's moment, and lie on the tips that are seen.";
pub(in crate::console) const PICTURE_PLAIN: &str = "Show the picture as it comes";
pub(in crate::console) const PICTURE_PLAIN_HOVER: &str = "With the camera's own brightness and colours, not cropped";
pub(in crate::console) const RECORDS_PICTURE: &str = "Record the endoscope's picture";
pub(in crate::console) const RECORDS_PICTURE_HOVER: &str =
    "In sessions, as the camera sends it: some 60 to 200 MB a minute more";
pub(in crate::console) const PANELS: &str = "Panels";
pub(in crate::console) const PANELS_HOVER: &str = "Drag a panel's title to move it, drag an edge to resize it";
pub(in crate::console) const PANEL_OPEN_HOVER: &str = "Open: click to close it";
pub(in crate::console) const PANEL_CLOSED_HOVER: &str = "Closed: click to open it where it was";
pub(in crate::console) const RESET_LAYOUT_HOVER: &str = "Opens all panels at their original places";
