//! Reports of a real device: found and checked with `hidapi`, read without waiting and without allocation.

use std::path::Path;

use hidapi::{DeviceInfo, HidApi};

use super::{
    models::{HidKind, known},
    source::HidIdentity,
};
use crate::{DeviceError, Loss, discovery::rules, transport::TransportDatagrams};

/// Returns usage page and usage of the interface that sends the reports; a device may have several interfaces.
const fn usage(kind: HidKind) -> Option<(u16, u16)> {
    match kind {
        // Generic desktop page: multi-axis controller, keyboard.
        HidKind::Cap => Some((1, 8)),
        HidKind::KeyboardPedal => Some((1, 6)),
        HidKind::SwitchPedal => None,
    }
}

fn other(place: &str, error: &hidapi::HidError) -> DeviceError {
    DeviceError::Other { place: place.to_owned(), reason: error.to_string() }
}

fn identity(info: &DeviceInfo) -> HidIdentity {
    HidIdentity {
        vendor: info.vendor_id(),
        product: info.product_id(),
        serial: info.serial_number().unwrap_or_default().to_owned(),
        name: info.product_string().unwrap_or_default().to_owned(),
    }
}

/// Opens the first device that `wanted` accepts, at the interface that sends the reports.
pub(super) fn open_first(
    what: &str,
    wanted: impl Fn(&HidIdentity) -> bool,
) -> Result<(Box<dyn TransportDatagrams>, HidIdentity), DeviceError> {
    let api = HidApi::new().map_err(|error| other(what, &error))?;
    let reports = |info: &DeviceInfo| {
        let kind = known(info.vendor_id(), info.product_id()).map(|model| model.kind);
        kind.and_then(usage).is_none_or(|usage| usage == (info.usage_page(), info.usage()))
    };
    let found = api.device_list().filter(|info| wanted(&identity(info)));
    let found = found.min_by_key(|info| (!reports(info), info.interface_number()));
    let found = found.ok_or_else(|| DeviceError::Absent { place: what.to_owned() })?;
    open(&api, found)
}

pub(super) fn open_path(path: &Path) -> Result<(Box<dyn TransportDatagrams>, HidIdentity), DeviceError> {
    let place = path.display().to_string();
    permitted(path, None)?;
    let api = HidApi::new().map_err(|error| other(&place, &error))?;
    let real = path.canonicalize();
    let real = real.as_deref().unwrap_or(path);
    let is_it = |info: &&DeviceInfo| info.path().to_str().is_ok_and(|known| Path::new(known) == real);
    match api.device_list().find(is_it) {
        Some(info) => open(&api, info),
        None => Err(DeviceError::WrongProduct {
            place,
            expected: "human interface device (hidraw)".to_owned(),
            found: "file of a different type".to_owned(),
        }),
    }
}

/// Opens and closes the node, to get the system's error code if this fails; `hidapi` gives only a text.
fn permitted(path: &Path, ids: Option<(u16, u16)>) -> Result<(), DeviceError> {
    let mut options = std::fs::File::options();
    options.read(true).write(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK | libc::O_NOCTTY);
    let rule = rules::of_hidraw(ids);
    options.open(path).map(drop).map_err(|error| DeviceError::of_port(path, &error, &rule))
}

#[cfg(target_os = "linux")]
fn open(api: &HidApi, info: &DeviceInfo) -> Result<(Box<dyn TransportDatagrams>, HidIdentity), DeviceError> {
    let place = info.path().to_string_lossy().into_owned();
    let path = Path::new(&place);
    permitted(path, Some((info.vendor_id(), info.product_id())))?;
    // Checks that it is a hidraw node. It is not read through `hidapi`, which allocates a text for every error.
    drop(api.open_path(info.path()).map_err(|error| other(&place, &error))?);
    let mut options = std::fs::File::options();
    options.read(true).write(true);
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK);
    let node = options.open(path).map_err(|error| DeviceError::of_port(path, &error, &rules::of_hidraw(None)))?;
    Ok((Box::new(RawNode { node }), identity(info)))
}

#[cfg(not(target_os = "linux"))]
fn open(api: &HidApi, info: &DeviceInfo) -> Result<(Box<dyn TransportDatagrams>, HidIdentity), DeviceError> {
    let place = info.path().to_string_lossy().into_owned();
    let node = api.open_path(info.path()).map_err(|error| other(&place, &error))?;
    node.set_blocking_mode(false).map_err(|error| other(&place, &error))?;
    Ok((Box::new(RawNode { node }), identity(info)))
}

struct RawNode {
    #[cfg(target_os = "linux")]
    node: std::fs::File,
    #[cfg(not(target_os = "linux"))]
    node: hidapi::HidDevice,
}

#[cfg(target_os = "linux")]
impl TransportDatagrams for RawNode {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss> {
        use std::io::{ErrorKind, Read as _};
        match self.node.read(buffer) {
            // A report has at least one byte, so 0 means the end.
            Ok(0) => Err(Loss::Disconnected),
            Ok(count) => Ok(Some(count)),
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(None),
            Err(_) => Err(Loss::Disconnected),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        std::io::Write::write(&mut self.node, bytes).map(drop).map_err(|_| Loss::Disconnected)
    }
}

#[cfg(not(target_os = "linux"))]
impl TransportDatagrams for RawNode {
    fn receive(&mut self, buffer: &mut [u8]) -> Result<Option<usize>, Loss> {
        match self.node.read(buffer) {
            Ok(0) => Ok(None),
            Ok(count) => Ok(Some(count)),
            Err(_) => Err(Loss::Disconnected),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Loss> {
        self.node.write(bytes).map(drop).map_err(|_| Loss::Disconnected)
    }
}
