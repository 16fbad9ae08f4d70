//! `nima emulate kinova`: a Gen3 on free ports. `--set watchdog_ms=50` sets the time without a command that is a fault.

use nima::device::{
    emulation::FaultSwitch,
    kinova::emulator::{EmulatedArm, StandIn, emulate},
};

use super::{Emulated, Settings};

pub(super) fn start(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let mut arm = EmulatedArm::default();
    if let Some(watchdog_ms) = settings.get("watchdog_ms")? {
        arm.watchdog_ms = watchdog_ms;
    }
    let serving = emulate(arm, StandIn::swaying(), FaultSwitch::default())?;
    Ok(vec![Emulated::new("kinova", serving)])
}
