//! A probe for each driver: opens the device like a rig, with shorter timeouts.

use std::time::Duration;

use nima_core::kinematics::ArmModel;

use super::{DataTiming, DeviceProbe, Probe};
use crate::{bota, dynamixel, external, force_dimension, haply, hid, kinova, ndi};

/// A first-generation sensor restarts whenever its line is opened.
const START: Duration = Duration::from_secs(1);
/// Timeout for one answer of an arm, s.
const ARM_S: f64 = 0.4;

pub fn handle(name: &str, settings: force_dimension::ForceDimensionSettings) -> Box<dyn Probe> {
    let place = settings.serial.map_or_else(|| "omega.7".to_owned(), |serial| format!("omega.7 {serial}"));
    Box::new(DeviceProbe::new(name, place, DataTiming::Always, move || force_dimension::open(&settings)))
}

pub fn arm(name: &str, settings: kinova::KinovaSettings, model: ArmModel) -> Box<dyn Probe> {
    let settings = kinova::KinovaSettings { timeout_s: settings.timeout_s.min(ARM_S), ..settings };
    let place = format!("{}:{}", settings.host, settings.tcp_port);
    let open = move || kinova::open_clearing(&settings, &model, &kinova::FaultClearing::default());
    Box::new(DeviceProbe::new(name, place, DataTiming::Always, open))
}

pub fn sensor(name: &str, settings: bota::BotaSettings) -> Box<dyn Probe> {
    let extra = if settings.transport == bota::Transport::Gen0 { START } else { Duration::ZERO };
    let place = settings.port.clone();
    let probe = DeviceProbe::new(name, place, DataTiming::Always, move || bota::BotaDriver::try_open(&settings));
    Box::new(probe.with_extra(extra))
}

pub fn servos(name: &str, settings: dynamixel::DynamixelSettings) -> Box<dyn Probe> {
    let place = settings.port.clone();
    Box::new(DeviceProbe::new(name, place, DataTiming::Always, move || dynamixel::try_open(&settings)))
}

pub fn tracker(name: &str, settings: ndi::NdiSettings) -> Box<dyn Probe> {
    Box::new(DeviceProbe::new(name, settings.place(), DataTiming::Always, move || ndi::NdiDriver::try_open(&settings)))
}

pub fn pedal(name: &str, settings: hid::PedalSettings) -> Box<dyn Probe> {
    let place = settings.source.clone();
    Box::new(DeviceProbe::new(name, place, DataTiming::OnChange, move || hid::PedalDriver::open(&settings)))
}

pub fn haply(name: &str, settings: haply::HaplySettings) -> Box<dyn Probe> {
    let place = settings.port.clone();
    Box::new(DeviceProbe::new(name, place, DataTiming::Always, move || haply::HaplyDriver::open(&settings)))
}

pub fn external(name: &str, kind: external::ExternalKind, settings: external::ExternalSettings) -> Box<dyn Probe> {
    let place = settings.place();
    match kind {
        external::ExternalKind::Handle => Box::new(DeviceProbe::new(name, place, DataTiming::Always, move || {
            external::ExternalHandle::open(&settings)
        })),
        external::ExternalKind::Arm => external_arm(name, settings, ArmModel::GEN3),
        external::ExternalKind::Sensor => Box::new(DeviceProbe::new(name, place, DataTiming::Always, move || {
            external::ExternalSensor::open(&settings)
        })),
    }
}

pub fn external_arm(name: &str, settings: external::ExternalSettings, model: ArmModel) -> Box<dyn Probe> {
    let place = settings.place();
    let open = move || external::ExternalArm::open(&settings, &model);
    Box::new(DeviceProbe::new(name, place, DataTiming::Always, open))
}
