//! The null-space cost of a posture, and which way it falls: away from limits, from singular poses, and with the elbow off the patient.
//!
//! The loop follows the slope of [`null_space_cost`] in what the shaft's motion leaves free. Angles in rad, lengths in m, in `world`.

use super::{
    gen3::{JOINTS, Joints, LIMIT_RAD},
    instrument::{Arm, Pose},
    rcm::Rcm,
    velocity::Task,
};

/// Distance from a limit at which a joint begins to be kept away from it, rad.
pub(super) const SOFT_RAD: f64 = 0.35;
/// Height above the trocar below which elbow and wrist are pushed up, m: half a link's thickness, a drape and a margin.
pub(super) const CLEARANCE_M: f64 = 0.12;
/// What the two other terms weigh beside the limits'.
const MANIPULABILITY_WEIGHT: f64 = 0.2;
const CLEARANCE_WEIGHT: f64 = 0.5;
/// Manipulability squared that counts as nothing (m/rad to the tenth): keeps the logarithm finite.
const LOST: f64 = 1e-14;
/// Step of the differences, rad.
const STEP_RAD: f64 = 1e-6;

/// Joints whose places (elbow, wrist) must stay above the patient.
const HIGH_JOINTS: [usize; 2] = [3, 5];

/// Cost of a posture: zero-based for limits and clearance, the logarithm of manipulability for the rest.
fn null_space_cost(pose: &Pose, joint_rad: &Joints, rcm: &Rcm) -> f64 {
    let limits: f64 = joint_rad.iter().zip(LIMIT_RAD).map(|(q, limit)| lack(limit - q.abs(), SOFT_RAD)).sum();
    let low: f64 = heights_m(pose, rcm).iter().map(|height_m| lack(*height_m, CLEARANCE_M)).sum();
    let squared = Task::new(pose, &rcm.settings().trocar_m).manipulability_squared().max(0.0);
    limits + CLEARANCE_WEIGHT * low - 0.5 * MANIPULABILITY_WEIGHT * (squared + LOST).ln()
}

/// Half the square of what is missing of `enough`, as a share of it.
fn lack(have: f64, enough: f64) -> f64 {
    0.5 * ((enough - have).max(0.0) / enough).powi(2)
}

fn heights_m(pose: &Pose, rcm: &Rcm) -> [f64; HIGH_JOINTS.len()] {
    HIGH_JOINTS.map(|joint| (rcm.settings().trocar_m - pose.chain.origin_m[joint]).dot(rcm.inward()))
}

/// How far elbow and wrist are above the trocar (against the direction into the body), m.
pub(super) fn clearance_m(pose: &Pose, rcm: &Rcm) -> f64 {
    heights_m(pose, rcm).into_iter().fold(f64::INFINITY, f64::min)
}

/// The direction in which the cost falls, per rad.
pub(super) fn relief(arm: &Arm, rcm: &Rcm, pose: &Pose, joint_rad: &Joints) -> Joints {
    let here = null_space_cost(pose, joint_rad, rcm);
    let mut relief = Joints::zeros();
    for joint in 0..JOINTS {
        let mut beside_rad = *joint_rad;
        beside_rad[joint] += STEP_RAD;
        relief[joint] = (here - null_space_cost(&arm.pose(&beside_rad), &beside_rad, rcm)) / STEP_RAD;
    }
    relief
}

/// How freely each joint may be used: 1 far from its limit, next to nothing at it, smoothly in between.
pub(super) fn freedom(joint_rad: &Joints) -> Joints {
    let mut freedom = Joints::repeat(1.0);
    for joint in 0..JOINTS {
        let share = ((LIMIT_RAD[joint] - joint_rad[joint].abs()) / SOFT_RAD).clamp(0.0, 1.0);
        freedom[joint] = (share * share * (3.0 - 2.0 * share)).max(1e-4);
    }
    freedom
}
