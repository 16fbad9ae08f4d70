//! Places at which a program reaches its devices, and the check that no two parts of a rig have the same one: the
//! second part would fail to open, or both would be one device.

use std::{
    fmt,
    net::{IpAddr, SocketAddr},
    path::{Path, PathBuf},
};

use nima_devices::{DeviceError, hid, ndi, same_serial, transport};

use super::{PartKind, RigPart, RigSettings};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// A device file.
    File(PathBuf),
    /// A port, of this computer or of a device. A device's number of a port is not one of another protocol.
    Port { is_udp: bool, host: String, port: u16 },
}

/// A place and the key that names it in the table of its part.
pub(super) type NamedPlace = (&'static str, Place);

impl Place {
    pub(super) fn file(path: impl Into<PathBuf>) -> Self {
        Self::File(path.into())
    }

    pub(super) fn tcp(host: &str, port: u16) -> Self {
        Self::Port { is_udp: false, host: host.to_owned(), port }
    }

    pub(super) fn udp(host: &str, port: u16) -> Self {
        Self::Port { is_udp: true, host: host.to_owned(), port }
    }

    /// Returns the TCP port of `HOST[:PORT]`.
    pub(super) fn tcp_at(address: &str, usual: u16) -> Self {
        let named = address.rsplit_once(':').filter(|(host, _)| !host.contains(':') || host.ends_with(']'));
        match named.and_then(|(host, port)| Some((host, port.parse().ok()?))) {
            Some((host, port)) => Self::tcp(host, port),
            None => Self::tcp(address, usual),
        }
    }

    pub(super) fn listens(address: SocketAddr) -> Self {
        Self::udp(&address.ip().to_string(), address.port())
    }

    pub(super) fn is_also(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::File(one), Self::File(other)) => same_file(one, other),
            (
                Self::Port { is_udp, host, port },
                Self::Port { is_udp: other_is_udp, host: other_host, port: other_port },
            ) => is_udp == other_is_udp && port == other_port && same_host(host, other_host),
            _ => false,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Port { host, port, .. } => write!(f, "{host}:{port}"),
        }
    }
}

/// Returns whether two paths lead to one file: a link such as `/dev/serial/by-id/...` leads to `/dev/ttyUSB0`.
pub(super) fn same_file(one: &Path, other: &Path) -> bool {
    // Windows does not distinguish com3 from COM3.
    let is_port =
        |path: &Path| path.to_str().is_some_and(|name| name.len() > 3 && name[..3].eq_ignore_ascii_case("com"));
    one == other
        || is_port(one) && one.as_os_str().eq_ignore_ascii_case(other.as_os_str())
        || matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}

/// Names are compared as text: resolving them would send a question to the network.
fn same_host(one: &str, other: &str) -> bool {
    let [one, other] = [one, other].map(|host| host.trim().trim_matches(['[', ']']).trim_end_matches('.'));
    let address = |host: &str| {
        if host.eq_ignore_ascii_case("localhost") { Some(IpAddr::from([127, 0, 0, 1])) } else { host.parse().ok() }
    };
    match (address(one), address(other)) {
        // A program that listens at every address of this computer also uses this one.
        (Some(one), Some(other)) => one == other || one.is_unspecified() || other.is_unspecified(),
        _ => one.eq_ignore_ascii_case(other),
    }
}

/// Returns the device file of a cap or a pedal, if its settings name one.
pub(super) fn of_hid(source: &str) -> Option<Place> {
    match source.parse().ok()? {
        hid::HidSource::Path(path) | hid::HidSource::Emulated(path) => Some(Place::File(path)),
        hid::HidSource::Any | hid::HidSource::Ids { .. } | hid::HidSource::Spacenavd(_) => None,
    }
}

