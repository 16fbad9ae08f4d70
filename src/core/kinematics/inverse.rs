//! Inverse kinematics through the trocar, one step per tick from the present joint angles; the result is continuous.
//!
//! Takes the target of the tip (m, `world`), at any time and any distance. Returns joint angles (rad) within the active
//! [`JointLimits`], clear of the ends of their ranges, with the shaft through the trocar. A target that is too far for
//! one period is reached later: the shaft rotates and slides in proportion along a path through the trocar, and every
//! limit slows all joints by a common factor. A target that is not finite brakes the arm. Nothing here allocates or
//! waits.

use nalgebra::{Vector2, Vector3};

use super::{
    arm_model::JOINTS,
    instrument::{Arm, InstrumentPose},
    joint_chain::Joints,
    limits::JointLimits,
    posture,
    rcm::{Rcm, RcmCorrection, RcmShaft},
    speed_scale,
    start::{ArmStartError, check_joints},
    velocity::{LENGTH_M, MotionRequest, StepParts, VelocityTask, turn_towards},
};

/// Fraction of the joints' speed limits that is used for motion; the manufacturer's planning limits (`ros_kortex`, hard
/// joint limits) are 95 %. The remainder is reserved for keeping the shaft in the trocar while braking.
const SPEED_FRACTION: f64 = 0.95;
/// Maximum speed of the tip and of the shaft's rotation: the manufacturer's twist limits (`ros_kortex`,
/// `twist_limits.yaml`), m/s and rad/s.
pub(super) const TIP_SPEED_M_S: f64 = 0.5;
/// See [`TIP_SPEED_M_S`].
pub(super) const TURN_SPEED_RAD_S: f64 = 1.74;
/// Distance that joints keep from their limits, rad, so that an overshooting drive does not report a fault.
pub const KEEP_OFF_RAD: f64 = 0.02;
/// Near a limit, the speed of a joint is at most this factor times its distance from the limit, 1/s. Design choice.
/// 20 per second: the last 0.07 rad before a limit are slowed down (1.4 rad/s over 20/s).
const APPROACH_PER_S: f64 = 20.0;
/// Fraction of the acceleration used for stopping at a target or a joint limit; the remainder is for the curvature of
/// the path.
/// Larger values leave the curvature of the path without acceleration, smaller ones start to brake earlier.
const BRAKING_FRACTION: f64 = 0.5;
/// Averaging time of the target's own motion, s, so that tremor and noise of the handle are not followed.
/// Longer averages make the tip lag behind a moving target, shorter ones follow the steps of the handle's encoder.
const TARGET_MOTION_S: f64 = 0.005;
/// Speed of the posture optimisation along the gradient, rad/s, and the fraction of the joint speed that it may use.
/// Design choice.
/// Larger values move the elbow visibly while the tip rests; smaller ones leave a posture near a limit for longer.
const POSTURE_PER_S: f64 = 1.0;
const POSTURE_FRACTION: f64 = 0.2;
/// A blocked arm is free again when every joint is within this fraction of the permitted lead. Without this margin, the
/// noise of the encoders would free it for single ticks.
const FREE_FRACTION: f64 = 0.8;
/// If the shaft misses the trocar by more than this at the start, m, the instrument is not in the trocar.
/// A larger miss is a wrong trocar or a wrong calibration, which the correction must not pull straight.
pub const START_MISS_M: f64 = 5e-3;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseQuality {
    /// Distance of the shaft's axis from the trocar, m.
    pub axis_miss_m: f64,
    /// Distance of the tip from the permitted target, m; NaN if the target was not finite.
    pub tip_miss_m: f64,
    /// Smallest distance of a joint from its limit, rad.
    pub limit_margin_rad: f64,
    /// Ability of the joints to move the shaft in its worst direction, m/rad (rotation is weighted with 0.3 m); 0 is a
    /// singular pose.
    pub dexterity: f64,
    /// Fraction of the planned motion that the limits allowed in this period, 0 to 1.
    pub granted: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct InverseStep {
    pub joint_rad: Joints,
    pub confined: RcmCorrection,
    pub measures: PoseQuality,
}

/// The commanded state of the arm; plans the motion from one target to the next.
///
/// The tip is moved 20 mm sideways; the shaft stays in the trocar all the time:
///
/// ```
/// use nalgebra::Vector3;
/// use nima_core::kinematics::{Arm, ArmSettings, Inverse, Rcm, RcmSettings, find};
///
/// let zero = Vector3::zeros();
/// let arm = Arm::new(&ArmSettings { base_m: zero, base_deg: zero, sensor_m: zero, sensor_deg: zero, shaft_m: 0.4 })?;
/// let rcm = Rcm::new(&RcmSettings {
///     trocar_m: Vector3::new(0.45, 0.0, 0.12),
///     inward: Vector3::new(0.0, 0.0, -1.0),
///     cone_deg: 45.0,
///     insertion_min_m: 0.02,
///     insertion_max_m: 0.2,
/// })?;
/// let start_m = Vector3::new(0.45, 0.0, 0.02);
/// let ready = find(&arm, &rcm, &start_m)?;
/// let mut inverse = Inverse::new(arm, rcm, 1e-3, &ready.joint_rad)?;
/// let goal_m = start_m + Vector3::new(0.02, 0.0, 0.0);
/// for _ in 0..2000 {
///     let step = inverse.step(&goal_m);
///     assert!(step.measures.axis_miss_m < 1e-4, "{:?}", step.measures);
/// }
/// assert!((inverse.pose().tip_m - goal_m).norm() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Inverse {
    arm: Arm,
    rcm: Rcm,
    period_s: f64,
    limits: JointLimits,
    /// Maximum change of each joint's step from one period to the next, rad.
    change_rad: Joints,
    joint_rad: Joints,
    pose: InstrumentPose,
    dexterity: f64,
    moved_rad: Joints,
    /// Difference between command and measured angle, rad.
    ahead_rad: Joints,
    blocked: bool,
    /// Last target, and its motion per period: rotation times [`LENGTH_M`] and sliding inwards, m.
    last_goal: Option<RcmShaft>,
    target_motion_m: Vector3<f64>,
}

