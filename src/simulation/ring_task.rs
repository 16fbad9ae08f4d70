//! The task of hands that carry rings from peg to peg: to the other side, and back.
//!
//! With two hands each ring changes hands in the middle, as in FLS: one hand takes it from its peg, the other takes it
//! in mid-air and puts it on a peg of its side. A single hand carries it all the way.

use nalgebra::Vector3;
use nima_machine::rig::{SIDES, Side};

use crate::{
    hand_task::{HandMove, HandTaskPart},
    physics::{ObjectSettings, RingStart},
};

/// Opening angle of jaws around a ring, rad, and opening speed.
const OPEN_RAD: f64 = 0.6;
const OPENS_S: f64 = 0.3;
/// Speeds of the tip between positions, on the approach to a ring or a peg, and of a hand that moves away, m/s.
const CARRIES_M_S: f64 = 0.10;
const NEARS_M_S: f64 = 0.05;
const LEAVES_M_S: f64 = 0.15;
/// Height of an empty hand above a ring, and of a carried ring above the tops of the pegs, m.
const ABOVE_RING_M: f64 = 0.03;
const OVER_PEGS_M: f64 = 0.02;
/// A ring is released at this fraction of the height of its peg.
const LET_GO: f64 = 0.64;
/// Jaws reach this far below the middle of a ring, m.
const DEEPER_M: f64 = 0.001;
/// Where rings change hands, m, and where the other hand waits.
const MIDDLE_M: Vector3<f64> = Vector3::new(0.0, 0.0, 0.060);
const ASIDE_M: Vector3<f64> = Vector3::new(0.045, 0.0, 0.090);
/// Rest after the task, s.
const DONE_S: f64 = 1e6;
/// Rest between two parts of the task, s.
const REST_S: f64 = 0.3;

/// The parts of both hands' tasks, which have equal durations.
struct CarryingTask {
    /// Distance from the middle of a ring to the middle of its tube, and the height of a ring on the board, m.
    rim_m: f64,
    lies_m: f64,
    peg_m: f64,
    parts: [Vec<HandTaskPart>; SIDES],
    position_m: [Vector3<f64>; SIDES],
    grip_rad: [f64; SIDES],
}

/// Returns the task of each hand; only the right hand's task if there is no other hand. Empty without a ring on a peg
/// that has an opposite peg.
pub(super) fn ways(setting: &ObjectSettings, two_hands: bool) -> [Vec<HandTaskPart>; SIDES] {
    let waits = [Side::Right, Side::Left].map(|side| outwards(side, ASIDE_M));
    let rim_m = setting.ring.major_radius_m;
    let lies_m = setting.ring.tube_radius_m;
    let peg_m = setting.pegs.height_m;
    let mut task =
        CarryingTask { rim_m, lies_m, peg_m, parts: [vec![], vec![]], position_m: waits, grip_rad: [0.0; SIDES] };
    let pegs = &setting.pegs.position_m;
    let foot_m = |peg: usize| pegs.get(peg).map(|[x, y]| Vector3::new(*x, *y, setting.board.z_m));
    // The pegs on the right are in the same order as those on the left.
    let opposite = |peg: usize| if peg < pegs.len() / 2 { peg + pegs.len() / 2 } else { peg - pegs.len() / 2 };
    let pairs: Vec<_> = setting
        .rings
        .iter()
        .filter_map(|start| match start {
            RingStart::Peg(peg) => Some([foot_m(*peg)?, foot_m(opposite(*peg))?]),
            RingStart::At(_) => None,
        })
        .collect();
    let back = pairs.iter().map(|[here_m, there_m]| [*there_m, *here_m]);
    for [from_m, to_m] in pairs.iter().copied().chain(back) {
        let giver = if from_m.x < 0.0 { Side::Left } else { Side::Right };
        if two_hands {
            task.hand_over(giver, from_m, to_m);
        } else {
            task.carry(Side::Right, from_m, to_m);
        }
    }
    // A ring may be some millimetres from where it started, and these hands are blind, so they carry each ring over and
    // back only once.
    if !pairs.is_empty() {
        task.act(Side::Right, task.position_m[Side::Right.index()], 0.0, DONE_S);
    }
    task.parts
}

