//! `nima emulate external-arm`: an arm that sends to the address of the settings. Settings: `listen` (where the driver
//! listens), `joints` (6 or 7), `serial`.

use std::io::Result;

use super::EmulatedExternalArm;
use crate::emulators::{Emulator, EmulatorSettings, kinova::StandIn, standalone::unusable};

pub(in crate::emulators) fn arm(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let arm = EmulatedExternalArm {
        listen: settings.get_or("listen", ([127, 0, 0, 1], 47_201).into())?,
        joints: settings.joints()?,
        serial: settings.get_or("serial", "EMULATED-1".to_owned())?,
    };
    if !arm.listen.ip().is_loopback() {
        return Err(unusable("listen", arm.listen, "give an address of this computer, 127.0.0.1:PORT"));
    }
    Ok(arm.with(StandIn::swaying()))
}