impl Inverse {
    /// Starts from these joint angles (rad), for a loop of this period (s).
    ///
    /// # Errors
    /// [`ArmStartError`] if the arm cannot start from there.
    pub fn new(arm: Arm, rcm: Rcm, period_s: f64, joint_rad: &Joints) -> Result<Self, ArmStartError> {
        // Written so that NaN is rejected too.
        if !(period_s > 0.0 && period_s <= 0.02) {
            return Err(ArmStartError::Period { period_s });
        }
        let insertion_max_m = rcm.settings().insertion_max_m;
        if arm.shaft_m() <= insertion_max_m {
            return Err(ArmStartError::ShortShaft { shaft_m: arm.shaft_m(), insertion_max_m });
        }
        check_joints(arm.model(), joint_rad)?;
        let pose = arm.pose(joint_rad);
        let trocar_m = rcm.settings().trocar_m;
        let miss_m = pose.axis_miss_m(&trocar_m).norm();
        let insertion_m = pose.insertion_m(&trocar_m);
        if miss_m > START_MISS_M {
            return Err(ArmStartError::BesideTrocar { miss_m, max_m: START_MISS_M });
        }
        if insertion_m <= 0.0 {
            return Err(ArmStartError::NotInserted { insertion_m });
        }
        let inverse = Self {
            arm,
            rcm,
            period_s,
            limits: JointLimits::speed_only(arm.model()),
            change_rad: Joints::repeat(f64::INFINITY),
            joint_rad: *joint_rad,
            pose,
            dexterity: 0.0,
            moved_rad: Joints::zeros(),
            ahead_rad: Joints::zeros(),
            blocked: false,
            last_goal: None,
            target_motion_m: Vector3::zeros(),
        };
        Ok(inverse)
    }

    /// Replaces the arm's plain speed limits by these limits.
    #[must_use]
    pub fn within(self, limits: JointLimits) -> Self {
        Self { limits, change_rad: limits.acceleration_rad_s2 * (self.period_s * self.period_s), ..self }
    }

    /// Updates the measured joint angles (rad, finite): a joint that is too far behind its command is not commanded
    /// farther away.
    pub fn observe(&mut self, measured_rad: &Joints) {
        self.ahead_rad = self.joint_rad - measured_rad;
        let limit_rad = self.limits.lead_rad * if self.blocked { FREE_FRACTION } else { 1.0 };
        self.blocked = self.ahead_rad.iter().any(|ahead_rad| ahead_rad.abs() >= limit_rad);
    }

    /// Returns whether a joint is so far from its command that the plan waits for it: the arm is blocked, or slower than
    /// its limits say.
    pub const fn is_blocked(&self) -> bool {
        self.blocked
    }

    pub fn is_still(&self) -> bool {
        self.moved_rad == Joints::zeros()
    }

    pub const fn joint_rad(&self) -> &Joints {
        &self.joint_rad
    }

    pub const fn pose(&self) -> &InstrumentPose {
        &self.pose
    }

    pub const fn rcm(&self) -> &Rcm {
        &self.rcm
    }

