//! Names of the commands, what each does, where it is, and why it may not be possible now.

use crate::language::{Text, told};

/// Name and meaning of each command.
pub(in crate::console) const STOP: (Text, Text) = (
    Text::of("Stop", "Halt"),
    Text::of(
        "No force, no motion, in every view. While you type, only Escape does it.",
        "Keine Kraft, keine Bewegung, in jeder Ansicht. Beim Tippen nur mit Escape.",
    ),
);
pub(in crate::console) const ENGAGE: (Text, Text) = (
    Text::of("Engage", "Koppeln"),
    Text::of("Starts motion and force feedback", "Startet Bewegung und Kraftrückkopplung"),
);
pub(in crate::console) const RELEASE: (Text, Text) = (
    Text::of("Release stop", "Halt lösen"),
    Text::of(
        "Returns from a stop or a fault to idle, still without force",
        "Von Halt oder Störung zurück in den Leerlauf, noch ohne Kraft",
    ),
);
pub(in crate::console) const RIG: (Text, Text) = (
    Text::of("Rig and scene", "Aufbau und Szene"),
    Text::of(
        "The page on which a rig and a scene are chosen and made",
        "Seite zum Wählen und Anlegen von Aufbau und Szene",
    ),
);
pub(in crate::console) const SESSIONS: (Text, Text) = (
    Text::of("Recorded sessions", "Aufgezeichnete Sitzungen"),
    Text::of(
        "The list of recorded sessions: look at one, keep it, report on it",
        "Liste der Sitzungen: ansehen, sichern, Bericht erstellen",
    ),
);
pub(in crate::console) const STUDIES: (Text, Text) = (
    Text::of("User studies", "Nutzerstudien"),
    Text::of("The page on which studies are made and gone on with", "Seite zum Anlegen und Fortsetzen von Studien"),
);
pub(in crate::console) const ALARMS: (Text, Text) =
    (Text::of("Alarms", "Alarme"), Text::of("The list of the last alarms", "Liste der letzten Alarme"));
pub(in crate::console) const GLOSSARY: (Text, Text) =
    (Text::of("Glossary", "Glossar"), Text::of("This list of keys and terms", "Diese Liste der Tasten und Begriffe"));
pub(in crate::console) const TOUR: (Text, Text) =
    (Text::of("Tour", "Rundgang"), Text::of("Four steps through the screen", "Vier Schritte durch die Anzeige"));
pub(in crate::console) const PALETTE: (Text, Text) = (
    Text::of("All commands", "Alle Befehle"),
    Text::of("Finds a command by its name and does it", "Findet einen Befehl über den Namen und führt ihn aus"),
);
pub(in crate::console) const ACKNOWLEDGE: (Text, Text) = (
    Text::of("Acknowledge the alarms", "Alarme quittieren"),
    Text::of(
        "Ends flashing and sound; an alarm stays while its cause does",
        "Beendet Blinken und Ton; ein Alarm bleibt, solange seine Ursache besteht",
    ),
);
pub(in crate::console) const MARK: (Text, Text) = (
    Text::of("Mark this moment", "Moment markieren"),
    Text::of(
        "In the traces and in the session that is being recorded",
        "In den Verläufen und in der laufenden Sitzung",
    ),
);
pub(in crate::console) const KEEP: (Text, Text) = (
    Text::of("Keep the session", "Sitzung sichern"),
    Text::of(
        "The session that is being recorded is kept, or no longer",
        "Die laufende Sitzung wird gesichert oder nicht mehr",
    ),
);
pub(in crate::console) const UNDO: (Text, Text) = (
    Text::of("Undo", "Rückgängig"),
    Text::of(
        "Takes back the last change of the arrangement or the look of the screen, nothing else",
        "Nimmt die letzte Änderung an Anordnung oder Aussehen der Anzeige zurück, sonst nichts",
    ),
);
pub(in crate::console) const REDO: (Text, Text) = (
    Text::of("Redo", "Wiederherstellen"),
    Text::of("Makes again what was taken back", "Stellt das Zurückgenommene wieder her"),
);
pub(in crate::console) const DARK: (Text, Text) =
    (Text::of("Dark colours", "Dunkle Farben"), Text::of("For a dark room", "Für dunkle Räume"));
pub(in crate::console) const LIGHT: (Text, Text) = (
    Text::of("Light colours", "Helle Farben"),
    Text::of("For a bright room and for printing", "Für helle Räume und zum Drucken"),
);
pub(in crate::console) const LANGUAGE_DOES: Text = Text::of(
    "The language of the window. The command line and what is written into files stay English.",
    "Die Sprache des Fensters. Die Befehlszeile und alles, was in Dateien geschrieben wird, bleiben Englisch.",
);
pub(in crate::console) const LARGER: (Text, Text) = (
    Text::of("Larger", "Größer"),
    Text::of(
        "Makes everything larger, as far as the window has room",
        "Vergrößert alles, soweit das Fenster Platz hat",
    ),
);
pub(in crate::console) const SMALLER: (Text, Text) =
    (Text::of("Smaller", "Kleiner"), Text::of("Makes everything smaller", "Verkleinert alles"));
