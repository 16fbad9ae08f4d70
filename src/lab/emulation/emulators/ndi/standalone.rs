//! `nima emulate ndi` (TCP) and `ndi-serial` (pseudo-terminal): the tracker. Setting `firmware` makes hosts choose `TX`
//! or `BX`, `missing` and `outside` hide one tool or put it out of the volume, `port` sets a fixed TCP port.

use std::io::Result;

use nima_devices::TrackedTool;

use super::{NdiBody, NdiProfile, wandering};
use crate::emulators::{Emulator, EmulatorSettings};

fn profile(settings: &EmulatorSettings) -> Result<NdiProfile> {
    let usual = NdiProfile::default();
    Ok(NdiProfile { firmware: settings.get_or("firmware", usual.firmware.clone())?, ..usual })
}

fn body(settings: &EmulatorSettings) -> Result<impl NdiBody + use<>> {
    let missing = settings.get::<usize>("missing")?;
    let outside = settings.get::<usize>("outside")?;
    Ok(move |unit_s: f64, number: usize| {
        if missing == Some(number) || outside == Some(number) {
            TrackedTool::Missing { out_of_volume: outside == Some(number) }
        } else {
            wandering(unit_s, number)
        }
    })
}

pub(in crate::emulators) fn network(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    Ok(profile(settings)?.on_network(settings.get_or("port", 0)?, body(settings)?))
}

pub(in crate::emulators) fn line(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    Ok(profile(settings)?.on_line(None, body(settings)?))
}