/// Mirrors a position on the right side for the left one.
fn outwards(side: Side, position_m: Vector3<f64>) -> Vector3<f64> {
    match side {
        Side::Right => position_m,
        Side::Left => Vector3::new(-position_m.x, position_m.y, position_m.z),
    }
}

impl CarryingTask {
    /// Moves one hand while the other one waits.
    fn act(&mut self, side: Side, to_m: Vector3<f64>, to_rad: f64, seconds: f64) {
        for hand in Side::ALL {
            let i = hand.index();
            let (to_m, to_rad) = if hand == side { (to_m, to_rad) } else { (self.position_m[i], self.grip_rad[i]) };
            let way = HandMove { from_m: self.position_m[i], to_m, seconds };
            self.parts[i].push(HandTaskPart { way, grip_rad: [self.grip_rad[i], to_rad], then: None });
            self.position_m[i] = to_m;
            self.grip_rad[i] = to_rad;
        }
    }

    fn go(&mut self, side: Side, to_m: Vector3<f64>, speed_m_s: f64) {
        let i = side.index();
        let seconds = (to_m - self.position_m[i]).norm() / speed_m_s;
        self.act(side, to_m, self.grip_rad[i], seconds.max(0.05));
    }

    fn jaws(&mut self, side: Side, to_rad: f64) {
        let position_m = self.position_m[side.index()];
        self.act(side, position_m, to_rad, OPENS_S);
        self.act(side, position_m, to_rad, REST_S);
    }

    /// Returns the position of the tip at a ring with this middle: at its outer rim, on the hand's own side.
    fn rim_m(&self, side: Side, middle_m: Vector3<f64>) -> Vector3<f64> {
        middle_m + outwards(side, Vector3::new(self.rim_m, 0.0, -DEEPER_M))
    }

    fn grasp(&mut self, side: Side, middle_m: Vector3<f64>) {
        let rim_m = self.rim_m(side, middle_m);
        self.go(side, rim_m + Vector3::z() * ABOVE_RING_M, CARRIES_M_S);
        self.jaws(side, OPEN_RAD);
        self.go(side, rim_m, NEARS_M_S);
        self.jaws(side, 0.0);
    }

    fn lift(&mut self, side: Side) {
        let position_m = self.position_m[side.index()];
        self.go(side, position_m + Vector3::z() * (self.peg_m + OVER_PEGS_M), CARRIES_M_S);
    }

    fn place(&mut self, side: Side, foot_m: Vector3<f64>) {
        let over = |height_m: f64| foot_m + Vector3::z() * height_m;
        let [above_m, on_m] =
            [over(self.peg_m + OVER_PEGS_M), over(LET_GO * self.peg_m)].map(|middle_m| self.rim_m(side, middle_m));
        self.go(side, above_m, CARRIES_M_S);
        self.go(side, on_m, NEARS_M_S);
        self.jaws(side, OPEN_RAD);
        self.go(side, above_m, CARRIES_M_S);
    }

    fn hand_over(&mut self, giver: Side, from_m: Vector3<f64>, to_m: Vector3<f64>) {
        let taker = giver.other();
        self.grasp(giver, from_m + Vector3::z() * self.lies_m);
        self.lift(giver);
        let held_m = self.rim_m(giver, MIDDLE_M);
        self.go(giver, held_m, CARRIES_M_S);
        self.grasp(taker, MIDDLE_M);
        self.jaws(giver, OPEN_RAD);
        self.go(giver, held_m + outwards(giver, Vector3::new(0.002, 0.0, ABOVE_RING_M)), NEARS_M_S);
        self.go(giver, outwards(giver, ASIDE_M), LEAVES_M_S);
        self.place(taker, to_m);
        self.go(taker, outwards(taker, ASIDE_M), LEAVES_M_S);
    }

    fn carry(&mut self, side: Side, from_m: Vector3<f64>, to_m: Vector3<f64>) {
        self.grasp(side, from_m + Vector3::z() * self.lies_m);
        self.lift(side);
        self.place(side, to_m);
    }
}
