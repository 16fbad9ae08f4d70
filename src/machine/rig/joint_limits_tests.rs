//! Sends fast commands through the inverse kinematics and the arm's driver, at several fractions of the arm's maximum
//! speed.

#[path = "../../core/kinematics/tests/usual_arm.rs"]
mod usual_arm;

use nalgebra::Vector3;
use nima_core::kinematics::{Arm, ArmModel, ArmSettings, Inverse, JOINTS, JointLimits, Joints, Rcm, RcmSettings};
use nima_devices::kinova::limits::Guard;

use self::usual_arm::{READY_RAD, TROCAR_M, arm, middle_m, rcm};

const PERIOD_S: f64 = 1e-3;
const STEPS: usize = 20_000;

/// A hand that moves at 0.3 m/s (the fastest follower of the rig files) to random places, with random reversals and
/// occasional jumps.
struct Hand {
    random: fastrand::Rng,
    goal_m: Vector3<f64>,
    target_m: Vector3<f64>,
}

impl Hand {
    fn new(seed: u64) -> Self {
        Self { random: fastrand::Rng::with_seed(seed), goal_m: middle_m(), target_m: middle_m() }
    }

    fn next(&mut self) -> Vector3<f64> {
        let travel_m = self.goal_m - self.target_m;
        let max_m = 0.3 * PERIOD_S;
        if travel_m.norm() < max_m || self.random.u32(..400) == 0 {
            let random = &mut self.random;
            self.goal_m = TROCAR_M + Vector3::new(random.f64() - 0.5, random.f64() - 0.5, -random.f64()) * 0.3;
        } else if self.random.u32(..200) == 0 {
            self.goal_m = self.target_m - travel_m;
        }
        if self.random.u32(..2000) == 0 {
            self.target_m = self.goal_m;
        }
        self.target_m += travel_m.cap_magnitude(max_m);
        self.target_m + Vector3::from_fn(|_, _| self.random.f64() - 0.5) * 2e-5
    }
}

#[derive(Default)]
struct Shown {
    misses_mm: Vec<f64>,
    /// Highest speed and acceleration of a joint as fractions of their limits.
    speed: f64,
    acceleration: f64,
    /// Periods with a joint near the end of its range, and periods in which a joint changes direction.
    at_limits: usize,
    reversals: usize,
    /// Distance of the tip from the target, m.
    behind_m: Vec<f64>,
}

/// Within a cone of 20 degrees no joint comes near its limits; at the edge of a cone of 50 degrees some do.
///
/// Controls the arm like the rig: a plan within the arm's limits, the driver's check, and occasionally a clutch, which
/// brakes and starts a new plan.
fn drive(fraction: f64, cone_deg: f64, seed: u64, shown: &mut Shown) {
    let arm = arm();
    let rcm = rcm(cone_deg);
    let limits = JointLimits::of_arm(&ArmModel::GEN3, fraction, 0.05);
    let begin = |joint_rad: &Joints| Inverse::new(arm, rcm, PERIOD_S, joint_rad).unwrap().within(limits);
    let mut hand = Hand::new(seed);
    let mut settled = Inverse::new(arm, rcm, PERIOD_S, &Joints::from(READY_RAD)).unwrap();
    for _ in 0..2000 {
        settled.step(&hand.target_m);
    }
    // With the wide cone, start near a joint limit; a slow arm would not reach one within the test.
    for _ in 0..5 * STEPS {
        if cone_deg < 45.0 || ArmModel::GEN3.limit_margin_rad(settled.joint_rad()) < 0.03 {
            break;
        }
        settled.step(&hand.next());
    }
    let mut inverse = begin(settled.joint_rad());
    let mut guard = Guard::new(limits);
    guard.seed(inverse.joint_rad().as_ref());
    let mut last = *inverse.joint_rad();
    let mut moved = Joints::zeros();
    let mut clutched = 0_u32;
    for tick in 0..STEPS {
        let target_m = hand.next();
        clutched = if hand.random.u32(..1500) == 0 { 600 } else { clutched.saturating_sub(1) };
        let step = if clutched > 0 { inverse.brake() } else { inverse.step(&target_m) };
        if clutched == 1 {
            assert!(inverse.is_still(), "at rest within {} s", limits.braking_s());
            inverse = begin(&Joints::from(*guard.command_rad()));
        }
        assert_eq!(guard.aim(step.joint_rad.as_ref(), last.as_ref()), Ok(()), "tick {tick}");
        let sent = Joints::from(*guard.step(PERIOD_S));
        let way = sent - last;
        shown.misses_mm.push(1e3 * arm.pose(&sent).axis_miss_m(&TROCAR_M).norm());
        for joint in 0..JOINTS {
            shown.speed = shown.speed.max(way[joint].abs() / PERIOD_S / limits.speed_rad_s[joint]);
            let change = (way[joint] - moved[joint]).abs() / PERIOD_S.powi(2);
            shown.acceleration = shown.acceleration.max(change / limits.acceleration_rad_s2[joint]);
        }
        shown.at_limits += usize::from(ArmModel::GEN3.limit_margin_rad(&sent) < 0.04);
        shown.reversals += usize::from(way.iter().zip(&moved).any(|(now, before)| now * before < 0.0));
        if clutched == 0 {
            shown.behind_m.push(step.measures.tip_miss_m);
        }
        assert!(ArmModel::GEN3.limit_margin_rad(&sent) > 0.0, "beyond the range of a joint in tick {tick}");
        last = sent;
        moved = way;
    }
}

