//! Motion of the joints by the emulated base itself: paths that stop at every point, and constant speeds.
//!
//! The real base moves to a pose, and between Cartesian waypoints, on a straight line of the tool; here all paths are
//! straight lines in joint space.

use std::{collections::VecDeque, f64::consts::PI};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector6};
use nima_core::kinematics::ACCELERATION_RAD_S2;
use nima_devices::{
    ARM_JOINTS,
    kinova::{
        kinematics::{joint_speeds, tool},
        limits::{GEN3, unwrapped},
        messages::KinovaPose,
    },
};

use super::{
    BodyCommand,
    interface::{INVALID_DURATION, INVALID_PARAM, InterfaceError, JOINT_COUNT, JOINT_LIMIT, OUTSIDE_WORKSPACE},
};

pub(super) type KinovaJoints = [f64; ARM_JOINTS];

/// The path to one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    to_rad: KinovaJoints,
    duration_s: f64,
}

pub(super) enum KinovaMotion {
    Path { from_rad: KinovaJoints, legs: VecDeque<Leg>, at_s: f64 },
    Speeds { goal_rad: KinovaJoints, rad_s: KinovaJoints },
}

impl KinovaMotion {
    pub(super) fn path(from_rad: KinovaJoints, legs: Vec<Leg>) -> Self {
        Self::Path { from_rad, legs: legs.into(), at_s: 0.0 }
    }

    pub(super) const fn speeds(from_rad: KinovaJoints, rad_s: KinovaJoints) -> Self {
        Self::Speeds { goal_rad: from_rad, rad_s }
    }

    pub(super) const fn is_path(&self) -> bool {
        matches!(self, Self::Path { .. })
    }

    /// Returns the command `elapsed_s` later; `None` when the last point is reached.
    pub(super) fn step(&mut self, elapsed_s: f64) -> Option<BodyCommand> {
        match self {
            Self::Speeds { goal_rad, rad_s } => {
                for j in 0..ARM_JOINTS {
                    goal_rad[j] = (goal_rad[j] + rad_s[j] * elapsed_s).clamp(GEN3[j].low_rad, GEN3[j].high_rad);
                }
                Some(BodyCommand::Joints(*goal_rad))
            }
            Self::Path { from_rad, legs, at_s } => {
                *at_s += elapsed_s;
                while let Some(leg) = legs.front().filter(|leg| *at_s >= leg.duration_s).copied() {
                    legs.pop_front();
                    *from_rad = leg.to_rad;
                    *at_s -= leg.duration_s;
                }
                let leg = legs.front()?;
                let fraction = 0.5 - 0.5 * (PI * *at_s / leg.duration_s).cos();
                Some(BodyCommand::Joints(std::array::from_fn(|j| {
                    from_rad[j] + (leg.to_rad[j] - from_rad[j]) * fraction
                })))
            }
        }
    }
}

/// Returns the path from one point to another in `wanted_s`, or as fast as the joints can if that is 0.
pub(super) fn leg(from_rad: &KinovaJoints, to_rad: KinovaJoints, wanted_s: f64) -> Result<Leg, InterfaceError> {
    // Along half a cosine the maximum speed is pi/2 times the mean speed, the maximum acceleration pi^2/2 times
    // distance over time squared.
    let shortest = |j: usize| {
        let way = (to_rad[j] - from_rad[j]).abs();
        let by_speed = 0.5 * PI * way / GEN3[j].speed_rad_s;
        by_speed.max(PI * (0.5 * way / ACCELERATION_RAD_S2[j]).sqrt())
    };
    let shortest_s = (0..ARM_JOINTS).map(shortest).fold(0.01, f64::max);
    let duration_s = if wanted_s == 0.0 { shortest_s } else { wanted_s };
    if duration_s >= shortest_s && duration_s <= 1e4 { Ok(Leg { to_rad, duration_s }) } else { Err(INVALID_DURATION) }
}

