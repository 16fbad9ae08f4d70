//! The built-in emulated rig with other addresses, so that tests do not interfere with each other or with a running
//! console.

use std::{
    net::{TcpListener, UdpSocket},
    path::Path,
};

use nima_devices::bota;
use nima_emulation::emulated::{EmulatedRig, HandFrame, provide_handles};
use nima_machine::{
    config::{RigConfig, RigFile},
    rig::{RigSettings, SensorPlace, SensorSettings, Side},
};
use nima_simulation::scene::Scene;

/// The devices of the emulated rig, in order. The paper's rig has no servos on the left.
pub const DEVICES: [&str; 11] = [
    "right handle",
    "right arm",
    "right sensor",
    "right servos",
    "left handle",
    "left arm",
    "left sensor",
    "left servos",
    "tissue sensor",
    "tracker",
    "pedal",
];

/// Returns a port that is free for TCP and UDP.
fn free_port() -> u16 {
    loop {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        if UdpSocket::bind(("127.0.0.1", port)).is_ok() {
            return port;
        }
    }
}

/// The built-in rig on free ports and in its own folder.
pub fn elsewhere(folder: &Path) -> RigSettings {
    provide_handles();
    let mut devices = RigConfig::load("emulated").unwrap().devices.unwrap();
    let within = |port: &str| folder.join(Path::new(port).file_name().unwrap()).display().to_string();
    for set in [&mut devices.right, &mut devices.left].into_iter().flatten() {
        set.handle.force_dimension_mut().unwrap().emulator =
            Some(format!("127.0.0.1:{}", free_port()).parse().unwrap());
        let arm = set.arm.kinova_mut().unwrap();
        arm.tcp_port = free_port();
        arm.udp_port = free_port();
        let sensor = set.sensor.bota_mut().unwrap();
        sensor.port = match sensor.transport {
            bota::Transport::Socket => format!("127.0.0.1:{}", free_port()),
            _ => within(&sensor.port),
        };
        if let Some(servos) = &mut set.servos {
            servos.port = within(&servos.port);
        }
    }
    if let Some(sensor) = devices.tissue_sensor.as_mut().and_then(SensorSettings::bota_mut) {
        sensor.port = within(&sensor.port);
    }
    if let Some(tracker) = &mut devices.tracker {
        tracker.address = Some(format!("127.0.0.1:{}", free_port()));
        tracker.tools.iter_mut().for_each(|tool| *tool = folder.join(tool.file_name().unwrap()));
    }
    devices.pedal.as_mut().unwrap().source = format!("emulated:{}", folder.join("pedal").display());
    devices
}

/// Returns the built-in rig as a file with the devices at these addresses.
pub fn rig_file(devices: &RigSettings) -> RigFile {
    let mut file = RigFile::of("emulated").unwrap();
    for side in Side::ALL {
        let set = devices.arm(side).unwrap();
        let side = side.word();
        let handle = set.handle.force_dimension().unwrap();
        file.set(&format!("devices.{side}.handle.emulator"), handle.emulator.unwrap().to_string());
        let arm = set.arm.kinova().unwrap();
        file.set(&format!("devices.{side}.arm.tcp_port"), i64::from(arm.tcp_port));
        file.set(&format!("devices.{side}.arm.udp_port"), i64::from(arm.udp_port));
        file.set(&format!("devices.{side}.sensor.port"), &set.sensor.bota().unwrap().port);
        file.set(&format!("devices.{side}.servos.port"), &set.servos.as_ref().unwrap().port);
    }
    file.set("devices.tissue_sensor.port", &devices.tissue_sensor.as_ref().unwrap().bota().unwrap().port);
    let tracker = devices.tracker.as_ref().unwrap();
    file.set("devices.tracker.address", tracker.address.as_ref().unwrap());
    let tools = tracker.tools.iter().map(|tool| tool.display().to_string());
    file.set_all("devices.tracker.tools", tools);
    file.set("devices.pedal.source", &devices.pedal.as_ref().unwrap().source);
    file.set("endoscope.url", format!("http://127.0.0.1:{}/", free_port()));
    assert_eq!(file.rig().unwrap().devices.as_ref(), Some(devices));
    file
}

/// Returns the same with its sensors at the tips, where they measure only the tissue and need no calibration.
pub fn at_tip(folder: &Path) -> RigSettings {
    let mut devices = elsewhere(folder);
    for set in [&mut devices.right, &mut devices.left].into_iter().flatten() {
        set.sensor_at = SensorPlace::Tip;
    }
    devices
}

/// Returns only the right arm: handle, arm, sensor and servos.
pub fn right_arm(folder: &Path) -> RigSettings {
    RigSettings { left: None, tissue_sensor: None, tracker: None, endoscope: None, pedal: None, ..at_tip(folder) }
}

/// Starts the emulated devices of the rig, in the scene of two arms, whose pegs are within reach of each arm.
pub fn started(devices: &RigSettings) -> EmulatedRig {
    started_in(&Scene::load("bimanual").unwrap(), devices)
}

/// Starts the emulated devices in another scene.
pub fn started_in(scene: &Scene, devices: &RigSettings) -> EmulatedRig {
    EmulatedRig::start(
        devices,
        scene,
        &[HandFrame::of(&RigConfig::load("emulated").unwrap().teleoperation.mapping()); 2],
    )
    .unwrap()
}
