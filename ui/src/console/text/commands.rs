//! Names of the commands, what each does, where it is, and why it may not be possible now.

use crate::language::{Text, told};

pub(in crate::console) const STOP: Text = Text::of("Stop", "Stop");
pub(in crate::console) const STOP_DOES: Text = Text::of(
    "No force, no motion, in every view. While you type, only Escape does it.",
    "No force, no motion, in every view. While you type, only Escape does it.",
);
pub(in crate::console) const ENGAGE: Text = Text::of("Engage", "Engage");
pub(in crate::console) const ENGAGE_DOES: Text =
    Text::of("Starts motion and force feedback", "Starts motion and force feedback");
pub(in crate::console) const RELEASE: Text = Text::of("Release stop", "Release stop");
pub(in crate::console) const RELEASE_DOES: Text = Text::of(
    "Returns from a stop or a fault to idle, still without force",
    "Returns from a stop or a fault to idle, still without force",
);
pub(in crate::console) const RIG: Text = Text::of("Rig and scene", "Rig and scene");
pub(in crate::console) const RIG_DOES: Text = Text::of(
    "The page on which a rig and a scene are chosen and made",
    "The page on which a rig and a scene are chosen and made",
);
pub(in crate::console) const SESSIONS: Text = Text::of("Recorded sessions", "Recorded sessions");
pub(in crate::console) const SESSIONS_DOES: Text = Text::of(
    "The list of recorded sessions: look at one, keep it, report on it",
    "The list of recorded sessions: look at one, keep it, report on it",
);
pub(in crate::console) const STUDIES: Text = Text::of("User studies", "User studies");
pub(in crate::console) const STUDIES_DOES: Text = Text::of(
    "The page on which studies are made and gone on with",
    "The page on which studies are made and gone on with",
);
pub(in crate::console) const ALARMS: Text = Text::of("Alarms", "Alarms");
pub(in crate::console) const ALARMS_DOES: Text = Text::of("The list of the last alarms", "The list of the last alarms");
pub(in crate::console) const GLOSSARY: Text = Text::of("Glossary", "Glossary");
pub(in crate::console) const GLOSSARY_DOES: Text =
    Text::of("This list of keys and terms", "This list of keys and terms");
pub(in crate::console) const TOUR: Text = Text::of("Tour", "Tour");
pub(in crate::console) const TOUR_DOES: Text =
    Text::of("Four steps through the screen", "Four steps through the screen");
pub(in crate::console) const PALETTE: Text = Text::of("All commands", "All commands");
pub(in crate::console) const PALETTE_DOES: Text =
    Text::of("Finds a command by its name and does it", "Finds a command by its name and does it");
pub(in crate::console) const ACKNOWLEDGE: Text = Text::of("Acknowledge the alarms", "Acknowledge the alarms");
pub(in crate::console) const ACKNOWLEDGE_DOES: Text = Text::of(
    "Ends flashing and sound; an alarm stays while its cause does",
    "Ends flashing and sound; an alarm stays while its cause does",
);
pub(in crate::console) const MARK: Text = Text::of("Mark this moment", "Mark this moment");
pub(in crate::console) const MARK_DOES: Text = Text::of(
    "In the traces and in the session that is being recorded",
    "In the traces and in the session that is being recorded",
);
pub(in crate::console) const KEEP: Text = Text::of("Keep the session", "Keep the session");
pub(in crate::console) const KEEP_DOES: Text = Text::of(
    "The session that is being recorded is kept, or no longer",
    "The session that is being recorded is kept, or no longer",
);
pub(in crate::console) const UNDO: Text = Text::of("Undo", "Undo");
pub(in crate::console) const UNDO_DOES: Text = Text::of(
    "Takes back the last change of the arrangement or the look of the screen, nothing else",
    "Takes back the last change of the arrangement or the look of the screen, nothing else",
);
pub(in crate::console) const REDO: Text = Text::of("Redo", "Redo");
pub(in crate::console) const REDO_DOES: Text =
    Text::of("Makes again what was taken back", "Makes again what was taken back");
pub(in crate::console) const DARK: Text = Text::of("Dark colours", "Dark colours");
pub(in crate::console) const DARK_DOES: Text = Text::of("For a dark room", "For a dark room");
pub(in crate::console) const LIGHT: Text = Text::of("Light colours", "Light colours");
pub(in crate::console) const LIGHT_DOES: Text =
    Text::of("For a bright room and for printing", "For a bright room and for printing");
