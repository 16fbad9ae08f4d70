//! The task performed by two hands.

use nima_core::{Side, task::TaskEvent};

use super::{LEFT, OPEN_RAD, RIGHT, Scene, at, one_ring};
use crate::physics::{ObjectSettings, PegTransfer, Pegs, RingActivity, RingStart};

impl Scene {
    /// One hand takes a ring from its peg to the middle; the other takes it there and puts it on a peg.
    fn carry_over(&mut self, from: usize, ring: usize, to_peg: usize) {
        let to = 1 - from;
        let outwards = if from == LEFT { -1.0 } else { 1.0 };
        self.grasp(from, ring, outwards);
        let tip_m = self.hands[from].unwrap().tip_m;
        self.glide(from, tip_m + at(0.0, 0.0, 0.045), 0.1);
        self.glide(from, at(outwards * 0.00725, 0.0, 0.06), 0.1);
        self.run(0.2);
        self.grasp(to, ring, -outwards);
        self.jaws(from, OPEN_RAD);
        let away_m = self.hands[from].unwrap().tip_m + at(outwards * 0.002, 0.0, 0.03);
        self.glide(from, away_m, 0.05);
        self.glide(from, at(outwards * 0.045, 0.0, 0.09), 0.15);
        self.place(to, ring, to_peg);
    }

    fn place(&mut self, side: usize, ring: usize, peg: usize) {
        let [x_m, y_m] = Pegs::default().position_m[peg];
        let grip_m = self.hands[side].unwrap().tip_m - self.centre_m(ring);
        self.glide(side, at(x_m, y_m, 0.045) + grip_m, 0.1);
        self.run(0.1);
        let grip_m = self.hands[side].unwrap().tip_m - self.centre_m(ring);
        let off_m = self.off_m() * 2.0;
        self.glide(side, at(x_m, y_m, 0.018) + grip_m + off_m, 0.05);
        self.jaws(side, OPEN_RAD);
        let tip_m = self.hands[side].unwrap().tip_m;
        self.glide(side, tip_m + at(0.0, 0.0, 0.04), 0.1);
        self.run(0.3);
    }
}

#[test]
fn a_ring_goes_from_hand_to_hand_in_mid_air_once_and_is_not_dropped() {
    let mut scene = Scene::new(&one_ring(RingStart::Peg(0)));
    scene.carry_over(LEFT, 0, 6);
    let expected = [
        TaskEvent::RingGrasped { ring: 0, side: Side::Left },
        TaskEvent::RingLifted { ring: 0, side: Side::Left },
        TaskEvent::RingTransferred { ring: 0, to: Side::Right },
        TaskEvent::RingPlaced { ring: 0, side: Side::Right, peg: 6 },
    ];
    assert_eq!(scene.events, expected);
}

#[test]
fn one_ring_goes_over_and_back() {
    let setting = one_ring(RingStart::Peg(0));
    let mut task = PegTransfer::new(&setting);
    let mut scene = Scene::new(&setting);
    scene.carry_over(LEFT, 0, 6);
    scene.carry_over(RIGHT, 0, 0);
    assert_eq!(scene.objects.rings()[0].doing, RingActivity::OnPeg(0));
    assert_eq!(scene.events.len(), 8, "{:?}", scene.events);
    assert!(!task.is_done());
    scene.events.iter().for_each(|event| task.take(*event));
    assert!(task.is_done());
}

#[test]
fn six_rings_go_over_and_back() {
    let setting = ObjectSettings::default();
    let mut task = PegTransfer::new(&setting);
    let mut scene = Scene::new(&setting);
    for ring in 0..6 {
        scene.carry_over(LEFT, ring, 6 + ring);
    }
    for ring in 0..6 {
        scene.carry_over(RIGHT, ring, ring);
    }
    for event in &scene.events {
        assert!(!task.is_done());
        task.take(*event);
    }
    assert!(task.is_done(), "{:?}", scene.events);
    assert_eq!(scene.events.len(), 48, "nothing was dropped or knocked off: {:?}", scene.events);
}

#[test]
fn unsure_hands_without_a_wrist_do_it_too() {
    let setting = one_ring(RingStart::Peg(1));
    for unsure_m in [5e-4, 1e-3] {
        let mut scene = Scene::new(&setting);
        scene.unsure_m = unsure_m;
        let mut task = PegTransfer::new(&setting);
        scene.carry_over(LEFT, 0, 9);
        scene.carry_over(RIGHT, 0, 4);
        scene.events.iter().for_each(|event| task.take(*event));
        assert!(task.is_done(), "off by {unsure_m} m: {:?}", scene.events);
    }
}
