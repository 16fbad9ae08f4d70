//! Reasons why a device could not be opened, each with its remedy. Not for the real-time thread, because it allocates.

use std::{io, path::Path};

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize)]
#[serde(rename_all = "snake_case", tag = "trouble")]
pub enum DeviceError {
    #[error("{place} was not found")]
    Absent {
        /// Port, path or identity searched for.
        place: String,
    },
    #[error("this user has no permission to open {place}")]
    Permission {
        place: String,
        /// The udev rule that grants the permission.
        udev: String,
    },
    #[error("{place} is in use by another program")]
    Busy {
        /// Port, path or address.
        place: String,
    },
    #[error("{place} is a {found}, not a {expected}")]
    WrongProduct { place: String, expected: String, found: String },
    #[error("{place} is a {found}, which is not supported")]
    Unsupported { place: String, found: String, cure: String },
    #[error("{place} has the serial number {found}, not {expected}")]
    OtherSerial {
        place: String,
        /// Serial number in the rig file; ids, for servos.
        expected: String,
        /// Serial number that the device reports; `unknown` if it reports none.
        found: String,
    },
    #[error("{place} is a {hand}-hand device")]
    OtherHand {
        place: String,
        /// `right` or `left`.
        hand: String,
    },
    #[error("the device connected as the {part} is the {other} ({serial}){}", since(.checked.as_deref()))]
    Exchanged {
        /// Part that is configured for the address at which the device answers: `right sensor`.
        part: &'static str,
        /// Part to which the device belongs: `left sensor`.
        other: &'static str,
        serial: Box<str>,
        /// Date of the ready check that found it there; `None` if the rig file assigns it.
        checked: Option<Box<str>>,
    },
    #[error("{place} and {other} are one device: both report the serial number {serial}")]
    OneDevice { place: String, other: String, serial: String },
    /// Bytes arrive that are not valid frames, as with a wrong line speed.
    #[error("{place} sends unreadable data at {baud} baud")]
    WrongBaud { place: String, baud: u32 },
    #[error("{place} is open but sends nothing")]
    Silent { place: String },
    /// Readings arrive, but each is too old for control when it does.
    #[error("the readings from {place} arrive too late")]
    Late { place: String },
    #[error("no device program sends to {place}")]
    NobodySends { place: String },
    /// The program sends data, but its datagrams show that it receives no answers.
    #[error("the device program that sends to {place} receives no answers")]
    Unheard { place: String },
    #[error("{place} cannot be reached")]
    Unreachable { place: String },
    /// Address and port to which the device sends.
    /// An address for documentation, to which nothing is sent.
    #[error("{place} is only an example of an address")]
    Example { place: String },
    #[error("no response from {place}")]
    NobodyListens {
        /// Address with port.
        place: String,
    },
    #[error("{place} sends its readings to {to} instead of this computer ({here})")]
    SendsElsewhere {
        place: String,
        /// Address and port to which it sends.
        to: String,
        /// This computer's address as seen by the device.
        here: String,
    },
    #[error("{place} refuses user \"{user}\"")]
    RefusedLogin { place: String, user: String },
    #[error("the {name} is not installed")]
    SdkMissing {
        name: String,
        /// Locations that were searched.
        searched: String,
    },
    #[error("the {name} at {path} cannot be used: {reason}")]
    SdkUnusable { name: String, path: String, reason: String },
    #[error("{place} is in {mode} mode")]
    NotReady { place: String, mode: String, cure: String },
    #[error("{place} reports a fault: {words}")]
    DeviceFault {
        place: String,
        /// Text, with the device's code.
        words: String,
        cure: String,
    },
    #[error("{place} refused {command}: {answer}")]
    Refused { place: String, command: String, answer: String },
    #[error("{key} = {value} is invalid: {allowed}")]
    Setting { key: String, value: String, allowed: String },
    #[error("{key} = {path}: {reason}")]
    File { key: String, path: String, reason: String },
    #[error("{place}: {reason}")]
    Other { place: String, reason: String },
}

fn since(checked: Option<&str>) -> String {
    checked.map_or_else(String::new, |date| format!(" since the ready check on {date}"))
}

