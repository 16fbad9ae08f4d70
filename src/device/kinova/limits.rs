//! What the arm may be commanded in low-level servoing, where it has no limits of its own but the hardware's ("no limitations in
//! low level control", the manufacturer's staff, kortex issue 92).
//!
//! Angles in rad, unwrapped; speeds in rad/s. Every command that leaves passes [`Guard::step`].

use crate::device::ARM_JOINTS;

/// One joint's bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimit {
    /// Lowest angle, rad; `-INFINITY` for a joint without end.
    pub low_rad: f64,
    /// Highest angle, rad.
    pub high_rad: f64,
    /// Highest speed, rad/s.
    pub speed_rad_s: f64,
    /// Highest acceleration, rad/s^2.
    pub acceleration_rad_s2: f64,
}

const fn large(range_rad: f64) -> JointLimit {
    JointLimit { low_rad: -range_rad, high_rad: range_rad, speed_rad_s: 1.33, acceleration_rad_s2: 4.94 }
}

const fn small(range_rad: f64) -> JointLimit {
    JointLimit { low_rad: -range_rad, high_rad: range_rad, speed_rad_s: 1.16, acceleration_rad_s2: 9.5 }
}

/// The Gen3 with 7 joints. Ranges: `ros2_kortex` `kortex_description/arms/gen3/7dof/urdf/gen3_macro.xacro`; speeds and
/// accelerations: the hard joint limits in `ros_kortex` (a little below the 1.3963 and 1.2218 rad/s of the description).
pub const GEN3: [JointLimit; ARM_JOINTS] = [
    large(f64::INFINITY),
    large(2.24),
    large(f64::INFINITY),
    large(2.57),
    small(f64::INFINITY),
    small(2.09),
    small(f64::INFINITY),
];

/// Fastest twist of the tool that is sent: linear m/s, angular rad/s (`ros_kortex` `twist_limits.yaml`).
pub const TWIST_MAX: (f64, f64) = (0.5, 1.74);

/// One command covers at most this time, s: after a pause the arm goes on slowly instead of catching up.
pub const STEP_MAX_S: f64 = 0.002;

/// An angle as the wire has it: degrees in [0, 360).
pub fn wire_degrees(angle_rad: f64) -> f32 {
    let degrees = angle_rad.to_degrees().rem_euclid(360.0) as f32;
    // Just below a whole turn rounds up to it.
    if degrees >= 360.0 { 0.0 } else { degrees }
}

/// The turn of a wire angle that is nearest to `near_rad`.
pub fn unwrapped(degrees: f32, near_rad: f64) -> f64 {
    let angle_rad = f64::from(degrees).to_radians();
    angle_rad + std::f64::consts::TAU * ((near_rad - angle_rad) / std::f64::consts::TAU).round()
}

/// Turns joint targets into commands that never jump: bounded in position, speed, acceleration, step, and in how far they run
/// ahead of the arm.
#[derive(Clone, Debug)]
pub struct Guard {
    limits: [JointLimit; ARM_JOINTS],
    lead_rad: f64,
    command_rad: [f64; ARM_JOINTS],
    speed_rad_s: [f64; ARM_JOINTS],
    target_rad: Option<[f64; ARM_JOINTS]>,
    last_target_rad: Option<[f64; ARM_JOINTS]>,
}

impl Guard {
    /// With a share of the arm's speeds, 0 to 1, and the most that a command may be ahead of the measured angle, rad.
    pub fn new(speed_fraction: f64, lead_rad: f64) -> Self {
        let fraction = speed_fraction.clamp(0.0, 1.0);
        let limits = GEN3.map(|limit| JointLimit { speed_rad_s: limit.speed_rad_s * fraction, ..limit });
        let rest = [0.0; ARM_JOINTS];
        Self { limits, lead_rad, command_rad: rest, speed_rad_s: rest, target_rad: None, last_target_rad: None }
    }

