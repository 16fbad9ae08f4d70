//! Searches a good starting pose from many random starts and tests it over the whole permitted space. The search takes
//! about a second, so it must not run in the loop.
//!
//! Takes the arm, the trocar and the position of the tip (m, `world`). Returns joint angles (rad) and the fraction of
//! the permitted space that the arm can reach from there while engaged, or the reason why the position cannot be
//! reached. Deterministic.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use thiserror::Error;

use super::{
    instrument::Arm,
    inverse::{Inverse, PoseQuality},
    joint_chain::Joints,
    posture,
    rcm::{Rcm, RcmError, RcmShaft},
    start::ArmStartError,
    velocity::{MotionRequest, VelocityTask, towards},
};

/// Random starts of the search. Many, because an arm with seven joints has many poses for one tip, and Newton's method
/// finds the nearest of them only.
/// Runs once, when a rig is set up, so its time matters less than a missed pose.
const STARTS: usize = 600;
/// Newton steps from each start.
/// A start that has not converged by then is given up; others follow.
const STEPS: usize = 80;
/// Number of poses that are tested over the permitted space, because each test moves the arm over the whole space,
/// which takes most of the time.
/// Sorted by `ease` before, so that the best poses are among the tested ones.
const CANDIDATES: usize = 8;
/// A pose below these values is not tested: distance from a joint limit (rad), dexterity (m/rad). Design choice.
const MIN_MARGIN_RAD: f64 = 0.1;
/// See [`MIN_MARGIN_RAD`].
/// The threshold of damping in the loop (`DAMPED_BELOW`): beyond it the loop follows exactly.
const MIN_DEXTERITY: f64 = 0.05;
/// Period of the test motions, s: longer than the loop's period to save time, but short enough to keep the shaft in the
/// trocar.
const TRY_PERIOD_S: f64 = 0.004;
/// Distance from the goal at which the tip has arrived, m.
/// A tenth of a millimetre: below the calibration errors of an arm, above the rest of a numerical approach.
const ARRIVED_M: f64 = 1e-4;
/// Time limit for one goal of the test, periods: 6 s at [`TRY_PERIOD_S`], enough to cross the permitted space several
/// times at the speed limit of the tip.
const TRY_PERIODS: usize = 1500;
/// Number of directions around the cone that are tested, so that the largest gap between two is 45 degrees.
const AROUND: usize = 8;

#[derive(Clone, Copy, Debug)]
pub struct Ready {
    /// Joint angles, rad, each within half a turn of the middle of its range.
    pub joint_rad: Joints,
    /// Fraction of the tested goals (edge and middle of the cone, at minimum and maximum insertion) that can be reached
    /// from here.
    pub reached: f64,
    /// Smallest distance of a joint from its limit during the test, rad.
    pub limit_margin_rad: f64,
    pub dexterity: f64,
    /// Smallest height of elbow and wrist above the trocar during the test, m.
    pub clearance_m: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ReadyError {
    #[error("the position of the instrument is not permitted")]
    Place(#[source] RcmError),
    #[error("the arm cannot start from the ready pose")]
    Start(#[source] ArmStartError),
    #[error(
        "the flange is out of reach: {needed_m:.3} m from the arm's shoulder, the limit is {reach_m:.3} m; move the arm nearer"
    )]
    TooFar { needed_m: f64, reach_m: f64 },
    #[error(
        "no pose reaches this tip and shaft (best miss {best_miss_m:.4} m in {starts} starts): the trocar is too close to the arm's base; move the arm"
    )]
    NoPose {
        /// Smallest remaining error of tip and direction, m.
        best_miss_m: f64,
        starts: usize,
    },
    #[error(
        "none of the {found} poses found is usable: {at_limits} at a joint limit, {singular} nearly singular, {low} with elbow or wrist too low; \
         move the arm or the trocar"
    )]
    Unusable {
        found: usize,
        /// Number of poses too close to a joint limit.
        at_limits: usize,
        /// Number of poses in which the arm cannot move the shaft freely.
        singular: usize,
        /// Number of poses in which elbow or wrist would touch the patient.
        low: usize,
    },
}

