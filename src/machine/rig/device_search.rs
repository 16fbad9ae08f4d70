//! Searches for devices that could become a part of a rig and that the rig does not use yet.
//!
//! USB devices are found automatically; network devices are tried at an address that the user names. The driver of its
//! kind queries the identity of each device. Not for the real-time thread, because it opens devices and waits.

use std::path::{Path, PathBuf};

use nima_core::kinematics::ArmModel;
use nima_devices::{
    DeviceError, DeviceIdentity, bota,
    discovery::{DiscoveryDiagnosis, PluggedDevices, Probe, TIMEOUT, TestOutcome, diagnose, probe_named, probes},
    dynamixel, force_dimension, kinova, ndi,
};
use toml_edit::Value;

use super::{PartKind, RigPart, RigSettings, places::same_file};

/// A device that was found, and the settings with which a rig file can use it.
#[derive(Clone, Debug)]
pub struct DeviceOffer {
    /// Port, address or name of the device.
    pub place: String,
    pub identity: DeviceIdentity,
    /// Keys below the part's table, and their values.
    pub(crate) changes: Vec<(&'static str, Value)>,
}

#[derive(Clone, Debug)]
pub struct SearchResult {
    pub place: String,
    /// The device at this address, or the reason why there is none.
    pub found: Result<DeviceOffer, DeviceError>,
}

/// A location to try: ports for devices on a serial line, USB for the others.
struct SearchScope {
    place: String,
    serial: Option<String>,
    changes: Vec<(&'static str, Value)>,
    probe: Box<dyn Probe>,
}

/// Searches for devices for this part: among the plugged devices, and at `place` if the user named one.
pub fn seek(part: RigPart, devices: &RigSettings, plugged: &PluggedDevices, place: &str) -> Vec<SearchResult> {
    // An external device sends to the address in the rig file by itself, and a simulated device is not plugged in.
    if !part.has_usual_make(devices) {
        return Vec::new();
    }
    let ports = Ports::free(devices, plugged, place.trim());
    let trials = match part.kind() {
        PartKind::Handle => return handles(part, devices),
        PartKind::Pedal => return pedals(devices, plugged),
        PartKind::Arm => arms(part, devices, place.trim()),
        PartKind::Sensor => sensors(&ports),
        PartKind::Servos => servos(part, devices, &ports),
        PartKind::Tracker => trackers(devices, &ports),
    };
    let (probes, wanted): (Vec<_>, Vec<_>) = trials
        .into_iter()
        .map(|SearchScope { place, serial, changes, probe }| (probe, (place, serial, changes)))
        .unzip();
    let found = diagnose(probes, TIMEOUT);
    found
        .into_iter()
        .zip(wanted)
        .map(|(diagnosis, (place, serial, changes))| report(diagnosis, place, serial, changes))
        .collect()
}

fn report(
    diagnosis: DiscoveryDiagnosis,
    place: String,
    serial: Option<String>,
    mut changes: Vec<(&'static str, Value)>,
) -> SearchResult {
    let found = match diagnosis.outcome {
        TestOutcome::Trouble { trouble, .. } => Err(trouble),
        TestOutcome::Connected(found) => {
            let mut identity = found.identity;
            // A servo bus has no serial number; its USB adapter has one.
            match serial {
                Some(serial) => identity.serial = serial,
                None => {
                    if let Some((_, number)) = changes.iter_mut().find(|(key, _)| *key == SERIAL_NUMBER) {
                        *number = identity.serial.as_str().into();
                    }
                }
            }
            changes.retain(|(key, value)| *key != SERIAL_NUMBER || value.as_str() != Some(""));
            Ok(DeviceOffer { place: place.clone(), identity, changes })
        }
    };
    SearchResult { place, found }
}

/// Key of the serial number of a sensor or an arm; filled in once the device has reported it.
const SERIAL_NUMBER: &str = "serial_number";

/// Serial ports that no part of the rig uses, and the location that the user named.
struct Ports {
    /// Each port with the serial number of its USB adapter.
    lines: Vec<(String, Option<String>)>,
    /// A network address.
    address: Option<String>,
}

impl Ports {
    fn free(devices: &RigSettings, plugged: &PluggedDevices, place: &str) -> Self {
        let is_line = place.contains('/') || place.starts_with("COM");
        let used = used_ports(devices);
        let is_used = |path: &Path| used.iter().any(|used| same_file(used, path));
        let named = is_line.then(|| (place.to_owned(), None));
        let found = plugged.serial.iter().filter(|port| port.usb.is_some() && !is_used(&port.path)).map(|port| {
            let serial = port.usb.as_ref().map(|usb| usb.serial.clone()).filter(|serial| !serial.is_empty());
            (lasting_name(&port.path).display().to_string(), serial)
        });
        let lines = if is_line { named.into_iter().collect() } else { found.collect() };
        Self { lines, address: (!is_line && !place.is_empty()).then(|| place.to_owned()) }
    }
}

fn used_ports(devices: &RigSettings) -> Vec<PathBuf> {
    let mut used = Vec::new();
    for set in [&devices.right, &devices.left].into_iter().flatten() {
        used.extend(set.sensor.bota().map(|sensor| sensor.port.clone()));
        used.extend(set.servos.as_ref().map(|servos| servos.port.clone()));
    }
    used.extend(devices.tissue_sensor.as_ref().and_then(|sensor| sensor.bota()).map(|sensor| sensor.port.clone()));
    used.extend(devices.tracker.as_ref().and_then(|tracker| tracker.port.clone()));
    used.into_iter().map(PathBuf::from).collect()
}

/// Returns a port name that contains the device's serial number and stays valid when devices are plugged in a different
/// order.
fn lasting_name(port: &Path) -> PathBuf {
    let names = std::fs::read_dir("/dev/serial/by-id").into_iter().flatten().flatten().map(|entry| entry.path());
    names.into_iter().find(|name| same_file(name, port)).unwrap_or_else(|| port.to_owned())
}

/// Finds every handle that is not open in another program.
fn handles(part: RigPart, devices: &RigSettings) -> Vec<SearchResult> {
    let place = "USB".to_owned();
    let now = part.side().and_then(|side| devices.arm(side)).and_then(|set| set.handle.force_dimension());
    match force_dimension::attached(&now.cloned().unwrap_or_default()) {
        Err(trouble) => vec![SearchResult { place, found: Err(trouble) }],
        Ok(handles) => {
            let offer = |(serial, identity): (u16, DeviceIdentity)| {
                let changes = vec![("serial", Value::from(i64::from(serial)))];
                SearchResult {
                    place: place.clone(),
                    found: Ok(DeviceOffer { place: place.clone(), identity, changes }),
                }
            };
            handles.into_iter().map(offer).collect()
        }
    }
}

/// Finds pedals by their ids, without opening them.
fn pedals(devices: &RigSettings, plugged: &PluggedDevices) -> Vec<SearchResult> {
    let used = devices.pedal.as_ref().map(|pedal| pedal.source.clone());
    let mut sought: Vec<SearchResult> = Vec::new();
    for node in plugged.hid.iter().filter(|node| node.usable_as == Some("foot pedal")) {
        let usb = &node.usb;
        let ids = format!("{:04x}:{:04x}", usb.vendor, usb.product);
        let place = if usb.serial.is_empty() { ids } else { format!("{ids}:{}", usb.serial) };
        // A pedal has one node for each of its interfaces.
        if used.as_ref() == Some(&place) || sought.iter().any(|one| one.place == place) {
            continue;
        }
        let identity =
            DeviceIdentity { product: usb.name.clone(), serial: usb.serial.clone(), ..DeviceIdentity::default() };
        let changes = vec![("source", Value::from(place.as_str()))];
        sought.push(SearchResult { place: place.clone(), found: Ok(DeviceOffer { place, identity, changes }) });
    }
    sought
}

/// Tries the address that the user named. The factory's address may belong to another device in the user's network.
fn arms(part: RigPart, devices: &RigSettings, place: &str) -> Vec<SearchScope> {
    let set = part.side().and_then(|side| devices.arm(side));
    let model = set.and_then(|set| set.model().ok()).unwrap_or(ArmModel::GEN3);
    let now = set.and_then(|set| set.arm.kinova()).cloned().unwrap_or_default();
    let usual = kinova::KinovaSettings::default();
    let Some(at) = kinova::KinovaSettings::at(place) else { return Vec::new() };
    let mut changes = vec![("host", Value::from(at.host.as_str())), (SERIAL_NUMBER, "".into())];
    if (at.tcp_port, at.udp_port) != (usual.tcp_port, usual.udp_port) {
        changes.push(("tcp_port", i64::from(at.tcp_port).into()));
        changes.push(("udp_port", i64::from(at.udp_port).into()));
    }
    let settings = kinova::KinovaSettings {
        host: at.host,
        tcp_port: at.tcp_port,
        udp_port: at.udp_port,
        serial_number: None,
        ..now
    };
    vec![SearchScope {
        place: place.to_owned(),
        serial: None,
        changes,
        probe: probes::arm(part.name(), settings, Some(model)),
    }]
}

/// Returns a port that the system calls a modem is a sensor of the second generation; an adapter may carry either
/// generation.
fn sensors(ports: &Ports) -> Vec<SearchScope> {
    use bota::Transport::{Gen0, GenA, Socket};
    let trial = |place: &str, transport, name: &str| {
        let settings = bota::BotaSettings::new(transport, place);
        settings.check().ok()?;
        let changes = vec![("transport", name.into()), ("port", place.into()), (SERIAL_NUMBER, "".into())];
        Some(SearchScope { place: place.to_owned(), serial: None, changes, probe: probes::sensor(place, settings) })
    };
    let on_line = |(place, _): &(String, Option<String>)| {
        let is_usb = Path::new(place).canonicalize().is_ok_and(|real| real.to_string_lossy().contains("ttyACM"));
        if is_usb { trial(place, GenA, "gen-a") } else { trial(place, Gen0, "gen0") }
    };
    let in_network = ports.address.iter().filter_map(|address| trial(address, Socket, "socket"));
    ports.lines.iter().filter_map(on_line).chain(in_network).collect()
}

/// Lists servos without configuring them.
fn servos(part: RigPart, devices: &RigSettings, ports: &Ports) -> Vec<SearchScope> {
    let now = part.side().and_then(|side| devices.arm(side)).and_then(|set| set.servos.as_ref());
    let baud = now.map_or(dynamixel::table::BAUDS[0], |servos| servos.baud);
    let trial = |(place, serial): &(String, Option<String>)| {
        let probe = probe_named(&format!("dynamixel={place}@{baud}")).ok()?;
        let changes = vec![("port", Value::from(place.as_str()))];
        Some(SearchScope { place: place.clone(), serial: serial.clone(), changes, probe })
    };
    ports.lines.iter().filter_map(trial).collect()
}

/// Opens a tracker with the tools of the rig.
fn trackers(devices: &RigSettings, ports: &Ports) -> Vec<SearchScope> {
    let Some(now) = &devices.tracker else { return Vec::new() };
    let trial = |settings: ndi::NdiSettings, key: &'static str, place: &str| {
        settings.check().ok()?;
        let changes = vec![(key, Value::from(place))];
        Some(SearchScope { place: place.to_owned(), serial: None, changes, probe: probes::tracker(place, settings) })
    };
    let on_line = ports.lines.iter().filter_map(|(place, _)| {
        trial(ndi::NdiSettings { port: Some(place.clone()), address: None, ..now.clone() }, "port", place)
    });
    let in_network = ports.address.iter().filter_map(|address| {
        trial(ndi::NdiSettings { address: Some(address.clone()), port: None, ..now.clone() }, "address", address)
    });
    on_line.chain(in_network).collect()
}
