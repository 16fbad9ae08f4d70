//! Inverse kinematics through the trocar, one step per tick, from where the arm is: continuous by construction.
//!
//! In: where the tip shall be (m, `kbf`), any time, however far. Out: joint angles (rad) that moved by no more than their speed
//! allows in one period, keep off their limits, and lead the shaft through the trocar. What cannot be reached in one period is
//! reached later, on the way through the trocar that turns and slides in proportion. A target that is not finite holds the arm.
//! Nothing here allocates or waits.

use nalgebra::{Vector2, Vector3};
use thiserror::Error;

use super::{
    gen3::{JOINTS, Joints, LIMIT_RAD, SPEED_RAD_S, limit_margin_rad},
    instrument::{Arm, Pose},
    posture,
    rcm::{Confined, Rcm, Shaft},
    velocity::{LENGTH_M, Parts, Task, Wish, turn_towards},
};

/// Share of the joints' greatest speed that is used; the maker's own planning limits (`ros_kortex`, hard joint limits) are 95 %.
const SPEED_SHARE: f64 = 0.95;
/// Fastest tip and fastest turn of the shaft: the maker's twist limits (`ros_kortex`, `twist_limits.yaml`), m/s and rad/s.
pub(super) const TIP_SPEED_M_S: f64 = 0.5;
/// See [`TIP_SPEED_M_S`].
pub(super) const TURN_SPEED_RAD_S: f64 = 1.74;
/// Joints stay this far from their limits, rad, so that a drive that overshoots does not fault.
pub const KEEP_OFF_RAD: f64 = 0.02;
/// Near a limit a joint approaches it at most at this rate, 1/s.
const APPROACH_PER_S: f64 = 20.0;
/// How fast the posture improves along its slope, rad/s, and which share of the joints' speed that may take.
const POSTURE_PER_S: f64 = 1.0;
const POSTURE_SHARE: f64 = 0.2;
/// A start further from the trocar than this is not one with the instrument in it, m.
pub const START_MISS_M: f64 = 5e-3;

/// Why the arm cannot start from where it is.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum StartError {
    /// The loop's period makes no sense.
    #[error("the period of the inverse kinematics is {period_s} s: it must be above 0 and at most 0.02 s")]
    Period {
        /// As given, s.
        period_s: f64,
    },
    /// The instrument is shorter than the way it shall go.
    #[error(
        "the shaft of {shaft_m} m is too short for an insertion of {insertion_max_m} m: correct the one or the other"
    )]
    ShortShaft {
        /// From the sensor to the tip, m.
        shaft_m: f64,
        /// Greatest insertion, m.
        insertion_max_m: f64,
    },
    /// A joint angle is not finite.
    #[error("joint {joint} of the arm reports no finite angle: check the arm's connection")]
    NotFinite {
        /// Counted from 1.
        joint: usize,
    },
    /// A joint is at its limit.
    #[error(
        "joint {joint} is at {angle_deg:.1} degrees, its limit is {limit_deg:.1}: move the arm off the limit by hand"
    )]
    AtLimit {
        /// Counted from 1.
        joint: usize,
        /// Its angle, degrees.
        angle_deg: f64,
        /// The furthest angle, degrees.
        limit_deg: f64,
    },
    /// The shaft does not lead through the trocar.
    #[error(
        "the shaft's axis misses the trocar by {miss_m:.4} m, at most {most_m} m are allowed: move the arm to the ready pose"
    )]
    BesideTrocar {
        /// Distance of the axis from the trocar, m.
        miss_m: f64,
        /// What is allowed, m.
        most_m: f64,
    },
    /// The tip is not in the body.
    #[error("the tip is {insertion_m:.4} m behind the trocar: insert the instrument before starting")]
    NotInserted {
        /// Along the shaft, m; negative in front of the trocar.
        insertion_m: f64,
    },
}

