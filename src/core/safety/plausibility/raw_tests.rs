//! Raw readings of a rig with an arm: the loop receives a force that rotates with the arm, but the sensor's own numbers
//! are checked.

use nalgebra::{UnitQuaternion, Vector3};

use super::*;
use crate::noise::Noise;

const TICK_S: f64 = 1e-3;
/// Time for which a rig was engaged before the fault, s.
const BEFORE_S: f64 = 14.0;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    Frozen,
    OneFrozen,
    /// All values are beyond the end of the range.
    Saturated,
    /// About half of the values are beyond the end of the range.
    Hovers,
    Block(usize),
    Jump,
}

#[derive(Clone, Copy, Debug)]
struct Rig {
    /// Intervals between two readings of sensor, handle and arm, s.
    sensor_s: f64,
    handle_s: f64,
    arm_s: f64,
    noise_n: f64,
    at_wrist: bool,
    /// Fraction of the ticks that are late, by up to 4 ms.
    late: f64,
    seed: u64,
}

const RIG: Rig =
    Rig { sensor_s: TICK_S, handle_s: TICK_S, arm_s: TICK_S, noise_n: 0.02, at_wrist: false, late: 0.0, seed: 1 };

/// The newest reading of a device that measures on its own clock.
struct Sampled<const N: usize> {
    every_s: f64,
    next_s: f64,
    newest: RawReading<N>,
    past: Vec<[f64; N]>,
}

impl<const N: usize> Sampled<N> {
    fn new(every_s: f64) -> Self {
        let newest = RawReading { channels: [f64::NAN; N], device_s: None, arrival_s: f64::NAN };
        Self { every_s, next_s: 0.3e-3, newest, past: Vec::new() }
    }

    fn at(&mut self, now_s: f64, fault: Fault, mut measure: impl FnMut(f64) -> [f64; N]) -> RawReading<N> {
        while self.next_s <= now_s {
            let mut channels = measure(self.next_s);
            match fault {
                Fault::Frozen => channels = self.newest.channels,
                Fault::OneFrozen => channels[0] = self.newest.channels[0],
                Fault::Saturated => {
                    let at = self.past.last().unwrap()[0] + 0.5;
                    channels[0] = (channels[0] + 1.0).min(at);
                    self.past.push(*self.past.last().unwrap());
                }
                Fault::Hovers => {
                    let beyond = (channels[0] * 1e4).fract().abs();
                    channels[0] = self.past.last().unwrap()[0] + 0.2 - 0.02 * beyond;
                    if beyond < 0.5 {
                        channels[0] = self.past.last().unwrap()[0] + 0.2;
                    }
                    self.past.push(*self.past.last().unwrap());
                }
                Fault::Block(length) => {
                    channels = self.past[self.past.len() - length];
                    self.past.push(channels);
                }
                Fault::Jump => channels[2] += 1.5,
                Fault::None => self.past.push(channels),
            }
            self.newest = RawReading { channels, device_s: Some(5.0 + self.next_s), arrival_s: now_s };
            self.next_s += self.every_s;
        }
        self.newest
    }
}

/// Returns the position of the hand, which circles with a tremor; the tip follows and presses on tissue of 400 N/m, and
/// the wrist rotates with it.
fn hand_m(t_s: f64) -> Vector3<f64> {
    let tremor = Vector3::new((53.4 * t_s).sin(), (56.5 * t_s).sin(), (59.7 * t_s).sin()) * 5e-5;
    Vector3::new(0.01 * (1.9 * t_s).cos(), 0.01 * (1.9 * t_s).sin(), -0.006 + 0.003 * (1.1 * t_s).sin()) + tremor
}

fn world_from_s1(t_s: f64) -> UnitQuaternion<f64> {
    let tip_m = hand_m(t_s);
    UnitQuaternion::from_euler_angles(2.0 + 4.0 * tip_m.x, 4.0 * tip_m.y, 0.3)
}

fn joints_rad(t_s: f64) -> [f64; ARM_CHANNELS] {
    let tip_m = hand_m(t_s);
    std::array::from_fn(|joint| 0.4 + tip_m[joint % 3] * (3.0 + joint as f64))
}

