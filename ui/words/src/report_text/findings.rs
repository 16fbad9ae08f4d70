//! Causes and remedies of the problems that a device test finds.

use nima_machine::rig::{PartKind, checkup::CheckupFinding};

use super::{
    channels::{channel_group, channel_name, marker},
    numbers::three_digits,
    sentence,
};
use crate::language::{Text, text_format, word};

pub fn finding_text(kind: PartKind, finding: &CheckupFinding) -> [String; 2] {
    let with_unit = |channel: usize, value: f64| {
        let (_, unit, scale) = channel_group(kind, channel).unwrap_or_default();
        format!("{} {unit}", three_digits(value * scale))
    };
    match *finding {
        CheckupFinding::Silent => SILENT.map(|text| text.get().to_owned()),
        CheckupFinding::Reopened => REOPENED.map(|text| text.get().to_owned()),
        CheckupFinding::Frozen => FROZEN.map(|text| text.get().to_owned()),
        CheckupFinding::Rate { hz, nominal_hz } => wrong_rate(hz, nominal_hz),
        CheckupFinding::Lost { count } => lost(count),
        CheckupFinding::Damaged { count } => damaged(count),
        CheckupFinding::Refused { count } => refused(count),
        CheckupFinding::Late { p99_s, max_s } => late(kind, p99_s, max_s),
        CheckupFinding::Moved { channel } => moved(kind, channel),
        CheckupFinding::Noisy { channel, deviation, max } => {
            noisy(kind, channel, &with_unit(channel, deviation), &with_unit(channel, max))
        }
        CheckupFinding::Gravity { size_m_s2 } => gravity(size_m_s2),
        CheckupFinding::AtTheEnd { channel, value, range: [low, high] } => {
            let range = format!("{} \u{2026} {}", with_unit(channel, low), with_unit(channel, high));
            at_the_end(kind, channel, &with_unit(channel, value), &range)
        }
        CheckupFinding::Hidden { tool, fraction } => hidden(tool, fraction),
    }
}

const SILENT: [Text; 2] = [
    Text::of("The device sent no data", "Das Gerät hat nichts gesendet"),
    Text::of(
        "Check cable and power; see the line above for details",
        "Kabel und Strom prüfen; Einzelheiten in der Zeile darüber",
    ),
];
const REOPENED: [Text; 2] = [
    Text::of(
        "The device was lost and reconnected during the test",
        "Das Gerät fiel während des Tests aus und wurde neu verbunden",
    ),
    Text::of("Check plug and cable, then test again", "Stecker und Kabel prüfen, dann neu testen"),
];
const FROZEN: [Text; 2] = [
    Text::of("The device repeats the same values", "Das Gerät wiederholt dieselben Werte"),
    Text::of(
        "Switch the device off and on; if that does not help, it is damaged",
        "Aus- und einschalten; hilft das nicht, ist es defekt",
    ),
];

fn wrong_rate(hz: f64, nominal_hz: f64) -> [String; 2] {
    let cure = if hz < nominal_hz {
        word(
            "Check the rate set on the device, and what else uses its connection or this computer",
            "Eingestellte Rate des Geräts prüfen, und was sonst seine Leitung oder diesen Rechner nutzt",
        )
    } else {
        word(
            "The rate set on the device differs from the rate in the rig file: correct one of them",
            "Das Gerät ist auf eine andere Rate eingestellt als in der Aufbaudatei: eine davon berichtigen",
        )
    };
    [
        text_format!(
            "The device sends {hz:.0} readings per second, not {nominal_hz:.0}",
            "Das Gerät sendet {hz:.0} Messwerte pro Sekunde, nicht {nominal_hz:.0}"
        ),
        cure.to_owned(),
    ]
}

fn lost(count: u64) -> [String; 2] {
    [
        text_format!("{count} readings never arrived", "{count} Messwerte kamen nie an"),
        word(
            "Check the cable; on a network, connect the device without a switch; check the load of this computer",
            "Kabel prüfen; im Netzwerk ohne Switch anschließen; Last dieses Rechners prüfen",
        )
        .to_owned(),
    ]
}

fn damaged(count: u64) -> [String; 2] {
    [
        if count == 1 {
            word("1 frame was damaged", "1 Datenrahmen war beschädigt").to_owned()
        } else {
            text_format!("{count} frames were damaged", "{count} Datenrahmen waren beschädigt")
        },
        word(
            "Check plug, shield and length of the cable, and keep it away from motors",
            "Stecker, Schirm und Länge des Kabels prüfen, von Motoren fernhalten",
        )
        .to_owned(),
    ]
}

fn refused(count: u64) -> [String; 2] {
    [
        text_format!(
            "{count} readings were refused: overload or impossible values",
            "{count} Messwerte abgelehnt: Überlast oder unmögliche Werte"
        ),
        word(
            "Remove the load; if that does not help, switch the device off and on",
            "Entlasten; hilft das nicht, aus- und einschalten",
        )
        .to_owned(),
    ]
}