impl DeviceError {
    pub fn cure(&self) -> String {
        match self {
            Self::Absent { .. } => {
                "Plug it in and switch it on, or correct its port, serial number or id in the rig file.".to_owned()
            }
            Self::Permission { udev, .. } => format!(
                "Add this line to /etc/udev/rules.d/70-nima.rules, run `sudo udevadm control --reload`, plug it in again: {udev}"
            ),
            Self::Busy { .. } => "Close the other program, or the other console.".to_owned(),
            Self::WrongProduct { .. } => "Correct the port or the driver in the rig file.".to_owned(),
            Self::OtherSerial { .. } => {
                "Check whether the cables or addresses of right and left are swapped, or press Choose in the Devices panel."
                    .to_owned()
            }
            Self::OtherHand { hand, .. } => format!(
                "The right and left handles are swapped: press Swap handles in the Devices panel. If the handle belongs here, add hand = \"{hand}\" next to its serial number in the rig file."
            ),
            Self::Exchanged { part, other, checked, .. } => {
                let cure = format!(
                    "The {part} and the {other} are swapped: swap their cables or addresses, or swap the two in the Devices panel."
                );
                match checked {
                    None => cure,
                    Some(_) => cure + " If this is intended, assign each its serial number in the rig file (Choose).",
                }
            }
            Self::OneDevice { .. } => {
                "Both addresses lead to one device: give each device its own address, and correct the rig file.".to_owned()
            }
            Self::WrongBaud { .. } => "Enter the device's speed as `baud` in the rig file.".to_owned(),
            Self::Silent { .. } => "Switch the device on, and check its cable and that it is configured to send.".to_owned(),
            Self::Late { .. } => {
                "Connect the device without a busy network in between, and check that its program sends at once; set the latency of a serial adapter to 1 ms."
                    .to_owned()
            }
            Self::NobodySends { .. } => {
                "Start the device program and configure it to send to this address; see docs/external-device.md.".to_owned()
            }
            Self::Unheard { .. } => {
                "Make the device program read from the socket from which it sends, and open any firewall between the two in both directions."
                    .to_owned()
            }
            Self::Unreachable { .. } => {
                "Check the cable and that this computer has an address in the device's network.".to_owned()
            }
            Self::Example { .. } => {
                "Enter the address of your device in the rig file, or type it in the Devices panel (Choose).".to_owned()
            }
            Self::NobodyListens { .. } => {
                "Correct the port number in the rig file, or wait until the device has started.".to_owned()
            }
            Self::SendsElsewhere { to, .. } => {
                format!(
                    "Assign the device's destination address ({to}) to this computer, or configure the device to send here."
                )
            }
            Self::RefusedLogin { .. } => "Correct the user name and password in the rig file.".to_owned(),
            Self::SdkMissing { searched, .. } => {
                format!("Install the manufacturer's package, or set its folder; searched in {searched}.")
            }
            Self::SdkUnusable { .. } => "Install the version named in the documentation.".to_owned(),
            Self::NotReady { cure, .. } | Self::DeviceFault { cure, .. } | Self::Unsupported { cure, .. } => cure.clone(),
            Self::Refused { .. } => "Check that the firmware is supported, then reconnect.".to_owned(),
            Self::Setting { allowed, .. } => format!("Correct the rig file: {allowed}."),
            Self::File { .. } => "Put the file in place, or correct its path in the rig file.".to_owned(),
            Self::Other { .. } => "Reconnect; if this persists, restart the device.".to_owned(),
        }
    }

    /// Converts an error while opening a device file; `udev` is the rule that would grant the permission.
    pub fn of_port(path: &Path, error: &io::Error, udev: &str) -> Self {
        let place = path.display().to_string();
        match error.kind() {
            io::ErrorKind::NotFound => Self::Absent { place },
            io::ErrorKind::PermissionDenied => Self::Permission { place, udev: udev.to_owned() },
            io::ErrorKind::ResourceBusy | io::ErrorKind::WouldBlock => Self::Busy { place },
            _ => Self::Other { place, reason: error.to_string() },
        }
    }

    /// Converts an error while connecting to a network address.
    pub fn of_address(address: &str, error: &io::Error) -> Self {
        let place = address.to_owned();
        match error.kind() {
            io::ErrorKind::ConnectionRefused => Self::NobodyListens { place },
            io::ErrorKind::TimedOut
            | io::ErrorKind::WouldBlock
            | io::ErrorKind::HostUnreachable
            | io::ErrorKind::NetworkUnreachable
            | io::ErrorKind::NetworkDown => Self::Unreachable { place },
            io::ErrorKind::PermissionDenied => Self::Other { place, reason: "not permitted (a firewall?)".to_owned() },
            io::ErrorKind::AddrInUse => Self::Busy { place },
            _ => Self::Other { place, reason: error.to_string() },
        }
    }
}
