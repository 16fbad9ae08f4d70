//! Sources of reports, as written in a rig file.

use std::{fmt, path::PathBuf, str::FromStr};

use nima_files::quoted;

use super::{
    models::{HidKind, known},
    raw,
};
use crate::{DeviceError, DeviceIdentity, transport::TransportDatagrams};

/// Source of reports. In a rig file: `any`, `046d:c626`, `046d:c626:SERIAL`, a path such as `/dev/hidraw0`,
/// `emulated:PATH` (the socket of `nima emulate`), `spacenavd` or `spacenavd:PATH` (caps only).
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HidSource {
    /// The first known device of this kind.
    Any,
    /// A device with these USB ids.
    Ids {
        vendor: u16,
        product: u16,
        /// Serial number, to choose among several.
        serial: Option<String>,
    },
    Path(PathBuf),
    /// The socket of this project's emulator.
    Emulated(PathBuf),
    /// The socket of `spacenavd`.
    Spacenavd(PathBuf),
}

/// Identity of a human interface device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HidIdentity {
    pub vendor: u16,
    pub product: u16,
    pub serial: String,
    pub name: String,
}

/// First word of an emulator's first packet, which contains the data that the kernel's file system provides for a real
/// device.
const HELLO: &str = "nima-hid";

impl HidIdentity {
    /// Returns the emulator's first packet.
    pub fn hello(&self) -> String {
        // A word must not be empty, because the parts are separated by spaces.
        let serial = if self.serial.is_empty() { "-" } else { &self.serial };
        format!("{HELLO} {:04x}:{:04x} {serial} {}", self.vendor, self.product, self.name)
    }

    #[cfg(any(target_os = "linux", test))]
    pub(super) fn of_hello(packet: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(packet).ok()?;
        // The name is last, because it may contain spaces.
        let mut words = text.splitn(4, ' ');
        let (Some(HELLO), Some(ids), Some(serial), Some(name)) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            return None;
        };
        let (vendor, product) = ids.split_once(':')?;
        let id = |text| u16::from_str_radix(text, 16).ok();
        let serial = if serial == "-" { String::new() } else { serial.to_owned() };
        Some(Self { vendor: id(vendor)?, product: id(product)?, serial, name: name.to_owned() })
    }

    /// Returns the format of the reports; `None` for an unknown device. Every newer device of 3Dconnexion is a cap.
    pub fn kind(&self) -> Option<HidKind> {
        match known(self.vendor, self.product) {
            Some(model) => Some(model.kind),
            // Models newer than this program use the same reports.
            None if self.vendor == 0x256f => Some(HidKind::Cap),
            None => None,
        }
    }

    /// Returns the text for a message.
    pub fn words(&self) -> String {
        let Self { vendor, product, name, .. } = self;
        let name = if name.is_empty() { known(*vendor, *product).map_or("device", |model| model.name) } else { name };
        format!("{} ({vendor:04x}:{product:04x})", quoted(name))
    }

    pub(super) fn identity(&self) -> DeviceIdentity {
        DeviceIdentity { product: self.words(), serial: self.serial.clone(), firmware: String::new() }
    }
}

impl FromStr for HidSource {
    type Err = DeviceError;

    fn from_str(text: &str) -> Result<Self, DeviceError> {
        let wrong = || DeviceError::Setting {
            key: "source".to_owned(),
            value: format!("\"{text}\""),
            allowed: "any, VENDOR:PRODUCT[:SERIAL] in hexadecimal digits, a path, emulated:PATH or spacenavd[:PATH]"
                .to_owned(),
        };
        match text.split_once(':') {
            Some(("emulated", path)) if !path.is_empty() => return Ok(Self::Emulated(path.into())),
            Some(("spacenavd", path)) if !path.is_empty() => return Ok(Self::Spacenavd(path.into())),
            None if text == "any" => return Ok(Self::Any),
            None if text == "spacenavd" => {
                let path = std::env::var_os("SPNAV_SOCKET").unwrap_or_else(|| super::spacenavd::SOCKET.into());
                return Ok(Self::Spacenavd(path.into()));
            }
            _ if text.contains('/') => return Ok(Self::Path(text.into())),
            _ => {}
        }
        let mut parts = text.splitn(3, ':');
        let mut id = || parts.next().filter(|part| part.len() == 4).and_then(|part| u16::from_str_radix(part, 16).ok());
        let (Some(vendor), Some(product)) = (id(), id()) else { return Err(wrong()) };
        Ok(Self::Ids { vendor, product, serial: parts.next().map(str::to_owned) })
    }
}

