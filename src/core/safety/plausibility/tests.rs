use super::*;

/// Checks at 1 kHz; noise of 0.02 N so that nothing is frozen.
struct Fixture {
    plausibility: Plausibility,
    noise: crate::noise::Noise,
    tick: u32,
}

impl Fixture {
    fn new() -> Self {
        Self { plausibility: Plausibility::default(), noise: crate::noise::Noise::new(5), tick: 0 }
    }

    fn seen(&mut self) -> PlausibilityInput {
        self.tick += 1;
        let t_s = f64::from(self.tick) * 1e-3;
        let force_n = Vector3::from_fn(|_, _| 0.02 * self.noise.gaussian());
        let sensor = Some(RawReading::of_sensor([Some(force_n.into()), None, None], None, t_s));
        let position_m = Vector3::new((3.0 * t_s).sin(), (2.0 * t_s).cos(), (5.0 * t_s).sin()) * 0.02;
        PlausibilityInput {
            t_s,
            raw: RawReadings { sensor, ..RawReadings::NONE },
            force_n,
            min_n: 0.1,
            world_from_s1: None,
            tip_m: position_m,
            hand_m: position_m,
            command_m: Some(position_m),
            hand_force_n: Vector3::zeros(),
            guided: false,
            tip_silent_s: 0.0,
            hand_silent_s: 0.0,
        }
    }

    fn run(&mut self, ticks: u32, mut edit: impl FnMut(u32, &mut PlausibilityInput)) -> Option<(u32, Implausible)> {
        (1..=ticks).find_map(|k| {
            let mut seen = self.seen();
            edit(k, &mut seen);
            self.plausibility.step(&seen);
            self.plausibility.doubt().map(|what| (k, what))
        })
    }
}

fn after(edit: impl FnMut(u32, &mut PlausibilityInput)) -> Option<(u32, Implausible)> {
    let mut bench = Fixture::new();
    assert_eq!(bench.run(11_000, |_, _| {}), None);
    bench.run(500, edit)
}

fn sensed(seen: &mut PlausibilityInput) -> &mut [f64; CHANNELS] {
    &mut seen.raw.sensor.as_mut().unwrap().channels
}

#[test]
fn a_sensor_that_sends_nothing_is_late_and_not_frozen() {
    let mut kept = None;
    let report = after(|k, seen| {
        if k <= 19 {
            seen.raw.sensor = *kept.get_or_insert(seen.raw.sensor);
        }
    });
    assert_eq!(report, None);
}

