//! Peg transfer in the closed loop: two hands carry six rings over and back.

use nima_core::{impedance::Mode, task::TaskEvent};
use nima_machine::{
    messages::LoopState,
    rig::{Rig as _, SIDES, Side},
    runtime,
};
use nima_simulation::{SimulationPlan, Worlds, scene::Scene};
use nima_tests::plan;

fn matched() -> SimulationPlan {
    let mut plan = plan("rings");
    plan.rig.mode = Mode::Matched;
    plan
}

#[test]
fn six_rings_go_over_and_back_from_hand_to_hand_and_none_is_dropped() {
    let (assembly, watched) = matched().watched().unwrap();
    let watched = watched.unwrap();
    let mut events = Vec::new();
    let mut grip_n = 0.0_f64;
    let summary = runtime::run_virtual(assembly, 125.0, |tick| {
        if tick.side == Side::Left {
            events.extend(watched.happenings().map(|happening| happening.event));
            grip_n = watched.newest().map_or(grip_n, |moment| grip_n.max(moment.loads[0].opening_n));
        }
        None
    });
    assert_eq!(summary.final_state, LoopState::Engaged);
    let count = |wanted: fn(&TaskEvent) -> bool| events.iter().filter(|event| wanted(event)).count();
    let counts = [
        count(|event| matches!(event, TaskEvent::RingTransferred { .. })),
        count(|event| matches!(event, TaskEvent::RingPlaced { .. })),
        count(|event| matches!(event, TaskEvent::RingDropped { .. } | TaskEvent::RingKnockedOff { .. })),
    ];
    assert_eq!((counts, events.last()), ([12, 12, 0], Some(&TaskEvent::Ended)), "{events:?}");
    assert!((1.0..6.0).contains(&grip_n), "the jaws press: {grip_n} N");
}

#[test]
fn the_same_scene_gives_the_same_forces_to_the_last_bit() {
    let forces = || {
        let mut bits = Vec::new();
        let plan = matched();
        nima_simulation::run_virtual(&plan, 8.0, |tick| {
            bits.extend(tick.measured_n.iter().chain(&tick.positions.tip_m).map(|x| x.to_bits()));
            None
        })
        .unwrap();
        bits
    };
    assert_eq!(forces(), forces());
}

#[test]
fn jaws_are_for_scenes_with_rings() {
    for (scene, has_jaws) in [("rings", true), ("bimanual", false)] {
        let mut worlds = Worlds::new(&Scene::load(scene).unwrap(), 1000.0);
        let inputs = worlds.read(0.001);
        assert_eq!(
            inputs.map(|side| side.is_some_and(|side| side.gripper_rad.is_some())),
            [has_jaws; SIDES],
            "{scene}"
        );
    }
}