pub(in crate::console) const SIZE_DOES: Text = Text::of(
    "Size of texts and controls, as far as the window has room",
    "Größe von Texten und Bedienelementen, soweit das Fenster Platz hat",
);
pub(in crate::console) const RESET_LAYOUT: Text = Text::of("Reset the layout", "Layout zurücksetzen");
pub(in crate::console) const PAUSE: Text = Text::of("Hold the traces, or go on", "Verläufe anhalten oder fortsetzen");
pub(in crate::console) const DRIVE: (Text, Text) = (
    Text::of("Drive by mouse, or let go", "Mit Maus steuern oder loslassen"),
    Text::of("Mouse and keys move the instrument", "Maus und Tasten bewegen das Instrument"),
);
pub(in crate::console) const OTHER_HAND: (Text, Text) = (
    Text::of("Drive the other instrument", "Anderes Instrument steuern"),
    Text::of(
        "While you drive: the one before stays where it is and holds what it holds",
        "Beim Steuern: das bisherige bleibt stehen und hält, was es hält",
    ),
);
pub(in crate::console) const JAWS: (Text, Text) = (
    Text::of("Open or close the jaws", "Backen öffnen oder schließen"),
    Text::of(
        "In a scene with rings, of the instrument that you drive",
        "In einer Szene mit Ringen, am gesteuerten Instrument",
    ),
);
pub(in crate::console) const MARK_PLACE: (Text, Text) = (
    Text::of("Mark the place under the tip", "Stelle unter der Spitze markieren"),
    Text::of("In a palpation, of the instrument that you drive", "Bei einer Palpation, am gesteuerten Instrument"),
);
pub(in crate::console) const END_TRIAL: (Text, Text) = (
    Text::of("End the trial", "Versuch beenden"),
    Text::of("In a palpation: the result is told", "Bei einer Palpation: zeigt das Ergebnis"),
);
pub(in crate::console) const BEGIN_TRIAL: (Text, Text) = (
    Text::of("Begin the trial anew", "Versuch neu beginnen"),
    Text::of("In a palpation or on a wire", "Bei einer Palpation oder am Draht"),
);
pub(in crate::console) const HIDE_FORCES: (Text, Text) = (
    Text::of("Forces in the endoscope's picture", "Kräfte im Endoskopbild"),
    Text::of(
        "Draws the forces into the endoscope's picture, or hides them",
        "Blendet Kräfte im Endoskopbild ein oder aus",
    ),
);
pub(in crate::console) const LENS: (Text, Text) = (
    Text::of("The other lens", "Anderes Objektiv"),
    Text::of(
        "Of an endoscope with two lenses: shows the left picture, the right one, or both",
        "Bei einem Endoskop mit zwei Objektiven: zeigt linkes, rechtes oder beide Bilder",
    ),
);
pub(in crate::console) const LEAVE_PAST: (Text, Text) = (
    Text::of("Live again", "Wieder live"),
    Text::of(
        "Leaves the recorded session: the screen shows the machine again",
        "Verlässt die aufgezeichnete Sitzung: die Anzeige zeigt wieder die Maschine",
    ),
);
pub(in crate::console) const PLAY: Text = Text::of("Play or hold the session", "Sitzung abspielen oder anhalten");
pub(in crate::console) const PLAY_DOES: Text = Text::of("In a recorded session", "In einer aufgezeichneten Sitzung");
pub(in crate::console) const BACK: Text = Text::of("A second back", "1 s zurück");
pub(in crate::console) const ON: Text = Text::of("A second on", "1 s vor");
pub(in crate::console) const BACK_FINE: Text = Text::of("10 ms back", "10 ms zurück");
pub(in crate::console) const ON_FINE: Text = Text::of("10 ms on", "10 ms vor");

/// Where the commands are.
pub(in crate::console) const AT_BAR: Text = Text::of("Top bar", "Kopfleiste");
pub(in crate::console) const AT_VIEW_MENU: Text = Text::of("View menu", "Menü Ansicht");
pub(in crate::console) const AT_ALARMS: Text = Text::of("Alarm strip", "Alarmleiste");
pub(in crate::console) const AT_CALIBRATION: Text = Text::of("Panel Calibration", "Panel Kalibrierung");
pub(in crate::console) const AT_TRACES: Text = Text::of("Panel Traces", "Panel Verläufe");
pub(in crate::console) const AT_FIELD: Text = Text::of("Operating field", "OP-Feld");
pub(in crate::console) const AT_PICTURE: Text = Text::of("Endoscope's picture", "Endoskopbild");
pub(in crate::console) const AT_PAST: Text = Text::of("Recorded session", "Aufgezeichnete Sitzung");
pub(in crate::console) const AT_KEYS: Text = Text::of("Keyboard", "Tastatur");

