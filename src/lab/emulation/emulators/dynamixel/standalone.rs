//! `nima emulate dynamixel`: four servos on a pseudo-terminal. Settings: `model`, `baud`, `fast`, `ids` (as `1,2,3,4`).

use std::io::Result;

use super::EmulatedDynamixel;
use crate::emulators::{Emulator, EmulatorSettings, standalone::unusable};

pub(in crate::emulators) fn bus(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let factory = EmulatedDynamixel::default();
    let ids = match settings.get::<String>("ids")? {
        Some(list) => {
            let ids = list.split(',').map(|id| id.trim().parse().ok()).collect::<Option<_>>();
            ids.ok_or_else(|| unusable("ids", list, "enter numbers up to 252, such as 1,2,3,4"))?
        }
        None => factory.ids,
    };
    EmulatedDynamixel {
        ids,
        model: settings.get_or("model", factory.model)?,
        baud: settings.get_or("baud", factory.baud)?,
        fast: settings.get_or("fast", factory.fast)?,
        link: None,
    }
    .with(None)
}
