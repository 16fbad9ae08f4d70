//! The task of a hand that leads its loop along a wire in short movements, each with a small lateral error of aim.

use nalgebra::Vector3;
use nima_core::noise::Noise;

use crate::{
    hand_task::{HandMove, HandTaskPart},
    physics::{SmoothCurve, WireSetting},
    scene::SceneHand,
};

/// Distance along the wire per movement, m, and speed, m/s.
const MOVEMENT_M: f64 = 0.009;
const SPEED_M_S: f64 = 0.02;
/// Start position of the hand, in front of the free end of the wire, m.
const BEFORE_M: f64 = 0.01;
/// End position beyond the goal, m.
const BEHIND_M: f64 = 0.002;
/// Rest after the task, s.
const DONE_S: f64 = 1e6;
/// Makes the errors of aim independent of the other random sequences of the seed.
const LOT: u64 = 0x3_1e5;

/// Returns the movements along the wire.
pub(super) fn way(setting: &WireSetting, hand: &SceneHand, seed: u64) -> Vec<HandTaskPart> {
    let curve = setting.curve();
    let goal_m = (curve.given_m(setting.goal_point) + BEHIND_M).min(curve.length_m());
    let steps = (goal_m / MOVEMENT_M).ceil().max(1.0) as u32;
    let mut lot = Noise::new(seed ^ LOT);
    let mut position_m = before(&curve);
    let mut parts = vec![part(position_m, position_m, hand.hold_s)];
    for step in 0..=steps {
        let fraction = f64::from(step) / f64::from(steps);
        // At the goal there is no aiming error, because the loop must reach it.
        let error_m = if step < steps { hand.aim_error_m } else { 0.0 };
        let to_m = curve.at(goal_m * fraction)
            + beside(&curve, goal_m * fraction) * error_m * lot.gaussian()
            + Vector3::z() * (error_m * lot.gaussian());
        parts.push(part(position_m, to_m, (to_m - position_m).norm() / SPEED_M_S));
        position_m = to_m;
    }
    parts.push(part(position_m, position_m, DONE_S));
    parts
}

fn part(from_m: Vector3<f64>, to_m: Vector3<f64>, seconds: f64) -> HandTaskPart {
    HandTaskPart { way: HandMove { from_m, to_m, seconds: seconds.max(0.05) }, grip_rad: [0.0; 2], then: None }
}

/// Returns a position in front of the free end, in the direction in which the wire begins.
fn before(curve: &SmoothCurve) -> Vector3<f64> {
    let end_m = curve.at(0.0);
    let into = (curve.at(1e-3) - end_m).try_normalize(1e-9).unwrap_or_else(Vector3::x);
    end_m - into * BEFORE_M
}

fn beside(curve: &SmoothCurve, along_m: f64) -> Vector3<f64> {
    let along = curve.at(along_m + 5e-4) - curve.at(along_m - 5e-4);
    Vector3::z().cross(&along).try_normalize(1e-9).unwrap_or_else(Vector3::y)
}