    /// Begins at rest where the arm is.
    pub const fn seed(&mut self, measured_rad: &[f64; ARM_JOINTS]) {
        self.command_rad = *measured_rad;
        self.speed_rad_s = [0.0; ARM_JOINTS];
        self.brake();
    }

    /// Sets where to go. What is outside of a joint's range is cut to it; the numbers must be finite.
    pub fn aim(&mut self, target_rad: &[f64; ARM_JOINTS]) {
        let mut target = *target_rad;
        for (angle, limit) in target.iter_mut().zip(&self.limits) {
            *angle = angle.clamp(limit.low_rad, limit.high_rad);
        }
        self.target_rad = Some(target);
    }

    /// Forgets the target: slows down and holds.
    pub const fn brake(&mut self) {
        self.target_rad = None;
        self.last_target_rad = None;
    }

    /// Nothing moves.
    pub fn is_still(&self) -> bool {
        self.speed_rad_s.iter().all(|speed| *speed == 0.0)
    }

    /// The commands now, rad.
    pub const fn command_rad(&self) -> &[f64; ARM_JOINTS] {
        &self.command_rad
    }

    /// The next commands, `elapsed_s` after the last ones, of an arm that is at `measured_rad`.
    pub fn step(&mut self, elapsed_s: f64, measured_rad: &[f64; ARM_JOINTS]) -> &[f64; ARM_JOINTS] {
        let step_s = if elapsed_s > 0.0 { elapsed_s.min(STEP_MAX_S) } else { return &self.command_rad };
        for j in 0..ARM_JOINTS {
            let wanted = self.wanted_speed(j, step_s);
            let limit = &self.limits[j];
            let (at, last) = (self.command_rad[j], self.speed_rad_s[j]);
            let change = limit.acceleration_rad_s2 * step_s;
            let mut speed = wanted.clamp(last - change, last + change);
            // A command far ahead of the arm goes no further: something holds the arm.
            let lead = at - measured_rad[j];
            if lead >= self.lead_rad {
                speed = speed.min(0.0);
            } else if lead <= -self.lead_rad {
                speed = speed.max(0.0);
            }
            // An arm that was pushed out of its range may stay or come back.
            let next = (at + speed * step_s).clamp(limit.low_rad.min(at), limit.high_rad.max(at));
            (self.speed_rad_s[j], self.command_rad[j]) = (speed, next);
        }
        self.last_target_rad = self.target_rad;
        &self.command_rad
    }

    /// Speed that leads to the target, and can still stop there and at the end of the range.
    fn wanted_speed(&self, j: usize, step_s: f64) -> f64 {
        let limit = &self.limits[j];
        let at = self.command_rad[j];
        let Some(target) = self.target_rad.map(|target| target[j]) else { return 0.0 };
        // A target that moves is followed without lag; one that jumps is approached.
        let moved = self.last_target_rad.map_or(0.0, |last| (target - last[j]) / step_s);
        let carried = if moved.abs() <= limit.speed_rad_s { moved } else { 0.0 };
        let left = target - at - carried * step_s;
        let approach = (left.abs() / step_s).min(stopping_speed(left.abs(), limit.acceleration_rad_s2, step_s));
        let wanted = (carried + approach.copysign(left)).clamp(-limit.speed_rad_s, limit.speed_rad_s);
        let up = stopping_speed(limit.high_rad - at, limit.acceleration_rad_s2, step_s);
        let down = stopping_speed(at - limit.low_rad, limit.acceleration_rad_s2, step_s);
        wanted.clamp(-down, up)
    }
}

/// Highest speed for the next step after which a joint can still stop within a distance, however long the steps after it are:
/// `v^2 / 2a + v step = distance`.
fn stopping_speed(distance: f64, acceleration: f64, step_s: f64) -> f64 {
    if distance <= 0.0 {
        return 0.0;
    }
    let change = acceleration * step_s;
    (2.0 * acceleration).mul_add(distance, change * change).sqrt() - change
}

#[cfg(test)]
mod tests {
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