fn load(rig: &Rig, noise: &mut Noise, t_s: f64) -> [f64; CHANNELS] {
    let s1_from_world = world_from_s1(t_s).inverse();
    let pressed_n = Vector3::new(0.0, 0.0, 400.0 * (-hand_m(t_s).z).max(0.0));
    let weight_n = if rig.at_wrist { Vector3::new(0.0, 0.0, -4.0) } else { Vector3::zeros() };
    let force_n = s1_from_world * (pressed_n + weight_n);
    let torque_nm = Vector3::new(0.0, 0.0, 0.4).cross(&(s1_from_world * pressed_n));
    let up = s1_from_world * Vector3::new(0.0, 0.0, 9.81);
    let mut channels = [0.0; CHANNELS];
    for axis in 0..3 {
        channels[axis] = force_n[axis] + rig.noise_n * noise.gaussian();
        channels[3 + axis] = torque_nm[axis] + 0.05 * rig.noise_n * noise.gaussian();
        channels[6 + axis] = up[axis] + rig.noise_n * noise.gaussian();
    }
    channels
}

/// Returns the first doubt after the faults of sensor, handle and arm begin, and the time since then, ms; an earlier
/// doubt is a false alarm.
fn report(rig: &Rig, faults: [Fault; 3], seconds: f64) -> Option<(f64, Implausible)> {
    let mut looks = Plausibility::default();
    let mut noise = Noise::new(rig.seed);
    let mut sensor = Sampled::<CHANNELS>::new(rig.sensor_s);
    let mut handle = Sampled::<HANDLE_CHANNELS>::new(rig.handle_s);
    let mut arm = Sampled::<ARM_CHANNELS>::new(rig.arm_s);
    let mut t_s = 0.0;
    while t_s < BEFORE_S + seconds {
        t_s += TICK_S + if noise.uniform() < rig.late { 4e-3 * noise.uniform() } else { 0.0 };
        let now = if t_s > BEFORE_S { faults } else { [Fault::None; 3] };
        let sensed = sensor.at(t_s, now[0], |at_s| load(rig, &mut noise, at_s));
        // Whole counts of 10 um.
        let held = handle.at(t_s, now[1], |at_s| hand_m(at_s).map(|x| (x * 1e5).round() * 1e-5).into());
        let angles = arm.at(t_s, now[2], joints_rad);
        let turn = world_from_s1(t_s);
        let felt_n = turn * Vector3::from_row_slice(&sensed.channels[..3]);
        let tip_m = hand_m(arm.next_s - rig.arm_s);
        looks.step(&PlausibilityInput {
            t_s,
            raw: RawReadings { handle: Some(held), arm: Some(angles), sensor: Some(sensed) },
            force_n: if rig.at_wrist { felt_n + Vector3::new(0.0, 0.0, 4.0) } else { felt_n },
            min_n: 0.1,
            world_from_s1: rig.at_wrist.then_some(turn),
            tip_m,
            hand_m: held.channels.into(),
            command_m: Some(tip_m),
            hand_force_n: Vector3::zeros(),
            guided: false,
            tip_silent_s: 0.0,
            hand_silent_s: 0.0,
        });
        if let Some(what) = looks.doubt() {
            return Some(((t_s - BEFORE_S) * 1e3, what));
        }
    }
    None
}

fn of_sensor(rig: &Rig, fault: Fault) -> Option<(f64, Implausible)> {
    report(rig, [fault, Fault::None, Fault::None], 0.5)
}

#[test]
fn a_sensor_on_an_arm_is_judged_by_its_own_numbers() {
    let faults = [
        (Fault::Frozen, Implausible::ForceFrozen, 12.5),
        (Fault::OneFrozen, Implausible::ForceFrozen, 12.5),
        (Fault::Saturated, Implausible::ForceFrozen, 12.5),
        (Fault::Hovers, Implausible::ForceSaturated, 30.0),
        (Fault::Block(1), Implausible::ForceFrozen, 12.5),
        (Fault::Block(2), Implausible::ForceRepeats, 12.5),
        (Fault::Block(150), Implausible::ForceRepeats, 12.5),
        (Fault::Jump, Implausible::ForceJumped, 5.0),
    ];
    for at_wrist in [false, true] {
        for late in [0.0, 0.05] {
            for (fault, wanted, within_ms) in faults {
                for seed in 1..4 {
                    let rig = Rig { at_wrist, late, seed, ..RIG };
                    let report = of_sensor(&rig, fault);
                    let late_ms = if late > 0.0 { 5.0 } else { 0.0 };
                    // With two alternating values and a loop that misses some, every second value is at an extreme.
                    let is_wanted = |what| {
                        what == wanted
                            || (fault == Fault::Block(2) && late > 0.0 && what == Implausible::ForceSaturated)
                    };
                    let good =
                        report.is_some_and(|(ms, what)| is_wanted(what) && ms > 0.0 && ms <= within_ms + late_ms);
                    assert!(good, "{rig:?}, {fault:?}: {report:?}");
                }
            }
        }
    }
}

