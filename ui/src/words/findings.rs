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
    Text::of("It sent nothing", "It sent nothing"),
    Text::of("Check cable and power; the line above tells more", "Check cable and power; the line above tells more"),
];
const REOPENED: [Text; 2] = [
    Text::of("It was lost and opened again during the test", "It was lost and opened again during the test"),
    Text::of("Check plug and cable, then test again", "Check plug and cable, then test again"),
];
const FROZEN: [Text; 2] = [
    Text::of("It repeats the same numbers", "It repeats the same numbers"),
    Text::of(
        "Switch it off and on; if that does not help, it is damaged",
        "Switch it off and on; if that does not help, it is damaged",
    ),
];

/// Too slow or too fast.
fn wrong_rate(hz: f64, nominal_hz: f64) -> [String; 2] {
    let cure = if hz < nominal_hz {
        word(
            "Check the rate that the device is set to, and what else uses its line or this computer",
            "Check the rate that the device is set to, and what else uses its line or this computer",
        )
    } else {
        word(
            "The device is set to another rate than the rig file says: correct one of them",
            "The device is set to another rate than the rig file says: correct one of them",
        )
    };
    [
        told!(
            "It sends {hz:.0} readings per second, not {nominal_hz:.0}",
            "It sends {hz:.0} readings per second, not {nominal_hz:.0}"
        ),
        cure.to_owned(),
    ]
}

/// Missing readings.
fn lost(count: u64) -> [String; 2] {
    [
        told!("{count} readings never arrived", "{count} readings never arrived"),
        word(
            "Check the cable; in a network, connect it without a switch; look at the load of this computer",
            "Check the cable; in a network, connect it without a switch; look at the load of this computer",
        )
        .to_owned(),
    ]
}

/// Damaged frames.
fn damaged(count: u64) -> [String; 2] {
    [
        if count == 1 {
            word("a frame was damaged", "a frame was damaged").to_owned()
        } else {
            told!("{count} frames were damaged", "{count} frames were damaged")
        },
        word(
            "Check plug, shield and length of the cable, and keep it away from motors",
            "Check plug, shield and length of the cable, and keep it away from motors",
        )
        .to_owned(),
    ]
}

/// Refused readings.
fn refused(count: u64) -> [String; 2] {
    [
        told!(
            "{count} readings were refused: overload, or impossible numbers",
            "{count} readings were refused: overload, or impossible numbers"
        ),
        word(
            "Take the load off; if that does not help, switch it off and on",
            "Take the load off; if that does not help, switch it off and on",
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
            "A serial adapter must hand on its bytes after 1 ms (latency_timer: nima devices --udev); else look at the \
             load of this computer (panel Timing)",
        ),
        PartKind::Handle | PartKind::Arm | PartKind::Pedal => word(
            "Look at the load of this computer (panel Timing), and connect the device without a hub or switch",
            "Look at the load of this computer (panel Timing), and connect the device without a hub or switch",
        ),
    };
    [
        told!(
            "One reading in a hundred was {:.0} ms old or older; {:.0} ms would be in order",
            "One reading in a hundred was {:.0} ms old or older; {:.0} ms would be in order",
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
            "It did not rest ({}): noise and gravity cannot be judged",
            channel_name(kind, channel)
        ),
        word("Leave it alone and test again", "Leave it alone and test again").to_owned(),
    ]
}

/// Too much noise; both with their unit.
fn noisy(kind: PartKind, channel: usize, is: &str, most: &str) -> [String; 2] {
    let cure = match kind {
        PartKind::Sensor => word(
            "Look for vibration; check that its mount is tight and its cable shielded and earthed",
            "Look for vibration; check that its mount is tight and its cable shielded and earthed",
        ),
        PartKind::Tracker => word(
            "Clean the markers, keep out reflections and sunlight, bring it nearer to the camera",
            "Clean the markers, keep out reflections and sunlight, bring it nearer to the camera",
        ),
        _ => word(
            "Make sure that nothing touches it and that it stands firmly",
            "Make sure that nothing touches it and that it stands firmly",
        ),
    };
    [
        told!(
            "Noise of {}: {is}; at most {most} is usual",
            "Noise of {}: {is}; at most {most} is usual",
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
            "At rest its accelerometer measures {size_m_s2:.2} m/s\u{b2}, not 9.81"
        ),
        word(
            "Switch it off and on; if that does not help, calibrations by its accelerometer are not possible",
            "Switch it off and on; if that does not help, calibrations by its accelerometer are not possible",
        )
        .to_owned(),
    ]
}

/// Near the end of a range; both with their unit.
fn at_the_end(kind: PartKind, channel: usize, is: &str, range: &str) -> [String; 2] {
    let cure = match kind {
        PartKind::Servos => word(
            "Turn the instrument back, or correct the limits in the rig file",
            "Turn the instrument back, or correct the limits in the rig file",
        ),
        _ => word("Move it towards the middle before you engage", "Move it towards the middle before you engage"),
    };
    [
        told!(
            "{} is at {is}, close to the end of its range ({range})",
            "{} is at {is}, close to the end of its range ({range})",
            capital(&channel_name(kind, channel))
        ),
        cure.to_owned(),
    ]
}

/// A marker that is not seen.
fn hidden(tool: usize, share: f64) -> [String; 2] {
    let seen = if share <= 0.0 {
        word("never", "never").to_owned()
    } else {
        told!("in {:.0} % of the frames", "in {:.0} % of the frames", 100.0 * share)
    };
    [
        told!("The {} was seen {seen}", "The {} was seen {seen}", marker(tool)),
        word(
            "Clear the view from the camera, turn the marker towards it, check its definition in the rig file",
            "Clear the view from the camera, turn the marker towards it, check its definition in the rig file",
        )
        .to_owned(),
    ]
}