fn of_tracker(settings: &ndi::NdiSettings) -> Vec<NamedPlace> {
    let address = settings.address.as_ref().map(|address| ("address", Place::tcp_at(address, ndi::PORT)));
    let port = settings.port.as_ref().map(|port| ("port", Place::file(port)));
    address.into_iter().chain(port).collect()
}

impl RigSettings {
    fn places(&self, part: RigPart) -> Vec<NamedPlace> {
        let set = part.side().and_then(|side| self.arm(side));
        match part {
            RigPart::Handle(_) => set.map(|set| set.handle.places()),
            RigPart::Arm(_) => set.map(|set| set.arm.places()),
            RigPart::Sensor(_) => set.map(|set| set.sensor.places()),
            RigPart::Servos(_) => {
                set.and_then(|set| set.servos.as_ref()).map(|servos| vec![("port", Place::file(&servos.port))])
            }
            RigPart::TissueSensor => self.tissue_sensor.as_ref().map(super::SensorSettings::places),
            RigPart::Tracker => self.tracker.as_ref().map(of_tracker),
            RigPart::Pedal => self
                .pedal
                .as_ref()
                .map(|pedal| of_hid(&pedal.source).into_iter().map(|place| ("source", place)).collect()),
        }
        .unwrap_or_default()
    }

    /// Returns the parts whose network address is only an example, with the key of the address.
    pub(crate) fn example_addresses(&self) -> Vec<(RigPart, String)> {
        let example = |part: RigPart| {
            let is_example = |(_, place): &NamedPlace| match place {
                Place::Port { host, .. } => transport::is_example(host),
                Place::File(_) => false,
            };
            let (key, _) = self.places(part).into_iter().find(is_example)?;
            Some((part, format!("{}.{key}", part.key())))
        };
        RigPart::ALL.into_iter().filter_map(example).collect()
    }

    /// Checks that no two parts have one address, one port or one serial number.
    pub(super) fn check_unique(&self) -> Result<(), DeviceError> {
        for (count, part) in RigPart::ALL.into_iter().enumerate() {
            for other in &RigPart::ALL[..count] {
                self.check_places(part, *other)?;
                self.check_serials(part, *other)?;
            }
        }
        Ok(())
    }

    fn check_places(&self, part: RigPart, other: RigPart) -> Result<(), DeviceError> {
        // All servos may be on one line; their ids distinguish them.
        if part.kind() == PartKind::Servos && other.kind() == PartKind::Servos {
            return Ok(());
        }
        let taken = self.places(other);
        for (key, place) in self.places(part) {
            if let Some((other_key, _)) = taken.iter().find(|(_, taken)| place.is_also(taken)) {
                let arms = part.kind() == PartKind::Arm && other.kind() == PartKind::Arm;
                let hint = if arms { "; all Gen3 leave the factory with the same address" } else { "" };
                return Err(DeviceError::Setting {
                    key: format!("{}.{key}", part.key()),
                    value: place.to_string(),
                    allowed: format!(
                        "give the {} a different {} than the {} ({}.{other_key}), which is at the same one{hint}",
                        part.name(),
                        if matches!(place, Place::File(_)) { "device file" } else { "address or port" },
                        other.name(),
                        other.key(),
                    ),
                });
            }
        }
        Ok(())
    }