#[test]
fn a_frozen_sensor_is_told_within_12_ms_and_one_without_noise_never() {
    let mut kept = None;
    let report = after(|_, seen| *sensed(seen) = *kept.get_or_insert(*sensed(seen)));
    assert!(matches!(report, Some((10..=12, Implausible::ForceFrozen))), "{report:?}");
    let mut one = None;
    let report = after(|_, seen| sensed(seen)[1] = *one.get_or_insert(sensed(seen)[1]));
    assert!(matches!(report, Some((10..=12, Implausible::ForceFrozen))), "one axis: {report:?}");
    let mut bench = Fixture::new();
    let ideal = |k: u32, seen: &mut PlausibilityInput| {
        let z = if k % 2000 < 900 { f64::from(k) * 1e-4 } else { 0.0 };
        *sensed(seen) = [0.0, 0.0, z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    };
    assert_eq!(bench.run(10_000, ideal), None);
}

#[test]
fn a_sensor_of_a_fifth_of_the_loops_rate_is_not_frozen() {
    let mut bench = Fixture::new();
    let mut kept = None;
    let slow = |k: u32, seen: &mut PlausibilityInput| {
        if k.is_multiple_of(5) || kept.is_none() {
            kept = Some(*sensed(seen));
        }
        *sensed(seen) = kept.unwrap();
    };
    assert_eq!(bench.run(10_000, slow), None);
}

#[test]
fn a_step_is_told_in_three_ticks_and_a_spike_is_taken_out() {
    let mut kept = None;
    let report = after(|k, seen| {
        seen.tip_m = *kept.get_or_insert(seen.tip_m);
        seen.command_m = None;
        seen.force_n.x += if k > 10 { 1.0 } else { 0.0 };
    });
    assert_eq!(report, Some((13, Implausible::ForceJumped)));
    let mut bench = Fixture::new();
    bench.run(100, |_, _| {});
    let mut seen = bench.seen();
    seen.force_n.z = 50.0;
    let admitted = bench.plausibility.step(&seen);
    assert!(admitted.force_n.norm() < 0.2, "{}", admitted.force_n);
    assert_eq!(bench.run(100, |_, _| {}), None);
}

#[test]
fn a_stiff_contact_is_no_jump() {
    // 5000 N/m at 60 mm/s: 0.3 N per tick.
    let mut bench = Fixture::new();
    let press = |k: u32, seen: &mut PlausibilityInput| {
        let depth_m = f64::from(k.saturating_sub(200)) * 6e-5;
        let position_m = Vector3::new(0.0, 0.0, 0.012 - 6e-5 * f64::from(k.min(200)) - depth_m);
        seen.tip_m = position_m;
        seen.command_m = Some(position_m);
        seen.hand_m = position_m;
        seen.force_n += Vector3::z() * 5000.0 * depth_m;
    };
    assert_eq!(bench.run(500, press), None);
}

/// Returns the fault reported for a force with these values (N, one per sample) after a contact of 2.6 N, while the tip
/// is at rest; with `again`, the values recur this many samples apart.
fn reported_change(sizes_n: &[f64], again: Option<u32>) -> Option<(u32, Implausible)> {
    let mut kept = None;
    after(|k, seen| {
        seen.tip_m = *kept.get_or_insert(seen.tip_m);
        seen.command_m = None;
        let pressed_n = 0.26 * f64::from(k.min(10));
        let since = k.checked_sub(50).map(|since| again.map_or(since, |again| since % again));
        let size_n = since.map_or(pressed_n, |since| match sizes_n.get(since as usize) {
            Some(size_n) => *size_n,
            // If the force is to recur, press again slowly.
            None if again.is_some() => (0.2 * f64::from(since - sizes_n.len() as u32)).min(2.6),
            None => sizes_n.last().copied().unwrap_or(pressed_n),
        });
        seen.force_n += Vector3::new(0.6, 0.0, 0.8) * size_n;
    })
}

#[test]
fn a_contact_that_ends_within_some_milliseconds_is_no_jump() {
    let rings_n = [&[2.55, 2.5, 2.3, 1.85, 0.55, 0.3, 0.2, 0.1, 0.0][..], &[2.55, 2.3, 1.9, 1.0, 0.1, 0.0]];
    let others_n = [&[1.9, 0.8, 0.0][..], &[2.3, 1.2, 0.3, 0.0], &[2.0, 1.5, 1.0, 0.6, 0.2, 0.0], &[1.2, 0.0]];
    for falls_n in rings_n.into_iter().chain(others_n) {
        assert_eq!(reported_change(falls_n, None), None, "{falls_n:?}");
    }
    assert_eq!(reported_change(&[1.9, 0.8, 0.0, 0.0], Some(40)), None, "again and again");
}

#[test]
fn a_force_that_steps_to_nothing_or_falls_to_something_or_grows_or_turns_has_jumped() {
    let jumped = |sizes_n: &[f64], by: u32| {
        let report = reported_change(sizes_n, None);
        assert!(matches!(report, Some((k, Implausible::ForceJumped)) if k <= 49 + by), "{sizes_n:?}: {report:?}");
    };
    jumped(&[0.0], 3);
    jumped(&[2.4, 2.2, 2.0, 0.3], 6);
    jumped(&[1.1], 3);
    jumped(&[1.9, 1.2], 3);
    jumped(&[2.0, 1.4, 0.9], 4);
    jumped(&[3.3, 4.1, 5.0], 3);
    jumped(&[1.9, 0.9, 0.0, -0.9, -1.8, -2.6], 8);
    jumped(&[1.9, -0.8, -2.6], 4);
}

#[test]
fn a_force_along_the_way_into_a_contact_is_told_and_a_puncture_is_not() {
    let touch = |sign: f64, gives_way_n: f64| {
        let mut bench = Fixture::new();
        bench.run(600, move |k, seen| {
            let position_m = Vector3::new(0.0, 0.0, 0.010 - 5e-5 * f64::from(k));
            seen.tip_m = position_m;
            seen.command_m = Some(position_m);
            seen.hand_m = position_m;
            let force = 400.0 * (-position_m.z).max(0.0);
            seen.force_n += Vector3::z() * sign * if force > gives_way_n { 0.2 * gives_way_n } else { force };
        })
    };
    let report = touch(-1.0, 9.0);
    assert!(matches!(report, Some((201..=225, Implausible::ForceAlong))), "{report:?}");
    assert_eq!(touch(1.0, 9.0), None);
    assert_eq!(touch(1.0, 0.4), None);
}

#[test]
fn the_sign_is_judged_of_a_touch_that_the_tip_makes_and_not_of_one_that_comes_to_it() {
    // The tip is still, trembles, and at some moment is pulled with 1.3 N: another hand takes the held object.
    let pulled = |from: u32, goes_m_s: f64| {
        Fixture::new().run(900, move |k, seen| {
            let t_s = f64::from(k) * 1e-3;
            let tremor_m = 0.00012 * (std::f64::consts::TAU * 8.5 * t_s).sin();
            let position_m = Vector3::new(tremor_m + goes_m_s * t_s, 0.0, 0.05);
            seen.tip_m = position_m;
            seen.command_m = Some(position_m);
            seen.hand_m = position_m;
            seen.force_n.x += 1.3 * (f64::from(k.saturating_sub(from)) / 15.0).min(1.0);
        })
    };
    for from in (300..420).step_by(6) {
        assert_eq!(pulled(from, 0.0), None, "from {from} ms on");
        assert!(
            matches!(pulled(from, 0.02), Some((_, Implausible::ForceAlong))),
            "from {from} ms on, while it moves along"
        );
    }
    // A wrong sign at a slow touch.
    let report = Fixture::new().run(900, |k, seen| {
        let position_m = Vector3::new(0.0, 0.0, 0.004 - 1e-5 * f64::from(k));
        seen.tip_m = position_m;
        seen.command_m = Some(position_m);
        seen.hand_m = position_m;
        seen.force_n.z -= 400.0 * (-position_m.z).max(0.0);
    });
    assert!(matches!(report, Some((401..=520, Implausible::ForceAlong))), "{report:?}");
}

#[test]
fn an_error_of_the_force_below_the_least_one_is_no_touch() {
    // Overcompensated friction pushes along the motion.
    let report = |min_n: f64| {
        Fixture::new().run(600, move |k, seen| {
            let position_m = Vector3::new(0.0, 0.0, 0.010 - 5e-5 * f64::from(k));
            seen.tip_m = position_m;
            seen.command_m = Some(position_m);
            seen.hand_m = position_m;
            seen.force_n.z -= if k > 200 { 0.2 } else { 0.0 };
            seen.min_n = min_n;
        })
    };
    assert!(matches!(report(0.1), Some((_, Implausible::ForceAlong))), "{:?}", report(0.1));
    assert_eq!(report(0.4), None);
}

#[test]
fn what_stands_while_its_cause_moves_is_stuck() {
    let report = after(|k, seen| {
        seen.hand_m = Vector3::repeat(0.5);
        seen.hand_force_n = Vector3::x() * 0.05 * f64::from(k);
    });
    assert!(matches!(report, Some((3, Implausible::HandleJumped))), "{report:?}");
    let mut kept = None;
    let report = after(|k, seen| {
        seen.hand_m = *kept.get_or_insert(seen.hand_m);
        seen.hand_force_n = Vector3::x() * 0.05 * f64::from(k);
    });
    assert!(matches!(report, Some((15..=20, Implausible::HandleFrozen))), "{report:?}");
    let mut kept = None;
    let report = after(|_, seen| {
        seen.hand_m = *kept.get_or_insert(seen.hand_m);
        seen.hand_force_n = Vector3::x() * 0.6;
    });
    assert!(matches!(report, Some((100..=103, Implausible::HandleFrozen))), "{report:?}");
    // A machine guides the handle for five seconds and then lets it stand still under its force.
    let mut bench = Fixture::new();
    let mut kept = Vector3::zeros();
    let led = |k: u32, seen: &mut PlausibilityInput| {
        kept = if k < 5000 { seen.hand_m } else { kept };
        seen.hand_m = kept;
        seen.hand_force_n = Vector3::x();
    };
    assert_eq!(bench.run(6000, led), None);
    let mut kept = None;
    let report = after(|k, seen| {
        seen.hand_m = *kept.get_or_insert(seen.hand_m);
        seen.hand_force_n = Vector3::x() * 0.05 * f64::from(k);
        seen.guided = true;
    });
    assert_eq!(report, None, "led from the screen");
    let mut kept = None;
    // The command is slow at that moment: moving half a millimetre takes longer than the 15 ms.
    let report = after(|_, seen| seen.tip_m = *kept.get_or_insert(seen.tip_m));
    assert!(matches!(report, Some((15..=60, Implausible::ArmAstray))), "{report:?}");
    let report = after(|_, seen| seen.command_m = Some(seen.tip_m + Vector3::x() * 0.05));
    assert!(matches!(report, Some((1, Implausible::ArmAstray))), "{report:?}");
}

/// Returns whether the link is in doubt after four seconds of noise and then half a second of this force, N.
fn link_doubted_after(force_n: Vector3<f64>) -> bool {
    let mut looks = Plausibility::default();
    let mut noise = crate::noise::Noise::new(5);
    for k in 0..4500 {
        let lively = Vector3::from_fn(|_, _| 0.01 * noise.gaussian());
        looks.delivered(&if k < 4000 { lively } else { force_n }, f64::from(k) * 1e-3);
    }
    looks.doubt() == Some(Implausible::LinkFrozen)
}

#[test]
fn a_link_that_repeats_a_force_is_frozen_and_one_without_any_force_is_not() {
    assert!(link_doubted_after(Vector3::new(0.4, 0.0, -1.2)));
    assert!(!link_doubted_after(Vector3::zeros()));
}

/// A tip that moves at 0.2 m/s and is silent for 40 ms is 8 mm farther.
#[test]
fn what_went_on_while_the_line_was_silent_has_not_jumped() {
    let report = |is_known: bool, is_tip: bool| {
        let mut from_m = None;
        let mut kept = None;
        after(|k, seen| {
            seen.command_m = None;
            let position_m = *from_m.get_or_insert(seen.tip_m) + Vector3::x() * 0.2e-3 * f64::from(k);
            let silent = if (101..140).contains(&k) { k - 100 } else { 0 };
            let position_m = if silent > 0 { *kept.get_or_insert(position_m) } else { position_m };
            let silent_s = if is_known { f64::from(silent) * 1e-3 } else { 0.0 };
            if is_tip {
                seen.tip_m = position_m;
                seen.tip_silent_s = silent_s;
            } else {
                seen.hand_m = position_m;
                seen.hand_silent_s = silent_s;
            }
        })
    };
    assert_eq!([report(true, true), report(true, false)], [None; 2]);
    assert!(matches!(report(false, true), Some((140..=143, Implausible::TipJumped))), "{:?}", report(false, true));
    assert!(matches!(report(false, false), Some((140..=143, Implausible::HandleJumped))), "{:?}", report(false, false));
}
