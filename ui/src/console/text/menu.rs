//! Words of the room `menu`.

pub(in crate::console) const VIEW: &str = "View";
pub(in crate::console) const PALETTE: &str = "Palette";
pub(in crate::console) const DARK: &str = "Dark";
pub(in crate::console) const LIGHT: &str = "Light";
pub(in crate::console) const SIZE_OF_EVERYTHING_CTRL: &str = "Size of everything (Ctrl + and Ctrl -)";
pub(in crate::console) const NEVER_LARGER_THAN_THIS: &str = "Never larger than this window has room for.";
pub(in crate::console) const ALARMS_F5: &str = "Alarms (F5)";
pub(in crate::console) const GLOSSARY_F4: &str = "Glossary (F4)";
pub(in crate::console) const TOUR: &str = "Tour";
pub(in crate::console) const LIGHT_OR_DARK_HOW: &str = "Light or dark, how large; glossary and tour.";
pub(in crate::console) const A_BURST_OF_TEN: &str =
    "A burst of ten pulses for an alarm, of three for a warning, again and again until it is acknowledged.";
pub(in crate::console) const ALARMS_SOUND: &str = "Alarms sound";
pub(in crate::console) const PANELS: &str = "Panels";
pub(in crate::console) const DRAG_A_PANEL_S: &str =
    "Drag a panel's title to put it elsewhere, an edge to make it larger.";
pub(in crate::console) const ON_THE_DESK_CLOSES: &str = "On the desk; closes it.";
pub(in crate::console) const CLOSED_PUTS_IT_BACK: &str = "Closed; puts it back where it was.";
pub(in crate::console) const RESET_THE_LAYOUT: &str = "Reset the layout";
pub(in crate::console) const ALL_PANELS_OPEN_WHERE: &str = "All panels open, where they lay at first.";