/// Finds a pose with the shaft through the trocar and the tip at `tip_m`.
///
/// # Errors
/// [`ReadyError`] if the position is not permitted or out of reach, or every pose is at a limit, singular or too low.
pub fn find(arm: &Arm, rcm: &Rcm, tip_m: &Vector3<f64>) -> Result<Ready, ReadyError> {
    let shaft = rcm.resolve(tip_m).map_err(ReadyError::Place)?;
    check_reach(arm, tip_m, &shaft)?;
    let candidates = candidates(arm, rcm, tip_m, &shaft)?;
    let mut best: Option<Ready> = None;
    for joint_rad in candidates {
        let ready = tried(arm, rcm, tip_m, &joint_rad).map_err(ReadyError::Start)?;
        if best.is_none_or(|best| worth(&ready) > worth(&best)) {
            best = Some(ready);
        }
    }
    best.ok_or(ReadyError::NoPose { best_miss_m: f64::INFINITY, starts: STARTS })
}

/// Returns the rank of a pose: first by the reachable fraction, then by the ease of reaching it.
fn worth(ready: &Ready) -> f64 {
    ready.reached + 0.1 * ease(ready.limit_margin_rad, ready.dexterity, ready.clearance_m)
}

/// Returns how easily the goals are reached, 0 (not usable) to 1 (ample margins).
fn ease(limit_margin_rad: f64, dexterity: f64, clearance_m: f64) -> f64 {
    let fractions = [limit_margin_rad / 0.5, dexterity / 0.2, clearance_m / (2.0 * posture::CLEARANCE_M)];
    fractions.into_iter().fold(1.0, f64::min).max(0.0)
}

/// Checks that the flange can be reached: it lies on a circle about the shaft's axis (its rotation is free), part of
/// which must be within the arm's reach.
fn check_reach(arm: &Arm, tip_m: &Vector3<f64>, shaft: &RcmShaft) -> Result<(), ReadyError> {
    let shoulder_m = (arm.world_from_base() * Point3::from(arm.model().shoulder_m)).coords;
    let s1_from_flange = arm.flange_from_s1().inverse().translation.vector;
    let centre_m = tip_m + shaft.direction * (s1_from_flange.z - arm.shaft_m());
    let needed_m = (centre_m - shoulder_m).norm() - s1_from_flange.xy().norm();
    let reach_m = arm.model().reach_m;
    if needed_m > reach_m { Err(ReadyError::TooFar { needed_m, reach_m }) } else { Ok(()) }
}

fn candidates(arm: &Arm, rcm: &Rcm, tip_m: &Vector3<f64>, shaft: &RcmShaft) -> Result<Vec<Joints>, ReadyError> {
    let model = arm.model();
    let mut random = fastrand::Rng::with_seed(0x6e33);
    let mut good: Vec<(f64, Joints)> = Vec::new();
    let mut found = 0;
    let mut at_limits = 0;
    let mut singular = 0;
    let mut low = 0;
    let mut best_miss_m = f64::INFINITY;
    for _ in 0..STARTS {
        let start = model.within_ranges(|| 2.0 * random.f64() - 1.0);
        let (joint_rad, miss_m) = converged(arm, tip_m, shaft, start);
        best_miss_m = best_miss_m.min(miss_m);
        if miss_m > 1e-9 {
            continue;
        }
        found += 1;
        let pose = arm.pose(&joint_rad);
        let margin_rad = model.limit_margin_rad(&joint_rad);
        let clearance_m = posture::clearance_m(model, &pose, rcm);
        let dexterity = dexterity(arm, rcm, &joint_rad);
        if margin_rad < MIN_MARGIN_RAD {
            at_limits += 1;
        } else if dexterity < MIN_DEXTERITY {
            singular += 1;
        } else if clearance_m < posture::CLEARANCE_M {
            low += 1;
        } else {
            good.push((ease(margin_rad, dexterity, clearance_m), joint_rad));
        }
    }
    if found == 0 {
        return Err(ReadyError::NoPose { best_miss_m, starts: STARTS });
    }
    if good.is_empty() {
        return Err(ReadyError::Unusable { found, at_limits, singular, low });
    }
    good.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut distinct: Vec<Joints> = Vec::new();
    for (_, joint_rad) in good {
        if distinct.len() < CANDIDATES
            && distinct.iter().all(|other| apart_rad(model.joints(), other, &joint_rad) > 0.5)
        {
            distinct.push(joint_rad);
        }
    }
    Ok(distinct)
}

/// Returns the largest difference of any joint along the shorter direction, excluding the last joint, which mainly
/// rotates the shaft about its own axis.
fn apart_rad(joints: usize, a: &Joints, b: &Joints) -> f64 {
    (a - b).iter().take(joints - 1).map(|difference| wrapped(*difference).abs()).fold(0.0, f64::max)
}

