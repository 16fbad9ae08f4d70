//! Calibrations that come into force while the loop runs: once the force sensor of a side has told who it is.
//!
//! A sensor that comes or goes may be another one afterwards. So every change puts the calibrations of its side out of force, in the
//! tick that notices it; and what was prepared before the change is refused. What a tick uses is allocated and freed outside.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use crossbeam_channel::{Receiver, Sender, bounded};
use nima_devices::Standing;

use crate::{
    rig::{DEVICES_MAX, DeviceEvent, RosterEntry, SIDES, Side},
    teleop::{Calibrations, ForcePath, Loop},
};

/// Preparations that wait for the loop.
const WAITING_MAX: usize = 4;

/// The last time that the force sensor of a side came or went: calibrations count until the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WristChange {
    side: Side,
    /// Odd while the sensor is there.
    count: u64,
}

impl WristChange {
    /// The sensor came.
    pub const fn is_there(self) -> bool {
        self.count % 2 == 1
    }

    const fn next(self, is_there: bool) -> u64 {
        self.count + if is_there == self.is_there() { 2 } else { 1 }
    }
}

#[derive(Debug)]
struct Prepared {
    change: WristChange,
    path: Box<ForcePath>,
}

type Counts = Arc<[AtomicU64; SIDES]>;

/// The loop's end.
#[derive(Debug)]
pub(super) struct Wrists {
    counts: Counts,
    of_device: [Option<Side>; DEVICES_MAX],
    prepared: Receiver<Prepared>,
    spent: Sender<Prepared>,
}

/// The other end.
#[derive(Debug)]
pub(super) struct WristDoor {
    counts: Counts,
    prepared: Sender<Prepared>,
    spent: Receiver<Prepared>,
    period_s: f64,
}

/// Both ends, for a loop of this period (s) on these devices.
pub(super) fn ends(roster: &[RosterEntry], period_s: f64) -> (Wrists, WristDoor) {
    let counts = Counts::default();
    let (prepare, prepared) = bounded(WAITING_MAX);
    // The door empties it before it sends, so that twice as many can never wait.
    let (spend, spent) = bounded(2 * WAITING_MAX);
    let of_device = std::array::from_fn(|device| roster.get(device).and_then(|entry| entry.force_sensor_of));
    let wrists = Wrists { counts: Arc::clone(&counts), of_device, prepared, spent: spend };
    (wrists, WristDoor { counts, prepared: prepare, spent, period_s })
}

impl Wrists {
    /// Takes in that a device came or went.
    pub(super) fn notice(&self, event: &DeviceEvent, control: &mut Loop) {
        if let Some(side) = self.of_device.get(usize::from(event.device)).copied().flatten() {
            control.suspend_calibrations(side);
            self.count_on(side, event.standing == Standing::Connected);
        }
    }

    /// Puts in force what was prepared for the sensor that is there.
    pub(super) fn put_in_force(&self, control: &mut Loop) {
        let Ok(mut prepared) = self.prepared.try_recv() else { return };
        let WristChange { side, count } = prepared.change;
        let now = self.counts[side.index()].load(Ordering::Acquire);
        if now == count && !control.exchange_force_path(side, &mut prepared.path) {
            // Drives are on: whoever prepared it shall see that it is not in force, and come again.
            self.count_on(side, prepared.change.is_there());
        }
        self.spent.try_send(prepared).ok();
    }

    /// Only the loop counts.
    fn count_on(&self, side: Side, is_there: bool) {
        let counter = &self.counts[side.index()];
        let change = WristChange { side, count: counter.load(Ordering::Relaxed) };
        counter.store(change.next(is_there), Ordering::Release);
    }
}

impl WristDoor {
    pub(super) fn change(&self, side: Side) -> WristChange {
        WristChange { side, count: self.counts[side.index()].load(Ordering::Acquire) }
    }

    pub(super) fn put_in_force(&self, change: WristChange, calibrations: &Calibrations) -> bool {
        self.spent.try_iter().for_each(drop);
        let path = Box::new(ForcePath::new(calibrations, self.period_s));
        self.prepared.try_send(Prepared { change, path }).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};
    use nima_core::{
        calibration::gravity::{GravityModel, Parameters, Source},
        frames::{GRAVITY_M_S2, Wrench, WristSample},
        kinematics::Hand,
    };
    use nima_devices::{Device, Health, Identity, Loss, Slot, Stamped};

    use super::*;
    use crate::{
        config::RigConfig,
        messages::ForceSource,
        rig::{Inputs, Sensed, Switches, View},
        teleop::Timing,
    };

