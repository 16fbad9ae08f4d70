//! An unknown force is reported as unknown, never as zero, and affects no statistics.
use nalgebra::{UnitQuaternion, Vector3};
use nima_core::frames::{Wrench, WristSample};
use nima_machine::{
    config::RigConfig,
    messages::{Command, ForceSource, LoopState, Tick},
    rig::{Inputs, SensedForce, Side},
    teleop::{Calibrations, Loop, Timing},
};

const DELAY_MS: u32 = 50;

struct Fixture {
    control: Loop,
    now_ms: u32,
}

impl Fixture {
    fn new() -> Self {
        let rig = RigConfig { delay_s: f64::from(DELAY_MS) * 1e-3, ..RigConfig::load("simulated").unwrap() };
        Self { control: Loop::new(&rig, &[Some(Calibrations::default()), None]).unwrap(), now_ms: 0 }
    }

    /// Runs this many ticks with the result of `sensed` at each time (s); returns the last tick.
    fn run(&mut self, ticks: u32, sensed: impl Fn(f64) -> Option<SensedForce>) -> Tick {
        let mut last = None;
        for _ in 0..ticks {
            self.now_ms += 1;
            let now_s = f64::from(self.now_ms) * 1e-3;
            let inputs = sensed(now_s).map(|sensed| Inputs { sensed, powered: true, ..Inputs::NOTHING });
            [last, _] = self.control.step([inputs, None], &Timing { now_s, ..Timing::default() }).1;
            let tick = last.unwrap();
            assert!(tick.rendering.rendered_n.iter().all(|x| x.is_finite()), "what the hand gets is known: {tick:?}");
            assert_eq!(tick.known_n().is_some(), tick.force.source.is_known());
        }
        last.unwrap()
    }

    fn judged(&self) -> u64 {
        let pair = self.control.pair(Side::Right).unwrap();
        pair.accuracy().of(RigConfig::load("simulated").unwrap().mode).count
    }
}

/// Returns a force that no reading repeats.
fn force_n(now_s: f64) -> Vector3<f64> {
    Vector3::new(0.3, 0.0, 1.0 + 1e-3 * now_s)
}

#[expect(clippy::unnecessary_wraps, reason = "as the bench asks for it: a sensor may deliver nothing")]
fn at_tip(now_s: f64) -> Option<SensedForce> {
    Some(SensedForce::AtTip(force_n(now_s)))
}

#[expect(clippy::unnecessary_wraps, reason = "as the bench asks for it: a sensor may deliver nothing")]
fn at_wrist(now_s: f64) -> Option<SensedForce> {
    let world_from_s1 = Some(UnitQuaternion::identity());
    let wrench = Wrench { force_n: force_n(now_s), torque_nm: Vector3::zeros() };
    Some(SensedForce::AtWrist(WristSample { world_from_s1, ..WristSample::of(wrench) }))
}

fn is_unknown(force_n: Vector3<f64>) -> bool {
    force_n.iter().all(|x| x.is_nan())
}

#[test]
fn before_the_first_sample_and_after_a_silence_no_force_is_known() {
    let mut bench = Fixture::new();
    let tick = bench.run(1, |_| None);
    assert_eq!(tick.force.source, ForceSource::NoSample);
    assert!(is_unknown(tick.measured_n) && is_unknown(tick.rendering.delayed_n));
    let tick = bench.run(10, at_tip);
    assert!(
        tick.measured_n == force_n(tick.t_s) && is_unknown(tick.rendering.delayed_n),
        "the link is still filling: {tick:?}"
    );
    let tick = bench.run(DELAY_MS, at_tip);
    assert!((tick.rendering.delayed_n - force_n(tick.t_s - 0.05)).norm() < 1e-9, "{}", tick.rendering.delayed_n);

    let judged = bench.judged();
    let tick = bench.run(10, |_| None);
    assert!(tick.known_n().is_some(), "a few lost samples do not count as silence");
    let tick = bench.run(15, |_| None);
    assert_eq!((tick.force.source, tick.state), (ForceSource::NoSample, LoopState::Disconnected));
    assert!(is_unknown(tick.measured_n) && !is_unknown(tick.rendering.delayed_n), "what is under way still arrives");
    let tick = bench.run(DELAY_MS, |_| None);
    assert!(is_unknown(tick.measured_n) && is_unknown(tick.rendering.delayed_n));
    assert_eq!(bench.judged(), judged, "nothing errs from a force that is not known");

    let tick = bench.run(10, at_tip);
    assert!(
        tick.measured_n == force_n(tick.t_s) && is_unknown(tick.rendering.delayed_n),
        "not the value from before the silence"
    );
    let tick = bench.run(DELAY_MS, at_tip);
    assert!((tick.rendering.delayed_n - force_n(tick.t_s - 0.05)).norm() < 1e-9, "{}", tick.rendering.delayed_n);
}

#[test]
fn the_readings_of_a_silent_wrist_sensor_are_not_repeated() {
    let mut bench = Fixture::new();
    assert!(bench.run(50, at_wrist).calibration.wrist.is_some());
    assert!(bench.run(25, |_| None).calibration.wrist.is_none());
}

#[test]
fn without_a_calibration_nothing_is_known_learnt_or_judged() {
    let mut bench = Fixture::new();
    let tick = bench.run(1000, at_wrist);
    assert_eq!((tick.force.source, tick.state), (ForceSource::Uncalibrated, LoopState::Idle));
    assert!(is_unknown(tick.measured_n) && is_unknown(tick.rendering.delayed_n) && is_unknown(tick.force.tip_n));
    assert!(tick.calibration.wrist.is_some(), "the sensor itself is read");
    assert_eq!((tick.identification.learnt, bench.judged()), (0, 0));
}

#[test]
fn an_arm_is_engaged_once_its_force_is_known_and_feels_what_the_link_brings() {
    let mut bench = Fixture::new();
    bench.run(500, at_wrist);
    bench.run(3, at_tip);
    bench.control.obey(Command::Engage, f64::from(bench.now_ms) * 1e-3);
    let tick = bench.run(2, at_tip);
    assert_eq!(tick.state, LoopState::Engaged);
    let tick = bench.run(2 * DELAY_MS, at_tip);
    assert_eq!(tick.state, LoopState::Engaged, "{tick:?}");
    assert!(tick.rendering.asked_n[tick.mode.index()].norm() > 0.9, "{:?}", tick.rendering.asked_n);
}
