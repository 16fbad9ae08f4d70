//! `nima emulate kinova`: a Gen3 on free ports, or on those given with `--set tcp_port=10000 --set udp_port=10001`.
//! `--set watchdog_ms=50` sets the time without a command after which the arm goes into a fault.

use nima_world::emulators::{
    FaultSwitch,
    kinova::{EmulatedArm, StandIn, emulate},
};

use super::{Emulated, Settings};

pub(super) fn start(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let usual = EmulatedArm::default();
    let mut arm = EmulatedArm {
        tcp_port: settings.get("tcp_port")?.unwrap_or(usual.tcp_port),
        udp_port: settings.get("udp_port")?.unwrap_or(usual.udp_port),
        ..usual
    };
    if let Some(watchdog_ms) = settings.get("watchdog_ms")? {
        arm.watchdog_ms = watchdog_ms;
    }
    let serving = emulate(arm, StandIn::swaying(), FaultSwitch::default())?;
    Ok(vec![Emulated::new("kinova", serving)])
}
