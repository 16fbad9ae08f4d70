//! The start page: rig and scene.

use crate::language::{Text, text_format, word};

pub const OPEN: Text = Text::of("Rig", "Aufbau");
pub const OPEN_HOVER: Text = Text::of(
    "Choose a rig and a scene, create a rig, see the connected devices. F6",
    "Aufbau und Szene wählen, Aufbau anlegen, Angeschlossenes sehen. F6",
);
pub const OPEN_DISABLED_HOVER: Text = Text::of(
    "Close the calibration wizard or the study first",
    "Erst den Kalibrierassistenten oder die Studie \
     schließen",
);
pub const RIGS: Text = Text::of("1. Choose a rig", "1. Aufbau wählen");
pub const RIGS_HOVER: Text = Text::of(
    "A rig is the set of devices and the settings of the loop",
    "Ein Aufbau umfasst die Geräte und die Einstellungen der Regelung",
);
pub const SCENES: Text = Text::of("2. Choose a scene", "2. Szene wählen");
pub const SCENES_HOVER: Text = Text::of(
    "The operating field on which a simulated or emulated rig works",
    "Das Feld, an dem ein simulierter oder emulierter Aufbau arbeitet",
);
pub const NO_SCENE: Text = Text::of(
    "This rig has a real arm and a real operating field: it needs no scene",
    "Dieser Aufbau hat einen echten Arm und ein echtes Operationsfeld: er braucht keine Szene",
);
pub const MISSING: Text = Text::of("Devices of this rig", "Geräte dieses Aufbaus");
pub const MISSING_HOVER: Text = Text::of(
    "Whether each device of the chosen rig responds; if not, the cause and the remedy",
    "Ob jedes Gerät des gewählten Aufbaus antwortet, und wenn nicht, Grund und Abhilfe",
);
pub const PLUGGED: Text = Text::of("Plugged into this computer", "An diesem Rechner angeschlossen");
pub const PLUGGED_HOVER: Text = Text::of(
    "Found without opening any device; updated every two seconds",
    "Gefunden, ohne ein Gerät zu öffnen; alle zwei Sekunden aktualisiert",
);
pub const RECENT: Text = Text::of("Recent", "Zuletzt");
pub const BUILT_IN: Text = Text::of("Built in", "Eingebaut");
pub const YOURS: Text = Text::of("Yours", "Eigene");
pub const ELSEWHERE: Text = Text::of("Open file…", "Datei öffnen…");
pub const ELSEWHERE_HOVER: Text =
    Text::of("Chooses a rig file from any folder", "Wählt eine Aufbaudatei aus einem beliebigen Ordner");
pub const ELSEWHERE_IS_OPEN: Text =
    Text::of("The dialog to choose a file is already open", "Der Dialog zum Wählen einer Datei ist schon offen");
/// The kind of file in the system's dialog.
pub const RIG_FILES: Text = Text::of("Rig files", "Aufbaudateien");
pub const NEW_NAME: Text = Text::of("Name of a new rig", "Name des neuen Aufbaus");
pub const MAKE: Text = Text::of("Copy the chosen rig", "Gewählten Aufbau kopieren");
pub const MAKE_HOVER: Text = Text::of(
    "Writes a commented rig file into your rigs folder; the chosen rig stays unchanged",
    "Schreibt eine kommentierte Aufbaudatei in Ihren Ordner der Aufbauten; der gewählte bleibt unverändert",
);
pub const ADDRESSES: Text = Text::of(
    "These addresses are examples. Enter those of your devices:",
    "Diese Adressen sind Beispiele. Die der eigenen Geräte eintragen:",
);
pub const COPY_FIRST: Text = Text::of(
    "The addresses of this rig are examples: copy the rig, then enter those of your devices",
    "Die Adressen dieses Aufbaus sind Beispiele: den Aufbau kopieren, dann die der eigenen Geräte eintragen",
);
pub const ENTER: Text = Text::of("Enter", "Eintragen");
pub const ENTER_HOVER: Text =
    Text::of("Writes the address into the rig file", "Schreibt die Adresse in die Aufbaudatei");
pub const ADDRESS_FIRST: Text = Text::of("Type an address first", "Erst eine Adresse eingeben");
pub const START: Text = Text::of("Start", "Starten");
pub const START_AGAIN: Text = Text::of("Restart", "Neu starten");
pub const START_HOVER: Text =
    Text::of("Ends the loop and starts this rig, idle", "Beendet die Regelung und startet diesen Aufbau im Leerlauf");
