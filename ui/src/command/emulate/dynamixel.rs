//! `nima emulate dynamixel`: four servos on a pseudo-terminal. Settings: `model`, `baud`, `fast`, `ids` (as `1,2,3,4`).

use anyhow::Context as _;
use nima_world::emulators::dynamixel::{Emulator, EmulatorSettings};

use super::{Emulated, Settings};

pub(super) fn start(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let factory = EmulatorSettings::default();
    let ids = match settings.get::<String>("ids")? {
        Some(list) => list.split(',').map(|id| id.trim().parse()).collect::<Result<_, _>>().context("--set ids")?,
        None => factory.ids,
    };
    let wanted = EmulatorSettings {
        ids,
        model: settings.get("model")?.unwrap_or(factory.model),
        baud: settings.get("baud")?.unwrap_or(factory.baud),
        fast: settings.get("fast")?.unwrap_or(factory.fast),
    };
    let emulator = Emulator::new(&wanted, None).context("unknown servo model number or baud rate")?;
    Ok(vec![Emulated::new("dynamixel", emulator.serve()?)])
}
