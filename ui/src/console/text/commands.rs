//! Names of the commands, what each does, where it is, and why it may not be possible now.

pub(in crate::console) const STOP: &str = "Stop";
pub(in crate::console) const STOP_DOES: &str =
    "No force, no motion, in every view. While you type, only Escape does it.";
pub(in crate::console) const ENGAGE: &str = "Engage";
pub(in crate::console) const ENGAGE_DOES: &str = "Starts motion and force feedback";
pub(in crate::console) const RELEASE: &str = "Release stop";
pub(in crate::console) const RELEASE_DOES: &str = "Returns from a stop or a fault to idle, still without force";
pub(in crate::console) const RIG: &str = "Rig and scene";
pub(in crate::console) const RIG_DOES: &str = "The page on which a rig and a scene are chosen and made";
pub(in crate::console) const SESSIONS: &str = "Recorded sessions";
pub(in crate::console) const SESSIONS_DOES: &str = "The list of recorded sessions: look at one, keep it, report on it";
pub(in crate::console) const STUDIES: &str = "User studies";
pub(in crate::console) const STUDIES_DOES: &str = "The page on which studies are made and gone on with";
pub(in crate::console) const ALARMS: &str = "Alarms";
pub(in crate::console) const ALARMS_DOES: &str = "The list of the last alarms";
pub(in crate::console) const GLOSSARY: &str = "Glossary";
pub(in crate::console) const GLOSSARY_DOES: &str = "This list of keys and terms";
pub(in crate::console) const TOUR: &str = "Tour";
pub(in crate::console) const TOUR_DOES: &str = "Four steps through the screen";
pub(in crate::console) const PALETTE: &str = "All commands";
pub(in crate::console) const PALETTE_DOES: &str = "Finds a command by its name and does it";
pub(in crate::console) const ACKNOWLEDGE: &str = "Acknowledge the alarms";
pub(in crate::console) const ACKNOWLEDGE_DOES: &str = "Ends flashing and sound; an alarm stays while its cause does";
pub(in crate::console) const MARK: &str = "Mark this moment";
pub(in crate::console) const MARK_DOES: &str = "In the traces and in the session that is being recorded";
pub(in crate::console) const KEEP: &str = "Keep the session";
pub(in crate::console) const KEEP_DOES: &str = "The session that is being recorded is kept, or no longer";
pub(in crate::console) const UNDO: &str = "Undo";
pub(in crate::console) const UNDO_DOES: &str =
    "Takes back the last change of the arrangement or the look of the screen, nothing else";
pub(in crate::console) const REDO: &str = "Redo";
pub(in crate::console) const REDO_DOES: &str = "Makes again what was taken back";
pub(in crate::console) const DARK: &str = "Dark colours";
pub(in crate::console) const DARK_DOES: &str = "For a dark room";
pub(in crate::console) const LIGHT: &str = "Light colours";
pub(in crate::console) const LIGHT_DOES: &str = "For a bright room and for printing";
pub(in crate::console) const LARGER: &str = "Larger";
pub(in crate::console) const LARGER_DOES: &str = "Makes everything larger, as far as the window has room";
pub(in crate::console) const SMALLER: &str = "Smaller";
pub(in crate::console) const SMALLER_DOES: &str = "Makes everything smaller";
pub(in crate::console) const SIZE_DOES: &str = "Size of texts and controls, as far as the window has room";
pub(in crate::console) const RESET_LAYOUT: &str = "Reset the layout";
pub(in crate::console) const PAUSE: &str = "Hold the traces, or go on";
pub(in crate::console) const DRIVE: &str = "Drive by mouse, or let go";
pub(in crate::console) const DRIVE_DOES: &str = "Mouse and keys move the instrument";
pub(in crate::console) const OTHER_HAND: &str = "Drive the other instrument";
pub(in crate::console) const OTHER_HAND_DOES: &str =
    "While you drive: the one before stays where it is and holds what it holds";
pub(in crate::console) const JAWS: &str = "Open or close the jaws";
pub(in crate::console) const JAWS_DOES: &str = "In a scene with rings, of the instrument that you drive";
pub(in crate::console) const MARK_PLACE: &str = "Mark the place under the tip";
pub(in crate::console) const MARK_PLACE_DOES: &str = "In a palpation, of the instrument that you drive";
pub(in crate::console) const END_TRIAL: &str = "End the trial";
pub(in crate::console) const END_TRIAL_DOES: &str = "In a palpation: the result is told";
pub(in crate::console) const BEGIN_TRIAL: &str = "Begin the trial anew";
pub(in crate::console) const BEGIN_TRIAL_DOES: &str = "In a palpation or on a wire";
pub(in crate::console) const HIDE_FORCES: &str = "Forces in the endoscope's picture";
pub(in crate::console) const HIDE_FORCES_DOES: &str = "Draws the forces into the endoscope's picture, or hides them";
pub(in crate::console) const LENS: &str = "The other lens";
pub(in crate::console) const LENS_DOES: &str =
    "Of an endoscope with two lenses: shows the left picture, the right one, or both";
