use std::f64::consts::PI;

use nalgebra::Vector3;
use nima_core::Side;

use super::{near, of, task, trial};
use crate::{HandSample, Score, ellipsoid::CHI_SQUARE_95};

fn pressed(force_n: impl Fn(f64) -> Vector3<f64>, end_s: f64, more: &str) -> Score {
    let hands = |t_s: f64| {
        let rendered_n = force_n(t_s) * 0.5;
        Side::Right.alone(HandSample { force_n: force_n(t_s), rendered_n, ..HandSample::default() })
    };
    trial(&task(more), end_s, hands, &[])
}

/// Returns a force of 4 N, once per second, for 10 s, with the threshold at half of it.
fn sine() -> Score {
    pressed(
        |t_s| Vector3::new(0.0, 0.0, 4.0 * (2.0 * PI * t_s).sin()),
        10.0,
        "force_threshold_n = 2.0\ncontact_n = 0.4",
    )
}

#[test]
fn a_sine_of_force_has_the_known_peak_rms_and_integral() {
    let score = sine();
    near("sine: peak_force_n", of(&score, "peak_force_n"), 4.0, 1e-6);
    near("sine: rms_force_n", of(&score, "rms_force_n"), 4.0 / 2_f64.sqrt(), 1e-6);
    near("sine: force_integral_n_s", of(&score, "force_integral_n_s"), 40.0 * 2.0 / PI, 1e-5);
    near("sine: peak_rendered_n", of(&score, "peak_rendered_n"), 2.0, 1e-6);
    near("sine: rms_rendered_n", of(&score, "rms_rendered_n"), 2.0 / 2_f64.sqrt(), 1e-6);
    near("sine: force_share", of(&score, "force_share"), 1.0, 0.0);
}

#[test]
fn a_sine_of_force_has_the_known_rate() {
    let score = sine();
    near("sine: peak_force_rate_n_per_s", of(&score, "peak_force_rate_n_per_s"), 4.0 * 2.0 * PI, 2e-3);
    near("sine: mean_force_rate_n_per_s", of(&score, "mean_force_rate_n_per_s"), 4.0 * 2.0 * PI * 2.0 / PI, 2e-3);
}

#[test]
fn a_sine_of_force_has_the_known_time_in_contact_and_over_the_threshold() {
    let score = sine();
    let contact = 1.0 - 2.0 / PI * 0.1_f64.asin();
    near("sine: contact_time_s", of(&score, "contact_time_s"), 10.0 * contact, 3e-3);
    let mean = 4.0 * 2.0 / PI * (1.0 - 0.01_f64).sqrt() / contact;
    near("sine: mean_force_n", of(&score, "mean_force_n"), mean, 3e-3);
    near("sine: time_over_threshold_s", of(&score, "time_over_threshold_s"), 20.0 / 3.0, 5e-3);
    near("sine: force_excursions", of(&score, "force_excursions"), 20.0, 0.0);
}

#[test]
fn a_force_that_varies_has_the_known_standard_deviation() {
    let score = pressed(|t_s| Vector3::new(5.0 + 2.0 * (2.0 * PI * t_s).sin(), 0.0, 0.0), 10.0, "");
    near("varied: mean_force_n", of(&score, "mean_force_n"), 5.0, 1e-6);
    near("varied: force_sd_n", of(&score, "force_sd_n"), 2_f64.sqrt(), 1e-4);
    assert!(of(&score, "force_volume_n3") < 1e-9, "all along one line");
}

#[test]
fn forces_in_all_directions_have_the_known_volume() {
    let force_n = |t_s: f64| {
        let angle = 2.0 * PI * t_s;
        Vector3::new(10.0 + 3.0 * angle.sin(), 2.0 * (2.0 * angle).sin(), (3.0 * angle).sin())
    };
    let known = 4.0 / 3.0 * PI * CHI_SQUARE_95.powf(1.5) * 6.0 / 8_f64.sqrt();
    near("spread: force_volume_n3", of(&pressed(force_n, 10.0, ""), "force_volume_n3"), known, 1e-4);
}

#[test]
fn each_hand_has_its_share_of_the_force() {
    let hands = |_: f64| {
        Side::ALL.map(|side| {
            let size_n = if side == Side::Right { 3.0 } else { 1.0 };
            Some(HandSample { force_n: Vector3::z() * size_n, ..HandSample::default() })
        })
    };
    let score = trial(&task(""), 5.0, hands, &[]);
    near("share: force_share", of(&score, "force_share"), 0.75, 1e-12);
    near("share: force_share", score.of("force_share", Side::Left).unwrap(), 0.25, 1e-12);
}

#[test]
fn a_force_that_is_not_known_leaves_the_motion() {
    let hands = |t_s: f64| {
        let force_n = if t_s < 2.0 { Vector3::x() } else { Vector3::repeat(f64::NAN) };
        Side::Right.alone(HandSample { tip_m: Vector3::x() * 0.1 * t_s, force_n, ..HandSample::default() })
    };
    let score = trial(&task(""), 4.0, hands, &[]);
    near("NaN: path_length_m", of(&score, "path_length_m"), 0.4, 1e-9);
    near("NaN: force_integral_n_s", of(&score, "force_integral_n_s"), 2.0, 1e-3);
    assert_eq!(score.value("samples_skipped"), Some(2001.0));
}

#[test]
fn no_contact_has_no_mean_and_noise_at_the_threshold_is_one_excursion() {
    let score = pressed(|_| Vector3::zeros(), 5.0, "");
    assert_eq!([score.of("mean_force_n", Side::Right), score.of("force_share", Side::Right)], [None; 2]);
    assert_eq!(score.of("contact_time_s", Side::Right), Some(0.0));
    let noisy = |t_s: f64| Vector3::x() * (3.0 + 0.1 * (2.0 * PI * 130.0 * t_s).sin());
    near("noisy: force_excursions", of(&pressed(noisy, 5.0, "force_threshold_n = 3.0"), "force_excursions"), 1.0, 0.0);
}