    #[test]
    fn no_target_makes_a_jump() {
        let mut random = fastrand::Rng::with_seed(7);
        for _ in 0..50 {
            let fraction = 0.05 + 0.95 * random.f64();
            let mut guard = Guard::new(fraction, 1e9);
            let mut at = [0.0; ARM_JOINTS].map(|_: f64| random.f64() * 4.0 - 2.0);
            guard.seed(&at);
            let mut speed = [0.0; ARM_JOINTS];
            for tick in 0..2000 {
                if random.u32(..100) == 0 {
                    guard.aim(&[0.0; ARM_JOINTS].map(|_: f64| (random.f64() - 0.5) * 20.0));
                }
                if tick % 700 == 699 {
                    guard.brake();
                }
                let elapsed_s = random.f64() * 0.01;
                let step_s = elapsed_s.min(STEP_MAX_S);
                let next = *guard.step(elapsed_s, &at);
                for j in 0..ARM_JOINTS {
                    let limit = &GEN3[j];
                    let now = (next[j] - at[j]) / step_s;
                    assert!(now.abs() <= limit.speed_rad_s * fraction * (1.0 + 1e-6) + 1e-12 / step_s, "speed {now}");
                    // Rounding of the angles is seen in their differences.
                    let change = limit.acceleration_rad_s2.mul_add(step_s, 1e-12 / step_s);
                    assert!((now - speed[j]).abs() <= change * (1.0 + 1e-6), "from {} to {now}", speed[j]);
                    assert!(next[j] >= limit.low_rad.min(at[j]) && next[j] <= limit.high_rad.max(at[j]));
                    speed[j] = now;
                }
                at = next;
            }
        }
    }

    #[test]
    fn a_target_is_reached_exactly_and_a_moving_one_without_lag() {
        let mut guard = Guard::new(1.0, 1e9);
        guard.seed(&[0.0; ARM_JOINTS]);
        guard.aim(&[0.7; ARM_JOINTS]);
        for _ in 0..2000 {
            let at = *guard.command_rad();
            guard.step(TICK_S, &at);
            assert!(guard.command_rad().iter().all(|angle| *angle <= 0.7 + 1e-12), "no overshoot");
        }
        assert!(guard.command_rad().iter().all(|angle| (angle - 0.7).abs() < 1e-9));
        guard.brake();
        let at = *guard.command_rad();
        guard.step(TICK_S, &at);
        assert!(guard.is_still());
        guard.aim(&[0.7; ARM_JOINTS]);
        for k in 1..3000 {
            let target = 0.4_f64.mul_add((f64::from(k) * TICK_S * 1.5).cos(), 0.3);
            guard.aim(&[target; ARM_JOINTS]);
            let at = *guard.command_rad();
            guard.step(TICK_S, &at);
            if k > 200 {
                assert!((guard.command_rad()[0] - target).abs() < 1e-5, "lag at {k}");
            }
        }
    }

    #[test]
    fn the_end_of_the_range_and_a_held_arm_stop_the_command() {
        let mut guard = Guard::new(1.0, 0.05);
        let mut at = [0.0; ARM_JOINTS];
        guard.seed(&at);
        for k in 0..6000 {
            guard.aim(&[f64::from(k) * 1.3e-3; ARM_JOINTS]);
            at = *guard.step(TICK_S, &at);
        }
        for (angle, limit) in at.iter().zip(&GEN3) {
            assert!(*angle <= limit.high_rad, "{angle}");
            assert!(limit.high_rad.is_infinite() || limit.high_rad - angle < 1e-6);
        }
        let held = at;
        guard.aim(&[-100.0; ARM_JOINTS]);
        for _ in 0..3000 {
            guard.step(TICK_S, &held);
        }
        for j in 0..ARM_JOINTS {
            let lead = held[j] - guard.command_rad()[j];
            assert!(lead < 0.05 + GEN3[j].speed_rad_s * TICK_S, "joint {j} is {lead} rad ahead");
        }
    }
}
