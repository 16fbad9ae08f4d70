//! The panel of devices: connection, which one is which, their choice, their test.

use nima_machine::rig::{Part, PartKind};

use crate::words::{channel_name, marker};

use crate::language::{Text, told, word};

pub(in crate::console) const NONE: Text =
    Text::of("This rig is simulated: it has no devices", "This rig is simulated: it has no devices");
pub(in crate::console) const NONE_TO_CONNECT: Text = Text::of(
    "To connect devices, press Rig (F6), make a copy of the paper rig and start it",
    "To connect devices, press Rig (F6), make a copy of the paper rig and start it",
);
pub(in crate::console) const DISCONNECT: Text = Text::of("Disconnect", "Disconnect");
pub(in crate::console) const CONNECT: Text = Text::of("Connect", "Connect");
pub(in crate::console) const CONNECT_HOVER: Text = Text::of(
    "A lost device is reconnected automatically until you press Disconnect",
    "A lost device is reconnected automatically until you press Disconnect",
);
pub(in crate::console) const CLEAR_FAULTS: Text = Text::of("Clear faults", "Clear faults");
pub(in crate::console) const CLEAR_FAULTS_HOVER: Text = Text::of(
    "Make sure that nobody is near the arm and the cause is gone: afterwards the arm may move again",
    "Make sure that nobody is near the arm and the cause is gone: afterwards the arm may move again",
);
pub(in crate::console) const OPENING: Text = Text::of("connecting", "connecting");
pub(in crate::console) const DISCONNECTED: Text = Text::of("disconnected", "disconnected");

pub(in crate::console) const TEST: Text = Text::of("Test", "Test");
pub(in crate::console) const TEST_HOVER: Text = Text::of(
    "Measures for two seconds: rate, noise, range, age of the readings, losses. Let the device rest meanwhile.",
    "Measures for two seconds: rate, noise, range, age of the readings, losses. Let the device rest meanwhile.",
);
pub(in crate::console) const TEST_ALL: Text = Text::of("Test all", "Test all");
pub(in crate::console) const TESTING: Text = Text::of("testing: let it rest", "testing: let it rest");
pub(in crate::console) const TEST_BROKEN_OFF: Text =
    Text::of("The test got no data: the loop does not run", "The test got no data: the loop does not run");
pub(in crate::console) const FINE: Text = Text::of("Tested: fine", "Tested: fine");
pub(in crate::console) const LOOK_AT: Text = Text::of("Tested: look at", "Tested: look at");
pub(in crate::console) const CHOOSE: Text = Text::of("Choose", "Choose");
pub(in crate::console) const CHOOSE_HOVER: Text = Text::of(
    "Use another device here, told apart by its serial number",
    "Use another device here, told apart by its serial number",
);
pub(in crate::console) const LOOK: Text = Text::of("Look for others", "Look for others");
pub(in crate::console) const LOOK_HOVER: Text = Text::of(
    "Asks every free port and USB device of this kind who it is; takes about a second",
    "Asks every free port and USB device of this kind who it is; takes about a second",
);
pub(in crate::console) const LOOKING: Text = Text::of("looking", "looking");
pub(in crate::console) const PLACE: Text = Text::of("Address or port", "Address or port");
pub(in crate::console) const PLACE_HOVER: Text = Text::of(
    "Where to look besides USB: an address in the network such as 192.168.1.10, or a port such as /dev/ttyUSB3. May be \
     empty.",
    "Where to look besides USB: an address in the network such as 192.168.1.10, or a port such as /dev/ttyUSB3. May be \
     empty.",
);
pub(in crate::console) const NOTHING_FOUND: Text =
    Text::of("No other device of this kind was found", "No other device of this kind was found");
pub(in crate::console) const NO_OTHER: Text = Text::of(
    "No other part of this rig has a device of this kind",
    "No other part of this rig has a device of this kind",
);
pub(in crate::console) const EMULATED: Text = Text::of(
    "Emulated devices stand where the rig file puts them: only exchanges are possible",
    "Emulated devices stand where the rig file puts them: only exchanges are possible",
);
pub(in crate::console) const EXCHANGE: Text = Text::of("Exchange right and left", "Exchange right and left");
pub(in crate::console) const EXCHANGE_HOVER: Text = Text::of(
    "The rig file is changed and the machine starts again, idle; press once more to take it back",
    "The rig file is changed and the machine starts again, idle; press once more to take it back",
);
pub(in crate::console) const WHICH: Text = Text::of(
    "Which one is it? Move a handle, press a sensor, move a marker, press the pedal: its light goes on",
    "Which one is it? Move a handle, press a sensor, move a marker, press the pedal: its light goes on",
);
pub(in crate::console) const LIGHT_HOVER: Text = Text::of(
    "Lights up while the readings change by more than their own noise, and for half a second after",
    "Lights up while the readings change by more than their own noise, and for half a second after",
);

pub(in crate::console) const ENGAGED: Text =
    Text::of("Rest or stop first: the drives are on", "Rest or stop first: the drives are on");
pub(in crate::console) const STOPPED: Text = Text::of("Release the stop first", "Release the stop first");
pub(in crate::console) const STARTING: Text = Text::of("The machine is starting", "The machine is starting");

/// Why nothing can be exchanged or chosen now.
pub(in crate::console) fn not_changeable(reason: &str) -> String {
    told!(
        "Devices cannot be exchanged or chosen now. {reason}.",
        "Devices cannot be exchanged or chosen now. {reason}."
    )
}

/// Why an arm cannot be engaged.
pub(in crate::console) fn not_to_be_engaged(side: &str, obstacle: &impl std::fmt::Display) -> String {
    told!("The {side} arm cannot be engaged: {obstacle}", "The {side} arm cannot be engaged: {obstacle}")
}

