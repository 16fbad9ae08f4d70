//! Public arms from their descriptions, against independent facts and through a trocar; and descriptions that are refused.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{IsometryMatrix3, Point3, Vector3};
use nima_core::kinematics::{
    Arm, ArmModel, ArmSettings, Inverse, JOINTS, JointChain, JointLimits, Joints, Rcm, RcmSettings, find,
};

use super::*;

const GEN3_7: &str = include_str!("../../../assets/arms/gen3-7dof.urdf");
const UR5E: &str = include_str!("../../../assets/arms/ur5e.urdf");
/// Name, text, links.
const ARMS: [(&str, &str, ChainEnds<'static>); 5] = [
    ("gen3-7dof", GEN3_7, ends("base_link", "end_effector_link")),
    ("gen3-6dof", include_str!("../../../assets/arms/gen3-6dof.urdf"), ends("base_link", "end_effector_link")),
    ("ur5e", UR5E, ends("base_link_inertia", "tool0")),
    ("xarm6", include_str!("../../../assets/arms/xarm6.urdf"), ends("link_base", "link_eef")),
    ("franka-panda", include_str!("../../../assets/arms/franka-panda.urdf"), ends("panda_link0", "panda_link8")),
];
const ACCELERATION_RAD_S2: f64 = 2.0;
const PERIOD_S: f64 = 1e-3;
/// Periods for each goal: enough for most of them at the limits of the joints.
const GOAL_STEPS: u32 = 2000;

const fn ends(base_link: &'static str, flange_link: &'static str) -> ChainEnds<'static> {
    ChainEnds { base_link, flange_link }
}

fn model(text: &str, ends: ChainEnds<'_>) -> ArmModel {
    ArmModel::new(&chain_of(text, ends, ACCELERATION_RAD_S2).unwrap()).unwrap()
}

fn flange(model: &ArmModel, joint_rad: &Joints) -> IsometryMatrix3<f64> {
    JointChain::new(model, &IsometryMatrix3::identity(), joint_rad).world_from_flange
}

fn random_joints(random: &mut fastrand::Rng) -> Joints {
    Joints::from_fn(|_, _| (random.f64() - 0.5) * 2.0 * PI)
}

#[test]
fn the_description_of_a_gen3_is_the_arm_that_is_built_in_also_with_rounded_right_angles() {
    let mut random = fastrand::Rng::with_seed(1);
    let rounded = GEN3_7.replace("1.5707963267948966", "1.5708").replace("3.141592653589793", "3.1416");
    for text in [GEN3_7, &rounded] {
        let read = model(text, ARMS[0].2);
        for _ in 0..300 {
            let joint_rad = random_joints(&mut random);
            let [read, own] = [&read, &ArmModel::GEN3].map(|model| flange(model, &joint_rad));
            assert!((read.translation.vector - own.translation.vector).norm() < 1e-12);
            assert!((read.rotation.matrix() - own.rotation.matrix()).norm() < 1e-12);
        }
        for joint in 0..JOINTS {
            let bits = |model: &ArmModel| model.range_rad(joint).map(f64::to_bits);
            assert_eq!(bits(&read), bits(&ArmModel::GEN3));
        }
        assert_eq!(read.speed_rad_s().map(f64::to_bits), ArmModel::GEN3.speed_rad_s().map(f64::to_bits));
    }
}

#[test]
fn a_ur5e_is_where_its_makers_table_of_denavit_and_hartenberg_puts_it() {
    // a, d, alpha: Universal Robots, "DH parameters for calculations of kinematics and dynamics".
    const ROWS: [[f64; 3]; 6] = [
        [0.0, 0.1625, FRAC_PI_2],
        [-0.425, 0.0, 0.0],
        [-0.3922, 0.0, 0.0],
        [0.0, 0.1333, FRAC_PI_2],
        [0.0, 0.0997, -FRAC_PI_2],
        [0.0, 0.0996, 0.0],
    ];
    let ur5e = model(UR5E, ARMS[2].2);
    let mut random = fastrand::Rng::with_seed(2);
    for _ in 0..300 {
        let mut joint_rad = random_joints(&mut random);
        let expected = ROWS.iter().zip(joint_rad.iter()).fold(Isometry3::identity(), |at, ([a, d, alpha], q)| {
            at * Isometry3::rotation(Vector3::z() * *q)
                * Isometry3::translation(*a, 0.0, *d)
                * Isometry3::rotation(Vector3::x() * *alpha)
        });
        // The unused joint moves nothing.
        joint_rad[6] = random.f64();
        let read = flange(&ur5e, &joint_rad);
        assert!((read.translation.vector - expected.translation.vector).norm() < 1e-9);
        assert!((read.rotation.matrix() - expected.rotation.to_rotation_matrix().matrix()).norm() < 1e-9);
    }
}

