//! The task of a simulated hand: minimum-jerk movements, and the state of the gripper during each.

use nalgebra::Vector3;
use nima_machine::rig::TaskAction;

use crate::scene::SceneHand as HandConfig;

/// Height above the targets at which the hand moves between them, m.
pub(super) const CARRY_HEIGHT_M: f64 = 0.015;

/// One movement of the task: minimum jerk from one point to another in a given time.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandMove {
    pub(super) from_m: Vector3<f64>,
    pub(super) to_m: Vector3<f64>,
    pub(super) seconds: f64,
}

/// One part of a hand's task.
#[derive(Clone, Copy, Debug)]
pub(super) struct HandTaskPart {
    pub(super) way: HandMove,
    /// Opening of the gripper at its beginning and at its end, rad.
    pub(super) grip_rad: [f64; 2],
    pub(super) then: Option<TaskAction>,
}

impl HandMove {
    /// Returns the intended position (m) and velocity (m/s) after `t_s` of the move (Flash and Hogan 1985).
    pub(super) fn at(&self, t_s: f64) -> (Vector3<f64>, Vector3<f64>) {
        if self.seconds <= 0.0 {
            return (self.to_m, Vector3::zeros());
        }
        let s = (t_s / self.seconds).clamp(0.0, 1.0);
        let way = self.to_m - self.from_m;
        let fraction = s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
        let speed = 30.0 * s * s * (1.0 - s) * (1.0 - s) / self.seconds;
        (self.from_m + way * fraction, way * speed)
    }
}

impl HandTaskPart {
    /// Returns the opening of the gripper after `t_s`, rad.
    pub(super) fn grip_rad_at(&self, t_s: f64) -> f64 {
        let [from_rad, to_rad] = self.grip_rad;
        let fraction = if self.way.seconds > 0.0 { (t_s / self.way.seconds).clamp(0.0, 1.0) } else { 1.0 };
        from_rad + (to_rad - from_rad) * fraction
    }
}

/// Returns the repeated task: above each target move down, press, drag a little, hold, lift, and move on to the next.
pub(super) fn repeated_task(hand: &HandConfig, targets_m: &[Vector3<f64>]) -> Vec<HandTaskPart> {
    let lift = Vector3::new(0.0, 0.0, CARRY_HEIGHT_M);
    let press = Vector3::new(0.0, 0.0, -hand.press_depth_m);
    let drag = Vector3::new(hand.drag_m, -0.5 * hand.drag_m, 0.0);
    let mut parts = Vec::with_capacity(targets_m.len() * 5);
    for (i, &target) in targets_m.iter().enumerate() {
        let next = targets_m[(i + 1) % targets_m.len()];
        let stations =
            [target + lift, target + press, target + press + drag, target + press + drag, target + lift, next + lift];
        let seconds = [hand.press_s, hand.hold_s, hand.hold_s, hand.press_s, hand.reach_s];
        parts.extend(stations.windows(2).zip(seconds).map(|(pair, seconds)| HandTaskPart {
            way: HandMove { from_m: pair[0], to_m: pair[1], seconds },
            grip_rad: [0.0; 2],
            then: None,
        }));
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minimum_jerk_move_starts_and_ends_at_rest() {
        let way = HandMove { from_m: Vector3::zeros(), to_m: Vector3::x(), seconds: 2.0 };
        assert_eq!(way.at(0.0), (Vector3::zeros(), Vector3::zeros()));
        let (end, speed) = way.at(2.0);
        assert!((end - Vector3::x()).norm() < 1e-12 && speed.norm() < 1e-12);
        let (middle, peak) = way.at(1.0);
        assert!(
            (middle.x - 0.5).abs() < 1e-12 && (peak.x - 1.875 / 2.0).abs() < 1e-12,
            "peak speed is 1.875 of the mean"
        );
    }
}
