//! The active calibrations: determined by the rig's sensors and tools, never by the scene.

use std::{
    path::Path,
    time::{Duration, Instant},
};

use nima_core::calibration::{RecordHead, correspondence::CorrespondenceRecord, gravity::GravityRecord};
use nima_devices::{DeviceSlot, ForceReading, Lever, bota};
use nima_emulation::emulators::{EmulatorThread, bota as emulated};
use nima_machine::{
    messages::ForceSource,
    rig::{DeviceEvent, DeviceWatch, Inputs, Outputs, Rig, RigPart, Roster, RosterEntry},
};
use nima_simulation::{SimulationPlan, Worlds, start_on};
use nima_tests::gravity;

use super::*;

/// Returns the simulated gravity calibration, for this sensor and tool.
fn record(sensor: &str, tool: &str) -> GravityRecord {
    static MADE: std::sync::OnceLock<GravityRecord> = std::sync::OnceLock::new();
    let made = MADE.get_or_init(gravity::gravity).clone();
    GravityRecord { head: RecordHead::new(sensor, tool, &made.head.date), ..made }
}

fn has_gravity(active: &mut ActiveCalibrations, rig: &RigConfig) -> [bool; SIDES] {
    active.calibrations(rig).each_ref().map(|calibrations| calibrations.gravity.is_some())
}

#[test]
fn a_simulated_calibration_is_not_in_force_on_a_rig_with_devices() {
    let folder = tempfile::tempdir().unwrap();
    let simulated = RigConfig::load("simulated").unwrap();
    let real = RigConfig::load("paper").unwrap();
    let scene = Scene::load("palpation").unwrap();
    let wrist = simulated.simulated_wrist(Side::Right).unwrap();
    Store::open(folder.path()).save(&record(&wrist.serial_number, &wrist.tool)).unwrap();
    let mut at_home = ActiveCalibrations::load(Some(folder.path()), &simulated, &scene);
    assert_eq!(has_gravity(&mut at_home, &simulated), [true, false]);
    let mut active = ActiveCalibrations::load(Some(folder.path()), &real, &scene);
    assert_eq!(has_gravity(&mut active, &real), [false; SIDES]);
    assert!(active.is_waiting() && active.binding().sensor.is_empty());
    let lines = active.lines();
    assert!(lines.len() == 2 && lines[1].starts_with("Left: The wrist sensor is not connected"), "{lines:?}");
}

#[test]
fn each_arm_has_the_calibration_of_its_own_sensor() {
    let folder = tempfile::tempdir().unwrap();
    let rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load("palpation").unwrap().with_left_hand();
    let store = Store::open(folder.path());
    store.save(&record("SIM-S1-0001", "Simulated grasper")).unwrap();
    let mut active = ActiveCalibrations::load(Some(folder.path()), &rig, &scene);
    assert_eq!(has_gravity(&mut active, &rig), [true, false], "the right arm's is not the left one's");
    assert_eq!(active.uncalibrated().map(|wrist| wrist.serial_number.as_str()), Some("SIM-S1-0002"));
    assert_eq!(active.report(), [""; 0], "the sensor on the other arm is where it belongs");
    let mut left = record("SIM-S1-0002", "Simulated grasper");
    left.model.imu_sign = -left.model.imu_sign;
    store.save(&left).unwrap();
    active.bind(&rig, &scene);
    let [right, left_one] = active.calibrations(&rig);
    assert_eq!(left_one.gravity, Some(left.model));
    assert_ne!(right.gravity, left_one.gravity);
    active.choose(Side::Left);
    assert_eq!(active.binding().sensor, "SIM-S1-0002");
}

/// Returns a rig whose right and left arms have sensors and tools of these names.
fn mounted(right: [&str; 2], left: [&str; 2]) -> RigConfig {
    let mut rig = RigConfig::load("simulated").unwrap();
    let wrist = |[serial, tool]: [&str; 2]| Some(WristId { serial_number: serial.to_owned(), tool: tool.to_owned() });
    let wrists = rig.simulated.as_mut().unwrap();
    wrists.right = wrist(right);
    wrists.left = wrist(left);
    rig.validate().unwrap();
    rig
}

