//! The panel of devices: connection, which one is which, their choice, their test.

use nima_machine::rig::{Part, PartKind};

use crate::words::{channel_name, marker};

pub(in crate::console) const NONE: &str = "This rig is simulated: it has no devices";
pub(in crate::console) const NONE_TO_CONNECT: &str =
    "To connect devices, press Rig (F6), make a copy of the paper rig and start it";
pub(in crate::console) const DISCONNECT: &str = "Disconnect";
pub(in crate::console) const CONNECT: &str = "Connect";
pub(in crate::console) const CONNECT_HOVER: &str =
    "A lost device is reconnected automatically until you press Disconnect";
pub(in crate::console) const CLEAR_FAULTS: &str = "Clear faults";
pub(in crate::console) const CLEAR_FAULTS_HOVER: &str =
    "Make sure that nobody is near the arm and the cause is gone: afterwards the arm may move again";
pub(in crate::console) const OPENING: &str = "connecting";
pub(in crate::console) const DISCONNECTED: &str = "disconnected";

pub(in crate::console) const TEST: &str = "Test";
pub(in crate::console) const TEST_HOVER: &str =
    "Measures for two seconds: rate, noise, range, age of the readings, losses. Let the device rest meanwhile.";
pub(in crate::console) const TEST_ALL: &str = "Test all";
pub(in crate::console) const TESTING: &str = "testing: let it rest";
pub(in crate::console) const TEST_BROKEN_OFF: &str = "The test got no data: the loop does not run";
pub(in crate::console) const FINE: &str = "Tested: fine";
pub(in crate::console) const LOOK_AT: &str = "Tested: look at";
pub(in crate::console) const CHOOSE: &str = "Choose";
pub(in crate::console) const CHOOSE_HOVER: &str = "Use another device here, told apart by its serial number";
pub(in crate::console) const LOOK: &str = "Look for others";
pub(in crate::console) const LOOK_HOVER: &str =
    "Asks every free port and USB device of this kind who it is; takes about a second";
pub(in crate::console) const LOOKING: &str = "looking";
pub(in crate::console) const PLACE: &str = "Address or port";
pub(in crate::console) const PLACE_HOVER: &str = "Where to look besides USB: an address in the network such as 192.168.1.10, or a port such as /dev/ttyUSB3. May be empty.";
pub(in crate::console) const NOTHING_FOUND: &str = "No other device of this kind was found";
pub(in crate::console) const NO_OTHER: &str = "No other part of this rig has a device of this kind";
pub(in crate::console) const EMULATED: &str =
    "Emulated devices stand where the rig file puts them: only exchanges are possible";
pub(in crate::console) const EXCHANGE: &str = "Exchange right and left";
pub(in crate::console) const EXCHANGE_HOVER: &str =
    "The rig file is changed and the machine starts again, idle; press once more to take it back";
pub(in crate::console) const WHICH: &str =
    "Which one is it? Move a handle, press a sensor, move a marker, press the pedal: its light goes on";
pub(in crate::console) const LIGHT_HOVER: &str =
    "Lights up while the readings change by more than their own noise, and for half a second after";

pub(in crate::console) const ENGAGED: &str = "Rest or stop first: the drives are on";
pub(in crate::console) const STOPPED: &str = "Release the stop first";
pub(in crate::console) const STARTING: &str = "The machine is starting";

/// Why nothing can be exchanged or chosen now.
pub(in crate::console) fn not_changeable(reason: &str) -> String {
    format!("Devices cannot be exchanged or chosen now. {reason}.")
}

/// Why an arm cannot be engaged.
pub(in crate::console) fn not_to_be_engaged(side: &str, obstacle: &impl std::fmt::Display) -> String {
    format!("The {side} arm cannot be engaged: {obstacle}")
}

/// Identity of a device.
pub(in crate::console) fn identity(product: &str, serial: &str, firmware: &str) -> String {
    let serial = if serial.is_empty() { String::new() } else { format!(", serial number {serial}") };
    let firmware = if firmware.is_empty() { String::new() } else { format!(", firmware {firmware}") };
    format!("{product}{serial}{firmware}")
}