#[test]
fn the_jacobian_of_every_arm_is_the_slope_of_its_forward_kinematics() {
    const H: f64 = 1e-6;
    let mut random = fastrand::Rng::with_seed(3);
    let mount = IsometryMatrix3::new(Vector3::new(0.3, -0.2, 0.1), Vector3::new(0.4, 0.3, -1.0));
    for (name, text, ends) in ARMS {
        let model = model(text, ends);
        for _ in 0..30 {
            let joint_rad = random_joints(&mut random);
            let chain = JointChain::new(&model, &mount, &joint_rad);
            let on_flange = Point3::new(0.02, -0.01, 0.4);
            let jacobian = chain.jacobian(&(chain.world_from_flange * on_flange).coords);
            for joint in 0..JOINTS {
                let at = |step: f64| {
                    let mut moved = joint_rad;
                    moved[joint] += step;
                    JointChain::new(&model, &mount, &moved).world_from_flange
                };
                let place = (at(H) * on_flange - at(-H) * on_flange) / (2.0 * H);
                let between = (at(H).rotation * at(-H).rotation.inverse()).into_inner();
                // Twice the sine of the small angle.
                let turn = (between - between.transpose()) / (4.0 * H);
                let turn = Vector3::new(turn[(2, 1)], turn[(0, 2)], turn[(1, 0)]);
                assert!((jacobian.fixed_view::<3, 1>(0, joint) - place).norm() < 1e-7, "{name}, joint {joint}");
                assert!((jacobian.fixed_view::<3, 1>(3, joint) - turn).norm() < 1e-7, "{name}, joint {joint}");
            }
        }
    }
}

fn trocar() -> Rcm {
    let trocar_m = Vector3::new(0.4, 0.0, -0.1);
    let inward = -Vector3::z();
    Rcm::new(&RcmSettings { trocar_m, inward, cone_deg: 20.0, insertion_min_m: 0.03, insertion_max_m: 0.22 }).unwrap()
}

/// Moves like a hand, with jumps, targets outside the cone, and targets that are not finite.
fn move_through_the_trocar(name: &str, model: &ArmModel, steps: u32) {
    let zero = Vector3::zeros();
    let sensor_m = Vector3::new(0.0, 0.0, 0.06);
    let mount = ArmSettings { base_m: zero, base_deg: zero, sensor_m, sensor_deg: zero, shaft_m: 0.42 };
    let arm = Arm::new(&mount).unwrap().of_model(*model);
    let rcm = trocar();
    let trocar_m = rcm.settings().trocar_m;
    let middle_m = trocar_m - Vector3::z() * 0.12;
    let ready = find(&arm, &rcm, &middle_m).unwrap_or_else(|error| panic!("{name}: {error}"));
    println!("{name}: {ready:?}");
    assert!(ready.reached >= 0.9 && ready.clearance_m > 0.0, "{name}: {ready:?}");
    let limits = JointLimits::of_arm(model, 0.5, 0.05);
    let mut inverse = Inverse::new(arm, rcm, PERIOD_S, &ready.joint_rad).unwrap().within(limits);
    let mut random = fastrand::Rng::with_seed(7);
    let mut goal_m = middle_m;
    let mut before = *inverse.joint_rad();
    let mut worst_m = 0.0_f64;
    let mut reached = 0;
    for step in 0..steps {
        if step % GOAL_STEPS == 0 {
            reached += u32::from((inverse.pose().tip_m - goal_m).norm() < 1e-3);
            let side =
                Vector3::from_fn(|_, _| random.f64() - 0.5) * if step % (4 * GOAL_STEPS) == 0 { 0.4 } else { 0.06 };
            goal_m = middle_m + side;
        }
        let broken = random.usize(..500) == 0;
        let target_m = if broken { Vector3::repeat(f64::NAN) } else { goal_m };
        let measures = inverse.step(&target_m).measures;
        worst_m = worst_m.max(measures.axis_miss_m);
        assert!(measures.axis_miss_m <= 1e-4, "{name}, step {step}: {measures:?}");
        assert!(measures.limit_margin_rad > 0.0, "{name}, step {step}: {measures:?}");
        let speed = (inverse.joint_rad() - before) / PERIOD_S;
        before = *inverse.joint_rad();
        for joint in 0..JOINTS {
            let most = limits.speed_rad_s[joint] * (1.0 + 1e-9);
            assert!(speed[joint].abs() <= most, "{name}, step {step}, joint {joint}: {speed}");
        }
        assert!(model.joints() == JOINTS || before[6] == 0.0, "{name}: the unused joint moves");
    }
    println!("{name}: axis within {worst_m} m, {reached} goals reached");
    assert!(reached >= steps / GOAL_STEPS / 2, "{name}: it hardly moves: {reached}");
}

