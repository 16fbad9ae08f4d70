//! One person leads two instruments from the screen, one at a time: a ring is passed from hand to hand, over to the
//! other side and back.

use nalgebra::Vector3;
use nima_core::{impedance::Mode, task::TaskEvent};
use nima_machine::{
    messages::{Command, LoopState},
    rig::{SIDES, Side},
    runtime,
};
use nima_tests::plan;

/// Distance that a led hand moves per second, m, and pause after that, s.
const LED_M_S: f64 = 0.15;
const SETTLES_S: f64 = 0.2;
const OPEN_RAD: f64 = 0.6;
/// Height of a carried ring, and of one that is released over a peg, m.
const CARRIED_M: f64 = 0.037;
const LET_GO_M: f64 = 0.016;

/// Commands to the loop, and their times, s.
struct Script {
    t_s: f64,
    commands: Vec<(f64, Command)>,
    position_m: [Vector3<f64>; SIDES],
}

/// From the middle of a ring to the middle of its tube, m.
const RIM_M: f64 = 0.00725;

/// Returns the position of the tip at the outer rim of a ring with this middle, on the hand's own side.
fn rim_m(side: Side, [x, y]: [f64; 2], height_m: f64) -> Vector3<f64> {
    let out_m = if side == Side::Left { -RIM_M } else { RIM_M };
    Vector3::new(x + out_m, y, height_m - 0.001)
}

impl Script {
    fn begin() -> Self {
        let position_m = [Vector3::new(0.03, 0.0, 0.06), Vector3::new(-0.03, 0.0, 0.06)];
        let mut script = Self { t_s: 0.5, commands: Vec::new(), position_m };
        for side in Side::ALL {
            script.commands.push((script.t_s, Command::Guide(side, Some(position_m[side.index()]))));
        }
        script.t_s += 0.6;
        script
    }

    fn go(&mut self, side: Side, to_m: Vector3<f64>) {
        self.commands.push((self.t_s, Command::Guide(side, Some(to_m))));
        let from_m = std::mem::replace(&mut self.position_m[side.index()], to_m);
        self.t_s += (to_m - from_m).norm() / LED_M_S + SETTLES_S;
    }

    fn up(&mut self, side: Side, height_m: f64) {
        let position_m = self.position_m[side.index()];
        self.go(side, Vector3::new(position_m.x, position_m.y, height_m));
    }

    fn jaws(&mut self, side: Side, open: bool) {
        self.commands.push((self.t_s, Command::Grip(side, Some(if open { OPEN_RAD } else { 0.0 }))));
        self.t_s += 0.3;
    }

    /// Moves a ring from this peg to that one; returns when only the taker holds it, and until when it is carried, s.
    fn over(&mut self, giver: Side, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
        let taker = giver.other();
        let middle = [0.0, 0.0];
        self.jaws(giver, true);
        self.go(giver, rim_m(giver, from, CARRIED_M));
        self.go(giver, rim_m(giver, from, 0.00175));
        self.jaws(giver, false);
        self.up(giver, CARRIED_M);
        self.go(taker, rim_m(taker, middle, 0.06));
        self.jaws(taker, true);
        self.go(giver, rim_m(giver, middle, CARRIED_M));
        let begins_s = self.t_s;
        self.go(taker, rim_m(taker, middle, CARRIED_M));
        self.jaws(taker, false);
        let ends_s = self.t_s;
        self.jaws(giver, true);
        self.up(giver, 0.06);
        self.go(taker, rim_m(taker, to, CARRIED_M));
        self.go(taker, rim_m(taker, to, LET_GO_M));
        self.jaws(taker, true);
        self.up(taker, CARRIED_M);
        [begins_s, ends_s]
    }
}

/// Returns the events of the rings during these commands, and the distance that the left tip moved in this time, m.
fn played(script: &Script, while_s: [f64; 2]) -> (Vec<TaskEvent>, f64) {
    let mut plan = plan("rings");
    plan.rig.mode = Mode::Matched;
    let (assembly, watched) = plan.watched().unwrap();
    let watched = watched.unwrap();
    let mut events = Vec::new();
    let mut given = 0;
    let mut held_m = None;
    let mut went_m = 0.0_f64;
    let summary = runtime::run_virtual(assembly, script.t_s + 0.5, |tick| {
        events.extend(watched.happenings().map(|happening| happening.event));
        if tick.side == Side::Left {
            if (while_s[0]..while_s[1]).contains(&tick.t_s) {
                went_m = went_m.max((tick.positions.tip_m - *held_m.get_or_insert(tick.positions.tip_m)).norm());
            }
            return None;
        }
        let (at_s, command) = script.commands.get(given)?;
        (tick.t_s >= *at_s).then(|| {
            given += 1;
            *command
        })
    });
    assert_eq!(summary.final_state, LoopState::Engaged);
    (events, went_m)
}

#[test]
fn a_ring_goes_over_and_back_and_the_hand_that_is_not_led_stays_and_holds() {
    let pegs = plan("rings").scene.objects.unwrap().pegs.position_m;
    let mut script = Script::begin();
    let held_s = script.over(Side::Left, pegs[3], pegs[9]);
    script.over(Side::Right, pegs[9], pegs[3]);
    let (events, went_m) = played(&script, held_s);
    let of = |ring, giver, taker, peg| {
        [
            TaskEvent::RingGrasped { ring, side: giver },
            TaskEvent::RingLifted { ring, side: giver },
            TaskEvent::RingTransferred { ring, to: taker },
            TaskEvent::RingPlaced { ring, side: taker, peg },
        ]
    };
    let [left, right] = Side::LEFT_TO_RIGHT;
    let wanted: Vec<TaskEvent> = of(3, left, right, 9).into_iter().chain(of(3, right, left, 3)).collect();
    assert_eq!(events, wanted);
    assert!(went_m < 0.002, "while the other one takes the ring: {went_m} m");
}