    /// Returns the height of elbow and wrist above the trocar, m.
    pub fn clearance_m(&self) -> f64 {
        posture::clearance_m(self.arm.model(), &self.pose, &self.rcm)
    }

    /// Advances by one period towards a tip position (m, `world`).
    pub fn step(&mut self, target_m: &Vector3<f64>) -> InverseStep {
        if !target_m.iter().all(|x| x.is_finite()) {
            return self.brake();
        }
        let (goal, confined) = self.rcm.confine(target_m);
        let wish = self.wish(&goal);
        let granted = self.solve(&wish).map_or(0.0, |parts| self.take(&parts, &wish, goal.insertion_m));
        self.answer(Some(&goal), confined, granted)
    }

    /// Slows down along a path through the trocar, then holds.
    pub fn brake(&mut self) -> InverseStep {
        self.last_goal = None;
        self.target_motion_m = Vector3::zeros();
        if self.moved_rad.iter().zip(&self.change_rad).all(|(moved, change)| moved.abs() <= *change) {
            self.moved_rad = Joints::zeros();
        } else {
            let wish = MotionRequest {
                at_trocar_m: self.to_trocar_m(),
                moved_rad: self.moved_rad,
                ..MotionRequest::default()
            };
            if let Some(parts) = self.solve(&wish) {
                let correction = parts.correction * self.correction_fraction(&parts, &self.bounds());
                let coast = parts.coast + correction;
                self.go(speed_scale::towards(&self.moved_rad, &coast, &correction, &self.change_rad));
            }
        }
        self.answer(None, RcmCorrection::default(), 0.0)
    }

    /// Returns the components of the step; `None` if they cannot be computed, in which case the arm holds.
    fn solve(&mut self, wish: &MotionRequest) -> Option<StepParts> {
        let task = VelocityTask::new(&self.pose, &self.rcm.settings().trocar_m);
        let parts = task.solve(wish, &posture::freedom(self.arm.model(), &self.joint_rad));
        match &parts {
            Some(parts) => self.dexterity = parts.dexterity,
            None => self.moved_rad = Joints::zeros(),
        }
        parts
    }

    /// Returns the motion wanted in this period, before limits.
    fn wish(&mut self, goal: &RcmShaft) -> MotionRequest {
        let travel_m = self.travel_m(goal);
        let moved_m = self.last_goal.map_or_else(Vector3::zeros, |last| travel_m - self.travel_m(&last));
        self.last_goal = Some(*goal);
        // Approaching the target is limited in speed; motion of the target itself is followed without lag.
        let moved_m = moved_m * self.twist_fraction(&moved_m, goal.insertion_m);
        self.target_motion_m += (moved_m - self.target_motion_m) * (self.period_s / TARGET_MOTION_S).min(1.0);
        let relief =
            posture::relief(&self.arm, &self.rcm, &self.pose, &self.joint_rad) * (POSTURE_PER_S * self.period_s);
        let step_rad = self.limits.speed_rad_s * self.period_s;
        let fastest = relief.iter().zip(&step_rad).map(|(r, v)| r.abs() / v).fold(0.0, f64::max);
        MotionRequest {
            at_trocar_m: self.to_trocar_m(),
            motion_m: travel_m - self.target_motion_m,
            carried_m: self.target_motion_m,
            moved_rad: self.moved_rad,
            posture_rad: relief * (POSTURE_FRACTION / fastest.max(POSTURE_FRACTION)),
        }
    }

    /// Returns the displacement that brings the axis back to the trocar, along `InstrumentPose::across`, m.
    fn to_trocar_m(&self) -> Vector2<f64> {
        let miss_m = self.pose.axis_miss_m(&self.rcm.settings().trocar_m);
        -Vector2::new(miss_m.dot(&self.pose.across[0]), miss_m.dot(&self.pose.across[1]))
    }

    /// Returns the displacement to a shaft: rotation along `InstrumentPose::across` times [`LENGTH_M`], and sliding inwards, m.
    fn travel_m(&self, goal: &RcmShaft) -> Vector3<f64> {
        let turn = turn_towards(&self.pose, &goal.direction) * LENGTH_M;
        Vector3::new(turn.x, turn.y, goal.insertion_m - self.pose.insertion_m(&self.rcm.settings().trocar_m))
    }

    /// Returns the fraction of a motion (as in [`Self::travel_m`]) that tip and shaft may make in one period while
    /// rotating and sliding in proportion.
    fn twist_fraction(&self, motion_m: &Vector3<f64>, insertion_m: f64) -> f64 {
        let turn_rad = motion_m.xy().norm() / LENGTH_M;
        let insertion_m = insertion_m.max(self.pose.insertion_m(&self.rcm.settings().trocar_m));
        let tip = (TIP_SPEED_M_S * self.period_s) / libm::hypot(turn_rad * insertion_m, motion_m.z);
        let shaft = (TURN_SPEED_RAD_S * self.period_s) / turn_rad;
        tip.min(shaft).min(1.0)
    }