#[test]
fn every_arm_moves_through_a_trocar_within_its_limits() {
    for (name, text, ends) in ARMS {
        move_through_the_trocar(name, &model(text, ends), 24_000);
    }
}

#[test]
fn what_is_no_arm_is_refused_with_its_line() {
    let ends = ARMS[2].2;
    let refused = |text: &str, words: &str| {
        let chain = chain_of(text, ends, ACCELERATION_RAD_S2).map_err(|error| error.to_string());
        let model = chain.and_then(|chain| ArmModel::new(&chain).map_err(|error| error.to_string()));
        let report = model.map(|_| ()).expect_err(words);
        assert!(report.contains(words) && !report.contains('\n'), "{words}: {report}");
    };
    let changed = |from: &str, to: &str| {
        assert!(UR5E.contains(from), "{from}");
        UR5E.replacen(from, to, 1)
    };
    let elbow = "name=\"elbow_joint\" type=\"revolute\"";
    refused(
        &changed(elbow, "name=\"elbow_joint\" type=\"prismatic\""),
        "line 22: joint \"elbow_joint\": it is prismatic",
    );
    refused(&changed(elbow, "name=\"elbow_joint\" type=\"fixed\""), "5 moving joints");
    refused(&changed("upper=\"3.141592653589793\"", ""), "its limit upper is missing");
    refused(&changed(" velocity=\"3.141592653589793\"", ""), "its limit velocity is missing");
    refused(&changed("lower=\"-6.283185307179586\"", "lower=\"-360\""), "in rad");
    refused(&changed("lower=\"-6.283185307179586\"", "lower=\"${-2*pi}\""), "is not a number");
    refused(&changed("-0.425 0 0", "-425 0 0"), "lengths are in metres");
    refused(&changed("-0.425 0 0", "-0.425 0"), "three numbers");
    refused(&changed("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>"), "axis length");
    refused(&changed("link=\"upper_arm_link\"", "link=\"other_link\""), "is not beyond");
    refused(&changed("tool0", "tool_0").replace("tool0", "tool1"), "no joint has the link \"tool0\"");
    refused(&UR5E[..UR5E.len() / 2], "");
    refused("<sdf/>", "not <robot>");
    refused(
        &changed("<robot ", "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\" ")
            .replace("</robot>", "<xacro:a/></robot>"),
        "xacro FILE.xacro",
    );
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <limit lower=\"-1\" upper=\"1\" velocity=\"1\"/></joint></robot>"
        )
    };
    let with = |joint: String| UR5E.replace("</robot>", &joint);
    refused(&with(joint("second", "shoulder_link", "second_arm")), "branches off");
    refused(&with(joint("again", "base_link_inertia", "forearm_link")), "two joints above it");
    let ring = changed("<parent link=\"base_link_inertia\"/>", "<parent link=\"wrist_3_link\"/>");
    refused(&ring.replace("</robot>", &joint("x", "base_link_inertia", "y")), "ring");
    let deep = format!("<robot>{}{}</robot>", "<a>".repeat(100_000), "</a>".repeat(100_000));
    refused(&deep, "no joint has the link");
    // A gripper beyond the flange does not concern the arm.
    let gripper = with(joint("finger", "tool0", "finger_link"));
    assert!(chain_of(&gripper, ends, ACCELERATION_RAD_S2).is_ok());
}
