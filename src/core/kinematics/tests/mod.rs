//! The complete path from target to joints, on an arm with a typical instrument.

mod usual_arm;

use std::{f64::consts::TAU, time::Instant};

use nalgebra::Vector3;

use self::usual_arm::{READY_RAD, TROCAR_M, arm, arm_settings, middle_m, rcm};
use super::{
    inverse::{TIP_SPEED_M_S, TURN_SPEED_RAD_S},
    start_pose::trial_places,
    *,
};

const PERIOD_S: f64 = 1e-3;

/// Returns an arm at rest with its tip in the middle of the permitted space.
fn started(cone_deg: f64) -> Inverse {
    let mut joint_rad = Joints::from(READY_RAD);
    // The stored angles are rounded; a few Newton steps remove the error of some millimetres.
    for _ in 0..20 {
        joint_rad += velocity::towards(&arm().pose(&joint_rad), &middle_m(), &-Vector3::z()).0;
    }
    let mut inverse = Inverse::new(arm(), rcm(cone_deg), PERIOD_S, &joint_rad).unwrap();
    for _ in 0..2000 {
        inverse.step(&middle_m());
    }
    inverse
}

#[derive(Debug)]
struct Drive {
    axis_miss_m: f64,
    speed_fraction: f64,
    keep_off_rad: f64,
    greatest_change_of_speed_rad_s2: f64,
    tip_miss_p95_m: f64,
    min_dexterity: f64,
    /// Median and 99th percentile; printed, never asserted.
    step_us: [f64; 2],
}

/// Moves for `steps` periods like a hand, with jumps across the whole space, targets outside it, and NaN.
fn drive(cone_deg: f64, steps: usize, seed: u64) -> Drive {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut inverse = started(cone_deg);
    let mut goal_m = middle_m();
    let mut target_m = goal_m;
    let mut before = *inverse.joint_rad();
    let mut speed_before = Joints::zeros();
    let mut misses = Vec::with_capacity(steps);
    let mut times_us = Vec::with_capacity(steps);
    let mut drive = Drive {
        axis_miss_m: 0.0,
        speed_fraction: 0.0,
        keep_off_rad: f64::INFINITY,
        greatest_change_of_speed_rad_s2: 0.0,
        tip_miss_p95_m: 0.0,
        min_dexterity: f64::INFINITY,
        step_us: [0.0; 2],
    };
    for k in 0..steps {
        if k % 400 == 0 {
            goal_m = TROCAR_M + Vector3::new(random.f64() - 0.5, random.f64() - 0.5, -random.f64()) * 0.3;
        }
        let jump = random.usize(..2000) == 0;
        target_m = if jump { goal_m } else { target_m + (goal_m - target_m) * 0.01 };
        let broken = random.usize(..500) == 0;
        let tremor_m = Vector3::from_fn(|_, _| random.f64() - 0.5) * 2e-4;
        let clock = Instant::now();
        let step = inverse.step(&(if broken { Vector3::repeat(f64::NAN) } else { target_m + tremor_m }));
        times_us.push(1e6 * clock.elapsed().as_secs_f64());
        let speed = (step.joint_rad - before) / PERIOD_S;
        before = step.joint_rad;
        drive.axis_miss_m = drive.axis_miss_m.max(step.measures.axis_miss_m);
        drive.keep_off_rad = drive.keep_off_rad.min(step.measures.limit_margin_rad);
        drive.min_dexterity = drive.min_dexterity.min(step.measures.dexterity);
        for joint in 0..JOINTS {
            drive.speed_fraction = drive.speed_fraction.max(speed[joint].abs() / SPEED_RAD_S[joint]);
        }
        drive.greatest_change_of_speed_rad_s2 =
            drive.greatest_change_of_speed_rad_s2.max((speed - speed_before).amax() / PERIOD_S);
        speed_before = speed;
        assert!(step.joint_rad.iter().all(|q| q.is_finite()), "step {k}");
        assert_eq!(step.measures.tip_miss_m.is_nan(), broken, "step {k}");
        if !broken {
            misses.push(step.measures.tip_miss_m);
        }
    }
    misses.sort_by(f64::total_cmp);
    times_us.sort_by(f64::total_cmp);
    drive.step_us = [50, 99].map(|percent| times_us[steps * percent / 100]);
    drive.tip_miss_p95_m = misses[misses.len() * 95 / 100];
    drive
}

