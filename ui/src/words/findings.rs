//! Texts: what the test of a device finds.

use nima_machine::rig::{PartKind, checkup::Finding};

use super::{
    channels::{channel_group, channel_name, marker},
    numbers::three_digits,
    ready::capital,
};
use crate::language::{Text, told, word};

/// Cause and cure.
pub(crate) fn finding_words(kind: PartKind, finding: &Finding) -> [String; 2] {
    let with_unit = |channel: usize, value: f64| {
        let (_, unit, scale) = channel_group(kind, channel).unwrap_or_default();
        format!("{} {unit}", three_digits(value * scale))
    };
    match *finding {
        Finding::Silent => SILENT.map(|text| text.get().to_owned()),
        Finding::Reopened => REOPENED.map(|text| text.get().to_owned()),
        Finding::Frozen => FROZEN.map(|text| text.get().to_owned()),
        Finding::Rate { hz, nominal_hz } => wrong_rate(hz, nominal_hz),
        Finding::Lost { count } => lost(count),
        Finding::Damaged { count } => damaged(count),
        Finding::Refused { count } => refused(count),
        Finding::Late { p99_s, most_s } => late(kind, p99_s, most_s),
        Finding::Moved { channel } => moved(kind, channel),
        Finding::Noisy { channel, deviation, most } => {
            noisy(kind, channel, &with_unit(channel, deviation), &with_unit(channel, most))
        }
        Finding::Gravity { size_m_s2 } => gravity(size_m_s2),
        Finding::AtTheEnd { channel, value, range: [low, high] } => {
            let range = format!("{} \u{2026} {}", with_unit(channel, low), with_unit(channel, high));
            at_the_end(kind, channel, &with_unit(channel, value), &range)
        }
        Finding::Hidden { tool, share } => hidden(tool, share),
    }
}

const SILENT: [Text; 2] = [
    Text::of("It sent nothing", "Es hat nichts gesendet"),
    Text::of(
        "Check cable and power; the line above tells more",
        "Kabel und Strom prüfen; mehr dazu in der Zeile \
     darüber",
    ),
];
const REOPENED: [Text; 2] = [
    Text::of("It was lost and opened again during the test", "Es fiel während des Tests aus und wurde neu geöffnet"),
    Text::of("Check plug and cable, then test again", "Stecker und Kabel prüfen, dann neu testen"),
];
const FROZEN: [Text; 2] = [
    Text::of("It repeats the same numbers", "Es wiederholt dieselben Zahlen"),
    Text::of(
        "Switch it off and on; if that does not help, it is damaged",
        "Aus- und einschalten; hilft das nicht, ist es defekt",
    ),
];

/// Too slow or too fast.
fn wrong_rate(hz: f64, nominal_hz: f64) -> [String; 2] {
    let cure = if hz < nominal_hz {
        word(
            "Check the rate that the device is set to, and what else uses its line or this computer",
            "Eingestellte Rate des Geräts prüfen, und was sonst seine Leitung oder diesen Rechner nutzt",
        )
    } else {
        word(
            "The device is set to another rate than the rig file says: correct one of them",
            "Das Gerät ist auf eine andere Rate eingestellt als in der Aufbaudatei: eine davon berichtigen",
        )
    };
    [
        told!(
            "It sends {hz:.0} readings per second, not {nominal_hz:.0}",
            "Es sendet {hz:.0} Messwerte pro Sekunde, nicht {nominal_hz:.0}"
        ),
        cure.to_owned(),
    ]
}

/// Missing readings.
fn lost(count: u64) -> [String; 2] {
    [
        told!("{count} readings never arrived", "{count} Messwerte kamen nie an"),
        word(
            "Check the cable; in a network, connect it without a switch; look at the load of this computer",
            "Kabel prüfen; im Netzwerk ohne Switch anschließen; Last dieses Rechners prüfen",
        )
        .to_owned(),
    ]
}

/// Damaged frames.
fn damaged(count: u64) -> [String; 2] {
    [
        if count == 1 {
            word("a frame was damaged", "ein Datenrahmen war beschädigt").to_owned()
        } else {
            told!("{count} frames were damaged", "{count} Datenrahmen waren beschädigt")
        },
        word(
            "Check plug, shield and length of the cable, and keep it away from motors",
            "Stecker, Schirm und Länge des Kabels prüfen, von Motoren fernhalten",
        )
        .to_owned(),
    ]
}

/// Refused readings.
fn refused(count: u64) -> [String; 2] {
    [
        told!(
            "{count} readings were refused: overload, or impossible numbers",
            "{count} Messwerte abgelehnt: Überlast oder unmögliche Zahlen"
        ),
        word(
            "Take the load off; if that does not help, switch it off and on",
            "Entlasten; hilft das nicht, aus- und einschalten",
        )
        .to_owned(),
    ]
}