/// Why a command is not possible now.
pub(in crate::console) const IS_ENGAGED: Text = Text::of("It is engaged, or about to be", "Gekoppelt oder kurz davor");
pub(in crate::console) const RELEASE_FIRST: Text = Text::of("Release the stop first", "Zuerst Halt lösen");
pub(in crate::console) const NOT_STOPPED: Text = Text::of("Nothing is stopped", "Nichts ist angehalten");
pub(in crate::console) const IS_STARTING: Text = Text::of("A rig is being started", "Ein Aufbau startet gerade");
pub(in crate::console) const STUDY_IS_OPEN: Text =
    Text::of("A study is open: close it first", "Eine Studie ist offen: zuerst schließen");
pub(in crate::console) const NOTHING_RECORDED: Text =
    Text::of("No session is being recorded", "Keine Sitzung wird aufgezeichnet");
pub(in crate::console) const NO_ALARM: Text = Text::of("Every alarm is acknowledged", "Alle Alarme sind quittiert");
pub(in crate::console) const NOTHING_TO_UNDO: Text =
    Text::of("Nothing was changed since the window was opened", "Seit dem Öffnen des Fensters nichts geändert");
pub(in crate::console) const NOTHING_TO_REDO: Text = Text::of("Nothing was taken back", "Nichts wurde zurückgenommen");
pub(in crate::console) const IS_PLAIN: Text = Text::of("It is shown as it comes", "Bild wird unverändert gezeigt");
pub(in crate::console) const PANEL_IS_CLOSED: Text =
    Text::of("Open the panel Traces first", "Zuerst Panel Verläufe öffnen");
pub(in crate::console) const FIELD_IS_HIDDEN: Text =
    Text::of("Bring the operating field to the front first", "Zuerst OP-Feld nach vorn holen");
pub(in crate::console) const NOT_NOW: Text =
    Text::of("Only while the loop is idle or engaged", "Nur im Leerlauf oder gekoppelt");
pub(in crate::console) const DRIVE_FIRST: Text =
    Text::of("Drive the instrument first (M)", "Zuerst Instrument steuern (M)");

/// Prefixes of keys.
pub(in crate::console) const CTRL: Text = Text::of("Ctrl ", "Ctrl ");
pub(in crate::console) const SHIFT: Text = Text::of("Shift ", "Shift ");
pub(in crate::console) const CTRL_SHIFT: Text = Text::of("Ctrl Shift ", "Ctrl Shift ");

/// The palette.
pub(in crate::console) const SEARCH: Text = Text::of("Find a command", "Befehl suchen");
pub(in crate::console) const NONE_FOUND: Text =
    Text::of("No command of this name can be reached from here", "Kein Befehl dieses Namens ist von hier erreichbar");
pub(in crate::console) const ONCE_MORE: Text =
    Text::of("Press Enter once more, or click again", "Nochmals Enter oder Klick");
pub(in crate::console) const FOOT: Text = Text::of(
    "Enter does it, Ctrl P closes this list, Escape stops the arm",
    "Enter führt aus, Ctrl P schließt die Liste, Escape hält den Arm an",
);

/// What is done by hand and has no name.
pub(in crate::console) const BY_HAND: [(Text, Text); 6] = [
    (
        Text::of("Wheel", "Mausrad"),
        Text::of(
            "Zooms the endoscope's picture. Drag moves it, a double click shows all of it.",
            "Zoomt das Endoskopbild. Ziehen verschiebt es, Doppelklick zeigt es ganz.",
        ),
    ),
    (
        Text::of("Arrow keys", "Pfeiltasten"),
        Text::of(
            "Move the instrument by a small step while you drive it",
            "Bewegen das gesteuerte Instrument um einen kleinen Schritt",
        ),
    ),
    (
        Text::of("Page Up, Page Down", "Bild auf, Bild ab"),
        Text::of("Move the instrument up or down while you drive it", "Bewegen das gesteuerte Instrument auf oder ab"),
    ),
    (
        Text::of("Tab, Shift Tab", "Tab, Shift Tab"),
        Text::of(
            "Select the next or the previous control; it gets a frame",
            "Nächstes oder voriges Bedienelement wählen; es erhält einen Rahmen",
        ),
    ),
    (Text::of("Enter", "Enter"), Text::of("Presses the selected control", "Betätigt das gewählte Bedienelement")),
    (
        Text::of("Ctrl Tab", "Ctrl Tab"),
        Text::of("Shows the next tab of the group under the pointer", "Nächster Reiter der Gruppe unter dem Zeiger"),
    ),
];

/// Name of a view's command.
pub(in crate::console) fn view(name: &str) -> String {
    told!("View: {name}", "Ansicht: {name}")
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
    told!("Size {percent} %", "Größe {percent} %")
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
