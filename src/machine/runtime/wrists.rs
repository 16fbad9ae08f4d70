//! Applies calibrations while the loop runs, once the force sensor of a side has reported its identity.
//!
//! A sensor that reconnects may be a different one. The tick that detects a change therefore suspends the calibrations
//! of that side, and calibrations prepared before the change are refused. The memory that a tick swaps is allocated and
//! freed in other threads.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use nima_devices::ConnectionState;
use rtrb::{Consumer, Producer};

use super::{
    loop_tap::{CalibrationFiler, Operation, Tap},
    thread::report,
};
use crate::{
    hand_over::{FromLoop, ToLoop, from_loop, to_loop},
    rig::{DEVICES_MAX, DeviceEvent, RosterEntry, SIDES, Side},
    teleop::{Calibrations, ForcePath, Loop},
};

/// Capacity of the queue of prepared calibrations.
const WAITING_MAX: usize = 4;

/// Identifies the last connection or disconnection of a side's force sensor. Calibrations are valid until the next
/// change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WristChange {
    side: Side,
    /// Odd while the sensor is connected.
    count: u64,
}

impl WristChange {
    /// Returns whether the change was a connection.
    pub const fn is_there(self) -> bool {
        self.count % 2 == 1
    }

    const fn next(self, is_there: bool) -> u64 {
        self.count + if is_there == self.is_there() { 2 } else { 1 }
    }
}

#[derive(Debug)]
struct PreparedWrist {
    change: WristChange,
    path: Box<ForcePath>,
    number: Option<u64>,
}

type WristsCounts = Arc<[AtomicU64; SIDES]>;

/// The loop's part.
#[derive(Debug)]
pub(super) struct Wrists {
    counts: WristsCounts,
    of_device: [Option<Side>; DEVICES_MAX],
    prepared: Consumer<PreparedWrist>,
    spent: Producer<PreparedWrist>,
}

/// The part of other threads.
#[derive(Debug)]
pub(super) struct WristConnection {
    counts: WristsCounts,
    prepared: ToLoop<PreparedWrist>,
    spent: FromLoop<PreparedWrist>,
    period_s: f64,
    filing: Option<CalibrationFiler>,
}

/// Creates both parts, for a loop of this period (s) on these devices.
pub(super) fn ends(
    roster: &[RosterEntry],
    period_s: f64,
    filing: Option<CalibrationFiler>,
) -> (Wrists, WristConnection) {
    let counts = WristsCounts::default();
    let (prepare, prepared) = to_loop(WAITING_MAX);
    // The other end empties this queue before it sends, so it never holds more than twice as many.
    let (spend, spent) = from_loop(2 * WAITING_MAX);
    let of_device = std::array::from_fn(|device| roster.get(device).and_then(RosterEntry::force_sensor_of));
    let wrists = Wrists { counts: Arc::clone(&counts), of_device, prepared, spent: spend };
    (wrists, WristConnection { counts, prepared: prepare, spent, period_s, filing })
}

impl Wrists {
    pub(super) fn notice(&self, event: &DeviceEvent, control: &mut Loop, tap: &mut Option<Tap>) {
        if let Some(side) = self.of_device.get(usize::from(event.device)).copied().flatten() {
            report(tap, Operation::Suspend(side));
            control.suspend_calibrations(side);
            self.count_on(side, event.standing == ConnectionState::Connected);
        }
    }

    /// Activates the calibrations that were prepared for the connected sensor.
    pub(super) fn activate(&mut self, control: &mut Loop, tap: &mut Option<Tap>) {
        let Ok(mut prepared) = self.prepared.pop() else { return };
        let WristChange { side, count } = prepared.change;
        let now = self.counts[side.index()].load(Ordering::Acquire);
        if let (true, Some(number)) = (now == count, prepared.number) {
            report(tap, Operation::Calibrations { side, number });
        }
        if now == count && !control.exchange_force_path(side, &mut prepared.path) {
            // The drives are on, so the calibrations cannot change now. A new count shows the caller that they are not
            // active and that it must retry.
            self.count_on(side, prepared.change.is_there());
        }
        self.spent.push(prepared).ok();
    }

