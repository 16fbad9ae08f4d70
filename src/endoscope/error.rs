//! Reasons for a missing image, each with its remedy.

use std::io::{self, ErrorKind};

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EndoscopeError {
    #[error("no response from {place}")]
    NobodyListens { place: String },
    #[error("{place} cannot be reached")]
    Unreachable { place: String },
    #[error("unknown host name in {place}")]
    NoSuchName { place: String },
    #[error("{place} responds with status {status}")]
    Refused { place: String, status: u16 },
    #[error("{place} redirects to {to}")]
    Redirected { place: String, to: String },
    #[error("{place} sends {found}, not {wanted}")]
    OtherFormat { place: String, found: String, wanted: &'static str },
    /// The response is not HTTP or exceeds a limit.
    #[error("{place} sent an unreadable response: {reason}")]
    Unreadable { place: String, reason: String },
    #[error("{place} is open but sends nothing")]
    Silent { place: String },
    #[error("{place} closed the connection")]
    Closed { place: String },
    #[error("{path} does not exist")]
    NoCamera { path: String },
    #[error("{path} is in use by another program")]
    Busy { path: String },
    #[error("this user has no permission to use {path}")]
    NoPermission { path: String },
    #[error("{path} is not a camera")]
    NotCamera { path: String },
    #[error("{path} does not offer {wanted}, only {offered}")]
    NoSuchFormat { path: String, wanted: String, offered: String },
    #[error("{path} does not offer images of {}x{}, only {offered}", .wanted[0], .wanted[1])]
    NoSuchSize { path: String, wanted: [u32; 2], offered: String },
    /// The USB bus lacks bandwidth for the stream.
    #[error("{path} lacks bandwidth on its USB bus")]
    NoBandwidth { path: String },
    #[error("{path} was unplugged")]
    Unplugged { path: String },
    #[error("{path} is open but sends no images")]
    NoPictures { path: String },
    #[error("{path}: {reason}")]
    Camera { path: String, reason: String },
    #[error("this program was built without {what}")]
    NotBuilt { what: &'static str },
    #[error("{path}: {reason}")]
    File { path: String, reason: String },
    #[error("{place}: {reason}")]
    Other { place: String, reason: String },
}

impl EndoscopeError {
    /// Returns the remedy, in one sentence.
    pub fn cure(&self) -> &'static str {
        match self {
            Self::NobodyListens { .. } => {
                "Correct the port in the rig file, or wait until the program that sends the image has started."
            }
            Self::Unreachable { .. } => {
                "Check the cable and that this computer has an address in the network of the endoscope."
            }
            Self::NoSuchName { .. } => "Correct the host name in the rig file, or enter a numeric address.",
            Self::Refused { status: 401 | 403, .. } => {
                "Add the camera's user name and password to its address in the rig file, as in http://USER:PASSWORD@HOST/PATH, or correct them."
            }
            Self::Refused { status: 404, .. } => "Correct the path in the rig file: the camera has no such page.",
            Self::Refused { .. } => "Correct the address in the rig file, or restart the camera.",
            Self::Redirected { .. } => {
                "Enter the address of the image itself in the rig file: only redirects within a camera and without encryption are followed."
            }
            Self::OtherFormat { wanted: "H.264", .. } => {
                "Set the camera to H.264, or correct the path in the rig file."
            }
            Self::OtherFormat { .. } => "Set the camera to motion JPEG (MJPEG), or correct the path in the rig file.",
            Self::Unreadable { .. } => {
                "Correct the port in the rig file: another program answers there, or the camera does not follow the protocol."
            }
            Self::Silent { .. } => "Switch the camera on, and check that a browser shows its image.",
            Self::Closed { .. } => "No action is needed: the console reconnects at once, then tries twice per second.",
            Self::NoCamera { .. } => {
                "Plug the camera in, or correct its path in the rig file: `nima devices` lists cameras."
            }
            Self::Busy { .. } => "Close the other program that uses this camera.",
            Self::NoPermission { .. } => {
                "Add this user to the group video (`sudo usermod -aG video $USER`), then log out and in."
            }
            Self::NotCamera { .. } => "Enter the path of a camera: `nima devices` lists cameras.",
            Self::NoSuchFormat { .. } => {
                "Omit `format` from the address; the camera must offer motion JPEG, NV12 or YUYV."
            }
            Self::NoSuchSize { .. } => "Choose a size that the camera offers, in its address in the rig file.",
            Self::NoBandwidth { .. } => {
                "Connect the camera to its own USB port, without a hub, or set a smaller size or rate in the address."
            }
            Self::Unplugged { .. } => "Plug the camera in again: it reconnects automatically.",
            Self::NoPictures { .. } => {
                "Check the signal at the capture card and the camera's cable, then plug the camera in again."
            }
            Self::Camera { .. } => "Plug the camera in again; see `dmesg` for the driver's messages.",
            Self::NotBuilt { .. } => {
                "Build it with `cargo build --release --locked -p nima-console --features h264`, or set the camera to motion JPEG."
            }
            Self::File { .. } => "Put the file there, or correct its path in the rig file.",
            Self::Other { .. } => "Check the camera and its address in the rig file.",
        }
    }

    /// Converts an error of a connection.
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
