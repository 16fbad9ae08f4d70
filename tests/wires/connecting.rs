//! A rig file that names other devices: the machine starts with them, and each part gets its data from the selected
//! device. The emulated devices stay in place, like real ones.
#![cfg(target_os = "linux")]
use std::time::{Duration, Instant};

use nima_devices::{ConnectionState, force_dimension};
use nima_emulation::emulators::EmulatedFault;
use nima_machine::{
    config::{ChosenDevice, RigConfig},
    rig::{Gauge, Gauges, Healths, PartKind, RigPart, Side},
    runtime::LoopHandle,
};
use nima_simulation::{SimulationPlan, scene::Scene};
use nima_testing::real_time::{alone, judged};
use nima_tests::emulated::{elsewhere, rig_file, started};

const TIMEOUT: Duration = Duration::from_secs(20);

/// A running machine, and the last status of its devices.
struct Machine {
    handle: LoopHandle,
    healths: Healths,
    gauges: Option<Gauges>,
}

impl Machine {
    fn start(rig: RigConfig) -> Self {
        let scene = Scene::load("peg_transfer").unwrap();
        let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: false };
        Self { handle: nima_simulation::start(&plan).unwrap(), healths: Healths::default(), gauges: None }
    }

    fn until(&mut self, what: &str, good: impl Fn(&Self) -> bool) {
        let begin = Instant::now();
        while !good(self) {
            assert!(begin.elapsed() <= TIMEOUT, "never: {what}; {:?}", self.healths);
            std::thread::sleep(Duration::from_millis(5));
            self.handle.drain_ticks(|_| ());
            self.healths = self.handle.healths().unwrap_or(self.healths);
            self.gauges = self.handle.gauges().last().or(self.gauges);
        }
    }

    fn place(&self, part: RigPart) -> usize {
        self.handle.roster().iter().position(|entry| entry.part == Some(part)).unwrap()
    }

    fn is(&self, part: RigPart, standing: impl Fn(ConnectionState) -> bool) -> bool {
        standing(self.healths.devices[self.place(part)].standing)
    }

    fn all_connected(&self) -> bool {
        RigPart::ALL.into_iter().all(|part| self.is(part, |standing| standing == ConnectionState::Connected))
    }

    fn serial(&self, part: RigPart) -> String {
        self.handle.roster()[self.place(part)].view.report().identity.unwrap().serial
    }

    fn gauge(&self, part: RigPart) -> Option<&Gauge> {
        self.gauges.as_ref().map(|gauges| &gauges.devices[self.place(part)])
    }
}

#[test]
fn the_chosen_handle_and_the_exchanged_sensors_are_the_ones_that_the_machine_uses() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = elsewhere(folder.path());
        let emulated = started(&devices);
        let mut file = rig_file(&devices);
        // Emulated handles report which hand they are for, like real ones, so a swap must be set explicitly.
        file.set("devices.right.handle.hand", "right");
        file.set("devices.left.handle.hand", "left");
        file.choose(RigPart::Handle(Side::Right), &ChosenDevice::Of(RigPart::Handle(Side::Left)));
        file.exchange_sides(PartKind::Sensor);
        file.exchange_sides(PartKind::Servos);
        let path = folder.path().join("exchanged.toml");
        file.save(&path).unwrap();
        let mut machine = Machine::start(RigConfig::load(path.to_str().unwrap()).unwrap());
        machine.until("all connected", Machine::all_connected);
        let serials = [RigPart::Handle(Side::Right), RigPart::Handle(Side::Left)].map(|part| machine.serial(part));
        assert_eq!(serials, ["4712", "4711"]);
        let serials = [RigPart::Sensor(Side::Right), RigPart::Sensor(Side::Left)].map(|part| machine.serial(part));
        assert_eq!(serials, ["SN000902", "SN000901"]);

        // A device that falls silent reveals which part it serves.
        for (device, part) in
            [("left sensor", RigPart::Sensor(Side::Right)), ("left servos", RigPart::Servos(Side::Right))]
        {
            machine.until("all connected", Machine::all_connected);
            assert!(emulated.set_fault(device, EmulatedFault::Silence));
            machine.until(device, |machine| machine.is(part, |standing| matches!(standing, ConnectionState::Lost(_))));
            let other = part.kind().of(Side::Left).unwrap();
            assert!(machine.is(other, |standing| standing == ConnectionState::Connected), "only the one behind it");
            assert!(emulated.set_fault(device, EmulatedFault::None));
        }
    });
}

#[test]
fn what_every_device_delivers_reaches_the_screen() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = elsewhere(folder.path());
        let emulated = started(&devices);
        let mut machine = Machine::start(rig_file(&devices).rig().unwrap());
        machine.until("all connected", Machine::all_connected);
        let delivers = |machine: &Machine, part: RigPart| {
            let numbers = match part.kind() {
                PartKind::Handle | PartKind::Arm => 7,
                // The sensor under the tissue is a first-generation one without an accelerometer.
                PartKind::Sensor if part == RigPart::TissueSensor => 6,
                PartKind::Sensor | PartKind::Tracker => 9,
                PartKind::Servos => 4,
                PartKind::Pedal => 1,
            };
            machine.gauge(part).is_some_and(|gauge| gauge.channels[..numbers].iter().all(|one| one.count > 0))
        };
        for part in RigPart::ALL {
            machine.until(part.name(), |machine| delivers(machine, part));
        }
        let gravity = |machine: &Machine, side| {
            let up = &machine.gauge(RigPart::Sensor(side)).unwrap().channels[6..9];
            up.iter().map(|one| one.mean * one.mean).sum::<f64>().sqrt()
        };
        for side in Side::ALL {
            assert!((gravity(&machine, side) - 9.81).abs() < 0.3, "{side:?}: {}", gravity(&machine, side));
        }
        emulated.press(1);
        machine
            .until("the pedal", |machine| machine.gauge(RigPart::Pedal).is_some_and(|one| one.channels[0].high > 0.5));
    });
}

#[test]
fn handles_that_nobody_uses_are_found_by_their_serial_numbers() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let devices = elsewhere(folder.path());
        let _emulated = started(&devices);
        let [right, left] = Side::ALL.map(|side| devices.arm(side).unwrap().handle.force_dimension().unwrap().clone());
        let serials = |settings: &force_dimension::ForceDimensionSettings| -> Vec<u16> {
            force_dimension::attached(settings).unwrap().into_iter().map(|(serial, _)| serial).collect()
        };
        serials(&right);
        let found = serials(&left);
        assert!(found.contains(&4711) && found.contains(&4712), "{found:?}");
        let in_use = force_dimension::open(&right).unwrap();
        let found = serials(&left);
        assert!(!found.contains(&4711) && found.contains(&4712), "{found:?}");
        drop(in_use);
    });
}