pub const BACK: Text = Text::of("Back", "Zurück");
pub const BACK_HOVER: Text = Text::of("Back to the view; nothing changes", "Zurück zur Ansicht; nichts ändert sich");
pub const CHECK: Text = Text::of("Check the devices", "Geräte prüfen");
pub const CHECK_HOVER: Text =
    Text::of("Opens each device briefly; takes about a second", "Öffnet jedes Gerät kurz; dauert etwa eine Sekunde");
pub const CHECK_RUNS: Text = Text::of("The check is running", "Die Prüfung läuft");
pub const CHECKING: Text = Text::of("Checking the devices", "Geräte werden geprüft");
pub const SIMULATED: Text =
    Text::of("Everything is simulated: nothing needs to be plugged in", "Alles simuliert: nichts anzuschließen");
pub const LED: Text = Text::of(
    "1 device: a real handle drives the simulated rig",
    "1 Gerät: ein echtes Handgerät führt den simulierten \
     Aufbau",
);
pub const EMULATED: Text = Text::of(
    "The emulators start with this rig: nothing needs to be plugged in",
    "Die Emulatoren starten mit diesem Aufbau: nichts anzuschließen",
);
pub const RUNNING: Text = Text::of("Running now", "Läuft jetzt");
pub const NOTHING_PLUGGED: Text = Text::of("No usable device found", "Kein nutzbares Gerät gefunden");
pub const STARTING: Text = Text::of("Starting", "Startet");
pub const ENGAGED: Text =
    Text::of("Press Stop first: this rig is engaged", "Erst Halt drücken: dieser Aufbau ist gekoppelt");
pub const UNUSABLE: Text = Text::of(
    "This rig or this scene cannot be used: the list shows the cause",
    "Dieser Aufbau oder diese Szene ist nicht nutzbar: der Grund steht in der Liste",
);
pub const ALL_THERE: Text = Text::of("All devices respond", "Alle Geräte antworten");
pub const NO_THREAD: Text = Text::of(
    "the system cannot start a thread for the emulators",
    "das System kann keinen Thread für die Emulatoren starten",
);
pub const NO_FOLDER: Text =
    Text::of("No data folder was found: set NIMA_DATA_DIR", "Kein Datenordner gefunden: NIMA_DATA_DIR setzen");
pub const NAME_FIRST: Text = Text::of(
    "Enter a name of letters, digits, spaces, dashes or underscores",
    "Namen aus Buchstaben, Ziffern, Leerzeichen, Binde- oder Unterstrichen eingeben",
);

pub const WELCOME_WINDOW: Text = Text::of("Welcome", "Willkommen");
pub const WELCOME: Text =
    Text::of("Haptic teleoperation in laparoscopy", "Haptische Teleoperation in der Laparoskopie");
pub const WELCOME_WHAT: Text = Text::of(
    "A surgeon moves a handle, and a robot arm moves the instrument. This console measures the force at the \
     instrument's tip, predicts it across the delay of the link, limits it, and renders it to the hand. \
     Everything that moves behind this window is simulated.",
    "Der Operateur bewegt ein Handgerät, und ein Roboterarm bewegt das Instrument. Diese Konsole misst die Kraft \
     an der Instrumentenspitze, sagt sie über die Verzögerung der Verbindung hinweg voraus, begrenzt sie und \
     stellt sie in der Hand dar. Alles, was sich hinter diesem Fenster bewegt, ist simuliert.",
);
pub const WELCOME_NOT: Text = Text::of(
    "For research and teaching only. It is not a medical device: never use it on patients.",
    "Nur für Forschung und Lehre. Kein Medizinprodukt: niemals am Patienten verwenden.",
);
pub const WELCOME_SIMULATED: Text = Text::of("Continue with the simulated rig", "Weiter mit dem simulierten Aufbau");
pub const WELCOME_SIMULATED_ABOUT: Text = Text::of(
    "It is already running. A tour of four steps explains the screen.",
    "Er läuft schon. Ein Rundgang in vier Schritten zeigt den Bildschirm.",
);
pub const WELCOME_DEMO: Text = Text::of("Watch the demonstration", "Vorführung ansehen");
pub const WELCOME_DEMO_ABOUT: Text = Text::of(
    "It explains the forces chapter by chapter; then it is your turn",
    "Sie erklärt die Kräfte Kapitel für Kapitel, danach selbst probieren",
);
pub const WELCOME_OWN: Text = Text::of("Choose or create your own rig", "Eigenen Aufbau wählen oder anlegen");
pub const WELCOME_OWN_ABOUT: Text = Text::of(
    "Your own devices, an emulation of the paper's rig, or another scene. The rig starts idle and engages only \
     when you press Engage.",
    "Eigene Geräte, der Aufbau des Artikels emuliert oder eine andere Szene. Startet im Leerlauf; gekoppelt wird \
     nur auf Knopfdruck.",
);