fn check(drive: &Drive) {
    assert!(drive.axis_miss_m < 2e-5, "the axis leaves the trocar: {drive:?}");
    assert!(drive.speed_fraction <= 1.0, "a joint jumps: {drive:?}");
    assert!(drive.keep_off_rad >= 0.99 * KEEP_OFF_RAD, "a joint runs into its limit: {drive:?}");
}

#[test]
fn random_targets_never_tear_the_shaft_out_of_the_trocar_nor_a_joint_beyond_its_speed() {
    // A cone that the arm can reach everywhere, and one whose edge it cannot reach.
    for cone_deg in [20.0, 50.0] {
        check(&drive(cone_deg, 20_000, 1));
    }
}

#[test]
#[ignore = "`./dev fuzz` runs it for as long as told"]
fn fuzz_random_steps() {
    nima_testing::fuzz::rounds(|seed| {
        for cone_deg in [20.0, 50.0] {
            check(&drive(cone_deg, 100_000, seed));
        }
    });
}

#[test]
fn every_corner_of_the_space_is_reached_to_a_micrometre_through_the_trocar() {
    let cone_deg = 20.0;
    for place_m in trial_places(&rcm(cone_deg)) {
        let mut inverse = started(cone_deg);
        let mut worst_m = 0.0_f64;
        for _ in 0..3000 {
            worst_m = worst_m.max(inverse.step(&place_m).measures.axis_miss_m);
        }
        let measures = inverse.step(&place_m).measures;
        assert!(measures.tip_miss_m < 1e-6, "{place_m} {measures:?}");
        assert!(worst_m < 2e-5, "{place_m} {worst_m}");
    }
}

#[test]
fn a_hands_motion_is_followed_without_lag() {
    let mut inverse = started(20.0);
    let mut worst_m = 0.0_f64;
    let mut before = [*inverse.joint_rad(); 2];
    let mut change_rad_s2 = 0.0_f64;
    for k in 0..5000 {
        let t_s = f64::from(k) * PERIOD_S;
        let fraction = t_s.min(1.0);
        // Fades in, then moves 10 to 20 mm about once a second: up to 0.09 m/s.
        let travel_m = Vector3::new((6.0 * t_s).sin(), 1.0 - (5.0 * t_s).cos(), (4.0 * t_s).sin())
            * 0.01
            * (fraction * fraction * (3.0 - 2.0 * fraction));
        let step = inverse.step(&(middle_m() + travel_m));
        worst_m = worst_m.max(step.measures.tip_miss_m);
        change_rad_s2 = change_rad_s2.max((step.joint_rad - 2.0 * before[1] + before[0]).amax() / PERIOD_S.powi(2));
        before = [before[1], step.joint_rad];
    }
    assert!(worst_m < 1e-6, "the tip lags by {worst_m} m");
    assert!(change_rad_s2 < 10.0, "the joints jerk: {change_rad_s2} rad/s^2");
    println!("tip within {worst_m} m, joints within {change_rad_s2} rad/s^2");
}

#[test]
fn a_far_target_is_approached_no_faster_than_tip_and_shaft_may_move() {
    let mut inverse = started(20.0);
    let before = *inverse.pose();
    inverse.step(&(middle_m() + Vector3::new(0.03, 0.0, -0.1)));
    let after = *inverse.pose();
    let tip_m_s = (after.tip_m - before.tip_m).norm() / PERIOD_S;
    let turn_rad_s = before.direction.angle(&after.direction) / PERIOD_S;
    assert!(tip_m_s > 1e-3 && tip_m_s < 1.01 * TIP_SPEED_M_S, "{tip_m_s}");
    assert!(turn_rad_s < 1.01 * TURN_SPEED_RAD_S, "{turn_rad_s}");
}

#[test]
fn a_broken_target_holds_the_arm() {
    let mut inverse = started(20.0);
    let before = *inverse.joint_rad();
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let step = inverse.step(&Vector3::new(0.4, broken, 0.0));
        assert_eq!(step.joint_rad, before);
        assert!(step.measures.granted.abs() < f64::EPSILON && step.measures.tip_miss_m.is_nan());
    }
    for far in [1e300, -1e300] {
        assert!(inverse.step(&Vector3::repeat(far)).joint_rad.iter().all(|q| q.is_finite()));
    }
}

