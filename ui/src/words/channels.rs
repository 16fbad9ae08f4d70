//! Texts: the numbers of a device's readings.

use nima_machine::rig::PartKind;

use crate::language::{told, word};

/// A tracker's marker by the order of its tools.
pub(crate) fn marker(tool: usize) -> String {
    match tool {
        0 => word("right marker", "right marker").to_owned(),
        1 => word("left marker", "left marker").to_owned(),
        2 => word("third marker", "third marker").to_owned(),
        _ => word("fourth marker", "fourth marker").to_owned(),
    }
}

/// A number of a device's readings.
pub(crate) fn channel_name(kind: PartKind, channel: usize) -> String {
    let axis = ["x", "y", "z"][channel % 3];
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => told!("position {axis}", "position {axis}"),
        (PartKind::Handle, 3..=5) => told!("rotation {axis}", "rotation {axis}"),
        (PartKind::Handle, 6) => word("gripper", "gripper").to_owned(),
        (PartKind::Handle, _) => word("buttons", "buttons").to_owned(),
        (PartKind::Arm, _) => told!("joint {}", "joint {}", channel + 1),
        (PartKind::Servos, _) => told!("servo {}", "servo {}", channel + 1),
        (PartKind::Sensor, 0..=2) => told!("force {axis}", "force {axis}"),
        (PartKind::Sensor, 3..=5) => told!("torque {axis}", "torque {axis}"),
        (PartKind::Sensor, _) => told!("acceleration {axis}", "acceleration {axis}"),
        (PartKind::Tracker, _) => format!("{} {axis}", marker(channel / 3)),
        (PartKind::Pedal, _) => word("switches", "switches").to_owned(),
    }
}

/// What the rows of a test's table are: a name, the unit, and how many of it a unit of the reading has.
pub(crate) fn channel_group(kind: PartKind, channel: usize) -> Option<(&'static str, &'static str, f64)> {
    const DEGREES: f64 = 180.0 / std::f64::consts::PI;
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => Some((word("position", "position"), "mm", 1e3)),
        (PartKind::Handle, 3..=5) => Some((word("rotation", "rotation"), "\u{b0}", DEGREES)),
        (PartKind::Handle, 6) => Some((word("gripper", "gripper"), "\u{b0}", DEGREES)),
        (PartKind::Arm, _) => Some((word("joints", "joints"), "\u{b0}", DEGREES)),
        (PartKind::Servos, _) => Some((word("servos", "servos"), "\u{b0}", DEGREES)),
        (PartKind::Sensor, 0..=2) => Some((word("force", "force"), "N", 1.0)),
        (PartKind::Sensor, 3..=5) => Some((word("torque", "torque"), "mNm", 1e3)),
        (PartKind::Sensor, _) => Some((word("acceleration", "acceleration"), "m/s\u{b2}", 1.0)),
        (PartKind::Tracker, 0..=2) => Some((word("right marker", "right marker"), "mm", 1e3)),
        (PartKind::Tracker, 3..=5) => Some((word("left marker", "left marker"), "mm", 1e3)),
        (PartKind::Tracker, 6..=8) => Some((word("third marker", "third marker"), "mm", 1e3)),
        (PartKind::Tracker, _) => Some((word("fourth marker", "fourth marker"), "mm", 1e3)),
        (PartKind::Handle | PartKind::Pedal, _) => None,
    }
}