fn wrapped(angle_rad: f64) -> f64 {
    angle_rad - TAU * (angle_rad / TAU).round()
}

/// Solves by Newton's method from a random start; returns joint angles within half a turn of the middles of their
/// ranges, and the remaining error of tip and direction, m.
fn converged(arm: &Arm, tip_m: &Vector3<f64>, shaft: &RcmShaft, start_rad: Joints) -> (Joints, f64) {
    let mut joint_rad = start_rad;
    let mut left_m = f64::INFINITY;
    for _ in 0..STEPS {
        let (step_rad, miss_m) = towards(&arm.pose(&joint_rad), tip_m, &shaft.direction);
        left_m = miss_m;
        if left_m < 1e-12 {
            break;
        }
        joint_rad += step_rad * (0.4 / step_rad.amax().max(0.4));
    }
    (arm.model().wrapped(&joint_rad), left_m)
}

fn dexterity(arm: &Arm, rcm: &Rcm, joint_rad: &Joints) -> f64 {
    let task = VelocityTask::new(&arm.pose(joint_rad), &rcm.settings().trocar_m);
    task.solve(&MotionRequest::default(), &posture::freedom(arm.model(), joint_rad))
        .map_or(0.0, |parts| parts.dexterity)
}

/// Lets a pose settle, then moves from it to goals in the whole permitted space and back.
fn tried(arm: &Arm, rcm: &Rcm, tip_m: &Vector3<f64>, joint_rad: &Joints) -> Result<Ready, ArmStartError> {
    let mut settled = Inverse::new(*arm, *rcm, TRY_PERIOD_S, joint_rad)?;
    for _ in 0..TRY_PERIODS {
        settled.step(tip_m);
    }
    let start_rad = arm.model().wrapped(settled.joint_rad());
    let mut ready = Ready {
        joint_rad: start_rad,
        reached: 0.0,
        limit_margin_rad: f64::INFINITY,
        dexterity: f64::INFINITY,
        clearance_m: f64::INFINITY,
    };
    let places = trial_places(rcm);
    let mut reached = 0;
    for place_m in &places {
        let mut inverse = Inverse::new(*arm, *rcm, TRY_PERIOD_S, &start_rad)?;
        if went(&mut inverse, place_m, &mut ready) && went(&mut inverse, tip_m, &mut ready) {
            reached += 1;
        }
    }
    ready.reached = f64::from(reached) / places.len() as f64;
    Ok(ready)
}

/// Moves to a goal and stores the worst values in `ready`. Returns whether the goal was reached.
fn went(inverse: &mut Inverse, place_m: &Vector3<f64>, ready: &mut Ready) -> bool {
    for _ in 0..TRY_PERIODS {
        let PoseQuality { tip_miss_m, limit_margin_rad, dexterity, .. } = inverse.step(place_m).measures;
        ready.limit_margin_rad = ready.limit_margin_rad.min(limit_margin_rad);
        ready.dexterity = ready.dexterity.min(dexterity);
        ready.clearance_m = ready.clearance_m.min(inverse.clearance_m());
        if tip_miss_m < ARRIVED_M {
            return true;
        }
    }
    false
}

/// Returns the middle and the edge of the cone, each at minimum and maximum insertion, m.
pub(super) fn trial_places(rcm: &Rcm) -> Vec<Vector3<f64>> {
    let settings = rcm.settings();
    let inward = *rcm.inward();
    let other = if inward.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let side = inward.cross(&other).normalize();
    let up = inward.cross(&side);
    // Slightly inside the edge, so that rounding does not put it outside.
    let (sin, cos) = libm::sincos(settings.cone_deg.to_radians() * 0.999);
    let rim = (0..AROUND).map(|i| {
        let (s, c) = libm::sincos(TAU * i as f64 / AROUND as f64);
        inward * cos + (side * c + up * s) * sin
    });
    let directions: Vec<Vector3<f64>> = std::iter::once(inward).chain(rim).collect();
    let depths_m = [settings.insertion_min_m, settings.insertion_max_m];
    let place_m = |direction: &Vector3<f64>, insertion_m| rcm.tip_m(&RcmShaft { direction: *direction, insertion_m });
    directions.iter().flat_map(|direction| depths_m.map(|insertion_m| place_m(direction, insertion_m))).collect()
}
