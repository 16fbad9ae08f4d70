//! Right and left swapped, one location at a time: on the wire where possible, otherwise in the rig file; and one device
//! for both. Each swap must be reported by name, with the remedy, before any force; without a swap nothing must be
//! reported.
#![cfg(target_os = "linux")]
use std::{
    path::Path,
    time::{Duration, Instant},
};

use nalgebra::Isometry3;
use nima_core::frames::to_roll_pitch_yaw_deg;
use nima_devices::{ConnectionState, DeviceError, bota};
use nima_emulation::emulated::{EmulatedRig, Truth};
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, LoopState, Refusal},
    rig::{ArmSet, EngageBlocker, Healths, RigPart, RigSettings, Side, SideSwap},
    runtime::LoopHandle,
};
use nima_recording::store::{CheckedDevice, ReadyRecord};
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{at_tip, started};

const TIMEOUT: Duration = Duration::from_secs(12);
const DATE: &str = "2026-08-21T10:20:30Z";

/// The swapped parts: on the wires (the devices themselves), in the rig file, or on the instruments.
struct Row {
    place: &'static str,
    wire: fn(&mut RigSettings),
    file: fn(&mut RigSettings),
    markers: bool,
    report: ReportSource,
}

/// Method of detection.
enum ReportSource {
    /// The devices of these parts are rejected.
    Kept(&'static [&'static str]),
    /// No arm can be engaged, for this reason.
    Obstacle(EngageBlocker),
    /// No detection needed: the devices are found automatically, and each is used correctly.
    Harmless,
}

const fn swapped(swap: SideSwap) -> ReportSource {
    ReportSource::Obstacle(EngageBlocker::Exchanged(swap))
}

fn row(place: &'static str, report: ReportSource) -> Row {
    Row { place, wire: |_| (), file: |_| (), markers: false, report }
}

fn sets(devices: &mut RigSettings) -> [&mut ArmSet; 2] {
    [devices.right.as_mut().unwrap(), devices.left.as_mut().unwrap()]
}

/// Returns the built-in rig on other ports, with a tissue sensor of the wrist sensors' generation; its trocars are next
/// to each other.
fn rig(folder: &Path) -> RigSettings {
    let mut devices = at_tip(folder);
    let tissue = devices.tissue_sensor.as_mut().unwrap().bota_mut().unwrap();
    tissue.transport = bota::Transport::GenA;
    tissue.mode = 2;
    tissue.rate_hz = 1000;
    tissue.port = folder.join("ttyACM-tissue-sensor").display().to_string();
    devices
}

/// The results of perfect hand-eye calibrations.
pub(crate) fn hand_eye(set: &mut ArmSet, truth: &Truth) {
    let base = nima_core::kinematics::Arm::new(&set.mount).unwrap();
    let base = Isometry3::from_parts(base.world_from_base().translation, base.world_from_base().rotation.into());
    let base_from_c = base.inverse() * truth.world_from_c;
    set.s1_from_m_m = Some(truth.s1_from_m.translation.vector);
    set.s1_from_m_deg = Some(to_roll_pitch_yaw_deg(&truth.s1_from_m.rotation));
    set.base_from_c_m = Some(base_from_c.translation.vector);
    set.base_from_c_deg = Some(to_roll_pitch_yaw_deg(&base_from_c.rotation));
}

/// Swaps the cables of right and left: the device and its world stay, its address changes.
fn exchange_sensors(devices: &mut RigSettings) {
    let [right, left] = sets(devices);
    std::mem::swap(&mut right.sensor, &mut left.sensor);
    let right = right.sensor.bota_mut().unwrap();
    let left = left.sensor.bota_mut().unwrap();
    std::mem::swap(&mut right.serial_number, &mut left.serial_number);
}

fn exchange_arms(devices: &mut RigSettings) {
    let [right, left] = sets(devices);
    let right = right.arm.kinova_mut().unwrap();
    let left = left.arm.kinova_mut().unwrap();
    std::mem::swap(&mut right.tcp_port, &mut left.tcp_port);
    std::mem::swap(&mut right.udp_port, &mut left.udp_port);
}

