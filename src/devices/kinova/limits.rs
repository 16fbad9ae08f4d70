//! Limits of joint commands in low-level servoing, where the arm itself checks only its hardware limits ("no
//! limitations in low level control", the manufacturer's staff, kortex issue 92).
//!
//! Angles in rad, unwrapped; speeds in rad/s. Every command passes [`Guard`], which refuses a command beyond the limits
//! and never changes one: clipping a single joint would take the shaft out of the trocar. The planner of the path
//! ([`Inverse`](nima_core::kinematics::Inverse)) keeps to the limits, so a command beyond them is a programming error
//! and ends servoing.

use nima_core::kinematics::{JointLimits, LIMIT_RAD, SPEED_RAD_S};

use crate::ARM_JOINTS;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimit {
    /// Lowest angle, rad; `-INFINITY` for a continuous joint.
    pub low_rad: f64,
    pub high_rad: f64,
    pub speed_rad_s: f64,
}

const fn limit(joint: usize) -> JointLimit {
    JointLimit { low_rad: -LIMIT_RAD[joint], high_rad: LIMIT_RAD[joint], speed_rad_s: SPEED_RAD_S[joint] }
}

/// The Gen3 with 7 joints.
pub const GEN3: [JointLimit; ARM_JOINTS] = [limit(0), limit(1), limit(2), limit(3), limit(4), limit(5), limit(6)];

/// Maximum twist of the tool that is sent: linear m/s, angular rad/s (`ros_kortex` `twist_limits.yaml`).
pub const TWIST_MAX: (f64, f64) = (0.5, 1.74);

/// Maximum time covered by one step of braking, s: after a delay the arm continues slowly instead of catching up.
pub const STEP_MAX_S: f64 = 0.002;

/// Returns an angle in the format of the protocol: degrees in [0, 360).
pub fn wire_degrees(angle_rad: f64) -> f32 {
    // The arm expects 0 to 360 degrees (`ros2_kortex` wraps commands in the same way).
    let degrees = angle_rad.to_degrees().rem_euclid(360.0) as f32;
    // An angle just below 360 can round up to 360.
    if degrees >= 360.0 { 0.0 } else { degrees }
}

/// Returns the angle, rad, that equals this protocol angle and is nearest to `near_rad`.
pub fn unwrapped(degrees: f32, near_rad: f64) -> f64 {
    let angle_rad = f64::from(degrees).to_radians();
    angle_rad + std::f64::consts::TAU * ((near_rad - angle_rad) / std::f64::consts::TAU).round()
}

/// In any interval, commands may move as far as the speed limit allows in the interval plus this time, s. The ticks of
/// the loop vary by fractions of a millisecond; the slowest loop that moves an arm has a period of 20 ms.
const AHEAD_OF_TIME_S: f64 = 0.025;

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExceededLimit {
    #[error("outside its range")]
    Range,
    /// Further from the last command than the speed limit allows.
    #[error("faster than its limit")]
    Speed,
    /// Too far from the measured angle.
    #[error("too far ahead of the arm")]
    Lead,
}

/// Last check of commands before they are sent: within range, speed limit, and distance from the measured position.
/// Brakes if no target is given.
#[derive(Clone, Debug)]
pub struct Guard {
    limits: JointLimits,
    command_rad: [f64; ARM_JOINTS],
    speed_rad_s: [f64; ARM_JOINTS],
    target_rad: Option<[f64; ARM_JOINTS]>,
    /// Remaining time at full speed that commands may use, s.
    allowed_s: f64,
}

impl Guard {
    pub const fn new(limits: JointLimits) -> Self {
        let rest = [0.0; ARM_JOINTS];
        Self { limits, command_rad: rest, speed_rad_s: rest, target_rad: None, allowed_s: AHEAD_OF_TIME_S }
    }

    /// Starts at rest at the measured position.
    pub const fn seed(&mut self, measured_rad: &[f64; ARM_JOINTS]) {
        *self = Self { command_rad: *measured_rad, ..Self::new(self.limits) };
    }