pub(in crate::console) const LANGUAGE_DOES: Text = Text::of(
    "The language of the window. The command line and what is written into files stay English.",
    "Die Sprache des Fensters. Die Befehlszeile und alles, was in Dateien geschrieben wird, bleiben Englisch.",
);
pub(in crate::console) const LARGER: Text = Text::of("Larger", "Larger");
pub(in crate::console) const LARGER_DOES: Text = Text::of(
    "Makes everything larger, as far as the window has room",
    "Makes everything larger, as far as the window has room",
);
pub(in crate::console) const SMALLER: Text = Text::of("Smaller", "Smaller");
pub(in crate::console) const SMALLER_DOES: Text = Text::of("Makes everything smaller", "Makes everything smaller");
pub(in crate::console) const SIZE_DOES: Text = Text::of(
    "Size of texts and controls, as far as the window has room",
    "Size of texts and controls, as far as the window has room",
);
pub(in crate::console) const RESET_LAYOUT: Text = Text::of("Reset the layout", "Reset the layout");
pub(in crate::console) const PAUSE: Text = Text::of("Hold the traces, or go on", "Hold the traces, or go on");
pub(in crate::console) const DRIVE: Text = Text::of("Drive by mouse, or let go", "Drive by mouse, or let go");
pub(in crate::console) const DRIVE_DOES: Text =
    Text::of("Mouse and keys move the instrument", "Mouse and keys move the instrument");
pub(in crate::console) const OTHER_HAND: Text = Text::of("Drive the other instrument", "Drive the other instrument");
pub(in crate::console) const OTHER_HAND_DOES: Text = Text::of(
    "While you drive: the one before stays where it is and holds what it holds",
    "While you drive: the one before stays where it is and holds what it holds",
);
pub(in crate::console) const JAWS: Text = Text::of("Open or close the jaws", "Open or close the jaws");
pub(in crate::console) const JAWS_DOES: Text = Text::of(
    "In a scene with rings, of the instrument that you drive",
    "In a scene with rings, of the instrument that you drive",
);
pub(in crate::console) const MARK_PLACE: Text =
    Text::of("Mark the place under the tip", "Mark the place under the tip");
pub(in crate::console) const MARK_PLACE_DOES: Text =
    Text::of("In a palpation, of the instrument that you drive", "In a palpation, of the instrument that you drive");
pub(in crate::console) const END_TRIAL: Text = Text::of("End the trial", "End the trial");
pub(in crate::console) const END_TRIAL_DOES: Text =
    Text::of("In a palpation: the result is told", "In a palpation: the result is told");
pub(in crate::console) const BEGIN_TRIAL: Text = Text::of("Begin the trial anew", "Begin the trial anew");
pub(in crate::console) const BEGIN_TRIAL_DOES: Text =
    Text::of("In a palpation or on a wire", "In a palpation or on a wire");
pub(in crate::console) const HIDE_FORCES: Text =
    Text::of("Forces in the endoscope's picture", "Forces in the endoscope's picture");
pub(in crate::console) const HIDE_FORCES_DOES: Text = Text::of(
    "Draws the forces into the endoscope's picture, or hides them",
    "Draws the forces into the endoscope's picture, or hides them",
);
pub(in crate::console) const LENS: Text = Text::of("The other lens", "The other lens");
pub(in crate::console) const LENS_DOES: Text = Text::of(
    "Of an endoscope with two lenses: shows the left picture, the right one, or both",
    "Of an endoscope with two lenses: shows the left picture, the right one, or both",
);
pub(in crate::console) const LEAVE_PAST: Text = Text::of("Live again", "Live again");
pub(in crate::console) const LEAVE_PAST_DOES: Text = Text::of(
    "Leaves the recorded session: the screen shows the machine again",
    "Leaves the recorded session: the screen shows the machine again",
);
pub(in crate::console) const PLAY: Text = Text::of("Play or hold the session", "Play or hold the session");
pub(in crate::console) const PLAY_DOES: Text = Text::of("In a recorded session", "In a recorded session");
pub(in crate::console) const BACK: Text = Text::of("A second back", "A second back");
pub(in crate::console) const ON: Text = Text::of("A second on", "A second on");
pub(in crate::console) const BACK_FINE: Text = Text::of("10 ms back", "10 ms back");
pub(in crate::console) const ON_FINE: Text = Text::of("10 ms on", "10 ms on");

/// Where the commands are.
pub(in crate::console) const AT_BAR: Text = Text::of("Top bar", "Top bar");
pub(in crate::console) const AT_VIEW_MENU: Text = Text::of("View menu", "View menu");
pub(in crate::console) const AT_ALARMS: Text = Text::of("Alarm strip", "Alarm strip");
pub(in crate::console) const AT_CALIBRATION: Text = Text::of("Panel Calibration", "Panel Calibration");
pub(in crate::console) const AT_TRACES: Text = Text::of("Panel Traces", "Panel Traces");
pub(in crate::console) const AT_FIELD: Text = Text::of("Operating field", "Operating field");
pub(in crate::console) const AT_PICTURE: Text = Text::of("Endoscope's picture", "Endoscope's picture");
pub(in crate::console) const AT_PAST: Text = Text::of("Recorded session", "Recorded session");
pub(in crate::console) const AT_KEYS: Text = Text::of("Keyboard", "Keyboard");