fn exchange_with_tissue(devices: &mut RigSettings) {
    let tissue = devices.tissue_sensor.as_mut().unwrap().bota_mut().unwrap();
    let right = devices.right.as_mut().unwrap().sensor.bota_mut().unwrap();
    std::mem::swap(&mut right.port, &mut tissue.port);
}

fn exchange_servos(devices: &mut RigSettings) {
    let [right, left] = sets(devices);
    std::mem::swap(&mut right.servos.as_mut().unwrap().port, &mut left.servos.as_mut().unwrap().port);
}

fn exchange_handles(devices: &mut RigSettings) {
    let [right, left] = sets(devices).map(|set| set.handle.force_dimension_mut().unwrap());
    std::mem::swap(&mut right.emulator, &mut left.emulator);
}

fn nameless_arms(devices: &mut RigSettings) {
    for set in sets(devices) {
        set.arm.kinova_mut().unwrap().serial_number = None;
    }
}

/// As if both addresses led to one arm, for instance through a name and a number.
fn one_serial_number(devices: &mut RigSettings) {
    let [right, left] = sets(devices);
    let serial = right.arm.kinova_mut().unwrap().serial_number.clone();
    left.arm.kinova_mut().unwrap().serial_number = serial;
}

fn nameless_sensors(devices: &mut RigSettings) {
    for set in sets(devices) {
        set.sensor.bota_mut().unwrap().serial_number = None;
    }
    devices.tissue_sensor.as_mut().unwrap().bota_mut().unwrap().serial_number = None;
}

/// Returns the settings after a passed ready check with every device in its place.
fn checked(devices: &mut RigSettings) {
    let serials = [
        ("right handle", "4711"),
        ("right arm", "EMULATED-1"),
        ("right sensor", "SN000901"),
        ("left handle", "4712"),
        ("left arm", "EMULATED-2"),
        ("left sensor", "SN000902"),
        ("tissue sensor", "SN000903"),
    ];
    let device = |(name, serial): (&str, &str)| CheckedDevice {
        name: name.to_owned(),
        driver: String::new(),
        serial: serial.to_owned(),
    };
    let record = ReadyRecord {
        kind: nima_recording::store::READY_CHECK.to_owned(),
        date: DATE.to_owned(),
        software: String::new(),
        rig: String::new(),
        rig_file: String::new(),
        by: String::new(),
        passed: true,
        took_s: 30.0,
        devices: serials.map(device).into(),
        items: Vec::new(),
    };
    devices.checked = Some(nima_machine::rig::CheckedDevices::of(&record));
}