#[test]
fn a_sensor_without_noise_that_stops_from_speed_is_frozen_while_the_arm_goes_on() {
    for at_wrist in [false, true] {
        let report = of_sensor(&Rig { noise_n: 0.0, at_wrist, ..RIG }, Fault::Frozen);
        assert!(matches!(report, Some((ms, Implausible::ForceFrozen)) if (9.0..13.0).contains(&ms)), "{report:?}");
    }
}

/// The sensor of the examples, with one noise-free axis, frozen at every phase of its swing, including the turning
/// points.
#[test]
fn a_smooth_swing_that_freezes_is_told_at_every_phase() {
    for phase in 0..200 {
        let mut device = DeviceMemory::<CHANNELS>::new(SENSOR_BLOCK);
        let from = 6000 + phase * 10;
        let report = (1..from + 200).find(|k| {
            let t_s = f64::from((*k).min(from)) * TICK_S;
            let mut channels = [0.0; CHANNELS];
            channels[2] = 1.0 + 0.5 * (3.0 * t_s).sin();
            let raw = RawReading { channels, device_s: None, arrival_s: f64::from(*k) * TICK_S };
            let travel_m = 19e-6 * f64::from(*k);
            if let Some(step) = device.is_new(&raw) {
                device.look_at_all(&raw, &step, |place| Around {
                    travel_m,
                    is_load: place < LOADS,
                    shortest_s: FROZEN_S,
                });
            }
            device.wrong().is_some()
        });
        assert!(report.is_some_and(|k| (from + 9..from + 13).contains(&k)), "{report:?} of {from}");
    }
}

#[test]
fn healthy_devices_raise_no_alarm_at_any_rate_and_on_any_clock() {
    for noise_n in [0.02, 0.0] {
        for at_wrist in [false, true] {
            for (sensor_s, handle_s, arm_s) in
                [(1e-3, 1e-3, 1e-3), (1e-2, 1e-3, 1e-3), (1e-3, 1e-2, 5e-3), (3e-3, 7e-3, 2e-3), (5e-4, 5e-4, 1e-3)]
            {
                for late in [0.0, 0.05] {
                    let rig = Rig { sensor_s, handle_s, arm_s, noise_n, at_wrist, late, seed: 7 };
                    assert_eq!(report(&rig, [Fault::None; 3], 10.0), None, "{rig:?}");
                }
            }
        }
    }
}

#[test]
fn a_sensor_of_a_tenth_of_the_loops_rate_is_told_after_three_repetitions() {
    let rig = Rig { sensor_s: 0.01, ..RIG };
    let frozen = of_sensor(&rig, Fault::Frozen);
    assert!(matches!(frozen, Some((ms, Implausible::ForceFrozen)) if (20.0..32.0).contains(&ms)), "{frozen:?}");
    let jumped = of_sensor(&rig, Fault::Jump);
    assert!(matches!(jumped, Some((ms, Implausible::ForceJumped)) if ms < 31.0), "{jumped:?}");
}

#[test]
fn a_handle_and_an_arm_that_repeat_a_block_or_jump_are_told() {
    let of = |place: usize, fault: Fault| {
        let mut faults = [Fault::None; 3];
        faults[place] = fault;
        report(&RIG, faults, 0.5)
    };
    let handle = of(1, Fault::Block(120));
    assert!(matches!(handle, Some((_, Implausible::HandleRepeats | Implausible::HandleJumped))), "{handle:?}");
    let arm = of(2, Fault::Block(60));
    assert!(matches!(arm, Some((ms, Implausible::ArmRepeats)) if ms < 40.0), "{arm:?}");
    let arm = of(2, Fault::Jump);
    assert!(matches!(arm, Some((ms, Implausible::TipJumped)) if ms < 5.0), "{arm:?}");
}

#[test]
fn a_handle_on_the_table_and_an_arm_at_rest_are_no_fault() {
    // After ten seconds of motion the handle rests on whole counts, one of which flickers, and the arm keeps its
    // angles.
    let mut looks = Plausibility::default();
    let mut noise = Noise::new(3);
    for k in 1..40_000 {
        let t_s = f64::from(k) * TICK_S;
        let lies = k > 20_000;
        let mut held = if lies { hand_m(20.0) } else { hand_m(t_s) }.map(|x| (x * 1e5).round() * 1e-5);
        held.x += if lies && noise.uniform() < 0.5 { 1e-5 } else { 0.0 };
        let mut angles = joints_rad(t_s.min(20.0)).map(|rad| (rad * 1e5).round() * 1e-5);
        angles[3] += if lies && noise.uniform() < 0.3 { 1e-5 } else { 0.0 };
        let handle = RawReading { channels: held.into(), device_s: None, arrival_s: t_s };
        let arm = RawReading { channels: angles, device_s: None, arrival_s: t_s };
        let sensor = RawReading { channels: load(&RIG, &mut noise, t_s.min(20.0)), device_s: None, arrival_s: t_s };
        let tip_m = hand_m(t_s.min(20.0));
        looks.step(&PlausibilityInput {
            t_s,
            raw: RawReadings { handle: Some(handle), arm: Some(arm), sensor: Some(sensor) },
            force_n: Vector3::from_row_slice(&sensor.channels[..3]),
            min_n: 0.1,
            world_from_s1: None,
            tip_m,
            hand_m: held,
            command_m: None,
            hand_force_n: Vector3::zeros(),
            guided: false,
            tip_silent_s: 0.0,
            hand_silent_s: 0.0,
        });
        assert_eq!(looks.doubt(), None, "at {t_s} s");
    }
}

