//! `nima emulate external-arm`: an arm that sends to the address of the settings. Settings: `listen` (where the driver
//! listens), `joints` (6 or 7), `serial`.

use std::io::Result;

use nima_devices::ARM_JOINTS;

use super::EmulatedExternalArm;
use crate::emulators::{Emulator, EmulatorSettings, kinova::StandIn, standalone::unusable};

pub(in crate::emulators) fn arm(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let joints = settings.get_or("joints", ARM_JOINTS)?;
    if !(ARM_JOINTS - 1..=ARM_JOINTS).contains(&joints) {
        return Err(unusable("joints", joints, "give 6 or 7"));
    }
    let arm = EmulatedExternalArm {
        listen: settings.get_or("listen", ([127, 0, 0, 1], 47_201).into())?,
        joints,
        serial: settings.get_or("serial", "EMULATED-1".to_owned())?,
    };
    if !arm.listen.ip().is_loopback() {
        return Err(unusable("listen", arm.listen, "give an address of this computer, 127.0.0.1:PORT"));
    }
    Ok(arm.with(StandIn::swaying()))
}
