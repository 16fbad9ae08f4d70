//! The test of a device: figures, causes and cures.

use nima_machine::rig::PartKind;

use super::devices::{channel_name, marker};

pub(in crate::console) const RATE: &str = "Rate";
pub(in crate::console) const RATE_HOVER: &str = "Readings per second, and how many there should be";
pub(in crate::console) const AGE: &str = "Age";
pub(in crate::console) const AGE_HOVER: &str =
    "How old the newest reading was in a tick of the loop: in half of the ticks at most, and in 99 of 100 at most";
pub(in crate::console) const LOSSES: &str = "Lost, damaged, refused";
pub(in crate::console) const LOSSES_HOVER: &str =
    "Lost: missing by the device's own count. Damaged: checksum or structure. Refused: status or impossible numbers.";
pub(in crate::console) const NOISE_HOVER: &str = "Standard deviation of each number (x, y, z or joint by joint) within tenths of a second, so that slow motion does not count";
pub(in crate::console) const SPAN_HOVER: &str = "Lowest and highest reading of each number (x, y, z or joint by joint), and of the device's range the share from its middle that was reached, where the range is known";
pub(in crate::console) const UP: &str = "Up";
pub(in crate::console) const UP_HOVER: &str =
    "Where the accelerometer sees up, in the sensor's own axes, and the size of gravity; 9.81 m/s\u{b2} at rest";
pub(in crate::console) const NO_AGE: &str = "no reading yet";

/// Noise of some numbers of a reading.
pub(in crate::console) fn noise_of(name: &str) -> String {
    format!("Noise of {name}")
}

/// Range of some numbers of a reading.
pub(in crate::console) fn span_of(name: &str) -> String {
    format!("Range of {name}")
}

/// Rate against the nominal one.
pub(in crate::console) fn rate(hz: f64, nominal_hz: Option<f64>) -> String {
    match nominal_hz {
        Some(nominal_hz) => format!("{hz:.0} of {nominal_hz:.0} Hz"),
        None => format!("{hz:.0} Hz"),
    }
}

/// Ages, s.
pub(in crate::console) fn age([p50_s, p99_s]: [f64; 2]) -> String {
    format!("p50 {:.0} ms, p99 {:.0} ms", p50_s * 1e3, p99_s * 1e3)
}

/// Losses.
pub(in crate::console) fn losses(lost: u64, damaged: u64, refused: u64) -> String {
    format!("{lost}, {damaged}, {refused}")
}

/// Upwards, as an axis, and the size of gravity.
pub(in crate::console) fn up(axis: &str, off_deg: f64, size_m_s2: f64) -> String {
    format!("{axis}, {off_deg:.0}\u{b0} off; {size_m_s2:.2} m/s\u{b2}")
}

/// Reached share of a range.
pub(in crate::console) fn share(percent: f64) -> String {
    format!("{percent:.0} % of its range")
}

pub(in crate::console) const SILENT: [&str; 2] =
    ["It sent nothing", "Check cable and power; the line above tells more"];
pub(in crate::console) const REOPENED: [&str; 2] =
    ["It was lost and opened again during the test", "Check plug and cable, then test again"];
pub(in crate::console) const FROZEN: [&str; 2] =
    ["It repeats the same numbers", "Switch it off and on; if that does not help, it is damaged"];

/// Too slow or too fast.
pub(in crate::console) fn wrong_rate(hz: f64, nominal_hz: f64) -> [String; 2] {
    let cure = if hz < nominal_hz {
        "Check the rate that the device is set to, and what else uses its line or this computer"
    } else {
        "The device is set to another rate than the rig file says: correct one of them"
    };
    [format!("It sends {hz:.0} readings per second, not {nominal_hz:.0}"), cure.to_owned()]
}

/// Missing readings.
pub(in crate::console) fn lost(count: u64) -> [String; 2] {
    [
        format!("{count} readings never arrived"),
        "Check the cable; in a network, connect it without a switch; look at the load of this computer".to_owned(),
    ]
}

/// Damaged frames.
pub(in crate::console) fn damaged(count: u64) -> [String; 2] {
    [
        if count == 1 { "a frame was damaged".to_owned() } else { format!("{count} frames were damaged") },
        "Check plug, shield and length of the cable, and keep it away from motors".to_owned(),
    ]
}

/// Refused readings.
pub(in crate::console) fn refused(count: u64) -> [String; 2] {
    [
        format!("{count} readings were refused: overload, or impossible numbers"),
        "Take the load off; if that does not help, switch it off and on".to_owned(),
    ]
}

/// Late readings.
pub(in crate::console) fn late(kind: PartKind, p99_s: f64, most_s: f64) -> [String; 2] {
    let cure = match kind {
        PartKind::Sensor | PartKind::Servos | PartKind::Tracker => {
            "A serial adapter must hand on its bytes after 1 ms (latency_timer: nima devices --udev); else look at the load of this computer (panel Timing)"
        }
        PartKind::Handle | PartKind::Arm | PartKind::Pedal => {
            "Look at the load of this computer (panel Timing), and connect the device without a hub or switch"
        }
    };
    [
        format!(
            "One reading in a hundred was {:.0} ms old or older; {:.0} ms would be in order",
            p99_s * 1e3,
            most_s * 1e3
        ),
        cure.to_owned(),
    ]
}

/// It did not rest.
pub(in crate::console) fn moved(kind: PartKind, channel: usize) -> [String; 2] {
    [
        format!("It did not rest ({}): noise and gravity cannot be judged", channel_name(kind, channel)),
        "Leave it alone and test again".to_owned(),
    ]
}

/// Too much noise; both with their unit.
pub(in crate::console) fn noisy(kind: PartKind, channel: usize, is: &str, most: &str) -> [String; 2] {
    let cure = match kind {
        PartKind::Sensor => "Look for vibration; check that its mount is tight and its cable shielded and earthed",
        PartKind::Tracker => "Clean the markers, keep out reflections and sunlight, bring it nearer to the camera",
        _ => "Make sure that nothing touches it and that it stands firmly",
    };
    [format!("Noise of {}: {is}; at most {most} is usual", channel_name(kind, channel)), cure.to_owned()]
}

/// No gravity.
pub(in crate::console) fn gravity(size_m_s2: f64) -> [String; 2] {
    [
        format!("At rest its accelerometer measures {size_m_s2:.2} m/s\u{b2}, not 9.81"),
        "Switch it off and on; if that does not help, calibrations by its accelerometer are not possible".to_owned(),
    ]
}

/// Near the end of a range; both with their unit.
pub(in crate::console) fn at_the_end(kind: PartKind, channel: usize, is: &str, range: &str) -> [String; 2] {
    let cure = match kind {
        PartKind::Servos => "Turn the instrument back, or correct the limits in the rig file",
        _ => "Move it towards the middle before you engage",
    };
    [
        format!("{} is at {is}, close to the end of its range ({range})", capital(&channel_name(kind, channel))),
        cure.to_owned(),
    ]
}

/// A marker that is not seen.
pub(in crate::console) fn hidden(tool: usize, share: f64) -> [String; 2] {
    let seen = if share <= 0.0 { "never".to_owned() } else { format!("in {:.0} % of the frames", 100.0 * share) };
    [
        format!("The {} was seen {seen}", marker(tool)),
        "Clear the view from the camera, turn the marker towards it, check its definition in the rig file".to_owned(),
    ]
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
