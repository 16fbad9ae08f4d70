//! `nima emulate bota-gen0` and `bota-gen-a` on pseudo-terminals, `bota-socket` on this computer's network.
//!
//! Settings: `serial` (digits), `baud` (0 accepts any), `boot_s`, `tcp_port`, `udp_port`, `timestamp_us` (clock at the
//! beginning), `status` (bits that are always set).

use std::{
    io::Result,
    net::{Ipv4Addr, SocketAddrV4},
};

use nima_devices::bota::Transport;

use super::{EmulatedBota, slow_motion};
use crate::emulators::{Emulator, EmulatorSettings};

pub(in crate::emulators) fn sensor(transport: Transport, settings: &EmulatorSettings) -> Result<Box<dyn Emulator>> {
    let usual = EmulatedBota::default();
    let baud = match settings.get("baud")? {
        Some(0) => None,
        given => given.or(usual.baud),
    };
    let udp_port = settings.get_or("udp_port", usual.destination.port())?;
    let sensor = EmulatedBota {
        transport,
        serial: settings.get("serial")?.unwrap_or(usual.serial),
        baud,
        boot_s: settings.get_or("boot_s", usual.boot_s)?,
        first_timestamp_us: settings.get_or("timestamp_us", usual.first_timestamp_us)?,
        status: settings.get_or("status", usual.status)?,
        tcp_port: settings.get_or("tcp_port", usual.tcp_port)?,
        destination: SocketAddrV4::new(Ipv4Addr::LOCALHOST, udp_port),
        ..usual
    };
    Ok(sensor.with(slow_motion()))
}