/// A sensor with few values often repeats itself, also at its extremes.
#[test]
fn coarse_numbers_are_no_fault() {
    for counts in [0.3, 1.0, 3.0, 10.0, 50.0] {
        let mut device = DeviceMemory::<CHANNELS>::new(SENSOR_BLOCK);
        let mut noise = Noise::new(11);
        for k in 1..100_000 {
            let channels = std::array::from_fn(|_| (counts * noise.gaussian()).round());
            let raw = RawReading { channels, device_s: None, arrival_s: f64::from(k) * TICK_S };
            if let Some(step) = device.is_new(&raw) {
                device.look_at_all(&raw, &step, |_| Around { travel_m: 1.0, is_load: true, shortest_s: FROZEN_S });
            }
            assert_eq!(device.wrong(), None, "noise of {counts} counts, reading {k}");
        }
    }
}

/// A sensor that is late by 18 ms leaves the same force in the link for as long, 50 ms later.
#[test]
fn a_late_sensor_is_not_a_link_that_repeats_itself_and_a_link_that_does_is_told() {
    let report = |link_stops: bool| {
        let mut looks = Plausibility::default();
        let mut noise = Noise::new(2);
        let mut felt = Vec::new();
        let mut sensor = RawReading::of_sensor([Some([0.0; 3]), None, None], None, 0.0);
        (1..8000).find(|k| {
            let t_s = f64::from(*k) * TICK_S;
            let is_late = k % 500 > 480 && k % 500 < 499;
            if !is_late {
                let force_n = std::array::from_fn(|_| 1.0 + 0.02 * noise.gaussian());
                sensor = RawReading::of_sensor([Some(force_n), None, None], None, t_s);
            }
            let force_n = Vector3::from_row_slice(&sensor.channels[..3]);
            felt.push(if link_stops && *k > 7000 { felt[6999] } else { force_n });
            let [tip_m, hand_m] = [Vector3::x() * 1e-3 * (19.0 * t_s).sin(); 2];
            looks.step(&PlausibilityInput {
                t_s,
                raw: RawReadings { sensor: Some(sensor), ..RawReadings::NONE },
                force_n,
                min_n: 0.1,
                world_from_s1: None,
                tip_m,
                hand_m,
                command_m: None,
                hand_force_n: Vector3::zeros(),
                guided: false,
                tip_silent_s: 0.0,
                hand_silent_s: 0.0,
            });
            if let Some(force_n) = felt.len().checked_sub(51).map(|at| felt[at]) {
                looks.delivered(&force_n, t_s - 0.05);
            }
            looks.doubt().is_some()
        })
    };
    assert_eq!(report(false), None);
    assert!(report(true).is_some_and(|k| (7050..7100).contains(&k)), "{:?}", report(true));
}

#[test]
fn a_sensor_that_froze_before_is_told_as_soon_again() {
    let mut device = DeviceMemory::<CHANNELS>::new(SENSOR_BLOCK);
    let mut noise = Noise::new(4);
    let mut kept = [0.0; CHANNELS];
    let mut report = Vec::new();
    for k in 1..12_000 {
        let stands = (5000..5060).contains(&k) || k >= 11_000;
        if !stands {
            kept = std::array::from_fn(|_| noise.gaussian());
        }
        let raw = RawReading { channels: kept, device_s: None, arrival_s: f64::from(k) * TICK_S };
        let was_wrong = device.wrong().is_some();
        if let Some(step) = device.is_new(&raw) {
            device.look_at_all(&raw, &step, |_| Around { travel_m: 0.0, is_load: true, shortest_s: FROZEN_S });
        }
        report.extend((device.wrong().is_some() && !was_wrong).then_some(k));
    }
    assert!(matches!(report[..], [5009..=5012, 11_009..=11_012]), "{report:?}");
}
