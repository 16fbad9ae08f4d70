//! Texts: the numbers of a device's readings.

use nima_machine::rig::PartKind;

/// A tracker's marker by the order of its tools.
pub(crate) fn marker(tool: usize) -> String {
    match tool {
        0 => "right marker".to_owned(),
        1 => "left marker".to_owned(),
        2 => "third marker".to_owned(),
        _ => "fourth marker".to_owned(),
    }
}

/// A number of a device's readings.
pub(crate) fn channel_name(kind: PartKind, channel: usize) -> String {
    let axis = ["x", "y", "z"][channel % 3];
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => format!("position {axis}"),
        (PartKind::Handle, 3..=5) => format!("rotation {axis}"),
        (PartKind::Handle, 6) => "gripper".to_owned(),
        (PartKind::Handle, _) => "buttons".to_owned(),
        (PartKind::Arm, _) => format!("joint {}", channel + 1),
        (PartKind::Servos, _) => format!("servo {}", channel + 1),
        (PartKind::Sensor, 0..=2) => format!("force {axis}"),
        (PartKind::Sensor, 3..=5) => format!("torque {axis}"),
        (PartKind::Sensor, _) => format!("acceleration {axis}"),
        (PartKind::Tracker, _) => format!("{} {axis}", marker(channel / 3)),
        (PartKind::Pedal, _) => "switches".to_owned(),
    }
}

/// What the rows of a test's table are: a name, the unit, and how many of it a unit of the reading has.
pub(crate) const fn channel_group(kind: PartKind, channel: usize) -> Option<(&'static str, &'static str, f64)> {
    const DEGREES: f64 = 180.0 / std::f64::consts::PI;
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => Some(("position", "mm", 1e3)),
        (PartKind::Handle, 3..=5) => Some(("rotation", "\u{b0}", DEGREES)),
        (PartKind::Handle, 6) => Some(("gripper", "\u{b0}", DEGREES)),
        (PartKind::Arm, _) => Some(("joints", "\u{b0}", DEGREES)),
        (PartKind::Servos, _) => Some(("servos", "\u{b0}", DEGREES)),
        (PartKind::Sensor, 0..=2) => Some(("force", "N", 1.0)),
        (PartKind::Sensor, 3..=5) => Some(("torque", "mNm", 1e3)),
        (PartKind::Sensor, _) => Some(("acceleration", "m/s\u{b2}", 1.0)),
        (PartKind::Tracker, 0..=2) => Some(("right marker", "mm", 1e3)),
        (PartKind::Tracker, 3..=5) => Some(("left marker", "mm", 1e3)),
        (PartKind::Tracker, 6..=8) => Some(("third marker", "mm", 1e3)),
        (PartKind::Tracker, _) => Some(("fourth marker", "mm", 1e3)),
        (PartKind::Handle | PartKind::Pedal, _) => None,
    }
}
