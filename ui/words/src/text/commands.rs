//! Commands: names, effects, places on the screen, and reasons why a command is not available.

use crate::language::{Text, text_format};

/// Name and meaning of each command.
pub const STOP: (Text, Text) = (
    Text::of("Stop", "Halt"),
    Text::of(
        "Removes force and motion at once, in every view. While you type, only Escape stops.",
        "Schaltet Kraft und Bewegung sofort ab, in jeder Ansicht. Beim Tippen nur mit Escape.",
    ),
);
pub const ENGAGE: (Text, Text) = (
    Text::of("Engage", "Koppeln"),
    Text::of("Starts motion and force feedback", "Startet Bewegung und Kraftrückkopplung"),
);
pub const RELEASE: (Text, Text) = (
    Text::of("Release stop", "Halt lösen"),
    Text::of(
        "Returns from a stop or a fault to idle, still without force",
        "Von Halt oder Störung zurück in den Leerlauf, noch ohne Kraft",
    ),
);
pub const RIG: (Text, Text) = (
    Text::of("Rig and scene", "Aufbau und Szene"),
    Text::of(
        "Opens the page to choose or create a rig and a scene",
        "Seite zum Wählen und Anlegen von Aufbau und Szene",
    ),
);
pub const SESSIONS: (Text, Text) = (
    Text::of("Recorded sessions", "Aufgezeichnete Sitzungen"),
    Text::of(
        "Lists the recorded sessions: play, keep, report or delete them",
        "Liste der Sitzungen: ansehen, sichern, auswerten, löschen",
    ),
);
pub const STUDIES: (Text, Text) = (
    Text::of("User studies", "Nutzerstudien"),
    Text::of("Opens the page to create and continue studies", "Seite zum Anlegen und Fortsetzen von Studien"),
);
pub const ALARMS: (Text, Text) =
    (Text::of("Alarms", "Alarme"), Text::of("Lists the most recent alarms", "Liste der letzten Alarme"));
pub const GLOSSARY: (Text, Text) =
    (Text::of("Glossary", "Glossar"), Text::of("Lists all keys and terms", "Liste aller Tasten und Begriffe"));
pub const TOUR: (Text, Text) = (
    Text::of("Tour", "Rundgang"),
    Text::of("Explains the screen in four steps", "Erklärt die Anzeige in vier Schritten"),
);
pub const PALETTE: (Text, Text) = (
    Text::of("All commands", "Alle Befehle"),
    Text::of("Finds a command by its name and runs it", "Findet einen Befehl über den Namen und führt ihn aus"),
);
pub const ACKNOWLEDGE: (Text, Text) = (
    Text::of("Acknowledge alarms", "Alarme quittieren"),
    Text::of(
        "Stops flashing and sound; an alarm stays until its cause is gone",
        "Beendet Blinken und Ton; ein Alarm bleibt, bis seine Ursache behoben ist",
    ),
);
pub const MARK: (Text, Text) = (
    Text::of("Mark this moment", "Moment markieren"),
    Text::of(
        "Sets a mark in the traces and in the session being recorded",
        "Setzt eine Marke in den Verläufen und in der laufenden Sitzung",
    ),
);
pub const KEEP: (Text, Text) = (
    Text::of("Keep the session", "Sitzung sichern"),
    Text::of(
        "Keeps the session being recorded, or stops keeping it",
        "Die laufende Sitzung wird gesichert oder nicht mehr",
    ),
);
pub const UNDO: (Text, Text) = (
    Text::of("Undo", "Rückgängig"),
    Text::of(
        "Undoes the last change to the layout or display settings",
        "Macht die letzte Änderung an Anordnung oder Darstellung rückgängig",
    ),
);
pub const REDO: (Text, Text) = (
    Text::of("Redo", "Wiederholen"),
    Text::of("Redoes the last undone change", "Wiederholt die zuletzt rückgängig gemachte Änderung"),
);
pub const DARK: (Text, Text) =
    (Text::of("Dark colours", "Dunkle Farben"), Text::of("For a dark room", "Für dunkle Räume"));
pub const LIGHT: (Text, Text) = (
    Text::of("Light colours", "Helle Farben"),
    Text::of("For a bright room and for printing", "Für helle Räume und zum Drucken"),
);
pub const LANGUAGE_DOES: Text = Text::of(
    "Sets the language of the window. The command line and all files stay in English.",
    "Stellt die Sprache des Fensters ein. Befehlszeile und Dateien bleiben Englisch.",
);
pub const LARGER: (Text, Text) = (
    Text::of("Larger", "Größer"),
    Text::of(
        "Makes everything larger, as far as it fits in the window",
        "Vergrößert alles, soweit das Fenster Platz hat",
    ),
);
pub const SMALLER: (Text, Text) =
    (Text::of("Smaller", "Kleiner"), Text::of("Makes everything smaller", "Verkleinert alles"));
