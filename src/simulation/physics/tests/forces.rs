//! The laws: friction, torsion, torque about the shaft, contact of instruments.

use nalgebra::{UnitQuaternion, Vector3};

use super::{LEFT, RIGHT, Scene, at, downwards, instrument, one_ring};
use crate::physics::{Instrument, InstrumentLoads, ObjectSettings, Objects, RingShape, RingStart};

const GRAVITY_M_S2: f64 = 9.806_65;

/// Returns a ring with a thin tube between jaws in the air, pressed with 1 N. The fingers are then nearly parallel.
fn gripped() -> Scene {
    let mut setting = one_ring(RingStart::At([-0.007, 0.0, 0.05]));
    setting.ring = RingShape { major_radius_m: 0.007, tube_radius_m: 5e-4, ..RingShape::default() };
    setting.jaws.finger_length_m = 0.02;
    setting.jaws.stiffness_n_m = 2000.0;
    setting.contact.ring_stiffness_n_m = 10_000.0;
    let mut scene = Scene::new(&setting);
    scene.hands[RIGHT] = Some(instrument(RIGHT, at(0.0, 0.0, 0.049), 0.05));
    for _ in 0..2000 {
        scene.tick();
        let lacking_n = 1.0 - scene.objects.grip_n(0, RIGHT);
        scene.hands[RIGHT].as_mut().unwrap().opening_rad -= lacking_n * 1e-3;
    }
    scene
}

#[test]
fn a_grip_of_1_n_carries_a_ring_and_slips_at_twice_mu_n() {
    let mut scene = gripped();
    assert!((scene.objects.grip_n(0, RIGHT) - 1.0).abs() < 0.01, "{}", scene.objects.grip_n(0, RIGHT));
    let held_m = scene.centre_m(0);
    scene.run(1.0);
    assert!((scene.centre_m(0) - held_m).norm() < 1e-5, "it carries the weight and does not creep");
    let mut slipped_n = None;
    for tick in 0..1200 {
        let force_n = f64::from(tick) * 1e-3;
        let rim_m = scene.centre_m(0) + at(0.007, 0.0, 0.0);
        scene.objects.pulled_n = Some((rim_m, Vector3::y() * force_n));
        scene.tick();
        if (scene.centre_m(0) - held_m).norm() > 6e-4 {
            slipped_n = Some(force_n);
            break;
        }
    }
    let slipped_n = slipped_n.expect("it slips");
    println!("slipped at {slipped_n} N");
    assert!((slipped_n / 0.8 - 1.0).abs() < 0.05, "2 mu N is 0.8 N; it slipped at {slipped_n} N");
}

#[test]
fn the_jaws_press_with_their_stiffness_times_the_width_up_to_their_most() {
    for (opening_rad, max_n) in [(0.25, 5.0), (0.0, 5.0), (0.0, 1.5)] {
        let mut setting = one_ring(RingStart::At([-0.00725, 0.0, 0.00175]));
        setting.jaws.force_max_n = max_n;
        let mut scene = Scene::new(&setting);
        scene.hands[RIGHT] = Some(instrument(RIGHT, at(0.0, 0.0, 0.001), super::OPEN_RAD));
        scene.jaws(RIGHT, opening_rad);
        scene.run(0.3);
        let wide_m = 0.01 * (scene.objects.openings_rad()[RIGHT].unwrap() - opening_rad);
        let law_n = (500.0 * wide_m).min(max_n);
        assert!(law_n > 0.3 && (scene.loads[RIGHT].opening_n - law_n).abs() < 0.01 * law_n, "{:?}", scene.loads);
    }
}