    fn check_serials(&self, part: RigPart, other: RigPart) -> Result<(), DeviceError> {
        // Servos identify themselves only by their ids, which are checked together with them.
        if part.kind() != other.kind() || part.kind() == PartKind::Servos {
            return Ok(());
        }
        match (self.serial(part), self.serial(other)) {
            (Some(serial), Some(taken)) if same_serial(&serial, &taken) => Err(DeviceError::Setting {
                key: format!("{}.serial_number", part.key()),
                value: serial,
                allowed: format!("the {} has the same one: enter the number on each device's label", other.name()),
            }),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;
    use crate::{config::RigConfig, rig::LeaderSettings};

    fn refusal(name: &str, change: impl FnOnce(&mut RigSettings)) -> String {
        let mut settings = RigConfig::load(name).unwrap().devices.unwrap();
        assert_eq!(settings.check(), Ok(()));
        change(&mut settings);
        settings.check().expect_err("two parts are one device").to_string()
    }

    #[test]
    fn two_parts_at_one_place_are_refused_whatever_their_kind() {
        let arms = refusal("paper", |settings| {
            let host = settings.right.as_ref().unwrap().arm.kinova().unwrap().host.clone();
            settings.left.as_mut().unwrap().arm.kinova_mut().unwrap().host = host;
        });
        assert!(arms.contains("devices.left.arm.host") && arms.contains("right arm"), "{arms}");
        let sensors = refusal("paper", |settings| {
            let port = settings.right.as_ref().unwrap().sensor.bota().unwrap().port.clone();
            settings.tissue_sensor.as_mut().unwrap().bota_mut().unwrap().port = port;
        });
        assert!(sensors.contains("devices.tissue_sensor.port") && sensors.contains("right sensor"), "{sensors}");
        let servos = refusal("paper", |settings| {
            let right = settings.right.as_mut().unwrap();
            right.servos.as_mut().unwrap().port = right.sensor.bota().unwrap().port.clone();
        });
        assert!(servos.contains("devices.right.servos.port"), "{servos}");
        let tracker = refusal("emulated", |settings| {
            let left = settings.left.as_ref().unwrap().sensor.bota().unwrap().port.clone();
            settings.tracker.as_mut().unwrap().address = Some(left);
            settings.tracker.as_mut().unwrap().port = None;
        });
        assert!(tracker.contains("devices.tracker.address") && tracker.contains("left sensor"), "{tracker}");
        let handles = refusal("emulated", |settings| {
            let right = settings.right.as_ref().unwrap().handle.force_dimension().unwrap().emulator;
            settings.left.as_mut().unwrap().handle.force_dimension_mut().unwrap().emulator = right;
        });
        assert!(handles.contains("devices.left.handle.emulator"), "{handles}");
    }

    #[test]
    fn one_serial_number_for_two_parts_is_refused() {
        let sensors = refusal("paper", |settings| {
            let sensor = |set: &mut super::super::SensorSettings, serial: &str| {
                set.bota_mut().unwrap().serial_number = Some(serial.to_owned());
            };
            sensor(&mut settings.right.as_mut().unwrap().sensor, "SN000853");
            sensor(settings.tissue_sensor.as_mut().unwrap(), "853");
        });
        assert!(sensors.contains("devices.tissue_sensor.serial_number"), "{sensors}");
        let arms = refusal("paper", |settings| {
            for set in [&mut settings.right, &mut settings.left].into_iter().flatten() {
                set.arm.kinova_mut().unwrap().serial_number = Some("PJ1".to_owned());
            }
        });
        assert!(arms.contains("devices.left.arm.serial_number"), "{arms}");
    }

    /// Addresses with which devices leave the factory (manuals of the Gen3 and of Bota's sensors for networks). Only a
    /// comment of a rig may state them.
    const FACTORY: [&str; 2] = ["192.168.1.10", "192.168.1.1"];

    /// Returns whether nothing leaves this computer by this address.
    fn stays_here(host: &str) -> bool {
        let ip = host.trim_matches(['[', ']']).parse::<IpAddr>();
        host == "localhost" || transport::is_example(host) || ip.is_ok_and(|ip| ip.is_loopback())
    }

    /// Returns the numeric addresses in a text.
    fn addresses(text: &str) -> impl Iterator<Item = &str> {
        let words = text.split(|letter: char| !letter.is_ascii_digit() && letter != '.');
        words.map(|word| word.trim_matches('.')).filter(|word| word.parse::<Ipv4Addr>().is_ok())
    }

    /// Returns the addresses to which the parts and the camera of a rig lead, with their keys.
    fn network(rig: &RigConfig) -> Vec<(&'static str, String)> {
        let parts =
            rig.devices.iter().flat_map(|devices| RigPart::ALL.map(|part| devices.places(part)).into_iter().flatten());
        let desk = rig.desk.iter().filter_map(|desk| desk.handle.as_ref()).flat_map(LeaderSettings::places);
        let camera = rig.endoscope.as_ref().and_then(|endoscope| endoscope.url.split_once("://"));
        let camera = camera.map(|(_, rest)| {
            let authority = rest.split(['/', '?']).next().unwrap_or_default();
            ("url", Place::tcp_at(authority, 80))
        });
        let host = |(key, place): NamedPlace| match place {
            Place::Port { host, .. } => Some((key, host)),
            Place::File(_) => None,
        };
        parts.chain(desk).chain(camera).filter_map(host).collect()
    }

    /// Otherwise a test or a copy of an example could reach another laboratory's device.
    #[test]
    fn the_rigs_that_come_with_the_program_have_no_address_of_a_device() {
        assert!(!FACTORY.into_iter().any(stays_here) && !stays_here("cam.local") && !stays_here("0.0.0.0"));
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let folders = ["config/rigs", "assets/arms"].map(|folder| std::fs::read_dir(root.join(folder)).unwrap());
        let files = folders.into_iter().flatten().map(|entry| entry.unwrap().path());
        let mut found = Vec::new();
        for file in files.filter(|file| file.extension().is_some_and(|ending| ending == "toml")) {
            let name = file.display().to_string();
            for line in std::fs::read_to_string(&file).unwrap().lines() {
                let (settings, comment) = line.split_once('#').unwrap_or((line, ""));
                assert!(addresses(settings).all(stays_here), "{name}: {line}");
                let is_stated = |address: &str| stays_here(address) || FACTORY.contains(&address);
                assert!(addresses(comment).all(is_stated), "{name}: {line}");
            }
            for (key, host) in network(&RigConfig::load(&name).unwrap()) {
                assert!(stays_here(&host), "{name}: {key} = {host}");
                found.push((key, host));
            }
        }
        for (key, host) in
            [("host", "192.0.2.10"), ("address", "192.0.2.20"), ("url", "127.0.0.1"), ("listen", "127.0.0.1")]
        {
            assert!(found.contains(&(key, host.to_owned())), "{key} = {host} was not even seen: {found:?}");
        }
    }

    #[test]
    fn one_place_is_recognised_under_different_names() {
        let same = |one: Place, other: Place| one.is_also(&other) && other.is_also(&one);
        assert!(same(Place::tcp("localhost", 1), Place::tcp("127.0.0.1", 1)));
        assert!(same(Place::tcp("Arm.local", 1), Place::tcp("arm.local.", 1)));
        assert!(same(Place::listens(([0, 0, 0, 0], 5).into()), Place::listens(([127, 0, 0, 1], 5).into())));
        assert!(same(Place::tcp_at("10.0.0.1", 23), Place::tcp_at("10.0.0.1:23", 1)));
        assert!(same(Place::tcp_at("[::1]:23", 1), Place::tcp_at("::1", 23)));
        assert!(same(Place::file("COM3"), Place::file("com3")));
        assert!(!same(Place::tcp("10.0.0.1", 1), Place::tcp("10.0.0.1", 2)));
        assert!(!same(Place::tcp("10.0.0.1", 1), Place::udp("10.0.0.1", 1)));
        assert!(!same(Place::file("/dev/ttyUSB0"), Place::file("/dev/ttyUSB1")));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_leads_to_its_device() {
        let folder = tempfile::tempdir().unwrap();
        let port = folder.path().join("ttyUSB0");
        let link = folder.path().join("by-id");
        std::fs::write(&port, "").unwrap();
        std::os::unix::fs::symlink(&port, &link).unwrap();
        assert!(Place::file(port).is_also(&Place::file(link)));
    }
}
