//! `nima emulate kinova`: a Gen3 on free ports, or on those set by `tcp_port` and `udp_port`. `watchdog_ms` sets the
//! time without a command that counts as a fault, `joints` is 6 or 7.

use std::io::Result;

use super::{EmulatedKinova, StandIn};
use crate::emulators::{Emulator, EmulatorSettings};

pub(in crate::emulators) fn arm(settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let usual = EmulatedKinova::default();
    let joints = settings.joints()?;
    let arm = EmulatedKinova {
        tcp_port: settings.get_or("tcp_port", usual.tcp_port)?,
        udp_port: settings.get_or("udp_port", usual.udp_port)?,
        watchdog_ms: settings.get_or("watchdog_ms", usual.watchdog_ms)?,
        joints: joints as u32,
        ..usual
    };
    Ok(arm.with(StandIn::swaying()))
}