#[test]
fn a_start_that_makes_no_sense_is_refused() {
    let good = *started(20.0).joint_rad();
    let start = |arm: Arm, period_s, joint_rad: &Joints| Inverse::new(arm, rcm(20.0), period_s, joint_rad).map(drop);
    assert!(start(arm(), PERIOD_S, &good).is_ok());
    assert!(matches!(start(arm(), 0.0, &good), Err(ArmStartError::Period { .. })));
    assert!(matches!(start(arm(), f64::NAN, &good), Err(ArmStartError::Period { .. })));
    let short = Arm::new(&ArmSettings { shaft_m: 0.2, ..arm_settings() }).unwrap();
    assert!(matches!(start(short, PERIOD_S, &good), Err(ArmStartError::ShortShaft { .. })));
    let changed = |joint: usize, by_rad: f64| {
        let mut joint_rad = good;
        joint_rad[joint] += by_rad;
        joint_rad
    };
    assert!(matches!(start(arm(), PERIOD_S, &changed(3, f64::NAN)), Err(ArmStartError::NotFinite { joint: 4 })));
    assert!(matches!(start(arm(), PERIOD_S, &changed(3, 3.0)), Err(ArmStartError::AtLimit { joint: 4, .. })));
    assert!(matches!(start(arm(), PERIOD_S, &changed(0, 0.1)), Err(ArmStartError::BesideTrocar { .. })));
    assert!(start(arm(), PERIOD_S, &changed(0, TAU)).is_ok(), "a joint that turns without end may have turned");
    let withdrawn = moved_to(&(TROCAR_M + Vector3::z() * 0.01), good);
    assert!(matches!(start(arm(), PERIOD_S, &withdrawn), Err(ArmStartError::NotInserted { .. })));
}

fn moved_to(tip_m: &Vector3<f64>, mut joint_rad: Joints) -> Joints {
    for _ in 0..50 {
        joint_rad += velocity::towards(&arm().pose(&joint_rad), tip_m, &-Vector3::z()).0 * 0.5;
    }
    joint_rad
}

#[test]
fn the_search_finds_a_pose_from_which_the_whole_space_can_be_reached() {
    let ready = find(&arm(), &rcm(20.0), &middle_m()).unwrap();
    assert!((ready.reached - 1.0).abs() < f64::EPSILON, "{ready:?}");
    assert!(ready.limit_margin_rad > KEEP_OFF_RAD && ready.clearance_m > 0.1 && ready.dexterity > 0.05, "{ready:?}");
    let inverse = Inverse::new(arm(), rcm(20.0), PERIOD_S, &ready.joint_rad).unwrap();
    assert!((inverse.pose().tip_m - middle_m()).norm() < 1e-6);
}

#[test]
fn a_place_without_a_pose_is_explained() {
    let at = |trocar_m: Vector3<f64>, tip_m: Vector3<f64>| {
        let rcm = Rcm::new(&RcmSettings { trocar_m, ..*rcm(20.0).settings() }).unwrap();
        find(&arm(), &rcm, &(trocar_m + tip_m)).unwrap_err()
    };
    let down = -Vector3::z() * 0.12;
    assert!(matches!(at(TROCAR_M, Vector3::zeros()), ReadyError::Place(RcmError::TooNear { .. })));
    assert!(matches!(at(Vector3::new(1.2, 0.0, 0.0), down), ReadyError::TooFar { .. }));
    let inside_the_foot = at(Vector3::new(0.05, 0.0, -0.3), down);
    assert!(matches!(inside_the_foot, ReadyError::NoPose { .. } | ReadyError::Unusable { .. }), "{inside_the_foot}");
}

#[test]
fn an_arm_that_does_not_move_stays_blocked_although_its_encoders_are_noisy() {
    let mut random = fastrand::Rng::with_seed(3);
    let mut inverse = started(45.0).within(JointLimits::of_arm(&ArmModel::GEN3, 0.5, 0.05));
    let held_rad = *inverse.joint_rad();
    let mut blocked = Vec::new();
    for k in 0..3000 {
        inverse.observe(&held_rad.map(|rad| rad + 1e-3 * (random.f64() - 0.5)));
        inverse.step(&(middle_m() + Vector3::x() * 0.05 * (f64::from(k) * 1e-3).min(1.0)));
        blocked.push(inverse.is_blocked());
    }
    let since = blocked.iter().position(|blocked| *blocked).unwrap();
    assert!(blocked[since..].iter().all(|blocked| *blocked), "blocked from tick {since} on");
    inverse.observe(&inverse.joint_rad().clone());
    assert!(!inverse.is_blocked(), "it has followed");
}