#[test]
fn exchanged_sensors_or_tools_have_no_calibration_in_force_and_are_told_as_exchanged() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    store.save(&record("R-1", "Right grasper")).unwrap();
    store.save(&record("L-1", "Left grasper")).unwrap();
    let scene = Scene::load("palpation").unwrap().with_left_hand();
    let active = |rig: &RigConfig| ActiveCalibrations::load(Some(folder.path()), rig, &scene);
    let good = mounted(["R-1", "Right grasper"], ["L-1", "Left grasper"]);
    let mut in_order = active(&good);
    assert_eq!((has_gravity(&mut in_order, &good), in_order.report()), ([true; SIDES], Vec::new()));
    for exchanged in [
        mounted(["L-1", "Right grasper"], ["R-1", "Left grasper"]),
        mounted(["R-1", "Left grasper"], ["L-1", "Right grasper"]),
    ] {
        let mut active = active(&exchanged);
        assert_eq!(has_gravity(&mut active, &exchanged), [false; SIDES], "no force is known, so nothing engages");
        let [words] = &active.report()[..] else { panic!("{:?}", active.report()) };
        assert!(words.contains("are swapped") && words.contains("R-1") && words.contains("Swap sensors"), "{words}");
    }
}

#[test]
fn a_calibration_that_was_copied_to_the_other_side_is_not_in_force_and_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(folder.path());
    store.save(&record("R-1", "Right grasper")).unwrap();
    let paths = ["R-1", "L-1"].map(|sensor| store.path::<GravityRecord>(sensor).unwrap());
    std::fs::copy(&paths[0], &paths[1]).unwrap();
    let rig = mounted(["R-1", "Right grasper"], ["L-1", "Left grasper"]);
    let scene = Scene::load("palpation").unwrap().with_left_hand();
    let mut active = ActiveCalibrations::load(Some(folder.path()), &rig, &scene);
    assert_eq!(has_gravity(&mut active, &rig), [true, false]);
    let report = active.report();
    assert!(report.len() == 1 && report[0].contains("not used") && report[0].contains("R-1"), "{report:?}");
}

#[test]
fn a_damaged_file_is_reported_until_its_own_calibration_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load("palpation").unwrap();
    let wrist = rig.simulated_wrist(Side::Right).unwrap();
    let store = Store::open(folder.path());
    std::fs::write(store.path::<GravityRecord>(&wrist.serial_number).unwrap(), "kind of a note").unwrap();
    std::fs::write(store.path::<CorrespondenceRecord>(&wrist.serial_number).unwrap(), b"\xff\0\x80").unwrap();
    let mut active = ActiveCalibrations::load(Some(folder.path()), &rig, &scene);
    let reported = |active: &ActiveCalibrations| {
        let report = active.report().join("\n");
        ["gravity", "correspondence"].map(|kind| report.contains(&format!("{kind}-{}.toml", wrist.serial_number)))
    };
    assert_eq!(reported(&active), [true, true], "{:?}", active.report());
    active.save(SaveRequest::Gravity(Box::new(record(&wrist.serial_number, &wrist.tool)))).unwrap();
    assert_eq!(reported(&active), [false, true], "{:?}", active.report());
}