/// Identity of a device.
pub(in crate::console) fn identity(product: &str, serial: &str, firmware: &str) -> String {
    let serial =
        if serial.is_empty() { String::new() } else { told!(", serial number {serial}", ", serial number {serial}") };
    let firmware =
        if firmware.is_empty() { String::new() } else { told!(", firmware {firmware}", ", firmware {firmware}") };
    format!("{product}{serial}{firmware}")
}

/// Accessible name of the button that clears a device's faults.
pub(in crate::console) fn clear_faults_of(name: &str) -> String {
    told!("Clear faults of the {name}", "Clear faults of the {name}")
}

/// Rate and losses of a device.
pub(in crate::console) fn delivery(rate_hz: f64, lost: u64, damaged: u64, refused: u64) -> String {
    if lost + damaged + refused == 0 {
        return told!(
            "{rate_hz:.0} readings per second, none lost or damaged",
            "{rate_hz:.0} readings per second, none lost or damaged"
        );
    }
    told!(
        "{rate_hz:.0} readings per second; lost {lost}, damaged {damaged}, refused {refused}",
        "{rate_hz:.0} readings per second; lost {lost}, damaged {damaged}, refused {refused}"
    )
}

/// Number and longest duration of the outages.
pub(in crate::console) fn outages(count: u64, longest_s: f64) -> String {
    let times = if count == 1 { word("once", "once").to_owned() } else { told!("{count} times", "{count} times") };
    told!(
        "; gone {times} since the start, at longest for {longest_s:.1} s",
        "; gone {times} since the start, at longest for {longest_s:.1} s"
    )
}

/// A device that was lost.
pub(in crate::console) fn lost(cause: &str, delivery: &str) -> String {
    told!("lost: {cause}; {delivery}", "lost: {cause}; {delivery}")
}

/// Accessible name of a button of one device.
pub(in crate::console) fn of(what: &str, name: &str) -> String {
    format!("{what} {name}")
}

/// Heading of a column.
pub(in crate::console) fn column(side: Option<nima_machine::rig::Side>) -> &'static str {
    match side {
        Some(nima_machine::rig::Side::Left) => word("Left", "Left"),
        Some(nima_machine::rig::Side::Right) => word("Right", "Right"),
        None => word("Both sides", "Both sides"),
    }
}

/// A kind of part, on the button that exchanges them.
pub(in crate::console) fn kind(kind: PartKind) -> &'static str {
    match kind {
        PartKind::Handle => word("Handles", "Handles"),
        PartKind::Arm => word("Arms", "Arms"),
        PartKind::Sensor => word("Sensors", "Sensors"),
        PartKind::Servos => word("Servos", "Servos"),
        PartKind::Tracker => word("Trackers", "Trackers"),
        PartKind::Pedal => word("Pedals", "Pedals"),
    }
}

/// Accessible name of that button.
pub(in crate::console) fn exchange(of: PartKind) -> String {
    told!("Exchange {}", "Exchange {}", kind(of).to_lowercase())
}

/// The name of the light beside a device.
pub(in crate::console) fn light(name: &str, motion: Option<&str>) -> String {
    match motion {
        Some(motion) => told!("Light of the {name}: {motion}", "Light of the {name}: {motion}"),
        None => told!("Light of the {name}: at rest", "Light of the {name}: at rest"),
    }
}

/// What a person does with a device whose number of this channel changes.
pub(in crate::console) fn motion(kind: PartKind, channel: usize) -> String {
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => word("moved", "moved").to_owned(),
        (PartKind::Handle, 3..=5) => word("turned", "turned").to_owned(),
        (PartKind::Handle, 6) => word("gripper", "gripper").to_owned(),
        (PartKind::Handle, _) => word("button", "button").to_owned(),
        (PartKind::Sensor, 0..=5) | (PartKind::Pedal, _) => word("pressed", "pressed").to_owned(),
        (PartKind::Sensor, _) => word("moved", "moved").to_owned(),
        (PartKind::Tracker, _) => told!("{} moved", "{} moved", marker(channel / 3)),
        (PartKind::Arm | PartKind::Servos, _) => told!("{} moved", "{} moved", channel_name(kind, channel)),
    }
}

/// A candidate that another part of the rig has now.
pub(in crate::console) fn candidate(identity: &str, other: Part) -> String {
    told!(
        "{identity}: now the {}; the two are exchanged",
        "{identity}: now the {}; the two are exchanged",
        other.name()
    )
}

/// A device that tells no identity yet.
pub(in crate::console) const UNKNOWN_IDENTITY: Text = Text::of("Not connected", "Not connected");

/// A candidate that was found.
pub(in crate::console) fn found(identity: &str, place: &str) -> String {
    told!("{identity} at {place}", "{identity} at {place}")
}

/// A place where no device of this kind answers.
pub(in crate::console) fn not_there(place: &str, cause: &str) -> String {
    format!("{place}: {cause}")
}

/// The change stands in the rig file that was in use.
pub(in crate::console) fn saved(path: &std::path::Path) -> String {
    told!(
        "Saved in the rig file {}. The machine has started again, idle.",
        "Saved in the rig file {}. The machine has started again, idle.",
        path.display()
    )
}

/// The change stands in a new rig file.
pub(in crate::console) fn saved_as(name: &str, path: &std::path::Path) -> String {
    told!(
        "A built-in rig cannot be changed: saved as the new rig \"{name}\" in {}, which is in use now. The machine has \
         started again, idle.",
        "A built-in rig cannot be changed: saved as the new rig \"{name}\" in {}, which is in use now. The machine has \
         started again, idle.",
        path.display()
    )
}

/// The change was not made.
pub(in crate::console) fn not_changed(cause: &str) -> String {
    told!("Not changed: {cause}", "Not changed: {cause}")
}
