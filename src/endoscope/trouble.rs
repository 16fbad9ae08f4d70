//! Why there is no picture, each cause with its cure.

use std::io::{self, ErrorKind};

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Trouble {
    #[error("nobody listens at {place}")]
    NobodyListens { place: String },
    #[error("{place} cannot be reached")]
    Unreachable { place: String },
    /// No name server knows it.
    #[error("no computer has the name in {place}")]
    NoSuchName { place: String },
    #[error("{place} answers with the status {status}")]
    Refused { place: String, status: u16 },
    #[error("{place} sends {found}, not motion JPEG")]
    OtherFormat { place: String, found: String },
    /// Not HTTP, or beyond a limit.
    #[error("{place} sends what cannot be read: {reason}")]
    Unreadable { place: String, reason: String },
    #[error("{place} is open but sends nothing")]
    Silent { place: String },
    /// The other end has closed the connection.
    #[error("{place} has closed the connection")]
    Closed { place: String },
    #[error("{path}: {reason}")]
    File { path: String, reason: String },
    #[error("{place}: {reason}")]
    Other { place: String, reason: String },
}

impl Trouble {
    /// What to do about it, in one sentence.
    pub fn cure(&self) -> &'static str {
        match self {
            Self::NobodyListens { .. } => {
                "Correct the port in the rig file, or wait until the program that sends the picture has started."
            }
            Self::Unreachable { .. } => {
                "Check the cable and that this computer has an address in the network of the endoscope."
            }
            Self::NoSuchName { .. } => "Correct the name in the rig file, or give an address in numbers.",
            Self::Refused { status: 401 | 403, .. } => {
                "Let the camera give its picture without a password: a password is not supported."
            }
            Self::Refused { status: 404, .. } => "Correct the path in the rig file: the camera has no such page.",
            Self::Refused { .. } => "Correct the address in the rig file, or start the camera again.",
            Self::OtherFormat { .. } => "Set the camera to motion JPEG (MJPEG), or correct the path in the rig file.",
            Self::Unreadable { .. } => {
                "Correct the port in the rig file: another program answers there, or the camera does not keep to HTTP."
            }
            Self::Silent { .. } => "Switch the camera on, and check that it sends a picture to a browser.",
            Self::Closed { .. } => "Nothing is to be done: it is opened again at once and then twice a second.",
            Self::File { .. } => "Put the file there, or correct its path in the rig file.",
            Self::Other { .. } => "Check the camera and its address in the rig file.",
        }
    }

    /// From an error of a connection.
    pub(crate) fn of_network(place: &str, error: &io::Error) -> Self {
        let place = place.to_owned();
        match error.kind() {
            ErrorKind::ConnectionRefused => Self::NobodyListens { place },
            ErrorKind::TimedOut
            | ErrorKind::WouldBlock
            | ErrorKind::HostUnreachable
            | ErrorKind::NetworkUnreachable
            | ErrorKind::NetworkDown => Self::Unreachable { place },
            ErrorKind::ConnectionReset | ErrorKind::ConnectionAborted | ErrorKind::BrokenPipe => Self::Closed { place },
            _ => Self::Other { place, reason: error.to_string() },
        }
    }
}