/// How good the pose is after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Distance of the shaft's axis from the trocar, m.
    pub axis_miss_m: f64,
    /// Distance of the tip from the permitted target, m; NaN when the target was not finite.
    pub tip_miss_m: f64,
    /// Least distance of a joint from its limit, rad.
    pub limit_margin_rad: f64,
    /// How well the joints can move the shaft in its worst direction, m/rad (a turn counts by 0.3 m); 0 is a singular pose.
    pub dexterity: f64,
    /// Share of the wished motion that the joints' speeds and limits allowed in this period, 0 to 1.
    pub granted: f64,
}

/// One period's answer.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Where the joints shall be, rad.
    pub joint_rad: Joints,
    /// The target was outside of the permitted space, and how.
    pub confined: Confined,
    /// How good the pose is.
    pub measures: Measures,
}

/// The arm as it is commanded, and the way from one target to the next.
#[derive(Clone, Debug)]
pub struct Inverse {
    arm: Arm,
    rcm: Rcm,
    period_s: f64,
    joint_rad: Joints,
    pose: Pose,
    dexterity: f64,
}

impl Inverse {
    /// Starts at these joint angles (rad), for a loop of this period (s).
    ///
    /// # Errors
    /// When the arm cannot start from there.
    pub fn new(arm: Arm, rcm: Rcm, period_s: f64, joint_rad: &Joints) -> Result<Self, StartError> {
        // Written so that NaN is refused.
        if !(period_s > 0.0 && period_s <= 0.02) {
            return Err(StartError::Period { period_s });
        }
        let insertion_max_m = rcm.settings().insertion_max_m;
        if arm.shaft_m() <= insertion_max_m {
            return Err(StartError::ShortShaft { shaft_m: arm.shaft_m(), insertion_max_m });
        }
        check_joints(joint_rad)?;
        let pose = arm.pose(joint_rad);
        let trocar_m = rcm.settings().trocar_m;
        let (miss_m, insertion_m) = (pose.axis_miss_m(&trocar_m).norm(), pose.insertion_m(&trocar_m));
        if miss_m > START_MISS_M {
            return Err(StartError::BesideTrocar { miss_m, most_m: START_MISS_M });
        }
        if insertion_m <= 0.0 {
            return Err(StartError::NotInserted { insertion_m });
        }
        Ok(Self { arm, rcm, period_s, joint_rad: *joint_rad, pose, dexterity: 0.0 })
    }

    /// Where the joints are commanded to be, rad.
    pub const fn joint_rad(&self) -> &Joints {
        &self.joint_rad
    }

    /// Where everything is at those angles.
    pub const fn pose(&self) -> &Pose {
        &self.pose
    }

    /// The trocar.
    pub const fn rcm(&self) -> &Rcm {
        &self.rcm
    }

    /// Height of elbow and wrist above the trocar, m.
    pub fn clearance_m(&self) -> f64 {
        posture::clearance_m(&self.pose, &self.rcm)
    }

    /// Moves on by one period towards a tip (m, `kbf`).
    pub fn step(&mut self, target_m: &Vector3<f64>) -> Step {
        if !target_m.iter().all(|x| x.is_finite()) {
            return self.answer(None, Confined::default(), 0.0);
        }
        let (goal, confined) = self.rcm.confine(target_m);
        let trocar_m = self.rcm.settings().trocar_m;
        let wish = self.wish(&goal, &trocar_m);
        let parts = Task::new(&self.pose, &trocar_m).solve(&wish, &posture::freedom(&self.joint_rad));
        let granted = parts.map_or(0.0, |parts| self.take(&parts));
        self.answer(Some(&goal), confined, granted)
    }