#[test]
fn a_ring_held_off_its_centre_turns_the_shaft_by_its_weight() {
    let mut scene = Scene::new(&one_ring(RingStart::At([-0.00725, 0.0, 0.00175])));
    scene.hands[RIGHT] = Some(instrument(RIGHT, at(0.0, 0.0, 0.001), super::OPEN_RAD));
    scene.jaws(RIGHT, 0.0);
    scene.glide(RIGHT, at(0.0, 0.0, 0.05), 0.1);
    // Rotate the jaws until they point along y, with the shaft behind them.
    for tick in 1..=500 {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), f64::from(tick) * 1e-3 * std::f64::consts::PI);
        let hand = scene.hands[RIGHT].as_mut().unwrap();
        hand.world_from_jaws = turn * downwards();
        hand.trocar_m = hand.tip_m - hand.world_from_jaws * Vector3::z() * 0.12;
        scene.tick();
    }
    scene.run(0.5);
    let hand = scene.hands[RIGHT].unwrap();
    let shaft = hand.world_from_jaws * Vector3::z();
    let offset_m = scene.centre_m(0) - hand.tip_m;
    let law_nm = offset_m.cross(&Vector3::new(0.0, 0.0, -0.0015 * GRAVITY_M_S2));
    let torque_nm = scene.loads[RIGHT].torque_nm;
    assert!(law_nm.dot(&shaft).abs() > 0.9e-4, "{law_nm}");
    assert!((torque_nm - law_nm).norm() < 0.02 * law_nm.norm(), "{torque_nm} instead of {law_nm}");
}

#[test]
fn shafts_push_each_other_apart_with_opposite_forces() {
    let setting = ObjectSettings { rings: Vec::new(), ..ObjectSettings::default() };
    let mut scene = Scene::new(&setting);
    let crossing = |side: usize, y_m: f64| {
        let x_m = if side == LEFT { -0.05 } else { 0.05 };
        let trocar_m = at(x_m, y_m, 0.14);
        let tip_m = at(-x_m, y_m, 0.04);
        let turn = UnitQuaternion::rotation_between(&Vector3::z(), &(tip_m - trocar_m)).unwrap();
        Instrument { tip_m, world_from_jaws: turn, trocar_m, opening_rad: 0.0 }
    };
    scene.hands[LEFT] = Some(crossing(LEFT, 0.0));
    scene.hands[RIGHT] = Some(crossing(RIGHT, 0.0045));
    scene.run(0.01);
    let [left_n, right_n] = [LEFT, RIGHT].map(|side| scene.loads[side].tip_n);
    assert!(left_n.y < -0.4 && (left_n + right_n).norm() < 1e-9, "{left_n} {right_n}");
    assert!(scene.loads.iter().all(|loads| loads.touching.other_instrument && !loads.touching.peg));
    scene.hands[RIGHT] = Some(crossing(RIGHT, 0.006));
    scene.run(0.01);
    assert_eq!(scene.loads.map(|loads| loads.tip_n), [Vector3::zeros(); 2], "5 mm shafts 6 mm apart");
}

#[test]
fn a_peg_pushes_back_what_is_pressed_against_it_and_holds_by_friction() {
    let mut scene = Scene::new(&ObjectSettings { rings: Vec::new(), ..ObjectSettings::default() });
    let [x_m, y_m] = crate::physics::Pegs::default().position_m[6];
    // Press with the fingers only: the shaft, which is thicker, stays above the peg's top.
    let touching_m = 0.00175 + 2.0 * 0.0008;
    scene.hands[RIGHT] = Some(instrument(RIGHT, at(x_m + touching_m + 0.002, y_m, 0.019), 0.0));
    scene.glide(RIGHT, at(x_m + touching_m - 0.001, y_m, 0.019), 0.02);
    scene.run(0.1);
    let loads = scene.loads[RIGHT];
    assert!(loads.touching.peg && (loads.tip_n.x - 1.0).abs() < 0.05, "1 kN/m at 1 mm: {loads:?}");
    scene.glide(RIGHT, at(x_m + touching_m - 0.001, y_m, 0.021), 0.02);
    let loads = scene.loads[RIGHT];
    assert!((loads.tip_n.z / loads.tip_n.x + 0.15).abs() < 0.01, "friction holds back: {loads:?}");
}

#[test]
fn no_rings_cost_nothing_and_an_absent_instrument_feels_nothing() {
    let mut objects = Objects::new(&ObjectSettings { rings: Vec::new(), ..ObjectSettings::default() }, 1e-3);
    assert!(objects.rings().is_empty());
    assert_eq!(objects.step(&[None, None]), [InstrumentLoads::default(); 2]);
    assert_eq!(objects.openings_rad(), [None, None]);
}