/// Accessible name of the button that clears a device's faults.
pub(in crate::console) fn clear_faults_of(name: &str) -> String {
    format!("Clear faults of the {name}")
}

/// Rate and losses of a device.
pub(in crate::console) fn delivery(rate_hz: f64, lost: u64, damaged: u64, refused: u64) -> String {
    if lost + damaged + refused == 0 {
        return format!("{rate_hz:.0} readings per second, none lost or damaged");
    }
    format!("{rate_hz:.0} readings per second; lost {lost}, damaged {damaged}, refused {refused}")
}

/// Number and longest duration of the outages.
pub(in crate::console) fn outages(count: u64, longest_s: f64) -> String {
    let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
    format!("; gone {times} since the start, at longest for {longest_s:.1} s")
}

/// A device that was lost.
pub(in crate::console) fn lost(cause: &str, delivery: &str) -> String {
    format!("lost: {cause}; {delivery}")
}

/// Accessible name of a button of one device.
pub(in crate::console) fn of(what: &str, name: &str) -> String {
    format!("{what} {name}")
}

/// Heading of a column.
pub(in crate::console) const fn column(side: Option<nima_machine::rig::Side>) -> &'static str {
    match side {
        Some(nima_machine::rig::Side::Left) => "Left",
        Some(nima_machine::rig::Side::Right) => "Right",
        None => "Both sides",
    }
}

/// A kind of part, on the button that exchanges them.
pub(in crate::console) const fn kind(kind: PartKind) -> &'static str {
    match kind {
        PartKind::Handle => "Handles",
        PartKind::Arm => "Arms",
        PartKind::Sensor => "Sensors",
        PartKind::Servos => "Servos",
        PartKind::Tracker => "Trackers",
        PartKind::Pedal => "Pedals",
    }
}

/// Accessible name of that button.
pub(in crate::console) fn exchange(of: PartKind) -> String {
    format!("Exchange {}", kind(of).to_lowercase())
}

/// The name of the light beside a device.
pub(in crate::console) fn light(name: &str, motion: Option<&str>) -> String {
    match motion {
        Some(motion) => format!("Light of the {name}: {motion}"),
        None => format!("Light of the {name}: at rest"),
    }
}

/// What a person does with a device whose number of this channel changes.
pub(in crate::console) fn motion(kind: PartKind, channel: usize) -> String {
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => "moved".to_owned(),
        (PartKind::Handle, 3..=5) => "turned".to_owned(),
        (PartKind::Handle, 6) => "gripper".to_owned(),
        (PartKind::Handle, _) => "button".to_owned(),
        (PartKind::Sensor, 0..=5) | (PartKind::Pedal, _) => "pressed".to_owned(),
        (PartKind::Sensor, _) => "moved".to_owned(),
        (PartKind::Tracker, _) => format!("{} moved", marker(channel / 3)),
        (PartKind::Arm | PartKind::Servos, _) => format!("{} moved", channel_name(kind, channel)),
    }
}

/// A candidate that another part of the rig has now.
pub(in crate::console) fn candidate(identity: &str, other: Part) -> String {
    format!("{identity}: now the {}; the two are exchanged", other.name())
}

/// A device that tells no identity yet.
pub(in crate::console) const UNKNOWN_IDENTITY: &str = "Not connected";

/// A candidate that was found.
pub(in crate::console) fn found(identity: &str, place: &str) -> String {
    format!("{identity} at {place}")
}

/// A place where no device of this kind answers.
pub(in crate::console) fn not_there(place: &str, cause: &str) -> String {
    format!("{place}: {cause}")
}

/// The change stands in the rig file that was in use.
pub(in crate::console) fn saved(path: &std::path::Path) -> String {
    format!("Saved in the rig file {}. The machine has started again, idle.", path.display())
}

/// The change stands in a new rig file.
pub(in crate::console) fn saved_as(name: &str, path: &std::path::Path) -> String {
    format!(
        "A built-in rig cannot be changed: saved as the new rig \"{name}\" in {}, which is in use now. The machine has started again, idle.",
        path.display()
    )
}

/// The change was not made.
pub(in crate::console) fn not_changed(cause: &str) -> String {
    format!("Not changed: {cause}")
}
