//! A probe for each driver: opens the device like a rig, with shorter timeouts.

use std::time::Duration;

use super::{DeviceProbe, Probe, Speaks};
use crate::{bota, dynamixel, external, force_dimension, haply, hid, kinova, ndi};

/// A first-generation sensor restarts whenever its line is opened.
const START: Duration = Duration::from_secs(1);
/// Timeout for one answer of an arm, s.
const ARM_S: f64 = 0.4;

pub fn handle(name: &str, settings: force_dimension::Settings) -> Box<dyn Probe> {
    let place = settings.serial.map_or_else(|| "omega.7".to_owned(), |serial| format!("omega.7 {serial}"));
    Box::new(DeviceProbe::new(name, place, Speaks::Always, move || force_dimension::open(&settings)))
}

pub fn arm(name: &str, settings: kinova::Settings) -> Box<dyn Probe> {
    let settings = kinova::Settings { timeout_s: settings.timeout_s.min(ARM_S), ..settings };
    let place = format!("{}:{}", settings.host, settings.tcp_port);
    Box::new(DeviceProbe::new(name, place, Speaks::Always, move || kinova::open(&settings)))
}

pub fn sensor(name: &str, settings: bota::Settings) -> Box<dyn Probe> {
    let extra = if settings.transport == bota::Transport::Gen0 { START } else { Duration::ZERO };
    let place = settings.port.clone();
    let probe = DeviceProbe::new(name, place, Speaks::Always, move || bota::Driver::try_open(&settings));
    Box::new(probe.with_extra(extra))
}

pub fn servos(name: &str, settings: dynamixel::Settings) -> Box<dyn Probe> {
    let place = settings.port.clone();
    Box::new(DeviceProbe::new(name, place, Speaks::Always, move || dynamixel::try_open(&settings)))
}

pub fn tracker(name: &str, settings: ndi::Settings) -> Box<dyn Probe> {
    Box::new(DeviceProbe::new(name, settings.place(), Speaks::Always, move || ndi::Driver::try_open(&settings)))
}

pub fn pedal(name: &str, settings: hid::PedalSettings) -> Box<dyn Probe> {
    let place = settings.source.clone();
    Box::new(DeviceProbe::new(name, place, Speaks::OnChange, move || hid::PedalDriver::open(&settings)))
}

pub fn haply(name: &str, settings: haply::Settings) -> Box<dyn Probe> {
    let place = settings.port.clone();
    Box::new(DeviceProbe::new(name, place, Speaks::Always, move || haply::Driver::open(&settings)))
}

pub fn external(name: &str, kind: external::Kind, settings: external::Settings) -> Box<dyn Probe> {
    let place = settings.place();
    match kind {
        external::Kind::Handle => {
            Box::new(DeviceProbe::new(name, place, Speaks::Always, move || external::Handle::open(&settings)))
        }
        external::Kind::Arm => {
            Box::new(DeviceProbe::new(name, place, Speaks::Always, move || external::Arm::open(&settings)))
        }
        external::Kind::Sensor => {
            Box::new(DeviceProbe::new(name, place, Speaks::Always, move || external::Sensor::open(&settings)))
        }
    }
}
