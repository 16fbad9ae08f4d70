//! A probe for each driver. It opens the device as a rig does and waits for the same time.

use std::time::Duration;

use nima_core::kinematics::ArmModel;

use super::{DataTiming, DeviceProbe, Probe};
use crate::{ati, bota, dynamixel, external, force_dimension, haply, hid, kinova, ndi};

/// A first-generation sensor restarts whenever its line is opened, which takes up to this time.
const START: Duration = Duration::from_secs(3);
/// Three attempts at a command and one in the other protocol, each with one second and the time to empty the line.
const COMMAND: Duration = Duration::from_secs(5);
/// Three attempts for each of four servos, then every line speed.
pub(super) const SERVOS: Duration = Duration::from_secs(4);
/// A tracker answers its first commands within seconds.
const TRACKER: Duration = Duration::from_secs(6);

pub fn handle(name: &str, settings: force_dimension::ForceDimensionSettings) -> Box<dyn Probe> {
    let place = settings.serial.map_or_else(|| "omega.7".to_owned(), |serial| format!("omega.7 {serial}"));
    Box::new(DeviceProbe::new(name, place, DataTiming::Always, move || force_dimension::open(&settings)))
}

/// Without a `model`, the number of its joints is not known.
pub fn arm(name: &str, settings: kinova::KinovaSettings, model: Option<ArmModel>) -> Box<dyn Probe> {
    let place = format!("{}:{}", settings.host, settings.tcp_port);
    // As long as the rig would wait; an address without an answer is reported after one such time.
    let extra = Duration::try_from_secs_f64(settings.timeout_s).unwrap_or_default();
    let Some(model) = model else {
        let open = move || kinova::open_to_read(&settings);
        return Box::new(DeviceProbe::new(name, place, DataTiming::Always, open).with_extra(extra));
    };
    let open = move || kinova::open_clearing(&settings, &model, &kinova::FaultClearing::default());
    Box::new(DeviceProbe::new(name, place, DataTiming::Always, open).with_extra(extra))
}

pub fn sensor(name: &str, settings: bota::BotaSettings) -> Box<dyn Probe> {
    let extra = if settings.transport == bota::Transport::Gen0 { START + COMMAND } else { COMMAND };
    let place = settings.port.clone();
    let probe = DeviceProbe::new(name, place, DataTiming::Always, move || bota::BotaDriver::open(&settings));
    Box::new(probe.with_extra(extra))
}

pub fn ati(name: &str, settings: ati::AtiSettings) -> Box<dyn Probe> {
    let probe = DeviceProbe::new(name, settings.place(), DataTiming::Always, move || ati::AtiDriver::open(&settings));
    Box::new(probe.with_extra(COMMAND))
}

pub fn servos(name: &str, settings: dynamixel::DynamixelSettings) -> Box<dyn Probe> {
    let place = settings.port.clone();
    let probe = DeviceProbe::new(name, place, DataTiming::Always, move || dynamixel::open(&settings));
    Box::new(probe.with_extra(SERVOS))
}

pub fn tracker(name: &str, settings: ndi::NdiSettings) -> Box<dyn Probe> {
    let probe = DeviceProbe::new(name, settings.place(), DataTiming::WithTool, move || ndi::NdiDriver::open(&settings));
    Box::new(probe.with_extra(TRACKER))
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
        // Without a rig file, the number of its joints is not known.
        external::ExternalKind::Arm => Box::new(DeviceProbe::new(name, place, DataTiming::Always, move || {
            external::ExternalArm::open_to_read(&settings)
        })),
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
