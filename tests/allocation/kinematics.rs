//! Computing the arm's joint angles from the hand's pose allocates nothing.

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::kinematics::{
    Arm, ArmSettings, HandEyeCoupling, HandPose, Inverse, MotionMapping, Rcm, RcmSettings, TipTarget, find,
    view_from_omega,
};
use nima_testing::real_time::alone;

use crate::counting::calls;

#[test]
fn hand_eye_mapping_and_inverse_kinematics_allocate_nothing() {
    let _alone = alone();
    let mount = ArmSettings {
        base_m: Vector3::zeros(),
        base_deg: Vector3::zeros(),
        sensor_m: Vector3::new(0.0, 0.0, 0.06),
        sensor_deg: Vector3::zeros(),
        shaft_m: 0.42,
    };
    let trocar_m = Vector3::new(0.4, 0.0, -0.1);
    let space =
        RcmSettings { trocar_m, inward: -Vector3::z(), cone_deg: 20.0, insertion_min_m: 0.03, insertion_max_m: 0.25 };
    let arm = Arm::new(&mount).unwrap();
    let rcm = Rcm::new(&space).unwrap();
    let tip_m = trocar_m - Vector3::z() * 0.12;
    let ready = find(&arm, &rcm, &tip_m).unwrap();
    let mut inverse = Inverse::new(arm, rcm, 1e-3, &ready.joint_rad).unwrap();
    let mapping = MotionMapping::new(&UnitQuaternion::identity(), &view_from_omega(), 0.5).unwrap();
    let target = TipTarget { tip_m, world_from_jaws: UnitQuaternion::identity() };
    let mut hand_eye = HandEyeCoupling::new(mapping, target);
    hand_eye.engage(target);
    let before = calls();
    for k in 0..3000 {
        let t_s = f64::from(k) * 1e-3;
        let mut position_m = Vector3::new((5.0 * t_s).sin(), (4.0 * t_s).cos(), (3.0 * t_s).sin()) * 0.3;
        if k % 500 == 100 {
            position_m.y = f64::NAN;
        }
        let orientation = Some(UnitQuaternion::from_scaled_axis(Vector3::x() * t_s));
        let target = hand_eye.step(&HandPose { position_m, orientation });
        inverse.step(&if k % 500 == 200 { Vector3::repeat(f64::NAN) } else { target.tip_m });
    }
    assert_eq!(calls() - before, 0);
    assert!((inverse.pose().tip_m - tip_m).norm() > 1e-3, "it did move");
}
