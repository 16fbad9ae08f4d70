//! A tick of two arms among rings.

use nima_machine::rig::{Outputs, Rig as _, SIDES, Side};
use nima_simulation::{Worlds, scene::Scene};
use nima_testing::real_time::alone;

use crate::counting::calls;

#[test]
fn a_tick_of_two_instruments_among_rings_allocates_nothing() {
    let _alone = alone();
    let (mut worlds, watched) = Worlds::watched(&Scene::load("rings").unwrap(), 1000.0);
    let watched = watched.unwrap();
    let mut events = 0;
    let mut gripped = false;
    let before = calls();
    for tick in 0..12_000 {
        let inputs = worlds.read(f64::from(tick) * 1e-3);
        let mut outputs = [Outputs::SAFE; SIDES];
        for side in Side::ALL.map(Side::index) {
            outputs[side].tip_command_m = inputs[side].map(|inputs| inputs.hand.position_m);
            gripped |= inputs[side].is_some_and(|inputs| inputs.grip_n.is_some_and(|grip_n| grip_n > 1.0));
        }
        worlds.write(f64::from(tick) * 1e-3, &outputs);
        events += watched.happenings().count();
    }
    assert_eq!(calls() - before, 0);
    assert!(events >= 3 && gripped, "a ring was grasped, lifted and passed on: {events}");
}