fn rows() -> Vec<Row> {
    vec![
        Row { wire: exchange_handles, ..row("cables of the handles", ReportSource::Harmless) },
        Row {
            file: |devices| {
                let [right, left] = sets(devices);
                let right = right.handle.force_dimension_mut();
                let left = left.handle.force_dimension_mut();
                std::mem::swap(&mut right.unwrap().serial, &mut left.unwrap().serial);
            },
            ..row("serial numbers of the handles in the file", ReportSource::Kept(&["right handle", "left handle"]))
        },
        Row { wire: exchange_arms, ..row("cables of the arms", ReportSource::Kept(&["right arm", "left arm"])) },
        Row {
            file: exchange_arms,
            ..row("addresses of the arms in the file", ReportSource::Kept(&["right arm", "left arm"]))
        },
        Row {
            wire: exchange_arms,
            file: |devices| {
                nameless_arms(devices);
                checked(devices);
            },
            ..row("cables of arms that only a ready check knows", ReportSource::Kept(&["right arm", "left arm"]))
        },
        Row { wire: exchange_arms, file: nameless_arms, ..row("cables of unknown arms", swapped(SideSwap::Arms)) },
        Row {
            wire: exchange_sensors,
            ..row("cables of the sensors", ReportSource::Kept(&["right sensor", "left sensor"]))
        },
        Row {
            wire: exchange_sensors,
            file: |devices| {
                nameless_sensors(devices);
                checked(devices);
            },
            ..row(
                "cables of sensors that only a ready check knows",
                ReportSource::Kept(&["right sensor", "left sensor"]),
            )
        },
        Row {
            wire: exchange_with_tissue,
            ..row("cables of wrist and tissue sensor", ReportSource::Kept(&["right sensor", "tissue sensor"]))
        },
        Row {
            wire: exchange_with_tissue,
            file: |devices| {
                nameless_sensors(devices);
                checked(devices);
            },
            ..row("the same, known by a ready check only", ReportSource::Kept(&["right sensor", "tissue sensor"]))
        },
        Row {
            wire: exchange_servos,
            ..row("cables of the servos", ReportSource::Kept(&["right servos", "left servos"]))
        },
        Row { markers: true, ..row("markers on the instruments", swapped(SideSwap::Markers)) },
        Row {
            file: |devices| {
                let [right, left] = sets(devices);
                std::mem::swap(&mut right.s1_from_m_deg, &mut left.s1_from_m_deg);
                std::mem::swap(&mut right.s1_from_m_m, &mut left.s1_from_m_m);
            },
            ..row("values of the markers in the file", swapped(SideSwap::Markers))
        },
        Row {
            file: |devices| {
                let [right, left] = sets(devices);
                std::mem::swap(&mut right.base_from_c_m, &mut left.base_from_c_m);
                std::mem::swap(&mut right.base_from_c_deg, &mut left.base_from_c_deg);
            },
            ..row("values of the camera in the file", swapped(SideSwap::Markers))
        },
        Row {
            file: |devices| {
                let [right, left] = sets(devices);
                std::mem::swap(&mut right.mount, &mut left.mount);
            },
            ..row("mounts of the arms in the file", swapped(SideSwap::Arms))
        },
        Row {
            file: |devices| {
                let [right, left] = sets(devices);
                std::mem::swap(&mut right.rcm, &mut left.rcm);
            },
            ..row("trocars in the file", swapped(SideSwap::Trocars))
        },
        Row {
            wire: one_serial_number,
            file: nameless_arms,
            ..row("one serial number for both arms", ReportSource::Obstacle(EngageBlocker::OneArm))
        },
    ]
}

/// A running machine, and its reports.
struct Machine {
    handle: LoopHandle,
    healths: Healths,
    refusals: Vec<Refusal>,
    engaged: bool,
    max_n: f64,
    tick_count: u64,
}