impl Leg {
    pub(super) const fn end_rad(&self) -> &KinovaJoints {
        &self.to_rad
    }
}

/// Returns the joint angles of a client, in the turn nearest to `near_rad`, within the joints' ranges.
pub(super) fn goal(degrees: &[f32], near_rad: &KinovaJoints) -> Result<KinovaJoints, InterfaceError> {
    let degrees: [f32; ARM_JOINTS] = degrees.try_into().map_err(|_| JOINT_COUNT)?;
    if !degrees.iter().all(|angle| angle.is_finite()) {
        return Err(INVALID_PARAM);
    }
    let turn = |j: usize| unwrapped(degrees[j], if GEN3[j].high_rad.is_finite() { 0.0 } else { near_rad[j] });
    let goal: KinovaJoints = std::array::from_fn(turn);
    let inside = goal.iter().zip(&GEN3).all(|(angle, joint)| (joint.low_rad..=joint.high_rad).contains(angle));
    if inside { Ok(goal) } else { Err(JOINT_LIMIT) }
}

/// Start angles of the search, degrees, if it fails from the current pose.
const BEGINNINGS_DEG: [KinovaJoints; 3] = [
    [0.0, 15.0, 180.0, -130.0, 0.0, 55.0, 90.0],
    [0.0, 45.0, 180.0, -60.0, 0.0, -15.0, 90.0],
    [180.0, -30.0, 0.0, 90.0, 0.0, 30.0, -90.0],
];
const SEARCH_STEPS: usize = 400;
const LONGEST_STEP_RAD: f64 = 0.2;
const CLOSE: f64 = 1e-6;

/// Returns joint angles that bring the tool to a pose; the search begins at the nearest start.
pub(super) fn reach(pose: &KinovaPose, near_rad: &KinovaJoints) -> Result<KinovaJoints, InterfaceError> {
    let numbers = [pose.x, pose.y, pose.z, pose.theta_x, pose.theta_y, pose.theta_z].map(f64::from);
    if !numbers.iter().all(|x| x.is_finite()) {
        return Err(INVALID_PARAM);
    }
    let [x, y, z, theta_x, theta_y, theta_z] = numbers;
    let rotation = UnitQuaternion::from_euler_angles(theta_x.to_radians(), theta_y.to_radians(), theta_z.to_radians());
    let wanted = Isometry3::from_parts(Translation3::new(x, y, z), rotation);
    let beginnings = BEGINNINGS_DEG.map(|degrees| degrees.map(f64::to_radians));
    let mut found = std::iter::once(near_rad).chain(&beginnings).filter_map(|begin| search(&wanted, begin));
    let found = found.next().ok_or(OUTSIDE_WORKSPACE)?;
    goal(&found.map(|angle| angle.to_degrees() as f32), near_rad)
}