pub const SIZE_DOES: Text = Text::of(
    "Sets the size of text and controls, as far as it fits in the window",
    "Stellt die Größe von Text und Bedienelementen ein, soweit das Fenster Platz hat",
);
pub const RESET_LAYOUT: Text = Text::of("Reset layout", "Layout zurücksetzen");
pub const PAUSE: Text = Text::of("Pause or resume the traces", "Verläufe anhalten oder fortsetzen");
pub const DRIVE: (Text, Text) = (
    Text::of("Toggle mouse control", "Maussteuerung starten oder beenden"),
    Text::of("Mouse and keys move the instrument", "Maus und Tasten bewegen das Instrument"),
);
pub const OTHER_HAND: (Text, Text) = (
    Text::of("Drive the other instrument", "Anderes Instrument steuern"),
    Text::of(
        "While you drive: the previous instrument stays in place and keeps its grip",
        "Beim Steuern: das bisherige Instrument bleibt stehen und hält, was es greift",
    ),
);
pub const JAWS: (Text, Text) = (
    Text::of("Open or close the jaws", "Backen öffnen oder schließen"),
    Text::of(
        "For the controlled instrument, in a scene with rings",
        "Am gesteuerten Instrument, in einer Szene mit Ringen",
    ),
);
pub const MARK_PLACE: (Text, Text) = (
    Text::of("Mark the place under the tip", "Stelle unter der Spitze markieren"),
    Text::of(
        "Palpation: marks the place with the controlled instrument",
        "Palpation: markiert mit dem gesteuerten Instrument",
    ),
);
pub const END_TRIAL: (Text, Text) = (
    Text::of("End the trial", "Versuch beenden"),
    Text::of("Palpation: shows the result", "Palpation: zeigt das Ergebnis"),
);
pub const BEGIN_TRIAL: (Text, Text) = (
    Text::of("Restart the trial", "Versuch neu starten"),
    Text::of("Rings, palpation or wire task", "Ringe, Palpation oder Drahtaufgabe"),
);
pub const HIDE_FORCES: (Text, Text) = (
    Text::of("Show or hide forces in the endoscope image", "Kräfte im Endoskopbild ein- oder ausblenden"),
    Text::of("Draws the forces as arrows at the tips", "Zeichnet die Kräfte als Pfeile an den Spitzen"),
);
pub const LENS: (Text, Text) = (
    Text::of("Switch lens", "Objektiv wechseln"),
    Text::of(
        "Stereo endoscope: cycles through left, right and both images",
        "Stereoendoskop: wechselt zwischen linkem, rechtem und beiden Bildern",
    ),
);
pub const LEAVE_PAST: (Text, Text) = (
    Text::of("Return to live", "Zurück zu live"),
    Text::of(
        "Closes the recorded session; the screen shows the machine again",
        "Schließt die aufgezeichnete Sitzung; die Anzeige zeigt wieder die Maschine",
    ),
);
pub const PLAY: Text = Text::of("Play or pause the session", "Sitzung abspielen oder anhalten");
pub const PLAY_DOES: Text =
    Text::of("While a recorded session is shown", "Während eine aufgezeichnete Sitzung gezeigt wird");
pub const BACK: Text = Text::of("Back 1 s", "1 s zurück");
pub const ON: Text = Text::of("Forward 1 s", "1 s vor");
pub const BACK_FINE: Text = Text::of("Back 10 ms", "10 ms zurück");
pub const ON_FINE: Text = Text::of("Forward 10 ms", "10 ms vor");

/// Places of the commands.
pub const AT_BAR: Text = Text::of("Top bar", "Kopfleiste");
pub const AT_VIEW_MENU: Text = Text::of("View menu", "Menü Ansicht");
pub const AT_ALARMS: Text = Text::of("Alarm strip", "Alarmleiste");
pub const AT_CALIBRATION: Text = Text::of("Calibration panel", "Panel Kalibrierung");
pub const AT_TRACES: Text = Text::of("Traces panel", "Panel Verläufe");
pub const AT_FIELD: Text = Text::of("Operating field", "OP-Feld");
pub const AT_IMAGE: Text = Text::of("Endoscope image", "Endoskopbild");
pub const AT_PAST: Text = Text::of("Recorded session", "Aufgezeichnete Sitzung");
pub const AT_KEYS: Text = Text::of("Keyboard", "Tastatur");

/// Reasons why a command is not available.
pub const IS_ENGAGED: Text = Text::of("The loop is engaged, or about to be", "Regelung gekoppelt oder kurz davor");
pub const RELEASE_FIRST: Text = Text::of("Press Release stop first", "Zuerst Halt lösen drücken");
pub const NOT_STOPPED: Text = Text::of("The loop is not stopped", "Die Regelung ist nicht angehalten");
pub const IS_STARTING: Text = Text::of("A rig is starting", "Ein Aufbau startet gerade");
pub const STUDY_IS_OPEN: Text = Text::of("A study is open: close it first", "Eine Studie ist offen: zuerst schließen");
pub const NOTHING_RECORDED: Text = Text::of("No session is being recorded", "Keine Sitzung wird aufgezeichnet");
pub const NO_ALARM: Text = Text::of("All alarms are acknowledged", "Alle Alarme sind quittiert");
pub const NOTHING_TO_UNDO: Text =
    Text::of("Nothing has changed since the window was opened", "Seit dem Öffnen des Fensters nichts geändert");
