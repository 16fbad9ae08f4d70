use std::f64::consts::PI;

use nalgebra::Vector3;
use nima_core::{Side, task::TaskEvent};

use super::{minimum_jerk, near, of, right, task, tip, trial, trial_at, value};
use crate::{HandSample, Score, ellipsoid::CHI_SQUARE_95};

const DIRECTION: Vector3<f64> = Vector3::new(0.6, 0.0, 0.8);

/// Returns a reach of 0.2 m in 2 s, which is the whole trial.
fn reach(times_s: impl Iterator<Item = f64>) -> Score {
    let way = |t_s: f64| right(DIRECTION * (0.2 * minimum_jerk(t_s / 2.0)) + Vector3::new(1.0, 2.0, 3.0));
    trial_at(&task(""), times_s, 2.0, way, &[])
}

fn even() -> impl Iterator<Item = f64> {
    (0..=2000).map(|tick| f64::from(tick) * 1e-3)
}

#[test]
fn a_straight_reach_has_the_known_length_and_depth() {
    let score = reach(even());
    near("reach: path_length_m", of(&score, "path_length_m"), 0.2, 1e-6);
    near("reach: depth_m", of(&score, "depth_m"), 0.16, 1e-6);
    near("reach: depth_share", of(&score, "depth_share"), 0.8, 1e-6);
    assert!(of(&score, "motion_volume_m3") < 1e-12, "a line has no volume");
    near("reach: movements", of(&score, "movements"), 1.0, 0.0);
}

#[test]
fn a_straight_reach_has_the_known_mean_and_peak_speed() {
    let score = reach(even());
    near("reach: mean_speed_m_per_s", of(&score, "mean_speed_m_per_s"), 0.2 / 2.0, 1e-4);
    near("reach: peak_speed_m_per_s", of(&score, "peak_speed_m_per_s"), 1.875 * 0.2 / 2.0, 1e-4);
}

#[test]
fn a_straight_reach_has_the_known_acceleration_and_jerk() {
    let score = reach(even());
    let peak = 10.0 / 3_f64.sqrt() * 0.2 / 4.0;
    near("reach: peak_acceleration_m_per_s2", of(&score, "peak_acceleration_m_per_s2"), peak, 1e-3);
    near("reach: mean_acceleration_m_per_s2", of(&score, "mean_acceleration_m_per_s2"), 3.75 * 0.2 / 4.0, 1e-3);
    // The acceleration rises from 0 to its peak, falls to the opposite peak, and returns to 0.
    near("reach: mean_jerk_m_per_s3", of(&score, "mean_jerk_m_per_s3"), 4.0 * peak / 2.0, 1e-2);
}

#[test]
fn a_straight_reach_has_the_known_smoothness() {
    let score = reach(even());
    // The integral of the squared jerk is 720 d^2 / T^5; the peak speed is 1.875 d / T.
    let known = -(720.0_f64 / (1.875 * 1.875)).ln();
    near("reach: log_dimensionless_jerk", of(&score, "log_dimensionless_jerk"), known, 2e-3);
    // Result of the authors' Python code, run with NumPy on the exact speed.
    near("reach: sparc", of(&score, "sparc"), -1.405_829_284_156, 1e-4);
}

#[test]
fn a_reach_that_is_sampled_unevenly_or_slowly_is_the_same() {
    let uneven = (0..=2000).map(|tick| f64::from(tick) * 1e-3 + if tick % 7 == 3 { 6e-4 } else { 0.0 });
    let lossy = even().enumerate().filter(|(tick, _)| tick % 50 < 30 || *tick > 1990).map(|(_, t_s)| t_s);
    let slow = (0..=500).map(|tick| f64::from(tick) * 4e-3);
    let fast = (0..=10_000).map(|tick| f64::from(tick) * 2e-4);
    for (name, score) in
        [("uneven", reach(uneven)), ("lossy", reach(lossy)), ("250 Hz", reach(slow)), ("5 kHz", reach(fast))]
    {
        near(&format!("{name}: path_length_m"), of(&score, "path_length_m"), 0.2, 1e-4);
        near(&format!("{name}: peak_speed_m_per_s"), of(&score, "peak_speed_m_per_s"), 1.875 * 0.1, 2e-3);
        near(&format!("{name}: sparc"), of(&score, "sparc"), -1.405_829_284_156, 5e-3);
    }
}