    /// Returns the fraction of the correction that may be made in this period; its acceleration is limited too.
    fn correction_fraction(&self, parts: &StepParts, [min, max]: &[Joints; 2]) -> f64 {
        let braking = BRAKING_FRACTION * speed_scale::braking(&parts.correction, &self.change_rad);
        let stopping = speed_scale::stopping_step(1.0, braking).min((parts.returning + braking).max(0.0));
        stopping * speed_scale::fraction_within(&(parts.correction * stopping), min, max)
    }

    /// Moves the joints by as much of the components as the limits allow, the correction at the trocar first; returns
    /// the fraction of the motion.
    fn take(&mut self, parts: &StepParts, wish: &MotionRequest, insertion_m: f64) -> f64 {
        let reserve_rad = self.change_rad * BRAKING_FRACTION;
        let approach = speed_scale::stopping_step(1.0, speed_scale::braking(&parts.motion, &reserve_rad));
        let twist = self.twist_fraction(&(wish.carried_m + wish.motion_m * approach), insertion_m);
        let motion = (parts.carried + parts.motion * approach) * twist;
        let [min, max] = self.bounds();
        let correction = parts.correction * self.correction_fraction(parts, &[min, max]);
        let moving = speed_scale::fraction_within(&motion, &(min - correction), &(max - correction));
        let mut pushing = motion * moving;
        let left = [min - correction - pushing, max - correction - pushing];
        pushing += parts.posture * speed_scale::fraction_within(&parts.posture, &left[0], &left[1]);
        let room_rad = self.room_rad();
        let ends = speed_scale::stopping_step(
            speed_scale::periods(&pushing, &room_rad),
            speed_scale::braking(&pushing, &reserve_rad),
        );
        let wanted = correction + pushing * ends.min(1.0);
        let coast = parts.coast + correction;
        let mut step_rad = speed_scale::towards(&self.moved_rad, &coast, &wanted, &self.change_rad);
        if !speed_scale::can_stop(&step_rad, &room_rad, &self.change_rad) {
            step_rad = speed_scale::towards(&self.moved_rad, &coast, &correction, &self.change_rad);
        }
        self.go(step_rad);
        moving * ends.min(1.0)
    }

    fn go(&mut self, step_rad: Joints) {
        self.joint_rad += step_rad;
        self.moved_rad = step_rad;
        self.pose = self.arm.pose(&self.joint_rad);
    }

    /// Returns the distance of each joint from both ends of its usable range, rad; negative beyond them.
    fn room_rad(&self) -> [Joints; 2] {
        let low_rad = self.limits.low_rad.add_scalar(KEEP_OFF_RAD);
        let high_rad = self.limits.high_rad.add_scalar(-KEEP_OFF_RAD);
        [self.joint_rad - low_rad, high_rad - self.joint_rad]
    }

    /// Returns the smallest and largest change of each joint in this period, rad: limited by its speed, by the distance
    /// to the end of its range, and, if the arm is blocked, by its distance from the measured angle.
    fn bounds(&self) -> [Joints; 2] {
        let mut min = Joints::zeros();
        let mut max = Joints::zeros();
        let approach = (APPROACH_PER_S * self.period_s).min(1.0);
        let [below_rad, above_rad] = self.room_rad();
        for joint in 0..JOINTS {
            let fastest = SPEED_FRACTION * self.limits.speed_rad_s[joint] * self.period_s;
            let ahead_rad = self.ahead_rad[joint];
            if ahead_rad < self.limits.lead_rad {
                max[joint] = (approach * above_rad[joint]).clamp(0.0, fastest);
            }
            if ahead_rad > -self.limits.lead_rad {
                min[joint] = -(approach * below_rad[joint]).clamp(0.0, fastest);
            }
        }
        [min, max]
    }

    fn answer(&self, goal: Option<&RcmShaft>, confined: RcmCorrection, granted: f64) -> InverseStep {
        let measures = PoseQuality {
            axis_miss_m: self.pose.axis_miss_m(&self.rcm.settings().trocar_m).norm(),
            tip_miss_m: goal.map_or(f64::NAN, |goal| (self.rcm.tip_m(goal) - self.pose.tip_m).norm()),
            limit_margin_rad: self.arm.model().limit_margin_rad(&self.joint_rad),
            dexterity: self.dexterity,
            granted,
        };
        InverseStep { joint_rad: self.joint_rad, confined, measures }
    }
}
