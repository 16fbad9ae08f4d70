//! Mistakes are reported with their cause.

use nalgebra::{Matrix3, Vector3};

use super::{rig::*, scenes::*};
use crate::calibration::frames::*;

const SEEDS: u64 = 50;

/// Returns the number of sample sets in which this mistake is reported. Undoing an absent mistake introduces it.
fn named<C: Calibration>(
    calibration: &C,
    made: Mistake,
    carrier: Carrier,
    samples: impl Fn(&mut Rig) -> Vec<FrameSample>,
) {
    let mut named = 0;
    for seed in 0..SEEDS {
        let good = samples(&mut Rig::new(seed));
        let wrong: Vec<FrameSample> = good.iter().map(|sample| made.undone(sample, carrier).unwrap()).collect();
        let cause = calibration.fit(&wrong).unwrap().cause;
        let right = cause == FrameCause::Mistake { mistake: made };
        if !right {
            println!("seed {seed}: {made:?} was named {cause:?}");
        }
        named += usize::from(right);
    }
    println!("{made:?}, {carrier:?}: named in {named} of {SEEDS}");
    assert_eq!(named, SEEDS as usize, "{made:?}");
}

#[test]
fn a_tip_names_swaps_inverses_and_signs() {
    for tip in [TipSettings::by_tracker(), TipSettings::by_arm()] {
        for made in Mistake::of_pivoting(tip.carrier) {
            // An arm's poses come from its joints, so inverted poses cannot be detected there.
            if made == Mistake::InversePose && tip.carrier == Carrier::Flange {
                continue;
            }
            named(&tip, made, tip.carrier, |rig| rig.samples(in_dimple(), 24));
        }
    }
}

#[test]
fn hand_eye_names_swaps_inverses_and_signs() {
    let hand_eye = HandEyeSettings::new(TIP_IN_FLANGE_M);
    for (made, carrier) in hand_eye.mistakes() {
        named(&hand_eye, made, carrier, |rig| {
            let mut samples = rig.samples(through_trocar(), 16);
            resting(&mut samples);
            samples
        });
    }
}

#[test]
fn a_trocar_names_swaps_inverses_and_signs() {
    for trocar in [TrocarSettings::by_arm(&arm()), TrocarSettings::by_tracker(&arm(), &flange_from_m())] {
        for made in Mistake::of_pivoting(trocar.carrier) {
            named(&trocar, made, trocar.carrier, |rig| {
                let mut samples = rig.samples(through_trocar(), 40);
                resting(&mut samples);
                samples
            });
        }
    }
}

#[test]
fn a_table_names_swaps_and_exchanged_axes() {
    let points = [[0.0, 0.0], [0.12, 0.0], [0.02, 0.1], [0.1, 0.09], [0.06, 0.05]];
    named(&TableSettings::by_arm(TIP_IN_FLANGE_M, Vector3::z()), Mistake::SwappedArm, Carrier::Flange, |rig| {
        let mut samples = touched(rig, &points);
        resting(&mut samples);
        samples
    });
    for seed in 0..SEEDS {
        let exchanged = points.map(|[x, y]| [y, x]);
        let report = TableSettings::by_arm(TIP_IN_FLANGE_M, Vector3::z())
            .fit(&touched(&mut Rig::new(seed), &exchanged))
            .unwrap();
        assert_eq!(report.cause, FrameCause::Mistake { mistake: Mistake::Mirrored }, "seed {seed}");
    }
}

/// Keeps the other arm and marker at rest while one is used.
fn resting(samples: &mut [FrameSample]) {
    let first = samples[0];
    for sample in samples {
        sample.other_base_from_flange = first.other_base_from_flange;
        sample.c_from_other_m = first.c_from_other_m;
    }
}

#[test]
fn a_view_names_swaps_and_mirrors_and_leaves_one_reversed_move_out() {
    let view = ViewSettings::by_arm(TIP_IN_FLANGE_M);
    named(&view, Mistake::SwappedArm, Carrier::Flange, |rig| {
        let mut samples = moved(rig, &all_moves(), 3.0);
        resting(&mut samples);
        samples
    });
    for seed in 0..SEEDS {
        let mut mirrored = all_moves();
        for direction in &mut mirrored {
            // Odd seeds swap right and up; even seeds swap left and right.
            *direction = if seed % 2 == 0 {
                Vector3::new(-direction.x, direction.y, direction.z)
            } else {
                Vector3::new(-direction.y, -direction.x, direction.z)
            };
        }
        let report = view.fit(&moved(&mut Rig::new(seed), &mirrored, 3.0)).unwrap();
        assert_eq!(report.cause, FrameCause::Mistake { mistake: Mistake::Mirrored }, "seed {seed}");
        let mut one = [all_moves(), all_moves()].concat();
        one[3] = -one[3];
        let report = view.fit(&moved(&mut Rig::new(seed), &one, 3.0)).unwrap();
        assert_eq!((report.cause, report.outliers), (FrameCause::Proven, vec![3]), "seed {seed}");
    }
}

#[test]
fn a_sensor_mount_names_swaps_inverses_signs_and_exchanged_axes() {
    let active = pose([0.0; 3], [0.0, 0.0, 30.0]).rotation;
    // The active mount is slightly off.
    let truth = active * pose([0.0; 3], [1.0, 1.0, -1.0]).rotation;
    let mount = SensorMount::new(active, Vector3::z());
    for made in [Mistake::SwappedArm, Mistake::InverseRotation] {
        named(&mount, made, Carrier::Flange, |rig| all_weighed(rig, 12, &truth));
    }
    let [x, y, z] = [SignedAxis::PlusX, SignedAxis::PlusY, SignedAxis::PlusZ];
    let [no_x, no_y, no_z] = [SignedAxis::MinusX, SignedAxis::MinusY, SignedAxis::MinusZ];
    let wrong = [[no_x, y, z], [x, no_y, z], [x, y, no_z], [no_x, no_y, no_z], [y, x, z]];
    for axes in wrong {
        let read = Matrix3::from_fn(|row, column| match axes[row] as usize {
            axis if axis % 3 != column => 0.0,
            axis if axis < 3 => 1.0,
            _ => -1.0,
        });
        for seed in 0..SEEDS {
            let mut samples = all_weighed(&mut Rig::new(seed), 12, &truth);
            for sample in &mut samples {
                let wrench = sample.wrench.as_mut().unwrap();
                wrench.force_n = read * wrench.force_n;
            }
            let cause = mount.fit(&samples).unwrap().cause;
            let mistake = Mistake::WrongAxes(SignedAxes(axes));
            assert_eq!(cause, FrameCause::Mistake { mistake }, "seed {seed}");
        }
    }
}
