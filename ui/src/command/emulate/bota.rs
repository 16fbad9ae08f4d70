//! Emulates Bota force-torque sensors: `bota-gen0` and `bota-gen-a` on pseudo-terminals, `bota-socket` on the loopback
//! network.
//!
//! Settings: `serial` (digits), `baud` (0 accepts any), `boot_s`, `tcp_port`, `udp_port`, `timestamp_us` (initial value
//! of the clock), `status` (bits that are always set).

use std::net::{Ipv4Addr, SocketAddrV4};

use anyhow::Context as _;
use nima_world::emulators::bota::{Emulated as Sensor, slow_motion};

use super::{Emulated, Settings};

fn sensor(settings: &Settings) -> anyhow::Result<Sensor> {
    let usual = Sensor::default();
    let baud = match settings.get("baud")? {
        Some(0) => None,
        given => given.or(usual.baud),
    };
    let udp_port = settings.get("udp_port")?.unwrap_or(usual.destination.port());
    Ok(Sensor {
        serial: settings.get("serial")?.unwrap_or(usual.serial),
        baud,
        boot_s: settings.get("boot_s")?.unwrap_or(usual.boot_s),
        first_timestamp_us: settings.get("timestamp_us")?.unwrap_or(usual.first_timestamp_us),
        status: settings.get("status")?.unwrap_or(usual.status),
        tcp_port: settings.get("tcp_port")?.unwrap_or(usual.tcp_port),
        destination: SocketAddrV4::new(Ipv4Addr::LOCALHOST, udp_port),
        ..usual
    })
}

#[cfg(unix)]
pub(super) fn gen0(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let serving = sensor(settings)?.serve_gen0(slow_motion()).context("no pseudo-terminal can be opened")?;
    Ok(vec![Emulated::new("bota-gen0", serving)])
}

#[cfg(unix)]
pub(super) fn gen_a(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let serving = sensor(settings)?.serve_gen_a(slow_motion()).context("no pseudo-terminal can be opened")?;
    Ok(vec![Emulated::new("bota-gen-a", serving)])
}

pub(super) fn socket(settings: &Settings) -> anyhow::Result<Vec<Emulated>> {
    let sensor = sensor(settings)?;
    let port = sensor.tcp_port;
    let serving = sensor.serve_socket(slow_motion()).with_context(|| {
        format!("TCP port {port} of this computer cannot be opened (below 1024 it needs rights): --set tcp_port=PORT")
    })?;
    Ok(vec![Emulated::new("bota-socket", serving)])
}
