//! Probes by name. A new driver needs one row.

use std::time::Duration;

use super::{DataTiming, DeviceProbe, FoundDevice, Probe, SerialProbe, TcpProbe};
use crate::{
    DeviceError, ati,
    bota::{self, Transport},
    external, force_dimension, haply,
    hid::{CapDriver, CapSettings, PedalDriver, PedalSettings},
    kinova, ndi,
};

pub struct ProbeKind {
    /// Name in `nima devices --probe NAME=PLACE`.
    pub name: &'static str,
    /// Format of the address.
    pub usage: &'static str,
    /// Creates a probe for an address; the text is empty if none was given.
    pub make: fn(&str) -> Result<Box<dyn Probe>, DeviceError>,
}

pub const KINDS: &[ProbeKind] = &[
    ProbeKind { name: "spacemouse", usage: "spacemouse[=any|VVVV:PPPP|PATH|emulated:PATH|spacenavd]", make: cap },
    ProbeKind { name: "pedal", usage: "pedal[=any|VVVV:PPPP|PATH|emulated:PATH]", make: pedal },
    ProbeKind { name: "serial", usage: "serial=PORT@BAUD[,HEADER as hexadecimal digits][,quiet]", make: serial },
    ProbeKind { name: "tcp", usage: "tcp=HOST:PORT", make: tcp },
    ProbeKind { name: "bota-gen0", usage: "bota-gen0=PORT[@BAUD]", make: gen0 },
    ProbeKind { name: "bota-gen-a", usage: "bota-gen-a=PORT[@BAUD]", make: gen_a },
    ProbeKind { name: "bota-socket", usage: "bota-socket=HOST[:PORT]", make: socket },
    ProbeKind { name: "ati", usage: "ati=HOST[ rdt=P][ http=P]", make: ati },
    ProbeKind { name: "dynamixel", usage: "dynamixel=PORT[@BAUD]", make: dynamixel },
    ProbeKind { name: "ndi", usage: "ndi=HOST[:PORT]|DEVICE FILE[@BAUD]", make: ndi },
    ProbeKind { name: "kinova", usage: "kinova=HOST[ tcp=P][ udp=P]", make: kinova },
    ProbeKind {
        name: "force-dimension",
        usage: "force-dimension[=SERIAL|emulated:ADDRESS:PORT]",
        make: force_dimension,
    },
    ProbeKind { name: "haply", usage: "haply=PORT", make: haply },
    ProbeKind { name: "external-handle", usage: "external-handle=ADDRESS:PORT[,FROM]", make: external_handle },
    ProbeKind { name: "external-arm", usage: "external-arm=ADDRESS:PORT[,FROM]", make: external_arm },
    ProbeKind { name: "external-sensor", usage: "external-sensor=ADDRESS:PORT[,FROM]", make: external_sensor },
];

/// Returns the error for an invalid address on the command line.
fn wrong(kind: &str, place: &str, allowed: &str) -> DeviceError {
    DeviceError::Setting { key: kind.to_owned(), value: place.to_owned(), allowed: allowed.to_owned() }
}

/// Returns port and line speed of `PORT[@BAUD]`; `usual` is the default speed.
fn line<'a>(kind: &str, place: &'a str, usual: u32) -> Result<(&'a str, u32), DeviceError> {
    let (port, baud) = place.rsplit_once('@').unwrap_or((place, ""));
    let baud = if baud.is_empty() { Some(usual) } else { baud.parse().ok() };
    match baud.filter(|baud| *baud > 0 && !port.is_empty()) {
        Some(baud) => Ok((port, baud)),
        None => Err(wrong(kind, place, "PORT or PORT@BAUD")),
    }
}

#[expect(clippy::unnecessary_wraps, reason = "every row of the table has one form")]
fn cap(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let mut settings = CapSettings::default();
    if !place.is_empty() {
        place.clone_into(&mut settings.source);
    }
    let place = settings.source.clone();
    Ok(Box::new(DeviceProbe::new("spacemouse", place, DataTiming::OnChange, move || CapDriver::open(&settings))))
}

#[expect(clippy::unnecessary_wraps, reason = "every row of the table has one form")]
fn pedal(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let mut settings = PedalSettings::default();
    if !place.is_empty() {
        place.clone_into(&mut settings.source);
    }
    let place = settings.source.clone();
    Ok(Box::new(DeviceProbe::new("pedal", place, DataTiming::OnChange, move || PedalDriver::open(&settings))))
}

fn serial(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    Ok(Box::new(place.parse::<SerialProbe>()?))
}

fn tcp(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    Ok(Box::new(TcpProbe::new(place)?))
}

fn gen0(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    bota("bota-gen0", Transport::Gen0, place)
}