#[test]
fn a_simulated_rig_that_names_no_sensor_tells_what_to_write() {
    let mut rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load("palpation").unwrap();
    rig.simulated = None;
    let folder = tempfile::tempdir().unwrap();
    let mut active = ActiveCalibrations::load(Some(folder.path()), &rig, &scene);
    assert!(active.lines()[0].contains("[simulated]"), "{:?}", active.lines());
    let refused = active.save(SaveRequest::Gravity(Box::new(record("any", "any")))).unwrap_err();
    assert!(refused.contains("serial number"), "{refused}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// The simulated world of one arm; its force sensor connects and disconnects on a real line with the real driver.
struct OneSensor {
    worlds: Worlds,
    slot: DeviceSlot<bota::BotaDriver>,
    watch: DeviceWatch,
}

impl Rig for OneSensor {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        self.slot.poll(now_s);
        self.watch.look(now_s, 0, self.slot.health().standing, [false; SIDES]);
        self.worlds.read(now_s)
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        self.worlds.write(now_s, outputs);
    }

    fn event(&mut self) -> Option<DeviceEvent> {
        self.watch.take()
    }

    fn levers(&self) -> Vec<Lever> {
        Vec::new()
    }
}

fn sensor(serial: &str, port: &std::path::Path) -> EmulatorThread {
    let sensor = emulated::EmulatedBota {
        serial: serial.to_owned(),
        baud: None,
        link: Some(port.to_owned()),
        ..emulated::EmulatedBota::default()
    };
    sensor.with(Box::new(|_| ForceReading::default())).serve().unwrap()
}

/// A loop on a rig with devices, and the calibrations that the console activates.
struct Fixture {
    handle: LoopHandle,
    active: ActiveCalibrations,
    rig: RigConfig,
    source: Option<ForceSource>,
}

impl Fixture {
    fn new(store: &Path, port: &Path) -> Self {
        let mut rig = RigConfig::load("paper").unwrap();
        rig.devices.as_mut().unwrap().left = None;
        // The default scene has no wrist sensor, which must not matter for a rig with devices.
        let scene = Scene::load("peg_transfer").unwrap();
        let settings = bota::BotaSettings::new(bota::Transport::GenA, port.display().to_string());
        let slot = DeviceSlot::start("sensor", move || bota::BotaDriver::open(&settings)).unwrap();
        let entry = RosterEntry::of(RigPart::Sensor(Side::Right), "", slot.view());
        let worlds = Worlds::new(&Scene::load("palpation").unwrap(), rig.rate_hz);
        let one = OneSensor { worlds, slot, watch: DeviceWatch::default() };
        let active = ActiveCalibrations::load(Some(store), &rig, &scene);
        let plan = SimulationPlan { rig: rig.clone(), scene, calibrations: Default::default(), engage: false };
        let handle = start_on(&plan, Box::new(one), Roster::from([entry])).unwrap();
        Self { handle, active, rig, source: None }
    }

    fn until(&mut self, what: &str, good: impl Fn(&Self) -> bool) {
        let began = Instant::now();
        while !good(self) {
            // Far longer than needed, even on a busy machine.
            assert!(began.elapsed() < Duration::from_mins(3), "never: {what}; {:?}", self.active.lines());
            std::thread::sleep(Duration::from_millis(2));
            self.handle.drain_ticks(|tick| self.source = Some(tick.force.source));
            self.active.meet(&self.handle, &self.rig);
        }
    }

    fn is_bound_to(&self, sensor: &str) -> bool {
        self.active.binding().sensor == sensor
    }
}

#[test]
fn a_calibration_comes_into_force_with_its_sensor_and_leaves_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let store = tempfile::tempdir().unwrap();
    let port = folder.path().join("ttyACM-sensor");
    let mut bench = Fixture::new(store.path(), &port);
    assert!(bench.active.is_waiting());
    // A rig with devices can be calibrated in any scene.
    let first = sensor("4242", &port);
    bench.until("the sensor is known", |bench| bench.is_bound_to("SN004242"));
    assert_eq!(bench.active.binding().tool, "Right grasper");
    bench.until("a first tick", |bench| bench.source == Some(ForceSource::Uncalibrated));
    bench.active.save(SaveRequest::Gravity(Box::new(record("SN004242", "Right grasper")))).unwrap();
    drop(bench);
    let mut bench = Fixture::new(store.path(), &port);
    bench.until("the calibration is active", |bench| bench.source == Some(ForceSource::Wrist));
    assert_eq!(bench.active.uncalibrated(), None);
    // Another sensor at the same address.
    drop(first);
    bench.until("it is inactive", |bench| bench.source == Some(ForceSource::Unidentified));
    let second = sensor("4243", &port);
    bench.until("the other one is known", |bench| bench.is_bound_to("SN004243"));
    let report = bench.active.report();
    assert!(
        report[0].contains("SN004243") && report[0].contains("SN004242 has one: connect that sensor"),
        "{report:?}"
    );
    std::thread::sleep(Duration::from_millis(50));
    bench.handle.drain_ticks(|tick| bench.source = Some(tick.force.source));
    assert_eq!(bench.source, Some(ForceSource::Uncalibrated), "the calibration of another sensor");
    // The first sensor again.
    drop(second);
    let _again = sensor("4242", &port);
    bench.until("it is active again", |bench| bench.source == Some(ForceSource::Wrist));
    // Another tool on the same sensor.
    drop(bench);
    let mut bench = Fixture::new(store.path(), &port);
    bench.rig.devices.as_mut().unwrap().right.as_mut().unwrap().tool = "Scissors".to_owned();
    bench.until("the tool is refused", |bench| {
        bench.active.report().iter().any(|report| report.contains("not \"Scissors\""))
    });
    assert_eq!(bench.active.calibrations(&bench.rig)[0].gravity, None);
}
