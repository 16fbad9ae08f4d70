//! Grasping, carrying, dropping.

use nima_core::{Side, task::TaskEvent};

use super::{LEFT, OPEN_RAD, RIGHT, Scene, at, one_ring};
use crate::physics::{RingActivity, RingStart};

#[test]
fn a_ring_on_its_peg_is_grasped_lifted_and_carried() {
    let mut scene = Scene::new(&one_ring(RingStart::Peg(0)));
    scene.grasp(LEFT, 0, -1.0);
    assert_eq!(scene.objects.rings()[0].doing, RingActivity::Held { by: [false, true] });
    assert!(scene.loads[LEFT].opening_n > 1.0, "{:?}", scene.loads[LEFT]);
    let tip_m = scene.hands[LEFT].unwrap().tip_m;
    scene.glide(LEFT, tip_m + at(0.0, 0.0, 0.04), 0.08);
    scene.run(0.3);
    assert!(scene.centre_m(0).z > 0.035, "{}", scene.centre_m(0));
    let expected =
        [TaskEvent::RingGrasped { ring: 0, side: Side::Left }, TaskEvent::RingLifted { ring: 0, side: Side::Left }];
    assert_eq!(scene.events, expected);
    let weight_n = 0.0015 * 9.806_65;
    assert!((scene.loads[LEFT].tip_n.z + weight_n).abs() < 1e-4, "the hand feels the weight: {:?}", scene.loads[LEFT]);
}

#[test]
fn a_held_ring_falls_when_the_jaws_open_and_comes_to_rest_on_the_board() {
    let mut scene = Scene::new(&one_ring(RingStart::At([0.0, 0.013, 0.00175])));
    scene.run(0.3);
    assert_eq!(scene.objects.rings()[0].doing, RingActivity::Lying);
    scene.grasp(RIGHT, 0, 1.0);
    let tip_m = scene.hands[RIGHT].unwrap().tip_m;
    scene.glide(RIGHT, tip_m + at(0.0, 0.0, 0.05), 0.1);
    scene.jaws(RIGHT, OPEN_RAD);
    scene.run(2.5);
    let ring = scene.objects.rings()[0];
    assert_eq!((ring.doing, ring.slow), (RingActivity::Lying, true));
    assert!((ring.centre_m.z - 0.00175).abs() < 2e-4, "it lies flat: {}", ring.centre_m);
    let expected = [
        TaskEvent::RingGrasped { ring: 0, side: Side::Right },
        TaskEvent::RingDropped { ring: 0, side: Side::Right, in_view: true },
    ];
    assert_eq!(scene.events, expected);
    let still_m = ring.centre_m;
    scene.run(1.0);
    assert_eq!(scene.centre_m(0), still_m, "at rest to the last bit");
}

#[test]
fn a_ring_that_slips_for_a_moment_was_not_dropped() {
    let mut scene = Scene::new(&one_ring(RingStart::At([0.0, 0.013, 0.00175])));
    scene.grasp(RIGHT, 0, 1.0);
    let tip_m = scene.hands[RIGHT].unwrap().tip_m;
    scene.glide(RIGHT, tip_m + at(0.0, 0.0, 0.05), 0.1);
    scene.hands[RIGHT].as_mut().unwrap().opening_rad = 0.55;
    scene.run(0.01);
    scene.hands[RIGHT].as_mut().unwrap().opening_rad = 0.0;
    scene.run(0.5);
    assert_eq!(scene.events, [TaskEvent::RingGrasped { ring: 0, side: Side::Right }]);
    assert!(matches!(scene.objects.rings()[0].doing, RingActivity::Held { .. }));
}

#[test]
fn a_ring_let_go_over_a_peg_is_placed_within_some_millimetres() {
    for (x_m, y_m) in [(0.0, 0.0), (0.003, 0.0), (-0.002, 0.002), (0.0, -0.003)] {
        let mut scene = Scene::new(&one_ring(RingStart::At([0.0, 0.013, 0.00175])));
        scene.grasp(RIGHT, 0, 1.0);
        let from_m = scene.centre_m(0);
        let tip_m = scene.hands[RIGHT].unwrap().tip_m;
        scene.glide(RIGHT, tip_m + at(0.0, 0.0, 0.045), 0.1);
        let [peg_x_m, peg_y_m] = crate::physics::Pegs::default().position_m[6];
        let over_m = tip_m - from_m + at(peg_x_m + x_m, peg_y_m + y_m, 0.033);
        scene.glide(RIGHT, over_m, 0.1);
        scene.glide(RIGHT, over_m - at(0.0, 0.0, 0.013), 0.05);
        scene.jaws(RIGHT, OPEN_RAD);
        scene.run(0.5);
        assert_eq!(scene.objects.rings()[0].doing, RingActivity::OnPeg(6), "{x_m} {y_m}: {:?}", scene.objects.rings());
        let placed = TaskEvent::RingPlaced { ring: 0, side: Side::Right, peg: 6 };
        assert_eq!(scene.events, [TaskEvent::RingGrasped { ring: 0, side: Side::Right }, placed], "{x_m} {y_m}");
    }
}

