//! Properties that hold for any input: no panic, exact results without noise, the same result in any frame.

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use proptest::prelude::*;

use super::rig::*;
use crate::{calibration::frames::*, frames::Wrench};

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1.0..1.0f64, Just(0.0), Just(f64::NAN), Just(f64::INFINITY), Just(-1e300), Just(1e-300),]
}

fn any_pose() -> impl Strategy<Value = Option<Isometry3<f64>>> {
    prop::option::of([number(), number(), number(), number(), number(), number(), number()].prop_map(
        |[x, y, z, w, i, j, k]| {
            let turn = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(w, i, j, k));
            Isometry3::from_parts(Vector3::new(x, y, z).into(), turn)
        },
    ))
}

fn any_sample() -> impl Strategy<Value = FrameSample> {
    (any_pose(), any_pose(), any_pose(), any_pose(), any_pose(), [number(), number(), number()]).prop_map(
        |(flange, other, marker, other_marker, handle, force_n)| FrameSample {
            base_from_flange: flange,
            other_base_from_flange: other,
            c_from_m: marker,
            c_from_other_m: other_marker,
            leader_from_handle: handle,
            wrench: Some(Wrench { force_n: force_n.into(), torque_nm: Vector3::zeros() }),
        },
    )
}

fn tried<C: Calibration>(calibration: C, samples: &[FrameSample]) {
    let report = calibration.fit(samples);
    if samples.iter().any(|sample| !sample.is_finite()) {
        assert!(report.is_err());
    }
    let fraction = calibration.coverage(samples).fraction;
    assert!((0.0..=1.0).contains(&fraction));
    let mut session = FrameSession::new(calibration);
    for (tick, sample) in samples.iter().enumerate() {
        session.step(sample, tick as f64 * 0.1);
    }
    let _ = session.report();
}

fn all_tried(samples: &[FrameSample]) {
    tried(TipSettings::by_tracker(), samples);
    tried(HandEyeSettings::new(TIP_IN_FLANGE_M), samples);
    tried(TrocarSettings::by_arm(&arm()), samples);
    tried(TableSettings::by_arm(TIP_IN_FLANGE_M, Vector3::z()), samples);
    tried(ViewSettings::by_handle(), samples);
    tried(SensorMount::new(UnitQuaternion::identity(), Vector3::z()), samples);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_input_makes_a_calibration_panic(samples in prop::collection::vec(any_sample(), 0..40)) {
        all_tried(&samples);
    }

    #[test]
    fn finite_poses_never_panic_either(parts in prop::collection::vec([-1.0..1.0f64, -1.0..1.0, -1.0..1.0, -3.0..3.0, -3.0..3.0, -3.0..3.0], 30..50), few in 1..5usize) {
        let samples: Vec<FrameSample> = parts
            .iter()
            .enumerate()
            // Includes many poses that are exactly equal.
            .map(|(i, _)| parts[i % (parts.len() / few)])
            .map(|[x, y, z, a, b, c]| Isometry3::new(Vector3::new(x, y, z), Vector3::new(a, b, c)))
            .map(|at| FrameSample {
                base_from_flange: Some(at),
                c_from_m: Some(at),
                leader_from_handle: Some(at),
                wrench: Some(Wrench { force_n: at.translation.vector, torque_nm: Vector3::zeros() }),
                ..FrameSample::default()
            })
            .collect();
        all_tried(&samples);
    }

    #[test]
    fn frames_without_noise_are_found_exactly(
        x in [-0.2..0.2f64, -0.2..0.2, -0.2..0.2, -3.0..3.0, -1.5..1.5, -3.0..3.0],
        y in [-2.0..2.0f64, -2.0..2.0, -2.0..2.0, -3.0..3.0, -1.5..1.5, -3.0..3.0],
    ) {
        let frame = |[a, b, c, d, e, f]: [f64; 6]| Isometry3::new(Vector3::new(a, b, c), Vector3::new(d, e, f));
        let flange_from_m = frame(x);
        let base_from_c = frame(y);
        let sample = |at: &Isometry3<f64>| FrameSample {
            base_from_flange: Some(*at),
            c_from_m: Some(base_from_c.inverse() * at * flange_from_m),
            ..FrameSample::default()
        };
        let near = |a: &Isometry3<f64>, b: &Isometry3<f64>| {
            (a.translation.vector - b.translation.vector).norm() < 1e-8 && a.rotation.angle_to(&b.rotation) < 1e-7
        };
        let samples: Vec<FrameSample> = through_trocar()[..12].iter().map(sample).collect();
        for solver in [HandEyeSolver::ParkMartin, HandEyeSolver::Shah] {
            for refine in [false, true] {
                let hand_eye = HandEyeSettings { solver, refine, ..HandEyeSettings::new(TIP_IN_FLANGE_M) };
                let found = hand_eye.fit(&samples).unwrap().found.unwrap();
                prop_assert!(near(&found.flange_from_m.pose(), &flange_from_m), "{solver:?} {refine} {found:?}");
                prop_assert!(near(&found.base_from_c.pose(), &base_from_c), "{solver:?} {refine} {found:?}");
            }
        }
        let samples: Vec<FrameSample> = in_dimple()[..20].iter().map(sample).collect();
        let tip = TipSettings::by_tracker().fit(&samples).unwrap().found.unwrap();
        let truth = flange_from_m.inverse() * Point3::from(TIP_IN_FLANGE_M);
        prop_assert!((Vector3::from(tip.tip_in_carrier_m) - truth.coords).norm() < 1e-9);
    }
}
