//! The Devices panel: connection, identification, choice and test of devices.

use nima_machine::rig::{PartKind, RigPart};

use crate::report_text::{channel_name, marker};

use crate::language::{Text, text_format, word};
use crate::report_text::{part_name, within};

pub const NAME: Text = Text::of("Devices", "Geräte");
pub const MEANING: Text = Text::of(
    "The devices of this rig. A connected device is not yet engaged.",
    "Die Geräte dieses Aufbaus. Ein verbundenes Gerät ist noch nicht gekoppelt.",
);

pub const NONE: Text =
    Text::of("This rig is simulated: it has no devices", "Dieser Aufbau ist simuliert: er hat keine Geräte");
pub const NONE_TO_CONNECT: Text = Text::of(
    "To connect devices, press Rig (F6), copy the paper rig and start the copy",
    "Um Geräte zu verbinden: Aufbau (F6) drücken, Kopie des Aufbaus paper anlegen und starten",
);
pub const DISCONNECT: Text = Text::of("Disconnect", "Trennen");
pub const CONNECT: Text = Text::of("Connect", "Verbinden");
pub const CONNECT_HOVER: Text = Text::of(
    "A lost device is reconnected automatically until you press Disconnect",
    "Ein ausgefallenes Gerät wird automatisch neu verbunden, bis Trennen gedrückt wird",
);
pub const CLEAR_FAULTS: Text = Text::of("Clear faults", "Störungen zurücksetzen");
pub const CLEAR_FAULTS_HOVER: Text = Text::of(
    "First make sure that no one is near the arm and that the cause is gone: afterwards the arm can move again",
    "Sicherstellen, dass niemand am Arm und die Ursache behoben ist: danach kann sich der Arm wieder bewegen",
);
pub const DEVICE: Text = Text::of("Device", "Gerät");
pub const STATE: Text = Text::of("State", "Zustand");
pub const READINGS: Text = Text::of("Readings/s", "Messwerte/s");
pub const ADDRESS: Text = Text::of("Address and identity", "Adresse und Kennung");
pub const RATES_HOVER: Text =
    Text::of("Readings per second during the last minute", "Messwerte pro Sekunde in der letzten Minute");
pub const COPY: Text = Text::of("Copy", "Kopieren");
pub const COPY_HOVER: Text = Text::of(
    "Copies address, identity, state, figures, cause and remedy, for example for an e-mail",
    "Kopiert Adresse, Kennung, Zustand, Zahlen, Grund und Abhilfe, etwa für eine E-Mail",
);
pub const NOTHING_TO_TEST: Text =
    Text::of("This rig has no devices to test", "Dieser Aufbau hat keine Geräte zum Testen");
pub const TEST_RUNS: Text = Text::of("A test is running", "Ein Test läuft");
pub const CONNECTED: Text = Text::of("connected", "verbunden");
pub const LOST: Text = Text::of("lost", "ausgefallen");
pub const OPENING: Text = Text::of("connecting", "wird verbunden");
pub const DISCONNECTED: Text = Text::of("disconnected", "getrennt");

pub const TEST: Text = Text::of("Test", "Testen");
pub const TEST_HOVER: Text = Text::of(
    "Measures rate, noise, range, age of the readings and losses for two seconds. Keep the device at rest during the \
     measurement.",
    "Misst zwei Sekunden lang: Rate, Rauschen, Bereich, Alter der Messwerte, Verluste. Das Gerät dabei ruhen lassen.",
);
pub const TEST_ALL: Text = Text::of("Test all", "Alle testen");
pub const TESTING: Text = Text::of("testing: keep it at rest", "Test läuft: ruhen lassen");
pub const TEST_BROKEN_OFF: Text =
    Text::of("The test received no data: the loop is not running", "Test ohne Daten: die Regelung läuft nicht");
