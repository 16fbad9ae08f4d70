//! Tries the devices that a rig file names, as the console would open them, but with less patience.

use std::time::Duration;

use super::{DeviceProbe, Probe, Speaks};
use crate::device::{Side, bota, dynamixel, force_dimension, hid, kinova, ndi, rig::Settings};

/// A first-generation sensor starts anew whenever its line is opened.
const START: Duration = Duration::from_secs(1);
/// For one answer of an arm, s.
const ARM_S: f64 = 0.4;

/// A probe of every device, by its name in the rig: `right handle`, `right arm`, `right sensor`, `right servos`, the same of the left side,
/// `tissue sensor`, `tracker`, `pedal`.
pub fn rig_probes(settings: &Settings) -> Vec<Box<dyn Probe>> {
    let mut probes = Vec::new();
    for side in Side::ALL {
        let Some(set) = settings.arm(side) else { continue };
        let name = |part: &str| format!("{} {part}", side.word());
        probes.push(handle(&name("handle"), set.handle.clone()));
        probes.push(arm(&name("arm"), set.arm.clone()));
        probes.push(sensor(&name("sensor"), set.sensor.clone()));
        probes.extend(set.servos.clone().map(|chosen| servos(&name("servos"), chosen)));
    }
    probes.extend(settings.tissue_sensor.clone().map(|chosen| sensor("tissue sensor", chosen)));
    probes.extend(settings.tracker.clone().map(|chosen| tracker("tracker", chosen)));
    probes.extend(settings.pedal.clone().map(|chosen| pedal("pedal", chosen)));
    probes
}

pub(super) fn handle(name: &str, settings: force_dimension::Settings) -> Box<dyn Probe> {
    let place = settings.serial.map_or_else(|| "omega.7".to_owned(), |serial| format!("omega.7 {serial}"));
    Box::new(DeviceProbe::new(name, place, Speaks::Always, move || force_dimension::open(&settings)))
}

pub(super) fn arm(name: &str, settings: kinova::Settings) -> Box<dyn Probe> {
    let settings = kinova::Settings { patience_s: settings.patience_s.min(ARM_S), ..settings };
    let place = format!("{}:{}", settings.host, settings.tcp_port);
    Box::new(DeviceProbe::new(name, place, Speaks::Always, move || kinova::open(&settings)))
}

pub(super) fn sensor(name: &str, settings: bota::Settings) -> Box<dyn Probe> {
    let extra = if settings.transport == bota::Transport::Gen0 { START } else { Duration::ZERO };
    let place = settings.port.clone();
    let probe = DeviceProbe::new(name, place, Speaks::Always, move || bota::Driver::try_open(&settings));
    Box::new(probe.with_extra(extra))
}

fn servos(name: &str, settings: dynamixel::Settings) -> Box<dyn Probe> {
    let place = settings.port.clone();
    Box::new(DeviceProbe::new(name, place, Speaks::Always, move || dynamixel::try_open(&settings)))
}

pub(super) fn tracker(name: &str, settings: ndi::Settings) -> Box<dyn Probe> {
    Box::new(DeviceProbe::new(name, settings.place(), Speaks::Always, move || ndi::Driver::try_open(&settings)))
}

fn pedal(name: &str, settings: hid::PedalSettings) -> Box<dyn Probe> {
    let place = settings.source.clone();
    Box::new(DeviceProbe::new(name, place, Speaks::OnChange, move || hid::PedalDriver::open(&settings)))
}
