//! Starts the emulators, each with the world of its side as data source.

use std::{
    net::{Ipv4Addr, SocketAddrV4},
    path::{Path, PathBuf},
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
};

use nalgebra::Vector3;
use nima_core::frames::Wrench;
#[cfg(target_os = "linux")]
use nima_devices::PedalReading;
use nima_devices::{ForceReading, TrackedTool, bota, dynamixel, force_dimension, hid, kinova, ndi};
use nima_machine::rig::{ArmSet, EndoscopeSettings, FollowerSettings, RigSettings, SIDES, SensorSettings, Side};

use super::{EmulatedDevice, EmulatedRigError, SharedWorld, SideWorld, addresses};
use crate::emulators::{self, EmulatedFault, Emulator, FaultSwitch};

type ServingSides = [Option<SharedWorld>; SIDES];
type ServedDevices = Result<EmulatedDevice, EmulatedRigError>;

/// Stiffness of the instrument's cables at a servo, Nm/rad, and their rest angle, rad: guesses of a realistic
/// magnitude.
const CABLES_NM_PER_RAD: f64 = 0.3;
const CABLES_REST_RAD: f64 = 0.3;
/// Start-up time of a first-generation sensor, s: short, because every test of an opening waits for it, but with all of
/// its steps visible.
const BOOT_S: f64 = 0.2;
/// The sensor under the tissue is at room temperature, degrees Celsius.
const ROOM_C: f64 = 24.0;

fn served(device: String, emulator: Box<dyn Emulator>) -> ServedDevices {
    match emulator.serve() {
        Ok(serving) => Ok(EmulatedDevice { name: device, serving }),
        Err(source) => Err(EmulatedRigError::Serve { device, source }),
    }
}

/// Starts every device of the rig.
pub(super) fn all(
    settings: &RigSettings,
    sides: &ServingSides,
    pedal_switches: &Arc<AtomicU32>,
    markers_exchanged: &Arc<AtomicBool>,
    endoscope: &Arc<OnceLock<FaultSwitch>>,
) -> Result<Vec<EmulatedDevice>, EmulatedRigError> {
    settings.check()?;
    let mut devices = Vec::new();
    for (side, shared) in Side::ALL.into_iter().zip(sides) {
        let (Some(set), Some(shared)) = (settings.arm(side), shared) else { continue };
        devices.push(handle(side, set, shared)?);
        devices.push(arm(side, set, shared)?);
        let world = shared.clone();
        let name = format!("{} sensor", side.word());
        devices.push(sensor(name, &set.sensor, 901 + side.index(), Box::new(move |_| world.with(SideWorld::feel)))?);
        if let Some(chosen) = &set.servos {
            devices.push(servos(side, chosen)?);
        }
    }
    if let Some(chosen) = &settings.tissue_sensor {
        devices.push(sensor("tissue sensor".to_owned(), chosen, 901 + SIDES, under_the_tissue(sides))?);
    }
    if let Some(chosen) = &settings.tracker {
        let marked = settings.endoscope.map(|settings| (settings, Arc::clone(endoscope)));
        devices.push(tracker(chosen, marked, sides, Arc::clone(markers_exchanged))?);
    }
    if let Some(chosen) = &settings.pedal {
        devices.push(pedal(chosen, pedal_switches)?);
    }
    Ok(devices)
}

fn handle(side: Side, set: &ArmSet, shared: &SharedWorld) -> ServedDevices {
    let name = format!("{} handle", side.word());
    let chosen = set.handle.force_dimension();
    let Some((chosen, address)) = chosen.and_then(|chosen| Some((chosen, chosen.emulator?))) else {
        let wanted = "for a handle of an emulated rig, set emulator = \"127.0.0.1:PORT\"";
        return Err(EmulatedRigError::Place { device: name, place: "no address".to_owned(), wanted });
    };
    addresses::local(&name, &address.ip().to_string())?;
    let left_handed = chosen.hand.unwrap_or(side) == Side::Left;
    let usual = emulators::force_dimension::EmulatedForceDimension::default();
    let emulated = emulators::force_dimension::EmulatedForceDimension {
        serial: chosen.serial.unwrap_or(usual.serial + side.index() as u16),
        // Taken from the rig file, which may intentionally have the left-handed device on the right side.
        kind: force_dimension::ForceDimensionKind::Omega7 { left_handed },
        port: address.port(),
        ..usual
    };
    let world = shared.clone();
    served(name, emulated.with(move |_: f64, applied: &_| world.with(|side, now_s| side.hold(now_s, applied))))
}