fn gen_a(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    bota("bota-gen-a", Transport::GenA, place)
}

fn socket(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    bota("bota-socket", Transport::Socket, place)
}

fn bota(kind: &str, transport: Transport, place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let usual = bota::BotaSettings::new(transport, place);
    let (port, baud) =
        if transport == Transport::Socket { (place, usual.baud) } else { line(kind, place, usual.baud)? };
    let settings = bota::BotaSettings { port: port.to_owned(), baud, ..usual };
    settings.check()?;
    Ok(super::probes::sensor(kind, settings))
}

fn ati(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let refused = || wrong("ati", place, "HOST, or HOST rdt=PORT http=PORT; it leaves the factory with 192.168.1.1");
    let settings = ati::AtiSettings::at(place).ok_or_else(refused)?;
    settings.check()?;
    Ok(super::probes::ati("ati", settings))
}

/// Creates a probe that lists the servos on the bus without configuring them, because their settings are unknown.
fn dynamixel(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let (port, baud) = line("dynamixel", place, 1_000_000)?;
    Ok(Box::new(super::bus::BusProbe::new(port, baud)))
}

fn ndi(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let mut settings = ndi::NdiSettings { wired: true, ..ndi::NdiSettings::default() };
    if place.contains('/') || place.starts_with("COM") {
        let (port, baud) = line("ndi", place, settings.baud)?;
        settings.port = Some(port.to_owned());
        settings.baud = baud;
    } else if place.is_empty() {
        return Err(wrong("ndi", place, "the unit's address or its device file"));
    } else {
        settings.address = Some(place.to_owned());
    }
    settings.check()?;
    Ok(super::probes::tracker("ndi", settings))
}

fn kinova(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let settings = kinova::KinovaSettings::at(place);
    let allowed = "HOST, or HOST tcp=PORT udp=PORT; a Gen3 leaves the factory with 192.168.1.10";
    let settings = settings.ok_or_else(|| wrong("kinova", place, allowed))?;
    Ok(super::probes::arm("kinova", settings, None))
}

fn force_dimension(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let refused = || wrong("force-dimension", place, "a serial number, or emulated:ADDRESS:PORT");
    let mut settings = force_dimension::ForceDimensionSettings::default();
    match place.strip_prefix("emulated:") {
        Some(address) => settings.emulator = Some(address.parse().map_err(|_| refused())?),
        None if place.is_empty() => {}
        None => settings.serial = Some(place.parse().map_err(|_| refused())?),
    }
    Ok(super::probes::handle("force-dimension", settings))
}

fn haply(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    if place.is_empty() {
        return Err(wrong("haply", place, "the handle's device file"));
    }
    Ok(super::probes::haply("haply", haply::HaplySettings::at(place)))
}

fn external_handle(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    external("external-handle", external::ExternalKind::Handle, place)
}

fn external_arm(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    external("external-arm", external::ExternalKind::Arm, place)
}

fn external_sensor(place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    external("external-sensor", external::ExternalKind::Sensor, place)
}

fn external(name: &str, kind: external::ExternalKind, place: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let refused = || wrong(name, place, "ADDRESS:PORT at which to listen, and of another computer its address: ,FROM");
    let (listen, from) = place.split_once(',').map_or((place, None), |(listen, from)| (listen, Some(from)));
    let usual = external::ExternalSettings::at(listen.parse().map_err(|_| refused())?);
    let from = from.map(str::parse).transpose().map_err(|_| refused())?;
    let settings = external::ExternalSettings { from, ..usual };
    settings.check(kind)?;
    Ok(super::probes::external(name, kind, settings))
}

/// Returns the probe for `KIND` or `KIND=PLACE`; its name is the whole text.
///
/// # Errors
/// [`DeviceError::Setting`] if the kind is unknown or its address invalid.
pub fn probe_named(text: &str) -> Result<Box<dyn Probe>, DeviceError> {
    let (name, place) = text.split_once('=').unwrap_or((text, ""));
    let Some(kind) = KINDS.iter().find(|kind| kind.name == name) else {
        let usages: Vec<_> = KINDS.iter().map(|kind| kind.usage).collect();
        return Err(DeviceError::Setting {
            key: "--probe".to_owned(),
            value: text.to_owned(),
            allowed: usages.join(", "),
        });
    };
    Ok(Box::new(NamedKind { name: text.to_owned(), probe: (kind.make)(place)? }))
}

struct NamedKind {
    name: String,
    probe: Box<dyn Probe>,
}

impl Probe for NamedKind {
    fn name(&self) -> &str {
        &self.name
    }

    fn extra(&self) -> Duration {
        self.probe.extra()
    }

    fn probe(&mut self, timeout: Duration) -> Result<FoundDevice, DeviceError> {
        self.probe.probe(timeout)
    }
}