    /// Sets the next command (finite) while the arm is at `measured_rad`.
    ///
    /// # Errors
    /// The joint (counted from 1) and the limit that it exceeds. The previous command stays active.
    pub fn aim(
        &mut self,
        target_rad: &[f64; ARM_JOINTS],
        measured_rad: &[f64; ARM_JOINTS],
    ) -> Result<(), (usize, ExceededLimit)> {
        let last_rad = self.target_rad.unwrap_or(self.command_rad);
        // If the arm is blocked, the plan itself stops at `lead_rad`. It then needs a distance to brake; the same
        // distance is added for the arm's lag.
        let braking_s = self.limits.braking_s();
        let mut needed_s: f64 = 0.0;
        for j in 0..ARM_JOINTS {
            let at = target_rad[j];
            let speed_rad_s = self.limits.speed_rad_s[j];
            // An arm that was pushed out of its range may stay there or move back.
            if at < self.limits.low_rad[j].min(last_rad[j]) || at > self.limits.high_rad[j].max(last_rad[j]) {
                return Err((j + 1, ExceededLimit::Range));
            }
            if (at - measured_rad[j]).abs() > speed_rad_s.mul_add(braking_s, self.limits.lead_rad) {
                return Err((j + 1, ExceededLimit::Lead));
            }
            // The joint that needs longest at its speed limit decides.
            let time_s = (at - last_rad[j]).abs() / speed_rad_s;
            if time_s > self.allowed_s {
                return Err((j + 1, ExceededLimit::Speed));
            }
            needed_s = needed_s.max(time_s);
        }
        // Only after all joints have been checked: a refused target costs nothing.
        self.allowed_s -= needed_s;
        self.target_rad = Some(*target_rad);
        Ok(())
    }

    /// Drops the target: slows down and holds. The joints move in a straight line, because the path is no longer known.
    pub const fn brake(&mut self) {
        self.target_rad = None;
    }

    pub fn is_still(&self) -> bool {
        self.speed_rad_s.iter().all(|speed| *speed == 0.0)
    }

    /// Returns the current commands, rad.
    pub const fn command_rad(&self) -> &[f64; ARM_JOINTS] {
        &self.command_rad
    }

    /// Returns the commands to send, `elapsed_s` after the previous ones.
    pub fn step(&mut self, elapsed_s: f64) -> &[f64; ARM_JOINTS] {
        // The clock did not advance, so no motion is permitted.
        if elapsed_s <= 0.0 {
            return &self.command_rad;
        }
        // Capped, so that a pause does not save up time for a jump.
        self.allowed_s = (self.allowed_s + elapsed_s).min(AHEAD_OF_TIME_S);
        if let Some(target_rad) = self.target_rad {
            let speed = |j: usize| (target_rad[j] - self.command_rad[j]) / elapsed_s;
            // A command that arrives early looks faster than it is.
            let fraction = (0..ARM_JOINTS).map(|j| self.limits.speed_rad_s[j] / speed(j).abs()).fold(1.0, f64::min);
            self.speed_rad_s = std::array::from_fn(|j| speed(j) * fraction);
            self.command_rad = target_rad;
        } else {
            let step_s = elapsed_s.min(STEP_MAX_S);
            let acceleration = &self.limits.acceleration_rad_s2;
            // The joint that needs longest decides for all, so that they stop together and the path stays a straight
            // line.
            let left_s = (0..ARM_JOINTS).map(|j| self.speed_rad_s[j].abs() / acceleration[j]).fold(0.0, f64::max);
            let fraction = if left_s > step_s { 1.0 - step_s / left_s } else { 0.0 };
            for j in 0..ARM_JOINTS {
                self.speed_rad_s[j] *= fraction;
                let low_rad = self.limits.low_rad[j];
                let high_rad = self.limits.high_rad[j];
                let at = self.command_rad[j];
                // An arm that was pushed beyond its range may stop there.
                self.command_rad[j] = (at + self.speed_rad_s[j] * step_s).clamp(low_rad.min(at), high_rad.max(at));
            }
        }
        &self.command_rad
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "the guard passes commands on unchanged, to the last bit")]
mod tests {
    use nima_core::kinematics::ArmModel;

    use super::*;

    const TICK_S: f64 = 1e-3;

    #[test]
    fn angles_go_to_the_wire_and_back_without_a_jump() {
        for k in -4000..4000 {
            let angle_rad = f64::from(k) * 0.0101;
            let degrees = wire_degrees(angle_rad);
            assert!((0.0..360.0).contains(&degrees), "{degrees}");
            assert!((unwrapped(degrees, angle_rad + 0.5) - angle_rad).abs() < 1e-6);
        }
        assert_eq!(wire_degrees(-1e-12).to_bits(), 0);
    }

    fn resting(fraction: f64) -> Guard {
        let mut guard = Guard::new(JointLimits::of_arm(&ArmModel::GEN3, fraction, 0.05));
        guard.seed(&[0.0; ARM_JOINTS]);
        guard
    }

