//! Rendering of forces that motion does not explain, with slow sensors, and after bad samples.

use nalgebra::Vector3;

use super::{Identifier, ImpedanceSettings, Mode, ModeSet, Sample};

fn settings(delay_s: f64) -> ImpedanceSettings {
    ImpedanceSettings { delay_s, axes: 1, modes: ModeSet::only(Mode::Best), ..ImpedanceSettings::default() }
}

fn sample(k: usize, position_m: f64, force_n: f64) -> Sample {
    let t_s = k as f64 * 1e-3;
    Sample { t_s, position_m: Vector3::new(position_m, 0.0, 0.0), force_n: Vector3::new(force_n, 0.0, 0.0) }
}

/// Returns a position (m) of a hand that palpates.
fn hand_m(k: usize) -> f64 {
    let t_s = k as f64 * 1e-3;
    0.004 * (5.0 * t_s).sin() + 0.002 * (11.3 * t_s).sin() + 0.0004 * (53.0 * t_s).sin()
}

fn soft_n(x_m: f64) -> f64 {
    -300.0 * x_m - 2e6 * x_m.powi(3)
}

fn stiff_n(x_m: f64) -> f64 {
    -1800.0 * (x_m + 0.002).max(0.0)
}

/// Returns the mean errors (N) of `mode` and of the delayed force over the samples from `from` on.
fn errors_n(mode: Mode, delay_s: f64, from: usize, samples: &[Sample]) -> [f64; 2] {
    let mut identifier = Identifier::new(&settings(delay_s)).unwrap();
    let mut sums_n = [0.0; 2];
    for (k, sample) in samples.iter().enumerate() {
        identifier.step(sample);
        if k >= from {
            for (sum_n, mode) in sums_n.iter_mut().zip([mode, Mode::Dfr]) {
                *sum_n += (identifier.report().prediction(mode).unwrap() - sample.force_n).norm();
            }
        }
    }
    sums_n.map(|sum_n| sum_n / (samples.len() - from) as f64)
}

#[test]
fn where_motion_does_not_explain_the_force_holding_is_not_worse() {
    // Another person pushes with a slow force, and the position follows another motion.
    let force_n = |k: usize| {
        let t_s = k as f64 * 1e-3;
        3.0 * (1.7 * t_s).sin() + 2.0 * (2.9 * t_s + 1.0).sin() + (0.61 * t_s).cos()
    };
    let samples: Vec<Sample> = (0..20_000).map(|k| sample(k, hand_m(k), force_n(k))).collect();
    for delay_s in [0.05, 0.3] {
        // At first there is no evidence against the motion.
        let [best_n, held_n] = errors_n(Mode::Best, delay_s, 6000, &samples);
        assert!(best_n < 1.02 * held_n, "{delay_s} s: {best_n} N, held {held_n} N");
    }
}

#[test]
fn a_sensor_that_renews_its_force_four_times_a_second_is_held() {
    let samples: Vec<Sample> = (0..6000).map(|k| sample(k, hand_m(k), soft_n(hand_m(k - k % 250)))).collect();
    for delay_s in [0.01, 0.05, 0.1] {
        let [best_n, held_n] = errors_n(Mode::Best, delay_s, 1000, &samples);
        assert!(best_n < 1.02 * held_n, "{delay_s} s: {best_n} N, held {held_n} N");
    }
}

#[test]
fn a_glitch_of_one_position_leaves_no_scar() {
    let clean: Vec<Sample> = (0..6000).map(|k| sample(k, hand_m(k), soft_n(hand_m(k)))).collect();
    let mut glitch = clean.clone();
    glitch[3000].position_m.x += 0.12;
    for delay_s in [0.05, 0.3] {
        let [clean_n, held_n] = errors_n(Mode::Best, delay_s, 3001, &clean);
        let [glitch_n, _] = errors_n(Mode::Best, delay_s, 3001, &glitch);
        assert!(glitch_n < 1.02 * clean_n + 0.002 * held_n, "{delay_s} s: {glitch_n} N, without {clean_n} N");
    }
}