fn at(sorted: &[f64], fraction: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * fraction) as usize]
}

#[test]
fn the_trocar_and_every_limit_are_kept_at_any_share_of_the_arms_speed() {
    for fraction in [0.1, 0.3, 1.0] {
        let mut shown = Shown::default();
        for (cone_deg, seed) in [(20.0, 1), (50.0, 1), (50.0, 2)] {
            drive(fraction, cone_deg, seed, &mut shown);
        }
        let Shown { mut misses_mm, mut behind_m, speed, acceleration, at_limits, reversals } = shown;
        misses_mm.sort_by(f64::total_cmp);
        behind_m.sort_by(f64::total_cmp);
        let worst_mm = at(&misses_mm, 1.0);
        println!(
            "{fraction}: miss p50 {:.5} mm, p99 {:.5} mm, max {worst_mm:.5} mm; behind p50 {:.2} mm, p99 {:.2} mm; speed {speed:.3}, \
             acceleration {acceleration:.3} of the limit; {at_limits} periods at limits, {reversals} reversals",
            at(&misses_mm, 0.5),
            at(&misses_mm, 0.99),
            1e3 * at(&behind_m, 0.5),
            1e3 * at(&behind_m, 0.99),
        );
        assert!(worst_mm <= 0.1, "the axis leaves the trocar at {fraction} of the speed: {worst_mm} mm");
        // The tolerance is for rounding: accelerations are second differences of the angles.
        assert!(speed <= 1.0 && acceleration <= 1.0 + 1e-6, "{fraction}: speed {speed}, acceleration {acceleration}");
        assert!(at_limits > 0 && reversals > 10, "nothing was tried: {at_limits} {reversals}");
    }
}

#[test]
fn an_arm_that_is_held_is_not_commanded_further_away_and_comes_back_through_the_trocar() {
    let arm = arm();
    let rcm = rcm(20.0);
    let limits = JointLimits::of_arm(&ArmModel::GEN3, 0.3, 0.05);
    let mut inverse = Inverse::new(arm, rcm, PERIOD_S, &Joints::from(READY_RAD)).unwrap().within(limits);
    let middle_m = TROCAR_M - Vector3::z() * 0.12;
    for _ in 0..2000 {
        inverse.step(&middle_m);
    }
    let held = *inverse.joint_rad();
    let mut worst_rad = 0.0_f64;
    let aside_m = middle_m + Vector3::new(0.03, 0.02, 0.0);
    for k in 0..6000 {
        inverse.observe(&held);
        let target_m = if k < 3000 { aside_m } else { middle_m };
        inverse.step(&target_m);
        worst_rad = worst_rad.max((inverse.joint_rad() - held).amax());
        assert!(arm.pose(inverse.joint_rad()).axis_miss_m(&TROCAR_M).norm() < 1e-4);
    }
    assert!(worst_rad > 0.05 && worst_rad < 0.05 + limits.speed_rad_s[0] * limits.braking_s(), "{worst_rad}");
    assert!((inverse.pose().tip_m - middle_m).norm() < 1e-4, "back at {}", inverse.pose().tip_m);
}