    struct Silent(Health, Identity);

    impl Device for Silent {
        type Reading = ();

        fn poll(&mut self, _: f64) -> Option<Stamped<()>> {
            None
        }

        fn about(&self) -> (&Health, &Identity) {
            (&self.0, &self.1)
        }
    }

    struct Bench {
        control: Loop,
        wrists: Wrists,
        door: WristDoor,
        t_s: f64,
    }

    impl Bench {
        fn new() -> Self {
            let rig = RigConfig::load("simulated").unwrap();
            let slot = Slot::start("test", || Ok(Silent(Health::default(), Identity::default()))).unwrap();
            let entry =
                RosterEntry { force_sensor_of: Some(Side::Right), ..RosterEntry::new("right sensor", "", slot.view()) };
            let (wrists, door) = ends(&[entry], 1e-3);
            let mut control = Loop::new(&rig, &[Some(calibrated()), None]).unwrap();
            control.suspend_calibrations(Side::Right);
            Self { control, wrists, door, t_s: 0.0 }
        }

        fn tick(&mut self) -> ForceSource {
            self.t_s += 1e-3;
            self.wrists.put_in_force(&mut self.control);
            let (_, [tick, _]) =
                self.control.step([Some(at_wrist()), None], &Timing { now_s: self.t_s, ..Timing::default() });
            tick.unwrap().force.source
        }

        fn sensor_is(&mut self, standing: Standing) {
            let event = DeviceEvent { t_s: self.t_s, device: 0, standing, of_side: [true, false] };
            self.wrists.notice(&event, &mut self.control);
        }
    }

    /// A tool at rest, hanging from an arm that measures at the wrist.
    fn at_wrist() -> Inputs {
        let sample = WristSample {
            raw: Wrench { force_n: Vector3::new(0.0, 0.0, -0.4 * GRAVITY_M_S2), torque_nm: Vector3::zeros() },
            acceleration_m_s2: Some(Vector3::new(0.0, 0.0, GRAVITY_M_S2)),
            world_from_s1: Some(UnitQuaternion::identity()),
            world_from_m: None,
            m_from_c: None,
            insertion_m: None,
            tissue_n: None,
        };
        Inputs {
            hand: Hand::at(Vector3::zeros()),
            gripper_rad: None,
            grip_n: None,
            tip_m: Vector3::zeros(),
            world_from_jaws: None,
            sensed: Sensed::AtWrist(sample),
            view: View::Fixed,
            switches: Switches::default(),
            powered: true,
            obstacle: None,
            age_s: 0.0,
        }
    }

    fn calibrated() -> Calibrations {
        let s1_from_source_wxyz = [1.0, 0.0, 0.0, 0.0];
        let parameters = Parameters::Physical { mass_kg: 0.4, s1_from_source_wxyz, bias_n: [0.0; 3], torque: None };
        Calibrations { gravity: Some(GravityModel { source: Source::Imu, imu_sign: 1, parameters }), tip_force: None }
    }

    #[test]
    fn a_sensor_that_comes_or_goes_takes_its_calibrations_with_it() {
        let mut bench = Bench::new();
        assert_eq!(bench.tick(), ForceSource::Uncalibrated, "nobody knows which sensor is there");
        assert!(!bench.door.change(Side::Right).is_there());
        bench.sensor_is(Standing::Connected);
        let met = bench.door.change(Side::Right);
        assert!(met.is_there());
        assert!(bench.door.put_in_force(met, &calibrated()));
        assert_eq!(bench.tick(), ForceSource::Wrist);
        for standing in [Standing::Lost(Loss::Disconnected), Standing::Connected] {
            bench.sensor_is(standing);
            assert_eq!(bench.tick(), ForceSource::Uncalibrated, "it may be another sensor now");
            assert_eq!(bench.door.change(Side::Right).is_there(), standing == Standing::Connected);
        }
        // What was prepared for the sensor before comes too late.
        assert!(bench.door.put_in_force(met, &calibrated()));
        assert_eq!(bench.tick(), ForceSource::Uncalibrated);
        assert!(bench.door.put_in_force(bench.door.change(Side::Right), &calibrated()));
        assert_eq!(bench.tick(), ForceSource::Wrist);
    }

    #[test]
    fn a_loop_that_takes_nothing_is_never_waited_for() {
        let bench = Bench::new();
        let met = bench.door.change(Side::Right);
        let taken = (0..100).filter(|_| bench.door.put_in_force(met, &calibrated())).count();
        assert_eq!(taken, WAITING_MAX);
    }
}