pub(in crate::console) const LEAVE_PAST: &str = "Live again";
pub(in crate::console) const LEAVE_PAST_DOES: &str = "Leaves the recorded session: the screen shows the machine again";
pub(in crate::console) const PLAY: &str = "Play or hold the session";
pub(in crate::console) const PLAY_DOES: &str = "In a recorded session";
pub(in crate::console) const BACK: &str = "A second back";
pub(in crate::console) const ON: &str = "A second on";
pub(in crate::console) const BACK_FINE: &str = "10 ms back";
pub(in crate::console) const ON_FINE: &str = "10 ms on";

/// Where the commands are.
pub(in crate::console) const AT_BAR: &str = "Top bar";
pub(in crate::console) const AT_VIEW_MENU: &str = "View menu";
pub(in crate::console) const AT_ALARMS: &str = "Alarm strip";
pub(in crate::console) const AT_CALIBRATION: &str = "Panel Calibration";
pub(in crate::console) const AT_TRACES: &str = "Panel Traces";
pub(in crate::console) const AT_FIELD: &str = "Operating field";
pub(in crate::console) const AT_PICTURE: &str = "Endoscope's picture";
pub(in crate::console) const AT_PAST: &str = "Recorded session";
pub(in crate::console) const AT_KEYS: &str = "Keyboard";

/// Why a command is not possible now.
pub(in crate::console) const IS_ENGAGED: &str = "It is engaged, or about to be";
pub(in crate::console) const RELEASE_FIRST: &str = "Release the stop first";
pub(in crate::console) const NOT_STOPPED: &str = "Nothing is stopped";
pub(in crate::console) const IS_STARTING: &str = "A rig is being started";
pub(in crate::console) const STUDY_IS_OPEN: &str = "A study is open: close it first";
pub(in crate::console) const NOTHING_RECORDED: &str = "No session is being recorded";
pub(in crate::console) const NO_ALARM: &str = "Every alarm is acknowledged";
pub(in crate::console) const NOTHING_TO_UNDO: &str = "Nothing was changed since the window was opened";
pub(in crate::console) const NOTHING_TO_REDO: &str = "Nothing was taken back";
pub(in crate::console) const IS_PLAIN: &str = "It is shown as it comes";
pub(in crate::console) const PANEL_IS_CLOSED: &str = "Open the panel Traces first";
pub(in crate::console) const FIELD_IS_HIDDEN: &str = "Bring the operating field to the front first";
pub(in crate::console) const NOT_NOW: &str = "Only while the loop is idle or engaged";
pub(in crate::console) const DRIVE_FIRST: &str = "Drive the instrument first (M)";

/// Prefixes of keys.
pub(in crate::console) const CTRL: &str = "Ctrl ";
pub(in crate::console) const SHIFT: &str = "Shift ";
pub(in crate::console) const CTRL_SHIFT: &str = "Ctrl Shift ";

/// The palette.
pub(in crate::console) const SEARCH: &str = "Find a command";
pub(in crate::console) const NONE_FOUND: &str = "No command of this name can be reached from here";
pub(in crate::console) const ONCE_MORE: &str = "Press Enter once more, or click again";
pub(in crate::console) const FOOT: &str = "Enter does it, Ctrl P closes this list, Escape stops the arm";

/// What is done by hand and has no name.
pub(in crate::console) const BY_HAND: [(&str, &str); 6] = [
    ("Wheel", "Zooms the endoscope's picture. Drag moves it, a double click shows all of it."),
    ("Arrow keys", "Move the instrument by a small step while you drive it"),
    ("Page Up, Page Down", "Move the instrument up or down while you drive it"),
    ("Tab, Shift Tab", "Select the next or the previous control; it gets a frame"),
    ("Enter", "Presses the selected control"),
    ("Ctrl Tab", "Shows the next tab of the group under the pointer"),
];

/// Name of a view's command.
pub(in crate::console) fn view(name: &str) -> String {
    format!("View: {name}")
}

/// Name of a panel's command.
pub(in crate::console) fn panel(name: &str) -> String {
    format!("Panel: {name}")
}

/// Name of the command that sets the size.
pub(in crate::console) fn size(percent: u16) -> String {
    format!("Size {percent} %")
}

/// A name with its keys, on a button.
pub(in crate::console) fn with_keys(name: &str, keys: &str) -> String {
    format!("{name} ({keys})")
}

/// Hover text of a command.
pub(in crate::console) fn hover(does: &str, place: &str) -> String {
    format!("{does}\n{place}")
}

/// In the list of keys.
pub(in crate::console) fn key_meaning(name: &str, does: &str) -> String {
    format!("{name}: {does}")
}
