//! `nima emulate ati`: a Net F/T on free ports. Settings: `serial`, `rate_hz`, `rdt_port`, `http_port`, `force_unit` and
//! `torque_unit` (as on its page).

use std::io::Result;

use super::EmulatedAti;
use crate::emulators::{Emulator, EmulatorSettings, bota::slow_motion, standalone::unusable};

pub(in crate::emulators) fn sensor(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let usual = EmulatedAti::default();
    let [force, torque] = usual.units;
    let rate_hz = settings.get_or("rate_hz", usual.rate_hz)?;
    if !(1.0..=7000.0).contains(&rate_hz) {
        return Err(unusable("rate_hz", rate_hz, "give 1 to 7000"));
    }
    let sensor = EmulatedAti {
        serial: settings.get_or("serial", usual.serial)?,
        rate_hz,
        rdt_port: settings.get_or("rdt_port", usual.rdt_port)?,
        http_port: settings.get_or("http_port", usual.http_port)?,
        units: [settings.get_or("force_unit", force)?, settings.get_or("torque_unit", torque)?],
    };
    Ok(sensor.with(slow_motion()))
}
