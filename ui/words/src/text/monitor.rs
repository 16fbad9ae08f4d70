//! A rig at another machine, shown without control.

use crate::language::{Text, text_format};

pub const WATCHING: Text = Text::of("WATCHING", "NUR ANSICHT");
pub const WATCHING_HOVER: Text = Text::of(
    "This window shows a rig on another machine, about 0.1 s late; it cannot control the rig",
    "Dieses Fenster zeigt einen Aufbau an einem anderen Rechner, etwa 0.1 s verspätet; es kann nicht auf ihn einwirken",
);
pub const BLOCKED: Text = Text::of("Only on the rig's own console", "Nur an der Konsole des Aufbaus");
pub const CONNECTING: Text = Text::of("Connecting to the rig", "Verbinden mit dem Aufbau");
pub const RESTS: Text = Text::of(
    "The rig is shared, but no loop is running there",
    "Der Aufbau ist freigegeben, aber dort läuft keine \
     Regelung",
);
pub const NO_LINK: Text = Text::of(
    "The network statistics are on the rig's own console",
    "Die Netzwerkwerte stehen an der Konsole des Aufbaus",
);
pub const SIMULATED: Text =
    Text::of("This rig has no devices: everything is simulated", "Dieser Aufbau hat keine Geräte: alles ist simuliert");
pub const NOT_OF_DEVICES: Text = Text::of(
    "The counters and readings of the devices, and the calibrations, are on the rig's own console",
    "Zähler und Messwerte der Geräte sowie die Kalibrierungen stehen an der Konsole des Aufbaus",
);

pub fn title(rig: &str) -> String {
    text_format!("{rig}: watching", "{rig}: nur Ansicht")
}

pub fn rig_and_scene(rig: &str, scene: &str) -> String {
    format!("{rig}, {scene}")
}

pub fn silent(seconds: f64) -> String {
    text_format!(
        "No data from the rig for {seconds:.0} s: the display is out of date",
        "Seit {seconds:.0} s nichts vom Aufbau: die Anzeige ist veraltet"
    )
}

pub fn alarm(priority: &str, cause: &str) -> String {
    format!("{priority}: {cause}")
}