#[test]
fn a_circle_has_the_known_speed_acceleration_and_jerk() {
    // A vertical circle of 5 cm, once in 4 s, three times.
    let radius = 0.05;
    let turn = PI / 2.0;
    let end_s = 12.0;
    let way = |t_s: f64| right(Vector3::new((turn * t_s).cos(), 0.3, (turn * t_s).sin()) * radius);
    let score = trial(&task(""), end_s, way, &[]);
    near("circle: path_length_m", of(&score, "path_length_m"), radius * turn * end_s, 1e-4);
    near("circle: mean_speed_m_per_s", of(&score, "mean_speed_m_per_s"), radius * turn, 1e-3);
    near("circle: mean_acceleration_m_per_s2", of(&score, "mean_acceleration_m_per_s2"), radius * turn * turn, 1e-2);
    // The motion is accelerated at its start and end, where the jerk is overestimated; this matters less in a longer trial.
    near("circle: mean_jerk_m_per_s3", of(&score, "mean_jerk_m_per_s3"), radius * turn.powi(3), 0.15);
    let long = trial(&task(""), 120.0, way, &[]);
    near("long circle: mean_jerk_m_per_s3", of(&long, "mean_jerk_m_per_s3"), radius * turn.powi(3), 0.015);
    near("circle: depth_share", of(&score, "depth_share"), 2.0 / PI, 1e-3);
    assert!(of(&score, "motion_volume_m3") < 1e-12, "a circle is flat");
}

#[test]
fn a_figure_in_space_has_the_known_volume() {
    let way = |t_s: f64| {
        right(Vector3::new(0.04 * (PI * t_s).sin(), 0.03 * (2.0 * PI * t_s).sin(), 0.02 * (3.0 * PI * t_s).sin()))
    };
    let score = trial(&task(""), 20.0, way, &[]);
    // The variance of a sine is half the square of its amplitude.
    let axes = 0.04 * 0.03 * 0.02 / 8_f64.sqrt();
    near(
        "figure: motion_volume_m3",
        of(&score, "motion_volume_m3"),
        4.0 / 3.0 * PI * CHI_SQUARE_95.powf(1.5) * axes,
        2e-3,
    );
}

#[test]
fn three_reaches_with_rests_are_three_smooth_movements() {
    let way = |t_s: f64| {
        right(Vector3::new(0.0, 0.1 * (0..3).map(|k| minimum_jerk(t_s - 2.0 * f64::from(k))).sum::<f64>(), 0.0))
    };
    let score = trial(&task(""), 6.0, way, &[]);
    near("three reaches: movements", of(&score, "movements"), 3.0, 0.0);
    near("three reaches: sparc_per_movement", of(&score, "sparc_per_movement"), -1.405_829_324_421, 0.02);
    // The speed is below 5 mm/s where 30 * 0.1 s^2 (1 - s)^2 is, that is, where s (1 - s) < sqrt(1 / 600).
    let early = (1.0 - (1.0 - 4.0 / 600_f64.sqrt()).sqrt()) / 2.0;
    // A movement is shorter by that much. The jerk of the whole is 60 - 360 s + 360 s^2, and the integral of its
    // square:
    let square =
        |s: f64| 3600.0 * s - 21_600.0 * s.powi(2) + 57_600.0 * s.powi(3) - 64_800.0 * s.powi(4) + 25_920.0 * s.powi(5);
    let known = -((1.0 - 2.0 * early).powi(3) / 1.875_f64.powi(2) * (square(1.0 - early) - square(early))).ln();
    let ours = of(&score, "log_dimensionless_jerk_per_movement");
    // Between rest and motion the jerk jumps; the filter smooths this.
    near("three reaches: log_dimensionless_jerk_per_movement", ours, known, 0.03);
    assert!(of(&score, "sparc") < -3.0, "the whole of it is not smooth: {}", of(&score, "sparc"));
    near("three reaches: hand_idle_time_s", of(&score, "hand_idle_time_s"), 3.0 + 3.0 * 2.0 * early, 0.02);
    near("three reaches: idle_time_s", value(&score, "idle_time_s"), 3.0 + 3.0 * 2.0 * early, 0.02);
}

