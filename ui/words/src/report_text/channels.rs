//! Names of the values in a device's readings.

use nima_machine::rig::PartKind;

use crate::language::{text_format, word};

/// Returns the name of a tracker's marker, by the index of its tool.
pub fn marker(tool: usize) -> String {
    match tool {
        0 => word("right marker", "Marker rechts").to_owned(),
        1 => word("left marker", "Marker links").to_owned(),
        2 => word("third marker", "Marker 3").to_owned(),
        _ => word("fourth marker", "Marker 4").to_owned(),
    }
}

pub fn channel_name(kind: PartKind, channel: usize) -> String {
    let axis = ["x", "y", "z"][channel % 3];
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => text_format!("position {axis}", "Position {axis}"),
        (PartKind::Handle, 3..=5) => text_format!("rotation {axis}", "Drehung {axis}"),
        (PartKind::Handle, 6) => word("gripper", "Greifer").to_owned(),
        (PartKind::Handle, _) => word("buttons", "Tasten").to_owned(),
        (PartKind::Arm, _) => text_format!("joint {}", "Gelenk {}", channel + 1),
        (PartKind::Servos, _) => text_format!("servo {}", "Servo {}", channel + 1),
        (PartKind::Sensor, 0..=2) => text_format!("force {axis}", "Kraft {axis}"),
        (PartKind::Sensor, 3..=5) => text_format!("torque {axis}", "Drehmoment {axis}"),
        (PartKind::Sensor, _) => text_format!("acceleration {axis}", "Beschleunigung {axis}"),
        (PartKind::Tracker, _) => format!("{} {axis}", marker(channel / 3)),
        (PartKind::Pedal, _) => word("switches", "Schalter").to_owned(),
    }
}

/// Returns the row of the test's table: name, display unit, and the factor from the reading's SI unit to the display
/// unit.
pub fn channel_group(kind: PartKind, channel: usize) -> Option<(&'static str, &'static str, f64)> {
    const DEGREES: f64 = 180.0 / std::f64::consts::PI;
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => Some((word("position", "Position"), "mm", 1e3)),
        (PartKind::Handle, 3..=5) => Some((word("rotation", "Drehung"), "\u{b0}", DEGREES)),
        (PartKind::Handle, 6) => Some((word("gripper", "Greifer"), "\u{b0}", DEGREES)),
        (PartKind::Arm, _) => Some((word("joints", "Gelenke"), "\u{b0}", DEGREES)),
        (PartKind::Servos, _) => Some((word("servos", "Servos"), "\u{b0}", DEGREES)),
        (PartKind::Sensor, 0..=2) => Some((word("force", "Kraft"), "N", 1.0)),
        (PartKind::Sensor, 3..=5) => Some((word("torque", "Drehmoment"), "mNm", 1e3)),
        (PartKind::Sensor, _) => Some((word("acceleration", "Beschleunigung"), "m/s\u{b2}", 1.0)),
        (PartKind::Tracker, 0..=2) => Some((word("right marker", "Marker rechts"), "mm", 1e3)),
        (PartKind::Tracker, 3..=5) => Some((word("left marker", "Marker links"), "mm", 1e3)),
        (PartKind::Tracker, 6..=8) => Some((word("third marker", "Marker 3"), "mm", 1e3)),
        (PartKind::Tracker, _) => Some((word("fourth marker", "Marker 4"), "mm", 1e3)),
        (PartKind::Handle | PartKind::Pedal, _) => None,
    }
}