/// Late readings.
fn late(kind: PartKind, p99_s: f64, most_s: f64) -> [String; 2] {
    let cure = match kind {
        PartKind::Sensor | PartKind::Servos | PartKind::Tracker => word(
            "A serial adapter must hand on its bytes after 1 ms (latency_timer: nima devices --udev); else look at the \
             load of this computer (panel Timing)",
            "Ein serieller Adapter muss Bytes nach 1 ms weitergeben (latency_timer: nima devices --udev); sonst Last \
             dieses Rechners prüfen (Panel Timing)",
        ),
        PartKind::Handle | PartKind::Arm | PartKind::Pedal => word(
            "Look at the load of this computer (panel Timing), and connect the device without a hub or switch",
            "Last dieses Rechners prüfen (Panel Timing), Gerät ohne Hub oder Switch anschließen",
        ),
    };
    [
        told!(
            "One reading in a hundred was {:.0} ms old or older; {:.0} ms would be in order",
            "Jeder hundertste Messwert war {:.0} ms alt oder älter; in Ordnung wären {:.0} ms",
            p99_s * 1e3,
            most_s * 1e3
        ),
        cure.to_owned(),
    ]
}

/// It did not rest.
fn moved(kind: PartKind, channel: usize) -> [String; 2] {
    [
        told!(
            "It did not rest ({}): noise and gravity cannot be judged",
            "Es ruhte nicht ({}): Rauschen und Schwerkraft nicht beurteilbar",
            channel_name(kind, channel)
        ),
        word("Leave it alone and test again", "In Ruhe lassen und neu testen").to_owned(),
    ]
}

/// Too much noise; both with their unit.
fn noisy(kind: PartKind, channel: usize, is: &str, most: &str) -> [String; 2] {
    let cure = match kind {
        PartKind::Sensor => word(
            "Look for vibration; check that its mount is tight and its cable shielded and earthed",
            "Vibration suchen; prüfen, ob Montage fest und Kabel geschirmt und geerdet ist",
        ),
        PartKind::Tracker => word(
            "Clean the markers, keep out reflections and sunlight, bring it nearer to the camera",
            "Marker reinigen, Reflexe und Sonnenlicht fernhalten, näher an die Kamera bringen",
        ),
        _ => word(
            "Make sure that nothing touches it and that it stands firmly",
            "Sicherstellen, dass nichts es berührt und es fest steht",
        ),
    };
    [
        told!(
            "Noise of {}: {is}; at most {most} is usual",
            "Rauschen von {}: {is}; üblich höchstens {most}",
            channel_name(kind, channel)
        ),
        cure.to_owned(),
    ]
}

/// No gravity.
fn gravity(size_m_s2: f64) -> [String; 2] {
    [
        told!(
            "At rest its accelerometer measures {size_m_s2:.2} m/s\u{b2}, not 9.81",
            "In Ruhe misst der Beschleunigungssensor {size_m_s2:.2} m/s\u{b2}, nicht 9.81"
        ),
        word(
            "Switch it off and on; if that does not help, calibrations by its accelerometer are not possible",
            "Aus- und einschalten; hilft das nicht, sind Kalibrierungen mit dem Beschleunigungssensor unmöglich",
        )
        .to_owned(),
    ]
}

/// Near the end of a range; both with their unit.
fn at_the_end(kind: PartKind, channel: usize, is: &str, range: &str) -> [String; 2] {
    let cure = match kind {
        PartKind::Servos => word(
            "Turn the instrument back, or correct the limits in the rig file",
            "Instrument zurückdrehen oder Grenzen in der Aufbaudatei berichtigen",
        ),
        _ => word("Move it towards the middle before you engage", "Vor dem Koppeln zur Mitte bewegen"),
    };
    [
        told!(
            "{} is at {is}, close to the end of its range ({range})",
            "{} ist bei {is}, nahe am Ende des Bereichs ({range})",
            capital(&channel_name(kind, channel))
        ),
        cure.to_owned(),
    ]
}

/// A marker that is not seen.
fn hidden(tool: usize, share: f64) -> [String; 2] {
    let seen = if share <= 0.0 {
        word("never", "nie").to_owned()
    } else {
        told!("in {:.0} % of the frames", "in {:.0} % der Bilder", 100.0 * share)
    };
    [
        told!("The {} was seen {seen}", "{} wurde {seen} gesehen", marker(tool)),
        word(
            "Clear the view from the camera, turn the marker towards it, check its definition in the rig file",
            "Sicht der Kamera freimachen, Marker zu ihr drehen, seine Definition in der Aufbaudatei prüfen",
        )
        .to_owned(),
    ]
}