    #[test]
    fn commands_within_the_limits_pass_as_they_are_however_the_ticks_come() {
        let mut random = fastrand::Rng::with_seed(7);
        for fraction in [0.1, 0.3, 1.0] {
            let mut guard = resting(fraction);
            let mut target = [0.0; ARM_JOINTS];
            let mut late_s = 0.0;
            for k in 0..5000 {
                let way = if k / 1000 % 2 == 0 { TICK_S } else { -TICK_S };
                target = std::array::from_fn(|j| target[j] + GEN3[j].speed_rad_s * fraction * way);
                assert_eq!(guard.aim(&target, &target), Ok(()), "tick {k}");
                let jitter_s = 0.9e-3 * random.f64();
                assert!(guard.step(TICK_S + jitter_s - late_s) == &target, "it changes nothing");
                late_s = jitter_s;
            }
        }
    }

    #[test]
    fn a_command_beyond_a_limit_is_refused_and_changes_nothing() {
        let mut random = fastrand::Rng::with_seed(8);
        for fraction in [0.1, 0.3, 1.0] {
            let mut guard = resting(fraction);
            let begin = *guard.command_rad();
            // A continuous joint.
            let j = 2 * random.usize(..4);
            let mut jump = begin;
            jump[j] += GEN3[j].speed_rad_s * fraction * 1.01 * AHEAD_OF_TIME_S;
            assert_eq!(
                guard.aim(&jump, &begin),
                Err((j + 1, ExceededLimit::Speed)),
                "the first command after the seed"
            );
            jump[j] = -jump[j];
            assert_eq!(guard.aim(&jump, &begin), Err((j + 1, ExceededLimit::Speed)));
            assert!(guard.step(TICK_S) == &begin);
            // 1 % too fast must be refused eventually.
            let mut target = begin;
            let refused = (0..5000).find_map(|_| {
                target[j] += GEN3[j].speed_rad_s * fraction * 1.01 * TICK_S;
                let refused = guard.aim(&target, &target).err();
                guard.step(TICK_S);
                refused
            });
            assert_eq!(refused, Some((j + 1, ExceededLimit::Speed)));
        }
        let mut guard = resting(1.0);
        guard.seed(&[2.08; ARM_JOINTS]);
        assert_eq!(guard.aim(&[2.1; ARM_JOINTS], &[2.08; ARM_JOINTS]), Err((6, ExceededLimit::Range)));
        assert_eq!(guard.aim(&[2.085; ARM_JOINTS], &[1.5; ARM_JOINTS]), Err((1, ExceededLimit::Lead)));
        assert_eq!(guard.aim(&[2.085; ARM_JOINTS], &[2.08; ARM_JOINTS]), Ok(()));
        // Pushed out by hand: moving back is allowed, moving farther is not.
        guard.seed(&[2.3; ARM_JOINTS]);
        assert_eq!(guard.aim(&[2.301; ARM_JOINTS], &[2.3; ARM_JOINTS]), Err((2, ExceededLimit::Range)));
        assert_eq!(guard.aim(&[2.299; ARM_JOINTS], &[2.3; ARM_JOINTS]), Ok(()));
    }

    #[test]
    fn braking_slows_all_joints_down_by_one_factor_and_within_their_accelerations() {
        let limits = JointLimits::of_arm(&ArmModel::GEN3, 1.0, 0.05);
        let mut guard = resting(1.0);
        let speed: [f64; ARM_JOINTS] = std::array::from_fn(|j| GEN3[j].speed_rad_s * (0.3 + 0.1 * j as f64));
        let mut target = [0.0; ARM_JOINTS];
        for _ in 0..100 {
            target = std::array::from_fn(|j| target[j] + speed[j] * TICK_S);
            guard.aim(&target, &target).unwrap();
            guard.step(TICK_S);
        }
        guard.brake();
        let mut last = speed;
        let mut at = *guard.command_rad();
        let mut ticks = 0;
        while !guard.is_still() {
            let next = *guard.step(TICK_S);
            for j in 0..ARM_JOINTS {
                let now = (next[j] - at[j]) / TICK_S;
                assert!((now - last[j]).abs() <= limits.acceleration_rad_s2[j] * TICK_S * (1.0 + 1e-6));
                assert!((now / speed[j] - (next[0] - at[0]) / TICK_S / speed[0]).abs() < 1e-6, "one factor");
                last[j] = now;
            }
            at = next;
            ticks += 1;
        }
        assert!(f64::from(ticks) * TICK_S < limits.braking_s() + 2.0 * TICK_S, "{ticks}");
    }
}
