//! `nima emulate haply`: an Inverse3 on a pseudo-terminal, whose grip moves in a circle and yields to the force.
//! Settings: `id` (four hexadecimal digits), `model`, `firmware`, `link` (name of the port).

use std::{io::Result, path::PathBuf};

use super::{EmulatedHaply, HapticForce};
use crate::emulators::{Emulator, EmulatorSettings, standalone::unusable};

pub(in crate::emulators) fn handle(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let mut usual = EmulatedHaply::default();
    if let Some(id) = settings.get::<String>("id")? {
        let number = u16::from_str_radix(&id, 16);
        usual.info.id = number.map_err(|_| unusable("id", &id, "enter four hexadecimal digits, such as 049D"))?;
    }
    usual.info.model = settings.get_or("model", usual.info.model)?;
    usual.info.firmware = settings.get_or("firmware", usual.info.firmware)?;
    usual.link = settings.get::<PathBuf>("link")?;
    Ok(usual.with(HapticForce::default().on_a_circle()))
}