#[test]
fn a_ring_dropped_or_pushed_out_of_view_is_lost() {
    let mut scene = Scene::new(&one_ring(RingStart::At([0.035, 0.013, 0.00175])));
    scene.grasp(RIGHT, 0, 1.0);
    let tip_m = scene.hands[RIGHT].unwrap().tip_m;
    scene.glide(RIGHT, tip_m + at(0.0, 0.0, 0.05), 0.1);
    scene.glide(RIGHT, tip_m + at(0.035, 0.0, 0.05), 0.1);
    scene.run(0.3);
    assert!(matches!(scene.objects.rings()[0].doing, RingActivity::Held { .. }), "held is not lost");
    scene.jaws(RIGHT, OPEN_RAD);
    scene.run(0.5);
    assert_eq!(scene.objects.rings()[0].doing, RingActivity::OutOfView);
    assert_eq!(scene.events.last(), Some(&TaskEvent::RingDropped { ring: 0, side: Side::Right, in_view: false }));

    let mut scene = Scene::new(&one_ring(RingStart::At([0.045, 0.013, 0.00175])));
    scene.hands[LEFT] = Some(super::instrument(LEFT, at(0.030, 0.013, 0.002), 0.0));
    scene.glide(LEFT, at(0.064, 0.013, 0.002), 0.05);
    scene.run(1.0);
    assert_eq!(scene.objects.rings()[0].doing, RingActivity::OutOfView);
    assert_eq!(scene.events, [TaskEvent::RingDropped { ring: 0, side: Side::Left, in_view: false }]);
}

#[test]
fn a_ring_that_is_flung_off_its_peg_was_knocked_off() {
    let mut scene = Scene::new(&one_ring(RingStart::Peg(0)));
    // Start below the rim and move up along the peg, with closed jaws.
    let peg_m = scene.centre_m(0);
    let tip_m = peg_m + at(-0.0075, 0.0, 0.012);
    scene.hands[LEFT] = Some(super::instrument(LEFT, tip_m, OPEN_RAD));
    scene.objects.ring_mut(0).throw(peg_m + at(0.0, 0.0, 0.004), at(0.0, 0.0, 0.9), at(0.0, 0.0, 0.0));
    scene.objects.ring_mut(0).velocity_m_s.x = 0.1;
    scene.run(1.5);
    assert!(matches!(scene.events[..], [TaskEvent::RingKnockedOff { ring: 0, .. }]), "{:?}", scene.events);
}

/// The closed jaws enter the ring next to its peg, press it outwards against the peg, and are pulled up.
#[test]
fn an_instrument_that_drags_a_ring_up_its_peg_knocks_it_off_and_is_named() {
    let mut scene = Scene::new(&one_ring(RingStart::Peg(0)));
    let peg_m = scene.centre_m(0);
    scene.hands[LEFT] = Some(super::instrument(LEFT, peg_m + at(0.0, 0.0036, 0.03), 0.0));
    scene.glide(LEFT, peg_m + at(0.0, 0.0036, -0.0005), 0.1);
    scene.glide(LEFT, peg_m + at(0.0, 0.0090, -0.0005), 0.03);
    assert!(scene.loads[LEFT].touching.ring, "{:?}", scene.loads[LEFT]);
    scene.glide(LEFT, peg_m + at(0.0, 0.0090, 0.06), 0.2);
    scene.run(1.5);
    let knocked = TaskEvent::RingKnockedOff { ring: 0, side: Some(Side::Left) };
    assert_eq!(scene.events.first(), Some(&knocked), "{:?}", scene.objects.rings());
    assert!(!matches!(scene.objects.rings()[0].doing, RingActivity::OnPeg(_) | RingActivity::Held { .. }));
}
