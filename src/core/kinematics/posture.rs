//! Cost of a posture and its gradient: it keeps the joints away from limits and singular poses, and the elbow off the
//! patient.
//!
//! The loop descends [`null_space_cost`] in the null space of the shaft's motion. Angles in rad, lengths in m, in
//! `world`.

use super::{
    arm_model::{ArmModel, JOINTS},
    instrument::{Arm, InstrumentPose},
    joint_chain::Joints,
    rcm::Rcm,
    velocity::VelocityTask,
};

/// Distance from a limit at which the cost of a joint begins, rad. Design choice.
/// About 20 degrees: a larger value restricts the posture far from any limit.
pub(super) const SOFT_RAD: f64 = 0.35;
/// Height above the trocar below which elbow and wrist are pushed up, m: half the thickness of a link, plus a drape and
/// a margin.
/// A smaller value lets the elbow touch the patient, a larger one refuses poses that an arm needs near its base.
pub(super) const CLEARANCE_M: f64 = 0.12;
/// Weights of the other two terms relative to the limit term. Design choice.
const MANIPULABILITY_WEIGHT: f64 = 0.2;
const CLEARANCE_WEIGHT: f64 = 0.5;
/// Smallest value of the squared manipulability ((m/rad)^10): keeps the logarithm finite.
const LOST: f64 = 1e-14;
/// Step of the numerical gradient, rad. Between rounding, which grows for smaller steps, and curvature, which spoils
/// larger ones.
const STEP_RAD: f64 = 1e-6;

/// Returns the cost of a posture: terms for joint limits and clearance, which are zero far from them, and the logarithm
/// of the manipulability.
fn null_space_cost(model: &ArmModel, pose: &InstrumentPose, joint_rad: &Joints, rcm: &Rcm) -> f64 {
    let margins_rad = (0..model.joints).map(|joint| model.margin_rad(joint, joint_rad[joint]));
    let limits: f64 = margins_rad.map(|margin_rad| lack(margin_rad, SOFT_RAD)).sum();
    let low: f64 = heights_m(model, pose, rcm).iter().map(|height_m| lack(*height_m, CLEARANCE_M)).sum();
    let squared = VelocityTask::new(pose, &rcm.settings().trocar_m).manipulability_squared().max(0.0);
    limits + CLEARANCE_WEIGHT * low - 0.5 * MANIPULABILITY_WEIGHT * libm::log(squared + LOST)
}

/// Returns half the squared deficit of `have` against `enough`, relative to `enough`.
fn lack(have: f64, enough: f64) -> f64 {
    let deficit = (enough - have).max(0.0) / enough;
    0.5 * (deficit * deficit)
}

fn heights_m(model: &ArmModel, pose: &InstrumentPose, rcm: &Rcm) -> [f64; 2] {
    model.high_joints.map(|joint| (rcm.settings().trocar_m - pose.chain.origin_m[joint]).dot(rcm.inward()))
}

/// Returns the height of elbow and wrist above the trocar (against the direction into the body), m.
pub(super) fn clearance_m(model: &ArmModel, pose: &InstrumentPose, rcm: &Rcm) -> f64 {
    heights_m(model, pose, rcm).into_iter().fold(f64::INFINITY, f64::min)
}

/// Returns the negative gradient of the cost, per rad.
pub(super) fn relief(arm: &Arm, rcm: &Rcm, pose: &InstrumentPose, joint_rad: &Joints) -> Joints {
    let model = arm.model();
    let here = null_space_cost(model, pose, joint_rad, rcm);
    let mut relief = Joints::zeros();
    for joint in 0..model.joints {
        let mut beside_rad = *joint_rad;
        beside_rad[joint] += STEP_RAD;
        relief[joint] = (here - null_space_cost(model, &arm.pose(&beside_rad), &beside_rad, rcm)) / STEP_RAD;
    }
    relief
}

/// Returns the weight of each joint: 1 far from its limit, almost 0 at it, smooth in between.
pub(super) fn freedom(model: &ArmModel, joint_rad: &Joints) -> Joints {
    let mut freedom = Joints::repeat(1.0);
    for joint in 0..JOINTS {
        let fraction = (model.margin_rad(joint, joint_rad[joint]) / SOFT_RAD).clamp(0.0, 1.0);
        freedom[joint] = (fraction * fraction * (3.0 - 2.0 * fraction)).max(1e-4);
    }
    freedom
}
