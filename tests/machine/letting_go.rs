//! A simulated hand that releases the handle on command, as in the demonstration.
use nalgebra::Vector3;
use nima_core::impedance::Mode;
use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState, Refusal, Tick},
    rig::{Acts, Inputs, Side, TaskAction},
    teleop::{Calibrations, Pair, Timing},
};
use nima_simulation::run_virtual;
use nima_tests::plan;

/// Direct reflection at 300 ms, released while pressing. Returns the farthest position of the handle while engaged (m),
/// and the states that followed. The hand grasps the handle again after 2.5 s, and the loop is commanded to engage.
fn let_go(governor: bool) -> (f64, Vec<LoopState>) {
    let mut plan = plan("peg_transfer");
    plan.rig.mode = Mode::Dfr;
    plan.rig.delay_s = 0.3;
    plan.rig.gates.static_hold = true;
    let mut opened = None::<(f64, Vector3<f64>)>;
    let mut far_m = 0.0_f64;
    let mut states = Vec::new();
    let mut asked = false;
    run_virtual(&plan, 20.0, |tick: &Tick| {
        if !asked {
            asked = true;
            return Some(Command::SetGovernor(governor));
        }
        let Some((at_s, from_m)) = opened else {
            if tick.t_s > 3.0 && tick.rendering.rendered_n.z > 1.5 {
                opened = Some((tick.t_s, tick.positions.leader_m));
                return Some(Command::LetGo(true));
            }
            return None;
        };
        if states.last() != Some(&tick.state) {
            states.push(tick.state);
        }
        let since_s = tick.t_s - at_s;
        if tick.state == LoopState::Engaged && since_s < 2.5 {
            far_m = far_m.max((tick.positions.leader_m - from_m).norm());
        }
        let now = |after_s: f64| (since_s - after_s).abs() < 0.5e-3;
        if now(2.5) { Some(Command::LetGo(false)) } else { now(2.6).then_some(Command::Engage) }
    })
    .unwrap();
    assert!(opened.is_some(), "the hand presses");
    (far_m, states)
}

#[test]
fn reflection_kicks_the_handle_away_and_the_governor_holds_it() {
    let (kicked_m, states) = let_go(false);
    println!("without the governor {:.1} mm, {states:?}", 1e3 * kicked_m);
    assert!(kicked_m > 0.05, "{kicked_m} m");
    assert_eq!(states, [LoopState::Engaged], "nothing else ends it");
    let (held_m, states) = let_go(true);
    println!("with the governor {:.2} mm, {states:?}", 1e3 * held_m);
    assert!(held_m < 0.005, "{held_m} m");
    assert_eq!(states.first(), Some(&LoopState::Engaged));
    assert!(states.contains(&LoopState::Idle), "no hand holds the handle: {states:?}");
    assert_eq!(states.last(), Some(&LoopState::Engaged), "engaged again by a command, with the hand back: {states:?}");
}

#[test]
fn an_act_of_a_task_is_counted_once_and_refused_in_a_stop() {
    let rig = RigConfig::load("simulated").unwrap();
    let mut pair = Pair::new(&rig, Side::Right, &Calibrations::default()).unwrap();
    let acts = |pair: &mut Pair| {
        let timing = Timing { now_s: 0.0, wake_s: 0.0, work_s: 0.0, sample_to_force_s: None, missed_now: 0 };
        pair.step(false, Some(Inputs::NOTHING), &timing).0.acts
    };
    assert_eq!(pair.obey(Command::Task(Side::Right, TaskAction::Mark), 0.0), Ok(()));
    let marked = Acts { marks: 1, ..Acts::NONE };
    assert_eq!([acts(&mut pair), acts(&mut pair)], [marked; 2]);
    assert_eq!(pair.obey(Command::Stop, 0.0), Ok(()));
    let refused = pair.obey(Command::Task(Side::Right, TaskAction::Mark), 0.0);
    assert!(matches!(refused, Err(Refusal::State(LoopState::Stopped))), "{refused:?}");
    assert_eq!(acts(&mut pair), marked);
}

#[test]
fn where_a_person_may_hold_the_handle_neither_is_obeyed() {
    for name in ["emulated", "paper"] {
        let rig = RigConfig::load(name).unwrap();
        let mut pair = Pair::new(&rig, Side::Right, &Calibrations::default()).unwrap();
        let acts = [
            Command::Task(Side::Right, TaskAction::Mark),
            Command::LetGo(true),
            Command::SetGovernor(false),
            Command::SetGovernor(true),
        ];
        for command in acts {
            assert_eq!(pair.obey(command, 0.0), Err(Refusal::SimulatedOnly), "{name}: {command:?}");
        }
    }
}