    /// Only the loop changes the count.
    fn count_on(&self, side: Side, is_there: bool) {
        let counter = &self.counts[side.index()];
        let change = WristChange { side, count: counter.load(Ordering::Relaxed) };
        counter.store(change.next(is_there), Ordering::Release);
    }
}

impl WristConnection {
    pub(super) fn change(&self, side: Side) -> WristChange {
        WristChange { side, count: self.counts[side.index()].load(Ordering::Acquire) }
    }

    pub(super) fn activate(&self, change: WristChange, calibrations: &Calibrations) -> bool {
        self.spent.try_iter().for_each(drop);
        let path = Box::new(ForcePath::new(calibrations, self.period_s));
        let number = self.filing.as_ref().map(|filing| filing.file(calibrations));
        self.prepared.try_send(PreparedWrist { change, path, number }).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};
    use nima_core::{
        calibration::gravity::{GravityModel, GravityParameters, GravitySource},
        frames::{GRAVITY_M_S2, Wrench, WristSample},
    };
    use nima_devices::{Loss, SlotView};

    use super::*;
    use crate::{
        config::RigConfig,
        messages::{Command, ForceSource, LoopState},
        rig::{AwaitedDevice, EngageBlocker, Inputs, RigPart, SensedForce},
        teleop::Timing,
    };

    struct Fixture {
        control: Loop,
        wrists: Wrists,
        door: WristConnection,
        t_s: f64,
        load_n: f64,
    }

    impl Fixture {
        fn new() -> Self {
            let rig = RigConfig::load("simulated").unwrap();
            let entry = RosterEntry::of(RigPart::Sensor(Side::Right), "", SlotView::default());
            let (wrists, door) = ends(&[entry], 1e-3, None);
            let mut control = Loop::new(&rig, &[Some(calibrated()), None]).unwrap();
            control.suspend_calibrations(Side::Right);
            Self { control, wrists, door, t_s: 0.0, load_n: 0.0 }
        }

        fn tick(&mut self) -> ForceSource {
            self.t_s += 1e-3;
            self.wrists.activate(&mut self.control, &mut None);
            let (_, [tick, _]) = self
                .control
                .step([Some(at_wrist(self.load_n, self.t_s)), None], &Timing { now_s: self.t_s, ..Timing::default() });
            tick.unwrap().force.source
        }

        fn sensor_is(&mut self, standing: ConnectionState) {
            let event = DeviceEvent { t_s: self.t_s, device: 0, standing, of_side: [true, false] };
            self.wrists.notice(&event, &mut self.control, &mut None);
        }
    }

    /// Returns inputs of a resting arm that measures this force (N) in addition to the weight at the wrist; no reading
    /// repeats.
    fn at_wrist(load_n: f64, t_s: f64) -> Inputs {
        let force_n = Vector3::new(load_n, 0.0, -0.4 * GRAVITY_M_S2 + 1e-3 * t_s);
        let sample = WristSample {
            acceleration_m_s2: Some(Vector3::new(1e-3 * t_s, 0.0, GRAVITY_M_S2)),
            world_from_s1: Some(UnitQuaternion::identity()),
            ..WristSample::of(Wrench { force_n, torque_nm: Vector3::zeros() })
        };
        Inputs { sensed: SensedForce::AtWrist(sample), powered: true, ..Inputs::NOTHING }
    }

    fn calibrated() -> Calibrations {
        let s1_from_source_wxyz = [1.0, 0.0, 0.0, 0.0];
        let parameters =
            GravityParameters::Physical { mass_kg: 0.4, s1_from_source_wxyz, bias_n: [0.0; 3], torque: None };
        Calibrations {
            gravity: Some(GravityModel { source: GravitySource::Imu, imu_sign: 1, parameters }),
            ..Calibrations::default()
        }
    }