impl fmt::Display for HidSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => f.write_str("any"),
            Self::Ids { vendor, product, serial: None } => write!(f, "{vendor:04x}:{product:04x}"),
            Self::Ids { vendor, product, serial: Some(serial) } => write!(f, "{vendor:04x}:{product:04x}:{serial}"),
            Self::Path(path) => path.display().fmt(f),
            Self::Emulated(path) => write!(f, "emulated:{}", path.display()),
            Self::Spacenavd(path) => write!(f, "spacenavd:{}", path.display()),
        }
    }
}

impl HidSource {
    /// Opens the source and checks that the device is one of `kinds`; ids given in the rig file are not checked.
    pub(super) fn open(&self, kinds: &[HidKind]) -> Result<(Box<dyn TransportDatagrams>, HidIdentity), DeviceError> {
        let opened = self.open_any(kinds)?;
        let is_chosen = matches!(self, Self::Ids { .. });
        if is_chosen || opened.1.kind().is_some_and(|kind| kinds.contains(&kind)) {
            return Ok(opened);
        }
        let what = kinds.first().map_or("device", |kind| kind.words());
        Err(DeviceError::WrongProduct { place: self.to_string(), expected: what.to_owned(), found: opened.1.words() })
    }

    /// Opens the source; a path may lead to any device.
    pub(super) fn open_any(
        &self,
        kinds: &[HidKind],
    ) -> Result<(Box<dyn TransportDatagrams>, HidIdentity), DeviceError> {
        let what = kinds.first().map_or("device", |kind| kind.words());
        let fits = |identity: &HidIdentity| identity.kind().is_some_and(|kind| kinds.contains(&kind));
        match self {
            Self::Any => raw::open_first(&format!("any {what}"), fits),
            // Ids in a rig file are the operator's decision, also for a model that is not listed.
            Self::Ids { vendor, product, serial } => raw::open_first(&format!("{what} {self}"), |identity| {
                (identity.vendor, identity.product) == (*vendor, *product)
                    && serial.as_ref().is_none_or(|serial| *serial == identity.serial)
            }),
            Self::Path(path) => raw::open_path(path),
            Self::Emulated(path) => emulated(path),
            Self::Spacenavd(_) => Err(DeviceError::Setting {
                key: "source".to_owned(),
                value: self.to_string(),
                allowed: "spacenavd supports caps only".to_owned(),
            }),
        }
    }
}

#[cfg(target_os = "linux")]
fn emulated(path: &std::path::Path) -> Result<(Box<dyn TransportDatagrams>, HidIdentity), DeviceError> {
    use std::time::{Duration, Instant};
    /// Time limit for the emulator's first packet.
    const TIMEOUT: Duration = Duration::from_millis(300);
    let place = format!("emulated:{}", path.display());
    let mut packets = super::seqpacket::connect(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::ConnectionRefused => DeviceError::NobodyListens { place: place.clone() },
        _ => DeviceError::of_port(path, &error, "the socket of an emulator belongs to the user who started it"),
    })?;
    let begin = Instant::now();
    let mut buffer = [0; 256];
    while begin.elapsed() < TIMEOUT {
        match packets.receive(&mut buffer) {
            Ok(Some(count)) => {
                let wrong = || DeviceError::WrongProduct {
                    place: place.clone(),
                    expected: "emulated human interface device".to_owned(),
                    found: "socket of another program".to_owned(),
                };
                let identity = HidIdentity::of_hello(&buffer[..count]).ok_or_else(wrong)?;
                return Ok((Box::new(packets), identity));
            }
            Ok(None) => std::thread::sleep(Duration::from_millis(1)),
            Err(_) => return Err(DeviceError::Absent { place }),
        }
    }
    Err(DeviceError::Silent { place })
}

#[cfg(not(target_os = "linux"))]
fn emulated(path: &std::path::Path) -> Result<(Box<dyn TransportDatagrams>, HidIdentity), DeviceError> {
    Err(DeviceError::Other { place: path.display().to_string(), reason: "emulated devices need Linux".to_owned() })
}