pub const FINE: Text = Text::of("Test passed", "Test bestanden");
pub const LOOK_AT: Text = Text::of("Test found a problem", "Test fand ein Problem");
pub const CHOOSE: Text = Text::of("Choose", "Wählen");
pub const CHOOSE_HOVER: Text = Text::of(
    "Use another device here, identified by its serial number",
    "Hier ein anderes Gerät verwenden, erkannt an der Seriennummer",
);
pub const LOOK: Text = Text::of("Search for others", "Andere suchen");
pub const LOOK_HOVER: Text = Text::of(
    "Queries every free port and USB device of this kind; takes about a second",
    "Fragt jeden freien Port und jedes USB-Gerät dieser Art nach seiner Kennung; dauert etwa eine Sekunde",
);
pub const LOOKING: Text = Text::of("searching", "sucht");
pub const LOOKS_NOW: Text = Text::of("The search is running", "Die Suche läuft");
pub const PLACE: Text = Text::of("Address or port", "Adresse oder Port");
pub const PLACE_HOVER: Text = Text::of(
    "Where to search in addition to USB: a network address such as 192.168.1.10, or a port such as /dev/ttyUSB3. \
     May be empty.",
    "Wo außer an USB zu suchen ist: eine Netzwerkadresse wie 192.168.1.10 oder ein Port wie /dev/ttyUSB3. Darf leer \
     sein.",
);
pub const NOTHING_FOUND: Text =
    Text::of("No other device of this kind found", "Kein anderes Gerät dieser Art gefunden");
pub const NO_OTHER: Text = Text::of(
    "No other part of this rig has a device of this kind",
    "Kein anderer Teil dieses Aufbaus hat ein Gerät dieser Art",
);
pub const EMULATED: Text = Text::of(
    "The rig file sets the addresses of emulated devices: they can only be swapped",
    "Die Aufbaudatei legt die Adressen emulierter Geräte fest: nur Tauschen ist möglich",
);
pub const EXCHANGE: Text = Text::of("Swap left and right", "Rechts und links tauschen");
pub const EXCHANGE_HOVER: Text = Text::of(
    "Changes the rig file and restarts the machine, idle; press again to undo",
    "Ändert die Aufbaudatei und startet die Maschine neu, im Leerlauf; nochmals drücken macht es rückgängig",
);
pub const WHICH: Text = Text::of(
    "Which device is which? Move a handle, press a sensor, move a marker or press the pedal: its light turns on",
    "Welches ist es? Handgerät bewegen, Sensor drücken, Marker bewegen, Pedal treten: seine Lampe leuchtet",
);
pub const LIGHT_HOVER: Text = Text::of(
    "Lights up while the readings change by more than their own noise, and for half a second after",
    "Leuchtet, solange sich die Messwerte um mehr als ihr Rauschen ändern, und eine halbe Sekunde danach",
);

pub const ENGAGED: Text = Text::of(
    "Set the loop to idle or press Stop first: the drives are on",
    "Zuerst Leerlauf oder Halt: die Antriebe sind ein",
);
pub const STOPPED: Text = Text::of("Press Release stop first", "Zuerst Halt lösen drücken");
pub const STARTING: Text = Text::of("The machine is starting", "Die Maschine startet");

pub fn not_changeable(reason: &str) -> String {
    text_format!(
        "Devices cannot be swapped or chosen now. {reason}.",
        "Geräte lassen sich jetzt nicht tauschen oder wählen. {reason}."
    )
}

pub fn not_to_be_engaged(side: &str, obstacle: &impl std::fmt::Display) -> String {
    text_format!("The {side} arm cannot be engaged: {obstacle}", "Arm {side} lässt sich nicht koppeln: {obstacle}")
}

pub fn identity(product: &str, serial: &str, firmware: &str) -> String {
    let serial = if serial.is_empty() {
        String::new()
    } else {
        text_format!(", serial number {serial}", ", Seriennummer {serial}")
    };
    let firmware = if firmware.is_empty() {
        String::new()
    } else {
        text_format!(", firmware {firmware}", ", Firmware {firmware}")
    };
    format!("{product}{serial}{firmware}")
}

/// Returns the accessible name of the button that clears a device's faults.
pub fn clear_faults_of(name: &str) -> String {
    text_format!("Clear faults of the {name}", "Störungen zurücksetzen: {name}")
}

pub fn delivery(rate_hz: f64, lost: u64, damaged: u64, refused: u64) -> String {
    if lost + damaged + refused == 0 {
        return text_format!(
            "{rate_hz:.0} readings per second, none lost or damaged",
            "{rate_hz:.0} Messwerte/s, keiner verloren oder beschädigt"
        );
    }
    text_format!(
        "{rate_hz:.0} readings per second; lost {lost}, damaged {damaged}, refused {refused}",
        "{rate_hz:.0} Messwerte/s; verloren {lost}, beschädigt {damaged}, abgelehnt {refused}"
    )
}