    #[test]
    fn a_sensor_that_comes_or_goes_takes_its_calibrations_with_it() {
        let mut bench = Fixture::new();
        assert_eq!(bench.tick(), ForceSource::Unidentified, "the connected sensor is unknown");
        assert!(!bench.door.change(Side::Right).is_there());
        bench.sensor_is(ConnectionState::Connected);
        let met = bench.door.change(Side::Right);
        assert!(met.is_there());
        assert!(bench.door.activate(met, &calibrated()));
        assert_eq!(bench.tick(), ForceSource::Wrist);
        for standing in [ConnectionState::Lost(Loss::Disconnected), ConnectionState::Connected] {
            bench.sensor_is(standing);
            assert_eq!(bench.tick(), ForceSource::Unidentified, "it may be another sensor now");
            assert_eq!(bench.door.change(Side::Right).is_there(), standing == ConnectionState::Connected);
        }
        // Prepared for the previous sensor, so it is rejected.
        assert!(bench.door.activate(met, &calibrated()));
        assert_eq!(bench.tick(), ForceSource::Unidentified);
        assert!(bench.door.activate(bench.door.change(Side::Right), &calibrated()));
        assert_eq!(bench.tick(), ForceSource::Wrist);
    }

    #[test]
    fn an_engagement_right_after_the_calibrations_sees_no_jump_of_the_force() {
        for after in 1..5 {
            let mut bench = Fixture::new();
            bench.load_n = 2.0;
            bench.sensor_is(ConnectionState::Connected);
            for _ in 0..100 {
                assert_eq!(bench.tick(), ForceSource::Unidentified);
            }
            assert!(bench.door.activate(bench.door.change(Side::Right), &calibrated()));
            for _ in 0..after {
                assert_eq!(bench.tick(), ForceSource::Wrist, "the trocar holds the instrument with 2 N");
            }
            bench.control.obey(Command::Engage, bench.t_s);
            for _ in 0..100 {
                bench.tick();
            }
            assert_eq!(bench.control.pair(Side::Right).unwrap().state(), LoopState::Engaged, "after {after} ticks");
        }
    }

    #[test]
    fn an_arm_that_was_waited_for_is_engaged_a_tick_after_it_was_heard_of() {
        let mut bench = Fixture::new();
        bench.sensor_is(ConnectionState::Connected);
        bench.tick();
        assert!(bench.door.activate(bench.door.change(Side::Right), &calibrated()));
        for _ in 0..3 {
            bench.tick();
        }
        let received = at_wrist(0.0, bench.t_s);
        let waiting = Inputs { obstacle: Some(EngageBlocker::Waiting(AwaitedDevice::Servos)), ..received };
        bench.control.step([Some(waiting), None], &Timing { now_s: bench.t_s, ..Timing::default() });
        assert!(!bench.control.is_idle_with(&[Some(received), None]), "it would be refused by what it knew a tick ago");
        bench.tick();
        assert!(bench.control.is_idle_with(&[Some(received), None]));
    }

    #[test]
    fn an_arm_is_not_engaged_by_itself_before_its_force_was_made_by_the_new_calibrations() {
        let mut bench = Fixture::new();
        bench.sensor_is(ConnectionState::Connected);
        bench.tick();
        assert!(bench.door.activate(bench.door.change(Side::Right), &calibrated()));
        bench.wrists.activate(&mut bench.control, &mut None);
        let inputs = [Some(at_wrist(0.0, bench.t_s)), None];
        assert!(!bench.control.is_idle_with(&inputs), "it would be refused now, and the other arm would not");
        bench.tick();
        assert!(bench.control.is_idle_with(&inputs));
        bench.control.obey(Command::Engage, bench.t_s);
        bench.tick();
        assert_eq!(bench.control.pair(Side::Right).unwrap().state(), LoopState::Engaged);
    }

    #[test]
    fn a_loop_that_takes_nothing_is_never_waited_for() {
        let bench = Fixture::new();
        let met = bench.door.change(Side::Right);
        let taken = (0..100).filter(|_| bench.door.activate(met, &calibrated())).count();
        assert_eq!(taken, WAITING_MAX);
    }
}