    /// What the joints shall do in this period if they could.
    fn wish(&self, goal: &Shaft, trocar_m: &Vector3<f64>) -> Wish {
        let miss_m = self.pose.axis_miss_m(trocar_m);
        let insertion_m = self.pose.insertion_m(trocar_m);
        let turn = turn_towards(&self.pose, &goal.direction);
        let slide_m = goal.insertion_m - insertion_m;
        // Turning and sliding in proportion, neither faster than it may be.
        let sweep_m = turn.norm() * insertion_m.max(goal.insertion_m);
        let tip = (TIP_SPEED_M_S * self.period_s) / sweep_m.hypot(slide_m);
        let shaft = (TURN_SPEED_RAD_S * self.period_s) / turn.norm();
        let share = tip.min(shaft).min(1.0);
        let across = self.pose.across;
        let relief =
            posture::relief(&self.arm, &self.rcm, &self.pose, &self.joint_rad) * (POSTURE_PER_S * self.period_s);
        let fastest = relief.iter().zip(SPEED_RAD_S).map(|(r, v)| r.abs() / (v * self.period_s)).fold(0.0, f64::max);
        Wish {
            at_trocar_m: -Vector2::new(miss_m.dot(&across[0]), miss_m.dot(&across[1])),
            motion_m: Vector3::new(turn.x * LENGTH_M, turn.y * LENGTH_M, slide_m) * share,
            posture_rad: relief * (POSTURE_SHARE / fastest.max(POSTURE_SHARE)),
        }
    }

    /// Moves the joints by as much of the parts as their bounds allow, the trocar first; gives the share of the motion.
    fn take(&mut self, parts: &Parts) -> f64 {
        let [least, most] = self.bounds();
        let mut step_rad = Joints::zeros();
        let mut shares = [0.0; 3];
        for (part, share) in [&parts.correction, &parts.motion, &parts.posture].into_iter().zip(&mut shares) {
            *share = share_within(part, &(least - step_rad), &(most - step_rad));
            step_rad += part * *share;
        }
        // The shares keep the bounds up to rounding; this keeps them exactly.
        self.joint_rad += step_rad.sup(&least).inf(&most);
        self.pose = self.arm.pose(&self.joint_rad);
        self.dexterity = parts.dexterity;
        shares[1]
    }

    /// Least and greatest change of each joint in this period, rad: its speed, and slower towards a limit that is near.
    fn bounds(&self) -> [Joints; 2] {
        let (mut least, mut most) = (Joints::zeros(), Joints::zeros());
        for joint in 0..JOINTS {
            let fastest = SPEED_SHARE * SPEED_RAD_S[joint] * self.period_s;
            let approach = (APPROACH_PER_S * self.period_s).min(1.0);
            let room = |way_rad: f64| (approach * (way_rad - KEEP_OFF_RAD)).clamp(0.0, fastest);
            most[joint] = room(LIMIT_RAD[joint] - self.joint_rad[joint]);
            least[joint] = -room(LIMIT_RAD[joint] + self.joint_rad[joint]);
        }
        [least, most]
    }

    fn answer(&self, goal: Option<&Shaft>, confined: Confined, granted: f64) -> Step {
        let measures = Measures {
            axis_miss_m: self.pose.axis_miss_m(&self.rcm.settings().trocar_m).norm(),
            tip_miss_m: goal.map_or(f64::NAN, |goal| (self.rcm.tip_m(goal) - self.pose.tip_m).norm()),
            limit_margin_rad: limit_margin_rad(&self.joint_rad),
            dexterity: self.dexterity,
            granted,
        };
        Step { joint_rad: self.joint_rad, confined, measures }
    }
}

fn check_joints(joint_rad: &Joints) -> Result<(), StartError> {
    for (i, (angle, limit)) in joint_rad.iter().zip(LIMIT_RAD).enumerate() {
        if !angle.is_finite() {
            return Err(StartError::NotFinite { joint: i + 1 });
        }
        if angle.abs() >= limit {
            return Err(StartError::AtLimit {
                joint: i + 1,
                angle_deg: angle.to_degrees(),
                limit_deg: limit.to_degrees(),
            });
        }
    }
    Ok(())
}

/// Greatest share (0 to 1) of a step that stays within the bounds (`least <= 0 <= most` up to rounding).
fn share_within(step: &Joints, least: &Joints, most: &Joints) -> f64 {
    let mut share: f64 = 1.0;
    for joint in 0..JOINTS {
        let bound = if step[joint] > 0.0 { most[joint] } else { least[joint] };
        // A component of nothing never holds the others back.
        if step[joint].abs() > bound.abs() {
            share = share.min((bound / step[joint]).max(0.0));
        }
    }
    share
}
