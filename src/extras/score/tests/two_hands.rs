use std::f64::consts::PI;

use nalgebra::Vector3;
use nima_core::Side;

use super::{near, task, tip, trial, value};
use crate::Score;

/// Moves both hands along x at 50 mm/s plus a sine of 30 mm/s, shifted by `phase` for the left one.
fn both(phase: f64) -> Score {
    let way = |t_s: f64, phase: f64| 0.05 * t_s - 0.03 / PI * (PI * t_s + phase).cos();
    let hands = |t_s: f64| [0.0, phase].map(|phase| Some(tip(Vector3::new(way(t_s, phase), 0.0, 0.0))));
    trial(&task(""), 10.0, hands, &[])
}

#[test]
fn hands_in_phase_correlate_by_one_and_in_antiphase_by_minus_one() {
    near("in phase: bimanual_dexterity", value(&both(0.0), "bimanual_dexterity"), 1.0, 1e-9);
    near("in antiphase: bimanual_dexterity", value(&both(PI), "bimanual_dexterity"), -1.0, 2e-3);
    let quarter = value(&both(PI / 2.0), "bimanual_dexterity");
    assert!(quarter.abs() < 0.01, "a quarter of a turn apart: {quarter}");
    assert!((value(&both(0.0), "both_move_share") - 1.0).abs() < 1e-12);
    assert!(value(&both(0.0), "idle_time_s").abs() < 1e-12);
}

#[test]
fn hands_that_take_turns_never_both_move() {
    let hands = |t_s: f64| {
        let left_m = 0.05 * t_s.min(5.0);
        let right_m = 0.05 * (t_s - 6.0).max(0.0);
        [right_m, left_m].map(|x_m| Some(tip(Vector3::new(x_m, 0.0, 0.0))))
    };
    let score = trial(&task(""), 12.0, hands, &[]);
    assert!(value(&score, "both_move_share").abs() < 1e-12);
    assert!(value(&score, "bimanual_dexterity") < -0.7);
    near("turns: idle_time_s", value(&score, "idle_time_s"), 1.0, 0.08);
    let half = trial(
        &task(""),
        10.0,
        |t_s| [0.05 * t_s, 0.05 * t_s.min(4.0)].map(|x_m| Some(tip(Vector3::new(x_m, 0.0, 0.0)))),
        &[],
    );
    near("half: both_move_share", value(&half, "both_move_share"), 0.4, 0.01);
}

#[test]
fn one_hand_has_no_correlation() {
    let score = trial(&task(""), 5.0, |t_s| Side::Left.alone(tip(Vector3::x() * 0.05 * t_s)), &[]);
    assert_eq!([score.value("bimanual_dexterity"), score.value("both_move_share")], [None; 2]);
    let still = trial(&task(""), 5.0, |_| [Some(tip(Vector3::x())); 2], &[]);
    assert_eq!(still.value("bimanual_dexterity"), None, "rest correlates with nothing");
}
