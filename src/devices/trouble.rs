//! Why a device could not be opened, each cause with its cure. Not for the real-time thread: it allocates.

use std::{io, path::Path};

/// Why a device could not be opened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize)]
#[serde(rename_all = "snake_case", tag = "trouble")]
pub enum Trouble {
    #[error("{place} is not there")]
    Absent {
        /// Port, path or identity searched for.
        place: String,
    },
    /// The user has no permission for the device.
    #[error("{place} may not be opened by this user")]
    Permission {
        place: String,
        /// The udev rule that grants the permission.
        udev: String,
    },
    #[error("{place} is used by another program")]
    Busy {
        /// Port, path or address.
        place: String,
    },
    /// Another device answers at this address.
    #[error("{place} is a {found}, not a {expected}")]
    WrongProduct { place: String, expected: String, found: String },
    /// The right kind of device, but another one than the rig file names.
    #[error("{place} has the serial number {found}, not {expected}")]
    OtherSerial {
        place: String,
        /// As the rig file has it; ids, for servos.
        expected: String,
        /// What the device tells; `unknown` if it tells none.
        found: String,
    },
    /// A handle for the other hand.
    #[error("{place} is for the {hand} hand")]
    OtherHand {
        place: String,
        /// `right` or `left`.
        hand: String,
    },
    /// The device of another part of the rig answers at this part's place.
    #[error("the device in the place of the {part} is that of the {other} ({serial}){}", since(.checked.as_deref()))]
    Exchanged {
        /// Where it answers: `right sensor`.
        part: &'static str,
        /// Whose device it is: `left sensor`.
        other: &'static str,
        serial: Box<str>,
        /// Date of the ready check that knows it there; `None` if the rig file says so.
        checked: Option<Box<str>>,
    },
    /// Bytes arrive that are not valid frames, as with a wrong line speed.
    #[error("{place} sends bytes that make no sense at {baud} baud")]
    WrongBaud { place: String, baud: u32 },
    /// The port is open, but no byte arrives.
    #[error("{place} is open but sends nothing")]
    Silent { place: String },
    /// The program of an external device has not sent anything.
    #[error("no program of a device sends to {place}")]
    NobodySends { place: String },
    /// It sends, but shows that it hears no answer.
    #[error("the program that sends to {place} does not hear the answers")]
    Unheard { place: String },
    /// There is no route to the address.
    #[error("{place} cannot be reached")]
    Unreachable { place: String },
    /// The computer at the address answers, but nothing listens on the port.
    #[error("nobody listens at {place}")]
    NobodyListens {
        /// Address with port.
        place: String,
    },
    /// It sends its readings to another address than this computer's.
    #[error("{place} sends its readings to {to}, and this computer is {here}")]
    SendsElsewhere {
        place: String,
        /// Address and port to which it sends.
        to: String,
        /// This computer's address as seen by the device.
        here: String,
    },
    /// User name or password is wrong.
    #[error("{place} refuses user \"{user}\"")]
    RefusedLogin { place: String, user: String },
    /// A library of the manufacturer is required and not installed.
    #[error("the {name} is not installed")]
    SdkMissing {
        name: String,
        /// Where it was searched for.
        searched: String,
    },
    /// The library is installed but not usable.
    #[error("the {name} at {path} cannot be used: {reason}")]
    SdkUnusable { name: String, path: String, reason: String },
    /// The device is in calibration, reset or boot mode.
    #[error("{place} is in {mode} mode")]
    NotReady { place: String, mode: String, cure: String },
    /// The device reports a fault of its own.
    #[error("{place} reports a fault: {words}")]
    DeviceFault {
        place: String,
        /// Text, with the device's code.
        words: String,
        cure: String,
    },
    /// The device refused a command or setting.
    #[error("{place} refused {command}: {answer}")]
    Refused { place: String, command: String, answer: String },
    /// A setting in the rig file is invalid.
    #[error("{key} = {value} is not possible: {allowed}")]
    Setting {
        /// Key in the rig file.
        key: String,
        value: String,
        allowed: String,
    },
    /// A file that the rig file names cannot be used.
    #[error("{key} = {path}: {reason}")]
    File {
        /// Key in the rig file.
        key: String,
        path: String,
        reason: String,
    },
    /// Any other error of the operating system.
    #[error("{place}: {reason}")]
    Other { place: String, reason: String },
}

fn since(checked: Option<&str>) -> String {
    checked.map_or_else(String::new, |date| format!(" since the ready check of {date}"))
}

impl Trouble {
    /// What to do about it, in one sentence.
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
                "See whether cables or addresses of right and left are exchanged, or press Choose in the panel Devices."
                    .to_owned()
            }
            Self::OtherHand { hand, .. } => format!(
                "Right and left handles are exchanged: press Exchange Handles in the panel Devices. If it is meant to be here, write hand = \"{hand}\" beside its serial number in the rig file."
            ),
            Self::Exchanged { part, other, checked, .. } => {
                let cure = format!(
                    "The {part} and the {other} are exchanged: exchange their cables or addresses, or exchange the two in the panel Devices."
                );
                match checked {
                    None => cure,
                    Some(_) => cure + " If they are meant so, give each its serial number in the rig file (Choose).",
                }
            }
            Self::WrongBaud { .. } => "Set the device's own speed as `baud` in the rig file.".to_owned(),
            Self::Silent { .. } => "Switch the device on, check its cable, and that it is set to send.".to_owned(),
            Self::NobodySends { .. } => {
                "Start your device's program and let it send to this address; see docs/external-device.md.".to_owned()
            }
            Self::Unheard { .. } => {
                "Let it read the socket from which it sends, and let a firewall between the two pass both ways."
                    .to_owned()
            }
            Self::Unreachable { .. } => {
                "Check the cable and that this computer has an address in the device's network.".to_owned()
            }
            Self::NobodyListens { .. } => {
                "Correct the port number in the rig file, or wait until the device has started.".to_owned()
            }
            Self::SendsElsewhere { to, .. } => {
                format!(
                    "Give this computer the address that the device sends to ({to}), or set the device to send here."
                )
            }
            Self::RefusedLogin { .. } => "Correct user and password in the rig file.".to_owned(),
            Self::SdkMissing { searched, .. } => {
                format!("Install the manufacturer's package, or set its folder; looked for in {searched}.")
            }
            Self::SdkUnusable { .. } => "Install the version that the documentation names.".to_owned(),
            Self::NotReady { cure, .. } | Self::DeviceFault { cure, .. } => cure.clone(),
            Self::Refused { .. } => "Check that the firmware fits, then connect again.".to_owned(),
            Self::Setting { allowed, .. } => format!("Correct the rig file: {allowed}."),
            Self::File { .. } => "Put the file there, or correct its path in the rig file.".to_owned(),
            Self::Other { .. } => "Connect again; if it stays, restart the device.".to_owned(),
        }
    }

    /// From an error while opening a device file; `udev` is the rule that would grant the permission.
    pub fn of_port(path: &Path, error: &io::Error, udev: &str) -> Self {
        let place = path.display().to_string();
        match error.kind() {
            io::ErrorKind::NotFound => Self::Absent { place },
            io::ErrorKind::PermissionDenied => Self::Permission { place, udev: udev.to_owned() },
            io::ErrorKind::ResourceBusy | io::ErrorKind::WouldBlock => Self::Busy { place },
            _ => Self::Other { place, reason: error.to_string() },
        }
    }

    /// From an error while connecting to a network address.
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