pub const NOTHING_TO_REDO: Text = Text::of("No change was undone", "Keine Änderung wurde rückgängig gemacht");
pub const IS_PLAIN: Text = Text::of("The image is shown unmodified", "Das Bild wird unverändert gezeigt");
pub const PANEL_IS_CLOSED: Text = Text::of("Open the Traces panel first", "Zuerst Panel Verläufe öffnen");
pub const FIELD_IS_HIDDEN: Text =
    Text::of("Bring the operating field to the front first", "Zuerst OP-Feld nach vorn holen");
pub const NOT_NOW: Text = Text::of("Only while the loop is idle or engaged", "Nur im Leerlauf oder gekoppelt");
pub const SIMULATED_HAND_ONLY: Text = Text::of(
    "Only on a rig with a simulated hand: a person may hold the handle of this rig",
    "Nur auf einem Aufbau mit simulierter Hand: hier kann ein Mensch das Handgerät halten",
);
pub const DRIVE_FIRST: Text = Text::of("Drive the instrument first (M)", "Zuerst Instrument steuern (M)");

/// Prefixes of keys.
pub const CTRL: Text = Text::of("Ctrl ", "Ctrl ");
pub const SHIFT: Text = Text::of("Shift ", "Shift ");
pub const CTRL_SHIFT: Text = Text::of("Ctrl Shift ", "Ctrl Shift ");

/// Command palette.
pub const SEARCH: Text = Text::of("Find a command", "Befehl suchen");
pub const NONE_FOUND: Text =
    Text::of("No command of this name is available here", "Kein Befehl dieses Namens ist hier verfügbar");
pub const ONCE_MORE: Text =
    Text::of("Press Enter or click again to confirm", "Nochmals Enter oder Klick zum Bestätigen");
pub const FOOT: Text = Text::of(
    "Enter runs the command, Ctrl P closes this list, Escape stops the arm",
    "Enter führt aus, Ctrl P schließt die Liste, Escape hält den Arm an",
);

/// Mouse and keyboard actions that are not commands.
pub const BY_HAND: [(Text, Text); 6] = [
    (
        Text::of("Wheel", "Mausrad"),
        Text::of(
            "Zooms the endoscope image. Drag to move it, double-click to show all of it.",
            "Zoomt das Endoskopbild. Ziehen verschiebt es, Doppelklick zeigt es ganz.",
        ),
    ),
    (
        Text::of("Arrow keys", "Pfeiltasten"),
        Text::of(
            "Move the controlled instrument in small steps",
            "Bewegen das gesteuerte Instrument in kleinen Schritten",
        ),
    ),
    (
        Text::of("Page Up, Page Down", "Bild auf, Bild ab"),
        Text::of("Move the controlled instrument up or down", "Bewegen das gesteuerte Instrument auf oder ab"),
    ),
    (
        Text::of("Tab, Shift Tab", "Tab, Shift Tab"),
        Text::of(
            "Select the next or the previous control, which is then outlined",
            "Nächstes oder voriges Bedienelement wählen; es erhält einen Rahmen",
        ),
    ),
    (Text::of("Enter", "Enter"), Text::of("Presses the selected control", "Betätigt das gewählte Bedienelement")),
    (
        Text::of("Ctrl Tab", "Ctrl Tab"),
        Text::of("Shows the next tab of the group under the pointer", "Nächster Reiter der Gruppe unter dem Zeiger"),
    ),
];

pub fn view(name: &str) -> String {
    text_format!("View: {name}", "Ansicht: {name}")
}

pub fn panel(name: &str) -> String {
    text_format!("Panel: {name}", "Panel: {name}")
}

pub fn window(name: &str) -> String {
    text_format!("{name} in its own window", "{name} in eigenem Fenster")
}

pub fn layout(name: &str) -> String {
    text_format!("Layout: {name}", "Layout: {name}")
}

pub fn language(name: &str) -> String {
    text_format!("Language: {name}", "Sprache: {name}")
}

pub fn size(percent: u16) -> String {
    text_format!("Size {percent} %", "Größe {percent} %")
}

pub fn with_keys(name: &str, keys: &str) -> String {
    format!("{name} ({keys})")
}

pub fn hover(does: &str, place: &str) -> String {
    format!("{does}\n{place}")
}

pub fn key_meaning(name: &str, does: &str) -> String {
    format!("{name}: {does}")
}
