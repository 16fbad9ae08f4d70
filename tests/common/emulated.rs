//! The embedded emulated rig away from its fixed places, so that tests disturb nobody.

use std::{
    net::{TcpListener, UdpSocket},
    path::Path,
    sync::{Mutex, MutexGuard, PoisonError},
};

use nima::{
    config::{Rig, Scene},
    device::{bota, rig::Settings},
    sim::emulated::{EmulatedRig, HandFrame},
};

/// A port that is free for TCP and UDP.
fn free_port() -> u16 {
    loop {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        if UdpSocket::bind(("127.0.0.1", port)).is_ok() {
            return port;
        }
    }
}

/// One rig at a time: devices in real time look silent beside others that take every core.
pub(crate) fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The embedded rig on free ports and in a folder of its own.
pub(crate) fn elsewhere(folder: &Path) -> Settings {
    let mut devices = Rig::load("emulated").unwrap().devices.unwrap();
    let within = |port: &str| folder.join(Path::new(port).file_name().unwrap()).display().to_string();
    for set in [&mut devices.right, &mut devices.left].into_iter().flatten() {
        set.handle.emulator = Some(format!("127.0.0.1:{}", free_port()).parse().unwrap());
        (set.arm.tcp_port, set.arm.udp_port) = (free_port(), free_port());
        set.sensor.port = match set.sensor.transport {
            bota::Transport::Socket => format!("127.0.0.1:{}", free_port()),
            _ => within(&set.sensor.port),
        };
        if let Some(servos) = &mut set.servos {
            servos.port = within(&servos.port);
        }
    }
    if let Some(sensor) = &mut devices.tissue_sensor {
        sensor.port = within(&sensor.port);
    }
    if let Some(tracker) = &mut devices.tracker {
        tracker.address = Some(format!("127.0.0.1:{}", free_port()));
        tracker.tools.iter_mut().for_each(|tool| *tool = folder.join(tool.file_name().unwrap()));
    }
    devices.pedal.as_mut().unwrap().source = format!("emulated:{}", folder.join("pedal").display());
    devices
}

pub(crate) fn started(devices: &Settings) -> EmulatedRig {
    EmulatedRig::start(
        devices,
        &Scene::load("peg_transfer").unwrap(),
        &[HandFrame::of(&Rig::load("emulated").unwrap().teleoperation.mapping()); 2],
    )
    .unwrap()
}