impl Machine {
    fn start(devices: RigSettings) -> Self {
        let rig = RigConfig { devices: Some(devices), ..RigConfig::load("emulated").unwrap() };
        rig.validate().unwrap();
        let scene = Scene::load("peg_transfer").unwrap();
        let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: false };
        let handle = nima_simulation::start(&plan).unwrap();
        let healths = Healths::default();
        Self { handle, healths, refusals: Vec::new(), engaged: false, max_n: 0.0, tick_count: 0 }
    }

    /// Processes its reports, and commands an engagement.
    fn look(&mut self) {
        std::thread::sleep(Duration::from_millis(10));
        let Self { handle, healths, refusals, engaged, max_n, tick_count } = self;
        let mut latched = false;
        handle.drain_ticks(|tick| {
            latched |= tick.state.is_latched();
            *engaged |= tick.state == LoopState::Engaged;
            *max_n = max_n.max(tick.rendering.rendered_n.norm());
            *tick_count += 1;
        });
        handle.drain_events(|event| {
            if let Event::CommandRefused { why, .. } = event {
                refusals.push(*why);
            }
        });
        *healths = handle.healths().unwrap_or(*healths);
        // On a busy machine a device may seem silent for a moment; release the stop that this causes too.
        handle.send(if latched { Command::ReleaseStop } else { Command::Engage });
    }

    fn until(&mut self, what: &str, good: impl Fn(&Self) -> bool) {
        let begin = Instant::now();
        while !good(self) {
            assert!(
                begin.elapsed() <= TIMEOUT,
                "never: {what}; {:?}; {:?}; {:?}",
                self.troubles(),
                self.healths.obstacles,
                self.refusals.last()
            );
            self.look();
        }
    }

    fn troubles(&self) -> Vec<(String, DeviceError)> {
        let trouble =
            |entry: &nima_machine::rig::RosterEntry| Some((entry.name().to_owned(), entry.view.report().trouble?));
        self.handle.roster().iter().filter_map(trouble).collect()
    }

    fn all_connected(&self) -> bool {
        let devices = &self.healths.devices[..self.handle.roster().len()];
        devices.iter().all(|health| health.standing == ConnectionState::Connected)
    }

    fn report(&mut self, row: &Row) -> Vec<String> {
        match row.report {
            ReportSource::Kept(parts) => {
                let kept = |machine: &Self| {
                    let is_exchanged = |(_, trouble): &(String, DeviceError)| trouble.cure().contains("swapped");
                    let names: Vec<_> =
                        machine.troubles().into_iter().filter(is_exchanged).map(|(name, _)| name).collect();
                    parts.iter().all(|part| names.iter().any(|name| name == part))
                };
                self.until(row.place, kept);
                let words = |(name, trouble): (String, DeviceError)| {
                    assert!(parts.contains(&name.as_str()), "{}: only they are kept out: {name}", row.place);
                    format!("{name}: {trouble}: {}", trouble.cure())
                };
                let report: Vec<_> = self.troubles().into_iter().map(words).collect();
                assert!(report.iter().all(|words| words.contains("swapped")), "{report:?}");
                report
            }
            ReportSource::Obstacle(named) => {
                self.until(row.place, |machine| {
                    machine.healths.obstacles == [Some(named); 2]
                        && machine.refusals.contains(&Refusal::Obstacle(named))
                });
                vec![named.to_string()]
            }
            ReportSource::Harmless => {
                self.until(row.place, |machine| machine.all_connected() && machine.max_n > 0.0);
                let serial = |part: RigPart| {
                    let entry = self.handle.roster().iter().find(|entry| entry.part == Some(part)).unwrap();
                    entry.view.report().identity.unwrap().serial
                };
                assert_eq!(Side::ALL.map(|side| serial(RigPart::Handle(side))), ["4711", "4712"]);
                Vec::new()
            }
        }
    }
}

fn start(row: &Row, folder: &Path) -> (EmulatedRig, Machine) {
    let good = rig(folder);
    let mut wired = good.clone();
    (row.wire)(&mut wired);
    let emulated = started(&wired);
    if row.markers {
        emulated.exchange_markers();
    }
    let mut named = good;
    for (set, side) in sets(&mut named).into_iter().zip(Side::ALL) {
        hand_eye(set, &emulated.truth(side).unwrap());
    }
    (row.file)(&mut named);
    (emulated, Machine::start(named))
}

#[test]
fn right_and_left_exchanged_at_any_place_are_told_before_any_force() {
    let _alone = alone();
    for row in rows() {
        judged(|| {
            let folder = tempfile::tempdir().unwrap();
            let (_emulated, mut machine) = start(&row, folder.path());
            let report = machine.report(&row);
            println!("{}: {report:?}", row.place);
            if !matches!(row.report, ReportSource::Harmless) {
                // Repeated commands have no effect.
                let end = Instant::now() + Duration::from_millis(200);
                while Instant::now() < end {
                    machine.look();
                }
                assert!(!machine.engaged && machine.max_n == 0.0 && machine.tick_count > 0, "{}", row.place);
            }
        });
    }
}

#[test]
fn where_nothing_is_exchanged_nothing_is_told() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let row = Row { file: checked, ..row("nothing", ReportSource::Harmless) };
        let (_emulated, mut machine) = start(&row, folder.path());
        machine.until("force", |machine| machine.max_n > 0.0);
        let end = Instant::now() + Duration::from_secs(1);
        while Instant::now() < end {
            machine.look();
            assert_eq!(machine.troubles(), []);
            let is_exchanged = |obstacle: &Option<EngageBlocker>| matches!(obstacle, Some(EngageBlocker::Exchanged(_)));
            assert!(!machine.healths.obstacles.iter().any(is_exchanged), "{:?}", machine.healths.obstacles);
        }
        let exchanged = |why: &&Refusal| matches!(why, Refusal::Obstacle(EngageBlocker::Exchanged(_)));
        assert_eq!(machine.refusals.iter().find(exchanged), None);
    });
}