fn arm(side: Side, set: &ArmSet, shared: &SharedWorld) -> ServedDevices {
    let name = format!("{} arm", side.word());
    let model = set.model().map_err(|source| EmulatedRigError::Mount { device: name.clone(), source })?;
    let joints = model.joints();
    let usual_serial = format!("EMULATED-{}", 1 + side.index());
    let world = shared.clone();
    let body = move |_: f64, asked: &_| world.with(|side, now_s| side.ask(now_s, asked));
    match set.arm.clone() {
        FollowerSettings::Kinova(chosen) => {
            let kinova::KinovaSettings { host, tcp_port, udp_port, serial_number, user, password, .. } = chosen;
            addresses::local(&name, &host)?;
            let usual = emulators::kinova::EmulatedKinova::default();
            let serial = serial_number.unwrap_or(usual_serial);
            let joints = joints as u32;
            let emulated =
                emulators::kinova::EmulatedKinova { user, password, serial, joints, tcp_port, udp_port, ..usual };
            served(name, emulated.with(body))
        }
        FollowerSettings::External(chosen) => {
            addresses::local(&name, &chosen.listen.ip().to_string())?;
            let serial = chosen.serial_number.unwrap_or(usual_serial);
            let emulated = emulators::external::EmulatedExternalArm { listen: chosen.listen, joints, serial };
            served(name, emulated.with(body))
        }
        FollowerSettings::Simulated(_) => Err(EmulatedRigError::Make { device: name }),
    }
}

fn sensor(
    name: String,
    chosen: &SensorSettings,
    usual_serial: usize,
    body: emulators::bota::BotaBody,
) -> ServedDevices {
    let Some(chosen) = chosen.bota() else { return Err(EmulatedRigError::Make { device: name }) };
    let usual = emulators::bota::EmulatedBota::default();
    let digits = |serial: &String| serial.trim().trim_start_matches("SN").to_owned();
    let mut emulated = emulators::bota::EmulatedBota {
        transport: chosen.transport,
        serial: chosen.serial_number.as_ref().map_or_else(|| usual_serial.to_string(), digits),
        baud: Some(chosen.baud).filter(|_| !chosen.is_usb()),
        boot_s: BOOT_S,
        link: Some(PathBuf::from(&chosen.port)),
        ..usual
    };
    if chosen.transport == bota::Transport::Socket {
        emulated.tcp_port = addresses::port(&name, &chosen.port, bota::TCP_PORT)?;
        // Readings go to the datagram port of the same number, so two sensors must not have the same TCP port.
        emulated.destination = SocketAddrV4::new(Ipv4Addr::LOCALHOST, emulated.tcp_port);
    }
    served(name, emulated.with(body))
}

/// Returns a sensor under the tissue: both tips press on the same tissue.
fn under_the_tissue(sides: &ServingSides) -> emulators::bota::BotaBody {
    let worlds: Vec<SharedWorld> = sides.iter().flatten().cloned().collect();
    Box::new(move |_| {
        let force_n = worlds.iter().map(|world| world.with(SideWorld::press)).sum();
        ForceReading {
            wrench: Wrench { force_n, torque_nm: Vector3::zeros() },
            temperature_c: ROOM_C,
            ..ForceReading::default()
        }
    })
}