fn late(kind: PartKind, p99_s: f64, max_s: f64) -> [String; 2] {
    let cure = match kind {
        PartKind::Sensor | PartKind::Servos | PartKind::Tracker => word(
            "A serial adapter must forward its bytes within 1 ms (latency_timer: nima devices --udev); otherwise \
             check the load of this computer (Timing panel)",
            "Ein serieller Adapter muss Bytes innerhalb von 1 ms weitergeben (latency_timer: nima devices \
             --udev); sonst Last dieses Rechners prüfen (Panel Timing)",
        ),
        PartKind::Handle | PartKind::Arm | PartKind::Pedal => word(
            "Check the load of this computer (Timing panel), and connect the device without a hub or switch",
            "Last dieses Rechners prüfen (Panel Timing), Gerät ohne Hub oder Switch anschließen",
        ),
    };
    [
        text_format!(
            "1 % of the readings were {:.0} ms old or older (limit {:.0} ms)",
            "1 % der Messwerte waren {:.0} ms alt oder älter (Grenze {:.0} ms)",
            p99_s * 1e3,
            max_s * 1e3
        ),
        cure.to_owned(),
    ]
}

fn moved(kind: PartKind, channel: usize) -> [String; 2] {
    [
        text_format!(
            "The device was not at rest ({}): noise and gravity cannot be judged",
            "Das Gerät ruhte nicht ({}): Rauschen und Schwerkraft nicht beurteilbar",
            channel_name(kind, channel)
        ),
        word("Keep the device at rest and test again", "Gerät ruhen lassen und neu testen").to_owned(),
    ]
}

/// `is` and `max` include their unit.
fn noisy(kind: PartKind, channel: usize, is: &str, max: &str) -> [String; 2] {
    let cure = match kind {
        PartKind::Sensor => word(
            "Check for vibration; check that the mount is tight and the cable is shielded and earthed",
            "Vibration suchen; prüfen, ob Montage fest und Kabel geschirmt und geerdet ist",
        ),
        PartKind::Tracker => word(
            "Clean the markers, avoid reflections and sunlight, and bring them closer to the camera",
            "Marker reinigen, Reflexe und Sonnenlicht fernhalten, näher an die Kamera bringen",
        ),
        _ => word(
            "Make sure that nothing touches the device and that it is mounted firmly",
            "Sicherstellen, dass nichts das Gerät berührt und es fest montiert ist",
        ),
    };
    [
        text_format!(
            "Noise of {}: {is} (usual limit {max})",
            "Rauschen von {}: {is} (übliche Grenze {max})",
            channel_name(kind, channel)
        ),
        cure.to_owned(),
    ]
}

fn gravity(size_m_s2: f64) -> [String; 2] {
    [
        text_format!(
            "At rest the accelerometer measures {size_m_s2:.2} m/s\u{b2}, not 9.81",
            "In Ruhe misst der Beschleunigungssensor {size_m_s2:.2} m/s\u{b2}, nicht 9.81"
        ),
        word(
            "Switch the sensor off and on; if that does not help, calibrations with its accelerometer are not \
             possible",
            "Aus- und einschalten; hilft das nicht, sind Kalibrierungen mit dem Beschleunigungssensor unmöglich",
        )
        .to_owned(),
    ]
}

/// `is` and `range` include their unit.
fn at_the_end(kind: PartKind, channel: usize, is: &str, range: &str) -> [String; 2] {
    let cure = match kind {
        PartKind::Servos => word(
            "Turn the instrument back, or correct the limits in the rig file",
            "Instrument zurückdrehen oder Grenzen in der Aufbaudatei berichtigen",
        ),
        _ => word("Move it towards the middle before you engage", "Vor dem Koppeln zur Mitte bewegen"),
    };
    [
        text_format!(
            "{} is at {is}, close to the end of its range ({range})",
            "{} ist bei {is}, nahe am Ende des Bereichs ({range})",
            sentence(&channel_name(kind, channel))
        ),
        cure.to_owned(),
    ]
}

fn hidden(tool: usize, fraction: f64) -> [String; 2] {
    let seen = if fraction <= 0.0 {
        word("never", "nie").to_owned()
    } else {
        text_format!("in {:.0} % of the frames", "in {:.0} % der Bilder", 100.0 * fraction)
    };
    [
        text_format!("The {} was seen {seen}", "{} wurde {seen} gesehen", marker(tool)),
        word(
            "Clear the camera's line of sight, turn the marker towards the camera, and check the marker's \
             definition in the rig file",
            "Sicht der Kamera freimachen, Marker zu ihr drehen, seine Definition in der Aufbaudatei prüfen",
        )
        .to_owned(),
    ]
}