fn search(wanted: &Isometry3<f64>, begin_rad: &KinovaJoints) -> Option<KinovaJoints> {
    let mut joint_rad = *begin_rad;
    for _ in 0..SEARCH_STEPS {
        let at = tool(&joint_rad);
        let linear = wanted.translation.vector - at.translation.vector;
        let angular = (wanted.rotation * at.rotation.inverse()).scaled_axis();
        let missing = Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z);
        if missing.amax() < CLOSE {
            return Some(joint_rad);
        }
        let step = joint_speeds(&joint_rad, &missing);
        let longest = step.iter().fold(0.0_f64, |max, angle| max.max(angle.abs()));
        let fraction = if longest > LONGEST_STEP_RAD { LONGEST_STEP_RAD / longest } else { 1.0 };
        for j in 0..ARM_JOINTS {
            joint_rad[j] = (joint_rad[j] + fraction * step[j]).clamp(GEN3[j].low_rad, GEN3[j].high_rad);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use nima_devices::kinova::kinematics::theta_rad;

    use super::*;

    const HOME_DEG: [f32; ARM_JOINTS] = [0.0, 15.0, 180.0, 230.0, 0.0, 55.0, 90.0];

    fn home() -> KinovaJoints {
        goal(&HOME_DEG, &[0.0; ARM_JOINTS]).unwrap()
    }

    #[test]
    fn a_path_rests_in_its_points_within_the_joints_speeds() {
        let first = leg(&home(), [0.0; ARM_JOINTS], 0.0).unwrap();
        let second = leg(first.end_rad(), home(), 8.0).unwrap();
        let mut motion = KinovaMotion::path(home(), vec![first, second]);
        let mut last = home();
        let mut before = [0.0; ARM_JOINTS];
        let mut steps = 0;
        let mut nearest = f64::INFINITY;
        while let Some(BodyCommand::Joints(angles)) = motion.step(1e-3) {
            let speeds: KinovaJoints = std::array::from_fn(|j| (angles[j] - last[j]) / 1e-3);
            for j in 0..ARM_JOINTS {
                assert!(speeds[j].abs() <= GEN3[j].speed_rad_s * 1.01, "joint {j}: {}", speeds[j]);
                assert!((speeds[j] - before[j]).abs() <= ACCELERATION_RAD_S2[j] * 1e-3 * 1.05 + 1e-6);
            }
            nearest = nearest.min(angles.iter().fold(0.0, |max, angle| angle.abs().max(max)));
            last = angles;
            before = speeds;
            steps += 1;
        }
        assert!(nearest < 1e-5, "{nearest}");
        assert!((last[3] - home()[3]).abs() < 1e-5);
        assert!((f64::from(steps) * 1e-3 - first.duration_s - 8.0).abs() < 0.01);
        assert_eq!(leg(&home(), [0.0; ARM_JOINTS], 0.5), Err(INVALID_DURATION));
        assert_eq!(leg(&home(), [0.0; ARM_JOINTS], f64::NAN), Err(INVALID_DURATION));
    }

    #[test]
    fn goals_are_in_the_nearest_turn_and_in_range() {
        let turned = goal(&[350.0, 350.0, 0.0, 0.0, 0.0, 0.0, 0.0], &[12.0; ARM_JOINTS]).unwrap();
        assert!((turned[0] - (350.0_f64.to_radians() + std::f64::consts::TAU)).abs() < 1e-6);
        assert!((turned[1] + 10.0_f64.to_radians()).abs() < 1e-6);
        assert_eq!(goal(&[0.0, 140.0, 0.0, 0.0, 0.0, 0.0, 0.0], &home()), Err(JOINT_LIMIT));
        assert_eq!(goal(&[0.0; 6], &home()), Err(JOINT_COUNT));
        assert_eq!(goal(&[f32::NAN; 7], &home()), Err(INVALID_PARAM));
    }

    #[test]
    fn poses_are_reached_or_refused() {
        let asked = [(0.7, 0.0, 0.5), (0.7, 0.48, 0.33), (0.63, -0.22, 0.45), (0.456_665, 0.001_35, 0.433_724)];
        for (x, y, z) in asked {
            let pose = KinovaPose { x, y, z, theta_x: 90.0, theta_y: 0.0, theta_z: 90.0 };
            let at = tool(&reach(&pose, &home()).unwrap());
            assert!((at.translation.vector.cast::<f32>() - nalgebra::Vector3::new(x, y, z)).amax() < 1e-5, "{at}");
            let theta_deg = theta_rad(&at.rotation).map(f64::to_degrees);
            assert!((theta_deg[0] - 90.0).abs() < 1e-3 && theta_deg[1].abs() < 1e-3, "{theta_deg:?}");
        }
        let far = KinovaPose { x: 1.5, ..KinovaPose::default() };
        assert_eq!(reach(&far, &home()), Err(OUTSIDE_WORKSPACE));
        assert_eq!(reach(&KinovaPose { x: f32::NAN, ..far }, &home()), Err(INVALID_PARAM));
    }
}
