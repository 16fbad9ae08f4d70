//! Tests: whatever the input, all values stay finite, and every ring is within range or lost.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use proptest::prelude::*;

use super::{LEFT, RIGHT, Scene, at, instrument};
use crate::physics::{Instrument, ObjectSettings, RingActivity};

fn all_finite(scene: &Scene) -> bool {
    let loads = scene
        .loads
        .iter()
        .all(|loads| loads.tip_n.iter().chain(loads.torque_nm.iter()).chain([&loads.opening_n]).all(|x| x.is_finite()));
    let rings = scene
        .objects
        .rings()
        .iter()
        .all(|ring| ring.centre_m.norm() < 3.0 && ring.world_from_ring.coords.iter().all(|x| x.is_finite()));
    loads && rings && scene.objects.openings_rad().iter().flatten().all(|x| x.is_finite())
}

#[test]
fn what_is_not_a_number_counts_as_absent() {
    let sane = instrument(LEFT, at(0.0, 0.0, -0.001), 0.0);
    let turned = UnitQuaternion::new_unchecked(Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    let poisoned = [
        Instrument { tip_m: at(f64::NAN, 0.0, 0.0), ..sane },
        Instrument { tip_m: at(0.0, f64::INFINITY, 0.0), ..sane },
        Instrument { trocar_m: at(0.0, 0.0, f64::NAN), ..sane },
        Instrument { world_from_jaws: turned, ..sane },
        Instrument { opening_rad: f64::NEG_INFINITY, ..sane },
        Instrument { tip_m: at(1e300, 0.0, 0.0), ..sane },
    ];
    let mut scene = Scene::new(&ObjectSettings::default());
    for hand in poisoned {
        scene.hands[LEFT] = Some(sane);
        scene.run(0.005);
        assert!(scene.loads[LEFT].tip_n.z > 1.0);
        scene.hands[LEFT] = Some(hand);
        scene.run(0.005);
        assert!(all_finite(&scene) && scene.loads[LEFT].tip_n == Vector3::zeros(), "{hand:?}");
    }
}

fn motion() -> impl Strategy<Value = Vec<([f64; 3], [f64; 3], f64, u32)>> {
    let reach = || prop_oneof![4 => -0.06..0.06f64, 1 => -1.0..1.0f64];
    let height = prop_oneof![4 => -0.01..0.05f64, 1 => -0.5..0.5f64];
    let place = [reach().boxed(), reach().boxed(), height.boxed()];
    prop::collection::vec((place, [-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64], -1.0..3.0f64, 1..60u32), 60)
}

fn round(left: &[([f64; 3], [f64; 3], f64, u32)], right: &[([f64; 3], [f64; 3], f64, u32)]) {
    let mut scene = Scene::new(&ObjectSettings::default());
    for (left, right) in left.iter().zip(right) {
        for (side, (to_m, turn_rad, opening_rad, _)) in [(LEFT, left), (RIGHT, right)] {
            let hand = scene.hands[side].get_or_insert_with(|| instrument(side, at(0.0, 0.0, 0.05), 0.0));
            hand.world_from_jaws = UnitQuaternion::from_scaled_axis(Vector3::from(*turn_rad));
            hand.opening_rad = *opening_rad;
            let from_m = hand.tip_m;
            let ticks = left.3;
            for tick in 1..=ticks {
                let to_m = Vector3::from(*to_m);
                scene.hands[side].as_mut().unwrap().tip_m =
                    from_m + (to_m - from_m) * (f64::from(tick) / f64::from(ticks));
                scene.tick();
                assert!(all_finite(&scene));
            }
        }
    }
    for ring in scene.objects.rings() {
        assert!(ring.doing == RingActivity::OutOfView || ring.centre_m.norm() < 1.6, "{ring:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]
    #[test]
    fn hostile_motions_keep_everything_finite(left in motion(), right in motion()) {
        round(&left, &right);
    }
}

#[test]
#[ignore = "runs until it is stopped: ./dev fuzz"]
fn fuzz_motions_among_rings() {
    use proptest::{strategy::ValueTree, test_runner::TestRunner};
    nima_testing::fuzz::rounds(|seed| {
        let bytes: Vec<u8> = seed.to_le_bytes().into_iter().cycle().take(32).collect();
        let random = proptest::test_runner::TestRng::from_seed(proptest::test_runner::RngAlgorithm::ChaCha, &bytes);
        let mut runner = TestRunner::new_with_rng(ProptestConfig::default(), random);
        let mut draw = || motion().new_tree(&mut runner).unwrap().current();
        round(&draw(), &draw());
    });
}
