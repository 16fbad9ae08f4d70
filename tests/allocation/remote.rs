//! Test: a tick of either of two machines allocates nothing, because messages are packed, sent, received and unpacked
//! in place.

use std::sync::Mutex;

use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState},
    remote::{FollowerRig, MESSAGE_MAX, OperatorRig, RemoteWire, at_follower},
    rig::Rig,
    runtime::tick,
    teleop::{Calibrations, Loop},
};
use nima_simulation::{Worlds, scene::Scene};
use nima_testing::real_time::alone;

use crate::counting::calls;

/// The newest message in each direction.
struct Slot(Mutex<([u8; MESSAGE_MAX], usize)>);

impl Slot {
    const fn empty() -> Self {
        Self(Mutex::new(([0; MESSAGE_MAX], 0)))
    }
}

static WAYS: [Slot; 2] = [Slot::empty(), Slot::empty()];

/// One end, with its number.
struct InPlace(usize);

impl RemoteWire for InPlace {
    fn send(&mut self, _: f64, message: &[u8]) {
        let mut way = WAYS[self.0].0.lock().unwrap();
        way.0[..message.len()].copy_from_slice(message);
        way.1 = message.len();
    }

    fn receive(&mut self, _: f64, take: &mut dyn FnMut(&[u8])) {
        let mut way = WAYS[1 - self.0].0.lock().unwrap();
        let len = std::mem::take(&mut way.1);
        if len > 0 {
            take(&way.0[..len]);
        }
    }
}

fn step(control: &mut Loop, rig: &mut impl Rig, now_s: f64, command: Option<Command>) -> LoopState {
    tick(control, rig, now_s, command)[0].unwrap().state
}

#[test]
fn a_tick_of_two_machines_allocates_nothing() {
    let _alone = alone();
    let rig = RigConfig::load("simulated").unwrap();
    let worlds = || Worlds::new(&Scene::load("bimanual").unwrap(), rig.rate_hz);
    let both = [Some(Calibrations::default()), Some(Calibrations::default())];
    let mut here = Loop::new(&rig, &both).unwrap();
    let mut there = Loop::new(&at_follower(&rig), &both).unwrap();
    let mut leader = OperatorRig::new(worlds(), InPlace(0), rig.rate_hz);
    let mut follower = FollowerRig::new(worlds(), InPlace(1), rig.rate_hz);
    let before = calls();
    let mut states = [LoopState::Idle; 2];
    for tick in 0..4000 {
        let now_s = f64::from(tick) * 1e-3;
        let command = match tick {
            100 | 2600 => Some(Command::Engage),
            2000 => Some(Command::Stop),
            2500 => Some(Command::ReleaseStop),
            _ => None,
        };
        states = [step(&mut here, &mut leader, now_s, command), step(&mut there, &mut follower, now_s, None)];
    }
    assert_eq!(calls() - before, 0);
    assert_eq!(states, [LoopState::Engaged; 2]);
}