#[test]
fn tremor_along_its_way_makes_a_reach_less_smooth_in_both_measures() {
    let way = |tremor_m: f64| {
        move |t_s: f64| right(DIRECTION * (0.2 * minimum_jerk(t_s / 2.0) + tremor_m * (2.0 * PI * 5.0 * t_s).sin()))
    };
    let [smooth, shaky] = [0.0, 1e-3].map(|tremor| trial(&task(""), 2.0, way(tremor), &[]));
    for id in ["sparc", "log_dimensionless_jerk"] {
        assert!(of(&shaky, id) < of(&smooth, id) - 0.1, "{id}: {} {}", of(&shaky, id), of(&smooth, id));
    }
}

#[test]
fn a_half_circle_from_grasp_to_place_has_the_known_economy() {
    let way = |t_s: f64| {
        let angle = PI * minimum_jerk((t_s - 1.0) / 3.0);
        right(Vector3::new(0.05 * angle.cos(), 0.05 * angle.sin(), 0.0))
    };
    let grasp = (1.0, TaskEvent::RingGrasped { ring: 0, side: Side::Right });
    let place = (4.0, TaskEvent::RingPlaced { ring: 0, side: Side::Right, peg: 3 });
    let score = trial(&task(""), 5.0, way, &[grasp, place]);
    near("half circle: path_economy", of(&score, "path_economy"), 2.0 / PI, 1e-3);
    let straight = trial(&task(""), 5.0, |t_s| right(Vector3::x() * 0.02 * t_s), &[grasp, place]);
    near("straight: path_economy", of(&straight, "path_economy"), 1.0, 1e-9);
    assert_eq!(straight.of("path_economy", Side::Left), None);
}

#[test]
fn a_gap_is_neither_path_nor_time() {
    let way = |t_s: f64| right(Vector3::x() * 0.1 * t_s);
    let times_s = (0..=1000).chain(3000..=4000).map(|tick| f64::from(tick) * 1e-3);
    let score = trial_at(&task(""), times_s, 4.0, way, &[]);
    near("gap: path_length_m", of(&score, "path_length_m"), 0.2, 1e-9);
    near("gap: mean_speed_m_per_s", of(&score, "mean_speed_m_per_s"), 0.1, 1e-9);
    near("gap: unknown_time_s", of(&score, "unknown_time_s"), 2.0, 1e-9);
}

#[test]
fn shares_of_time_and_openings_of_the_jaw_are_counted() {
    let hands = |t_s: f64| {
        let jaw_rad = Some(0.3 - 0.3 * (2.0 * PI * t_s).cos());
        Side::Right.alone(HandSample { engaged: t_s < 7.5, in_view: t_s < 9.0, jaw_rad, ..tip(Vector3::zeros()) })
    };
    let score = trial(&task(""), 10.0, hands, &[]);
    near("engaged_share", of(&score, "engaged_share"), 0.75, 1e-3);
    near("out_of_view_share", of(&score, "out_of_view_share"), 0.1, 2e-3);
    near("jaw_openings", of(&score, "jaw_openings"), 10.0, 0.0);
    near("jaw_openings_per_min", of(&score, "jaw_openings_per_min"), 60.0, 1e-9);
    assert_eq!(score.of("sparc", Side::Right), None, "the tip never moved");
    assert_eq!(score.of("engaged_share", Side::Left), None);
}