pub fn outages(count: u64, longest_s: f64) -> String {
    let times =
        if count == 1 { word("once", "einmal").to_owned() } else { text_format!("{count} times", "{count}-mal") };
    text_format!(
        "; lost {times} since the start, for up to {longest_s:.1} s",
        "; seit dem Start {times} ausgefallen, bis zu {longest_s:.1} s lang"
    )
}

pub fn lost(cause: &str, delivery: &str) -> String {
    text_format!("lost: {cause}; {delivery}", "ausgefallen: {cause}; {delivery}")
}

/// Returns the accessible name of a button of one device.
pub fn of(what: &str, name: &str) -> String {
    format!("{what} {name}")
}

/// Returns the kind of part, on the button that swaps the devices of that kind.
pub fn kind(kind: PartKind) -> &'static str {
    match kind {
        PartKind::Handle => word("Handles", "Handgeräte"),
        PartKind::Arm => word("Arms", "Arme"),
        PartKind::Sensor => word("Sensors", "Sensoren"),
        PartKind::Servos => word("Servos", "Servos"),
        PartKind::Tracker => word("Trackers", "Tracker"),
        PartKind::Pedal => word("Pedals", "Pedale"),
    }
}

/// Returns the accessible name of that button.
pub fn exchange(of: PartKind) -> String {
    text_format!("Swap {}", "{} tauschen", within(kind(of)))
}

/// Returns the accessible name of the light next to a device.
pub fn light(name: &str, motion: Option<&str>) -> String {
    match motion {
        Some(motion) => text_format!("Light of the {name}: {motion}", "Lampe {name}: {motion}"),
        None => text_format!("Light of the {name}: at rest", "Lampe {name}: in Ruhe"),
    }
}

/// Returns the motion of the device that changes this channel.
pub fn motion(kind: PartKind, channel: usize) -> String {
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => word("moved", "bewegt").to_owned(),
        (PartKind::Handle, 3..=5) => word("turned", "gedreht").to_owned(),
        (PartKind::Handle, 6) => word("gripper", "Greifer").to_owned(),
        (PartKind::Handle, _) => word("button", "Taste").to_owned(),
        (PartKind::Sensor, 0..=5) | (PartKind::Pedal, _) => word("pressed", "gedrückt").to_owned(),
        (PartKind::Sensor, _) => word("moved", "bewegt").to_owned(),
        (PartKind::Tracker, _) => text_format!("{} moved", "{} bewegt", marker(channel / 3)),
        (PartKind::Arm | PartKind::Servos, _) => text_format!("{} moved", "{} bewegt", channel_name(kind, channel)),
    }
}

pub fn candidate(identity: &str, other: RigPart) -> String {
    text_format!(
        "{identity}: currently the {}; the two will be swapped",
        "{identity}: derzeit {}; beide werden getauscht",
        part_name(other)
    )
}

/// Device without a reported identity.
pub const UNKNOWN_IDENTITY: Text = Text::of("Not connected", "Nicht verbunden");

pub fn found(identity: &str, place: &str) -> String {
    text_format!("{identity} at {place}", "{identity} an {place}")
}

pub fn not_there(place: &str, cause: &str) -> String {
    format!("{place}: {cause}")
}

pub fn saved(path: &std::path::Path) -> String {
    text_format!(
        "Saved in the rig file {}. The machine has restarted, idle.",
        "In der Aufbaudatei {} gespeichert. Die Maschine ist neu gestartet, im Leerlauf.",
        path.display()
    )
}

pub fn saved_as(name: &str, path: &std::path::Path) -> String {
    text_format!(
        "A built-in rig cannot be changed: saved as the new rig \"{name}\" in {}, which is now in use. The \
         machine has restarted, idle.",
        "Ein eingebauter Aufbau ist nicht änderbar: als neuer Aufbau „{name}“ in {} gespeichert und jetzt aktiv. Die \
         Maschine ist neu gestartet, im Leerlauf.",
        path.display()
    )
}

pub fn not_changed(cause: &str) -> String {
    text_format!("Not changed: {cause}", "Nicht geändert: {cause}")
}