/// Why a command is not possible now.
pub(in crate::console) const IS_ENGAGED: Text =
    Text::of("It is engaged, or about to be", "It is engaged, or about to be");
pub(in crate::console) const RELEASE_FIRST: Text = Text::of("Release the stop first", "Release the stop first");
pub(in crate::console) const NOT_STOPPED: Text = Text::of("Nothing is stopped", "Nothing is stopped");
pub(in crate::console) const IS_STARTING: Text = Text::of("A rig is being started", "A rig is being started");
pub(in crate::console) const STUDY_IS_OPEN: Text =
    Text::of("A study is open: close it first", "A study is open: close it first");
pub(in crate::console) const NOTHING_RECORDED: Text =
    Text::of("No session is being recorded", "No session is being recorded");
pub(in crate::console) const NO_ALARM: Text = Text::of("Every alarm is acknowledged", "Every alarm is acknowledged");
pub(in crate::console) const NOTHING_TO_UNDO: Text =
    Text::of("Nothing was changed since the window was opened", "Nothing was changed since the window was opened");
pub(in crate::console) const NOTHING_TO_REDO: Text = Text::of("Nothing was taken back", "Nothing was taken back");
pub(in crate::console) const IS_PLAIN: Text = Text::of("It is shown as it comes", "It is shown as it comes");
pub(in crate::console) const PANEL_IS_CLOSED: Text =
    Text::of("Open the panel Traces first", "Open the panel Traces first");
pub(in crate::console) const FIELD_IS_HIDDEN: Text =
    Text::of("Bring the operating field to the front first", "Bring the operating field to the front first");
pub(in crate::console) const NOT_NOW: Text =
    Text::of("Only while the loop is idle or engaged", "Only while the loop is idle or engaged");
pub(in crate::console) const DRIVE_FIRST: Text =
    Text::of("Drive the instrument first (M)", "Drive the instrument first (M)");

/// Prefixes of keys.
pub(in crate::console) const CTRL: Text = Text::of("Ctrl ", "Ctrl ");
pub(in crate::console) const SHIFT: Text = Text::of("Shift ", "Shift ");
pub(in crate::console) const CTRL_SHIFT: Text = Text::of("Ctrl Shift ", "Ctrl Shift ");

/// The palette.
pub(in crate::console) const SEARCH: Text = Text::of("Find a command", "Find a command");
pub(in crate::console) const NONE_FOUND: Text =
    Text::of("No command of this name can be reached from here", "No command of this name can be reached from here");
pub(in crate::console) const ONCE_MORE: Text =
    Text::of("Press Enter once more, or click again", "Press Enter once more, or click again");
pub(in crate::console) const FOOT: Text = Text::of(
    "Enter does it, Ctrl P closes this list, Escape stops the arm",
    "Enter does it, Ctrl P closes this list, Escape stops the arm",
);

/// What is done by hand and has no name.
pub(in crate::console) const BY_HAND: [(Text, Text); 6] = [
    (
        Text::of("Wheel", "Wheel"),
        Text::of(
            "Zooms the endoscope's picture. Drag moves it, a double click shows all of it.",
            "Zooms the endoscope's picture. Drag moves it, a double click shows all of it.",
        ),
    ),
    (
        Text::of("Arrow keys", "Arrow keys"),
        Text::of(
            "Move the instrument by a small step while you drive it",
            "Move the instrument by a small step while you drive it",
        ),
    ),
    (
        Text::of("Page Up, Page Down", "Page Up, Page Down"),
        Text::of(
            "Move the instrument up or down while you drive it",
            "Move the instrument up or down while you drive it",
        ),
    ),
    (
        Text::of("Tab, Shift Tab", "Tab, Shift Tab"),
        Text::of(
            "Select the next or the previous control; it gets a frame",
            "Select the next or the previous control; it gets a frame",
        ),
    ),
    (Text::of("Enter", "Enter"), Text::of("Presses the selected control", "Presses the selected control")),
    (
        Text::of("Ctrl Tab", "Ctrl Tab"),
        Text::of(
            "Shows the next tab of the group under the pointer",
            "Shows the next tab of the group under the pointer",
        ),
    ),
];

/// Name of a view's command.
pub(in crate::console) fn view(name: &str) -> String {
    told!("View: {name}", "View: {name}")
}

/// Name of a panel's command.
pub(in crate::console) fn panel(name: &str) -> String {
    told!("Panel: {name}", "Panel: {name}")
}

/// Name of the command that chooses a language, by its name in itself.
pub(in crate::console) fn language(name: &str) -> String {
    told!("Language: {name}", "Sprache: {name}")
}

/// Name of the command that sets the size.
pub(in crate::console) fn size(percent: u16) -> String {
    told!("Size {percent} %", "Size {percent} %")
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