#[test]
fn a_gap_of_half_a_second_leaves_no_scar() {
    let clean: Vec<Sample> = (0..4000).map(|k| sample(k, hand_m(k), soft_n(hand_m(k)))).collect();
    let mut gap = clean.clone();
    for sample in &mut gap[3000..3500] {
        sample.position_m.x = f64::NAN;
        sample.force_n.x = f64::NAN;
    }
    for delay_s in [0.05, 0.1] {
        let [clean_n, held_n] = errors_n(Mode::Matched, delay_s, 3500, &clean);
        let [gap_n, _] = errors_n(Mode::Matched, delay_s, 3500, &gap);
        assert!(gap_n < 2.0 * clean_n + 0.03 * held_n, "{delay_s} s: {gap_n} N, without {clean_n} N, held {held_n} N");
    }
}

/// Replaces all forces that the leader cannot know yet: neither the voices of the mixture nor the mixture change by a bit.
/// The tissue changes, and a slow sensor renews its force, so that every part of the judge is active.
#[test]
fn no_voice_of_the_mixture_uses_a_force_before_it_arrives() {
    for (delay_s, delay) in [(0.01, 10), (0.1, 100), (0.3, 300)] {
        for stop in [900_usize, 2500, 3777] {
            let [mut clean, mut corrupt] = [(); 2].map(|()| Identifier::new(&settings(delay_s)).unwrap());
            let law = |k: usize| match k {
                ..2000 => soft_n(hand_m(k)),
                2000..3000 => stiff_n(hand_m(k)),
                _ => stiff_n(hand_m(k - k % 250)),
            };
            for k in 0..stop + delay {
                let noise_n = if k < stop { 0.0 } else { ((k * 7919) % 101) as f64 - 50.0 };
                clean.step(&sample(k, hand_m(k), law(k)));
                corrupt.step(&sample(k, hand_m(k), law(k) + noise_n));
                for mode in [Mode::Dfr, Mode::Anchored, Mode::Matched, Mode::Best] {
                    let [clean, corrupt] = [&clean, &corrupt].map(|identifier| identifier.report().prediction(mode));
                    assert_eq!(clean, corrupt, "{mode}, {delay_s} s, tick {k} of {stop}");
                }
            }
            let k = stop + delay;
            clean.step(&sample(k, hand_m(k), law(k)));
            corrupt.step(&sample(k, hand_m(k), law(k)));
            let [clean, corrupt] = [&clean, &corrupt].map(|identifier| identifier.report().prediction(Mode::Best));
            assert_ne!(clean, corrupt, "the corrupt force arrives at last");
        }
    }
}

/// A hand with a glitch, lost samples, and a slow sensor on another tissue.
fn troubled() -> Vec<Sample> {
    let hand_m = |t_s: f64| 0.004 * libm::sin(5.0 * t_s) + 0.002 * libm::sin(11.3 * t_s);
    let sample = |k: usize| {
        let t_s = k as f64 * 1e-3;
        let position_m = hand_m(t_s) + if k == 1500 { 0.12 } else { 0.0 };
        let force_n = if k < 2500 { -300.0 * hand_m(t_s) } else { -900.0 * hand_m((k - k % 250) as f64 * 1e-3) };
        let lost = (2000..2200).contains(&k);
        let known = |value: f64| Vector3::new(if lost { f64::NAN } else { value }, 0.0, 0.0);
        Sample { t_s, position_m: known(position_m), force_n: known(force_n) }
    };
    (0..4000).map(sample).collect()
}

/// The forces of a program that wrote version 5, which a replay must repeat.
#[test]
fn a_session_of_an_earlier_journal_has_its_forces_to_the_bit() {
    let digest = |mode: Mode, earlier_forces: bool| {
        let mut identifier = Identifier::new(&ImpedanceSettings { earlier_forces, ..settings(0.05) }).unwrap();
        troubled().iter().fold(0xcbf2_9ce4_8422_2325_u64, |bits, sample| {
            identifier.step(sample);
            let force_n = identifier.report().prediction(mode).map_or(0.0, |force_n| force_n.x);
            (bits ^ force_n.to_bits()).wrapping_mul(0x0100_0000_01b3)
        })
    };
    for (mode, bits) in [
        (Mode::Anchored, 0xac6a_9404_4378_fb7f),
        (Mode::Matched, 0xf1ba_441f_a004_bd3f),
        (Mode::Best, 0x28f3_d1cc_f56f_841d),
    ] {
        assert_eq!(digest(mode, true), bits, "{mode}");
        assert_ne!(digest(mode, false), bits, "{mode}");
    }
}