pub const ENDOSCOPE: Text = Text::of("Endoscope of this rig", "Endoskop dieses Aufbaus");
pub const ENDOSCOPE_HOVER: Text = Text::of(
    "Source of the surgeon's image. A typed address is tested at once",
    "Woher das Bild des Operateurs kommt. Eingaben werden sofort probiert",
);
pub const ENDOSCOPE_ADDRESS: Text = Text::of("Address of the endoscope", "Adresse des Endoskops");
pub const ENDOSCOPE_HINT: Text = Text::of("http://192.168.10.7:8080/stream", "http://192.168.10.7:8080/stream");
pub const ENDOSCOPE_USE: Text = Text::of("Write this address to the rig", "Adresse in den Aufbau schreiben");
pub const ENDOSCOPE_REMOVE: Text = Text::of("Remove the endoscope from the rig", "Endoskop aus dem Aufbau entfernen");
pub const ENDOSCOPE_SAME: Text = Text::of("The rig already has this address", "Der Aufbau hat diese Adresse schon");
pub const ENDOSCOPE_USE_HOVER: Text = Text::of(
    "A built-in rig stays unchanged: the address is written to your copy of it. Start the rig to see the image \
     in the Surgeon view.",
    "Ein eingebauter Aufbau bleibt unverändert: eine eigene Kopie erhält die Adresse. Aufbau starten, um das \
     Bild in der Ansicht Chirurg zu sehen.",
);
pub const ENDOSCOPE_TYPING: Text = Text::of("Opens when you stop typing", "Öffnet nach der Eingabe");
pub const ENDOSCOPE_EMULATED: Text = Text::of("Starts with this rig", "Startet mit diesem Aufbau");
pub const ENDOSCOPE_OPENING: Text = Text::of("Opening", "Wird geöffnet");
pub const ENDOSCOPE_FORMS: Text = Text::of(
    "Enter http://HOST:PORT/PATH, or the path of a .mjpeg file, a JPEG file or a folder of JPEG files",
    "http://HOST:PORT/PATH oder den Pfad eines .mjpeg, eines JPEG oder eines Ordners davon eingeben",
);
pub const NO_ENDOSCOPE: Text =
    Text::of("None: the Surgeon view draws the field", "Keins: die Ansicht Chirurg zeichnet das OP-Feld");

/// Returns the size of the image in px, and frame rate; `None` for a still image.
pub fn endoscope_sends([width, height]: [usize; 2], rate_hz: Option<f64>) -> String {
    match rate_hz {
        Some(rate_hz) => text_format!(
            "Sends {width} x {height} pixels, {rate_hz:.0} images per second",
            "Sendet {width} x {height} Pixel, {rate_hz:.0} Bilder pro Sekunde"
        ),
        None => text_format!("One image of {width} x {height} pixels", "Ein Bild mit {width} x {height} Pixeln"),
    }
}

pub fn endoscope_written(path: &str) -> String {
    text_format!(
        "Written: {path}. Start the rig to use the address.",
        "Geschrieben: {path}. Zum Nutzen der Adresse starten."
    )
}

pub fn of_devices(count: usize, emulated: bool) -> String {
    let devices = if count == 1 {
        word("1 device", "1 Gerät").to_owned()
    } else {
        text_format!("{count} devices", "{count} Geräte")
    };
    if emulated { text_format!("{devices}, emulated", "{devices}, emuliert") } else { devices }
}

pub fn unusable(cause: &str) -> String {
    text_format!("Cannot be used: {cause}", "Nicht nutzbar: „{cause}“")
}

pub fn taken(path: &std::path::Path) -> String {
    text_format!("A rig with this name exists: {}", "Ein Aufbau heißt schon so: {}", path.display())
}

pub fn made(path: &std::path::Path) -> String {
    text_format!("Written: {}", "Geschrieben: {}", path.display())
}

pub fn not_started(cause: &str, instead: Option<&str>) -> String {
    match instead {
        Some(rig) => {
            text_format!(
                "Not started: {cause}. {rig} is running again.",
                "Nicht gestartet: {cause}. {rig} läuft wieder."
            )
        }
        None => {
            text_format!("Not started: {cause}. No rig is running.", "Nicht gestartet: {cause}. Kein Aufbau läuft.")
        }
    }
}

pub fn answers(name: &str, product: &str, serial: &str) -> String {
    format!("{name}: {product} {serial}").trim_end().to_owned()
}
