//! What can be tried, by its name. A driver takes part by one row.

use std::time::Duration;

use super::{DeviceProbe, Found, LibraryProbe, Probe, SerialProbe, Speaks, TcpProbe};
use crate::device::{
    Trouble,
    hid::{CapDriver, CapSettings, PedalDriver, PedalSettings},
};

/// A kind of device.
pub struct ProbeKind {
    /// Its name.
    pub name: &'static str,
    /// How its place is written.
    pub usage: &'static str,
    /// Makes a probe of a place; empty where none was given.
    pub make: fn(&str) -> Result<Box<dyn Probe>, Trouble>,
}

/// All kinds.
pub const KINDS: &[ProbeKind] = &[
    ProbeKind { name: "spacemouse", usage: "spacemouse[=any|VVVV:PPPP|PATH|emulated:PATH|spacenavd]", make: cap },
    ProbeKind { name: "pedal", usage: "pedal[=any|VVVV:PPPP|PATH|emulated:PATH]", make: pedal },
    ProbeKind { name: "serial", usage: "serial=PORT@BAUD[,HEADER as hexadecimal digits][,quiet]", make: serial },
    ProbeKind { name: "tcp", usage: "tcp=HOST:PORT", make: tcp },
    ProbeKind { name: "force-dimension", usage: "force-dimension", make: force_dimension },
];

#[expect(clippy::unnecessary_wraps, reason = "every row of the table has one form")]
fn cap(place: &str) -> Result<Box<dyn Probe>, Trouble> {
    let mut settings = CapSettings::default();
    if !place.is_empty() {
        place.clone_into(&mut settings.source);
    }
    let place = settings.source.clone();
    Ok(Box::new(DeviceProbe::new("spacemouse", place, Speaks::OnChange, move || CapDriver::open(&settings))))
}

#[expect(clippy::unnecessary_wraps, reason = "every row of the table has one form")]
fn pedal(place: &str) -> Result<Box<dyn Probe>, Trouble> {
    let mut settings = PedalSettings::default();
    if !place.is_empty() {
        place.clone_into(&mut settings.source);
    }
    let place = settings.source.clone();
    Ok(Box::new(DeviceProbe::new("pedal", place, Speaks::OnChange, move || PedalDriver::open(&settings))))
}

fn serial(place: &str) -> Result<Box<dyn Probe>, Trouble> {
    Ok(Box::new(place.parse::<SerialProbe>()?))
}

fn tcp(place: &str) -> Result<Box<dyn Probe>, Trouble> {
    Ok(Box::new(TcpProbe::new(place)?))
}

#[expect(clippy::unnecessary_wraps, reason = "every row of the table has one form")]
fn force_dimension(_: &str) -> Result<Box<dyn Probe>, Trouble> {
    Ok(Box::new(LibraryProbe::force_dimension()))
}

/// The probe of `KIND` or `KIND=PLACE`; its name is the whole text.
pub fn probe_named(text: &str) -> Result<Box<dyn Probe>, Trouble> {
    let (name, place) = text.split_once('=').unwrap_or((text, ""));
    let Some(kind) = KINDS.iter().find(|kind| kind.name == name) else {
        let usages: Vec<_> = KINDS.iter().map(|kind| kind.usage).collect();
        return Err(Trouble::Setting { key: "--probe".to_owned(), value: text.to_owned(), allowed: usages.join(", ") });
    };
    Ok(Box::new(Named { name: text.to_owned(), probe: (kind.make)(place)? }))
}

struct Named {
    name: String,
    probe: Box<dyn Probe>,
}

impl Probe for Named {
    fn name(&self) -> &str {
        &self.name
    }

    fn probe(&mut self, patience: Duration) -> Result<Found, Trouble> {
        self.probe.probe(patience)
    }
}