fn servos(side: Side, chosen: &dynamixel::DynamixelSettings) -> ServedDevices {
    let name = format!("{} servos", side.word());
    let usual = emulators::dynamixel::EmulatedDynamixel::default();
    let model = chosen.servos[0].model.as_ref();
    let known = model.and_then(|model| dynamixel::table::MODELS.iter().find(|known| known.name == model));
    let emulated = emulators::dynamixel::EmulatedDynamixel {
        ids: chosen.servos.iter().map(|servo| servo.id).collect(),
        model: known.map_or(usual.model, |model| model.number),
        baud: chosen.baud,
        fast: usual.fast,
        link: Some(PathBuf::from(&chosen.port)),
    };
    let supply_v = if known.is_some_and(dynamixel::table::ServoModel::is_small) { 5.0 } else { 12.0 };
    // In this world, tissue does not load the jaws; the cables that move them do.
    let body = move |_: f64, _: usize, shaft: &emulators::dynamixel::ServoShaft| {
        let load_nm = CABLES_NM_PER_RAD * (CABLES_REST_RAD - shaft.angle_rad).clamp(-1.0, 1.0);
        emulators::dynamixel::ServoSurroundings { load_nm, supply_v, temperature_c: 31.0 }
    };
    match emulated.with(Some(Box::new(body))) {
        Ok(emulator) => served(name, emulator),
        Err(source) => Err(EmulatedRigError::Serve { device: name, source }),
    }
}

fn tracker(
    chosen: &ndi::NdiSettings,
    endoscope: Option<(EndoscopeSettings, Arc<OnceLock<FaultSwitch>>)>,
    sides: &ServingSides,
    exchanged: Arc<AtomicBool>,
) -> ServedDevices {
    let name = "tracker".to_owned();
    for tool in &chosen.tools {
        if let Err(source) = define(tool) {
            return Err(EmulatedRigError::Serve { device: name, source });
        }
    }
    let worlds: Vec<SharedWorld> = sides.iter().flatten().cloned().collect();
    let on = move |number: usize| match number {
        0 | 1 if exchanged.load(Ordering::Acquire) => 1 - number,
        _ => number,
    };
    let body = move |_: f64, number: usize| match (worlds.get(on(number)), &endoscope, worlds.first()) {
        (Some(world), ..) => world.with(SideWorld::marker),
        (None, Some((endoscope, fault)), Some(world)) if endoscope.tool == number => {
            let is_moved = fault.get().is_some_and(|fault| fault.get() == EmulatedFault::Moved);
            world.with(|side, _| side.endoscope(endoscope, is_moved))
        }
        _ => TrackedTool::Missing { out_of_volume: false },
    };
    let profile = emulators::ndi::NdiProfile::default();
    let emulator = match chosen.address {
        Some(_) => profile.on_network(addresses::port(&name, &chosen.place(), ndi::PORT)?, body),
        None => profile.on_line(chosen.port.as_ref().map(PathBuf::from), body),
    };
    served(name, emulator)
}

/// Creates a tool definition if the rig names a missing file, or replaces an unusable one of an older program.
fn define(path: &Path) -> std::io::Result<()> {
    const OLDER: &[u8] = b"NDI\0emulated instrument";
    let is_older = || nima_files::read(path, ndi::DEFINITION as u64).is_ok_and(|bytes| bytes.starts_with(OLDER));
    if path.exists() && !is_older() {
        return Ok(());
    }
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        nima_devices::own_folder::prepare(folder)?;
    }
    // Each tool has its own definition, as on a real rig.
    let definition = ndi::NdiDefinition::emulated(&path.to_string_lossy());
    nima_files::write_atomically(path, |file| file.write_all(definition.bytes()))
}

#[cfg(target_os = "linux")]
fn pedal(chosen: &hid::PedalSettings, switches: &Arc<AtomicU32>) -> ServedDevices {
    let name = "pedal".to_owned();
    let path = PathBuf::from(addresses::pedal(&name, &chosen.source)?);
    let switches = Arc::clone(switches);
    let body =
        emulators::hid::PedalBody::pressed_by(move |_| PedalReading { pressed: switches.load(Ordering::Acquire) });
    served(name, emulators::hid::pedal(Some(path), emulators::hid::PedalModel::Switches, body))
}

#[cfg(not(target_os = "linux"))]
fn pedal(chosen: &hid::PedalSettings, _: &Arc<AtomicU32>) -> ServedDevices {
    let device = "pedal".to_owned();
    Err(EmulatedRigError::Place { device, place: chosen.source.clone(), wanted: "emulated pedals need Linux" })
}
