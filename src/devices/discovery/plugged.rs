//! Lists the devices that are plugged in, from the kernel's file system, without opening any of them.

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde::Serialize;

use crate::hid;

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct UsbIds {
    pub vendor: u16,
    pub product: u16,
    pub name: String,
    pub serial: String,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SerialPort {
    pub path: PathBuf,
    pub usb: Option<UsbIds>,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct HidNode {
    pub path: PathBuf,
    pub usb: UsbIds,
    /// Possible use in this program.
    pub usable_as: Option<&'static str>,
}

/// A USB device of a known vendor that is neither a serial port nor a human interface device.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct UsbDevice {
    pub usb: UsbIds,
    /// Possible use in this program.
    pub usable_as: &'static str,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PluggedDevices {
    pub serial: Vec<SerialPort>,
    pub hid: Vec<HidNode>,
    pub usb: Vec<UsbDevice>,
    /// Path of Force Dimension's library, if it is installed.
    pub force_dimension_library: Option<PathBuf>,
}

/// Vendors of devices that are used through a library.
const VENDORS: [(u16, &str); 1] = [(0x1451, "Force Dimension haptic device")];

fn text(path: &Path) -> Option<String> {
    fs::read_to_string(path).ok().map(|text| text.trim().to_owned())
}

fn hexadecimal(path: &Path) -> Option<u16> {
    u16::from_str_radix(&text(path)?, 16).ok()
}

/// Returns the entries of a folder, sorted by name with numbers in numerical order; empty if the folder does not exist.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<_> = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    entries.sort_by_key(|path| (path.as_os_str().len(), path.clone()));
    entries
}

impl UsbIds {
    /// Reads the description of a USB device from its folder in sysfs.
    fn of_folder(folder: &Path) -> Option<Self> {
        Some(Self {
            vendor: hexadecimal(&folder.join("idVendor"))?,
            product: hexadecimal(&folder.join("idProduct"))?,
            name: text(&folder.join("product")).unwrap_or_default(),
            serial: text(&folder.join("serial")).unwrap_or_default(),
        })
    }

    /// Returns the USB device to which a device belongs: the nearest parent folder that describes one.
    fn above(device: &Path) -> Option<Self> {
        let real = device.canonicalize().ok()?;
        real.ancestors().find_map(Self::of_folder)
    }

    /// Returns the USB device of a serial port; the kernel's file system is at `sys`.
    pub fn of_port(sys: &Path, port: &Path) -> Option<Self> {
        // A name from udev is a symbolic link.
        let real = port.canonicalize().unwrap_or_else(|_| port.to_owned());
        Self::above(&sys.join("class/tty").join(real.file_name()?).join("device"))
    }

    pub fn words(&self) -> String {
        let Self { vendor, product, name, serial } = self;
        let mut words = format!("{vendor:04x}:{product:04x}");
        for part in [name, serial].into_iter().filter(|part| !part.is_empty()) {
            words.push(' ');
            words.push_str(part);
        }
        words
    }
}

impl PluggedDevices {
    pub fn list() -> Self {
        let library = crate::force_dimension::installed_library();
        Self { force_dimension_library: library, ..Self::under(Path::new("/sys")) }
    }

    /// Returns one line for each device: location, possible use, identity.
    pub fn lines(&self) -> Vec<[String; 3]> {
        let usb = |usb: &Option<UsbIds>| usb.as_ref().map_or_else(|| "not on USB".to_owned(), UsbIds::words);
        let mut lines = Vec::new();
        for port in &self.serial {
            lines.push([port.path.display().to_string(), "serial port".to_owned(), usb(&port.usb)]);
        }
        for node in &self.hid {
            let used = node.usable_as.unwrap_or("other input device").to_owned();
            lines.push([node.path.display().to_string(), used, node.usb.words()]);
        }
        for device in &self.usb {
            lines.push(["USB".to_owned(), device.usable_as.to_owned(), device.usb.words()]);
        }
        if let Some(library) = &self.force_dimension_library {
            lines.push(["library".to_owned(), "Force Dimension SDK".to_owned(), library.display().to_string()]);
        }
        lines
    }

    /// Lists devices from the kernel's file system at `sys`; does not search for a library.
    pub fn under(sys: &Path) -> Self {
        let serial = entries(&sys.join("class/tty")).iter().filter_map(|entry| serial_port(entry)).collect();
        let hid = entries(&sys.join("class/hidraw")).iter().filter_map(|entry| hid_node(entry)).collect();
        let devices = entries(&sys.join("bus/usb/devices"));
        let usb = devices.iter().filter_map(|folder| {
            let usb = UsbIds::of_folder(folder)?;
            let (_, usable_as) = VENDORS.into_iter().find(|(vendor, _)| *vendor == usb.vendor)?;
            Some(UsbDevice { usb, usable_as })
        });
        Self { serial, hid, usb: usb.collect(), force_dimension_library: None }
    }
}

/// Returns a serial port that has a device. The kernel also lists ports that the board does not have; their type is 0.
fn serial_port(entry: &Path) -> Option<SerialPort> {
    let device = entry.join("device");
    if !device.exists() || text(&entry.join("type")).is_some_and(|kind| kind == "0") {
        return None;
    }
    Some(SerialPort { path: Path::new("/dev").join(entry.file_name()?), usb: UsbIds::above(&device) })
}

fn hid_node(entry: &Path) -> Option<HidNode> {
    let event = text(&entry.join("device/uevent"))?;
    let value = |key: &str| event.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='));
    // Bus, vendor and product in hexadecimal.
    let mut ids = value("HID_ID")?.split(':').skip(1).map(|part| u32::from_str_radix(part, 16).ok());
    let mut id = || ids.next().flatten().and_then(|id| u16::try_from(id).ok());
    let usb = UsbIds {
        vendor: id()?,
        product: id()?,
        name: value("HID_NAME").unwrap_or_default().to_owned(),
        serial: value("HID_UNIQ").unwrap_or_default().to_owned(),
    };
    let identity = hid::HidIdentity { vendor: usb.vendor, product: usb.product, ..hid::HidIdentity::default() };
    let usable_as = identity.kind().map(hid::HidKind::words);
    Some(HidNode { path: Path::new("/dev").join(entry.file_name()?), usb, usable_as })
}
