//! Two arm pairs in one loop: independence and interaction, clutch and presence, agreement and force ramp, shared
//! faults.
use std::cell::Cell;

use nalgebra::{UnitQuaternion, Vector3};
use nima_core::{kinematics::ArmStartError, safety::TransitionCause};
use nima_devices::{ConnectionState, Loss};
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, Fault, LoopState, Refusal, Tick},
    rig::{DeviceEvent, EngageBlocker, Inputs, Outputs, Rig as _, SIDES, Side, Switches, ViewOrientation},
    teleop::{Calibrations, Loop, Timing},
};
use nima_simulation::{Worlds, run_virtual, scene::Scene};
use nima_tests::plan;

struct Fixture {
    worlds: Worlds,
    control: Loop,
    outputs: [Outputs; SIDES],
    ticks: [Tick; SIDES],
    tick: u64,
}

fn stepped(control: &mut Loop, inputs: &[Option<Inputs>; SIDES], tick: u64) -> ([Outputs; SIDES], [Tick; SIDES]) {
    let (outputs, ticks) = control.step(*inputs, &Timing { now_s: tick as f64 * 1e-3, ..Timing::default() });
    (outputs, ticks.map(Option::unwrap))
}

fn refusals(control: &Loop) -> Vec<(Side, Refusal)> {
    let refused = |event: &Event| match *event {
        Event::CommandRefused { side, why, .. } => Some((side, why)),
        _ => None,
    };
    control.events().filter_map(refused).collect()
}

impl Fixture {
    fn new() -> Self {
        Self::of(&RigConfig::load("simulated").unwrap())
    }

    fn of(rig: &RigConfig) -> Self {
        let mut control = Loop::new(rig, &[Some(Calibrations::default()), Some(Calibrations::default())]).unwrap();
        let mut worlds = Worlds::new(&Scene::load("bimanual").unwrap(), rig.rate_hz);
        let inputs = worlds.read(0.0);
        let (outputs, ticks) = stepped(&mut control, &inputs, 0);
        Self { worlds, control, outputs, ticks, tick: 1 }
    }

    fn obey(&mut self, command: Command) {
        self.control.clear_events();
        self.control.obey(command, self.now_s());
    }

    fn now_s(&self) -> f64 {
        self.tick as f64 * 1e-3
    }

    fn step(&mut self, edit: impl Fn(Side, Inputs) -> Option<Inputs>) {
        self.worlds.write(self.now_s(), &self.outputs);
        let mut inputs = self.worlds.read(self.now_s());
        for side in Side::ALL {
            inputs[side.index()] = inputs[side.index()].and_then(|inputs| edit(side, inputs));
        }
        (self.outputs, self.ticks) = stepped(&mut self.control, &inputs, self.tick);
        self.tick += 1;
    }

    fn run(&mut self, ticks: usize, edit: impl Fn(Side, Inputs) -> Option<Inputs>) {
        for _ in 0..ticks {
            self.step(&edit);
        }
    }

    /// Refusals since the last command, with their reasons.
    fn refusals(&self) -> Vec<(Side, Refusal)> {
        refusals(&self.control)
    }

    fn states(&self) -> [LoopState; SIDES] {
        self.ticks.each_ref().map(|tick| tick.state)
    }
}

const AS_IT_IS: fn(Side, Inputs) -> Option<Inputs> = |_, inputs| Some(inputs);

#[test]
fn each_hand_works_on_its_own_pegs_and_both_feel() {
    let mut felt_n = [0.0_f64; SIDES];
    run_virtual(&plan("bimanual"), 10.0, |tick| {
        let felt = &mut felt_n[tick.side.index()];
        *felt = felt.max(tick.rendering.rendered_n.norm());
        let beyond_m = if tick.side == Side::Right { -tick.positions.tip_m.x } else { tick.positions.tip_m.x };
        assert!(beyond_m < 0.0, "{:?} is on the other side", tick.side);
        None
    })
    .unwrap();
    assert!(felt_n.iter().all(|felt| *felt > 0.5), "{felt_n:?}");
}

#[test]
fn one_hand_may_engage_and_a_stop_is_for_both() {
    let mut bench = Fixture::new();
    bench.obey(Command::EngageOne(Side::Left));
    bench.run(5, AS_IT_IS);
    assert_eq!(bench.states(), [LoopState::Idle, LoopState::Engaged]);
    bench.obey(Command::Engage);
    bench.run(5, AS_IT_IS);
    assert_eq!(bench.states(), [LoopState::Engaged; SIDES]);
    bench.obey(Command::Stop);
    bench.step(AS_IT_IS);
    assert_eq!(bench.states(), [LoopState::Stopped; SIDES]);
    assert_eq!(bench.outputs, [Outputs::SAFE; SIDES]);
    bench.obey(Command::EngageOne(Side::Left));
    assert_eq!(bench.refusals(), [(Side::Left, Refusal::State(LoopState::Stopped))]);
    bench.obey(Command::ReleaseStop);
    bench.run(1000, AS_IT_IS);
    assert_eq!(bench.states(), [LoopState::Idle; SIDES], "nothing resumes by itself");
}

#[test]
fn a_refused_engagement_says_why_and_one_arm_that_obeys_does_not_hide_the_other() {
    let obstacle = EngageBlocker::Start(ArmStartError::AtLimit { joint: 4, angle_deg: 148.0, limit_deg: 147.8 });
    let stuck =
        |side: Side, inputs: Inputs| Some(Inputs { obstacle: (side == Side::Left).then_some(obstacle), ..inputs });
    let mut bench = Fixture::new();
    bench.run(5, stuck);
    bench.obey(Command::Engage);
    assert_eq!(bench.refusals(), [(Side::Left, Refusal::Obstacle(obstacle))]);
    bench.run(5, stuck);
    assert_eq!(bench.states(), [LoopState::Engaged, LoopState::Idle]);
    bench.run(5, AS_IT_IS);
    bench.obey(Command::Engage);
    assert_eq!(bench.refusals(), [], "the right arm is engaged already, so there is no event");
    bench.run(100, |side, inputs| (side == Side::Left).then_some(inputs));
    let [right, left] = bench.states();
    assert_eq!((right, left), (LoopState::Faulted(Fault::SourceSilent), LoopState::Faulted(Fault::OtherArm)));
    bench.obey(Command::Engage);
    assert_eq!(bench.refusals(), [(Side::Right, Refusal::State(right)), (Side::Left, Refusal::State(left))]);
    bench.obey(Command::ReleaseStop);
    assert_eq!(bench.refusals(), [(Side::Right, Refusal::StillPresent(Fault::SourceSilent))]);
    bench.run(100, |_, _| None);
    bench.obey(Command::EngageOne(Side::Left));
    assert_eq!(bench.refusals(), [(Side::Left, Refusal::State(LoopState::Disconnected))]);
}

#[test]
fn an_arm_that_the_rig_does_not_have_is_refused_and_the_other_one_engages() {
    let rig = RigConfig::load("simulated").unwrap();
    let mut control = Loop::new(&rig, &[Some(Calibrations::default()), None]).unwrap();
    let mut worlds = Worlds::new(&Scene::load("peg_transfer").unwrap(), rig.rate_hz);
    let mut outputs = [Outputs::SAFE; SIDES];
    let mut states = Vec::new();
    let mut refused = Vec::new();
    for tick in 0..20 {
        let now_s = f64::from(tick) * 1e-3;
        control.clear_events();
        match tick {
            5 => control.obey(Command::EngageOne(Side::Left), now_s),
            10 => control.obey(Command::EngageOne(Side::Right), now_s),
            _ => {}
        }
        worlds.write(now_s, &outputs);
        let (next, [right, left]) = control.step(worlds.read(now_s), &Timing { now_s, ..Timing::default() });
        assert!(left.is_none() && next[1] == Outputs::SAFE);
        outputs = next;
        states.push(right.unwrap().state);
        refused.extend(refusals(&control));
    }
    assert_eq!(refused, [(Side::Left, Refusal::NoSuchArm)]);
    assert_eq!((states[9], states[19]), (LoopState::Idle, LoopState::Engaged));
}

/// Changes the inputs of a side.
type Edit = fn(Side, Inputs) -> Option<Inputs>;

#[test]
fn an_engagement_that_is_given_up_says_what_it_waited_for() {
    let edits: [(Refusal, Edit); 4] = [
        (Refusal::EndoscopeUnseen, |_, inputs| Some(Inputs { view: ViewOrientation::Unseen, ..inputs })),
        (Refusal::DrivesOff, |_, inputs| Some(Inputs { powered: false, ..inputs })),
        (Refusal::HandAbsent, |_, inputs| {
            Some(Inputs { switches: Switches { clutch: false, presence: Some(false) }, ..inputs })
        }),
        (Refusal::ClutchPressed, |_, inputs| {
            Some(Inputs { switches: Switches { clutch: true, presence: None }, ..inputs })
        }),
    ];
    for (why, edit) in edits {
        let mut bench = Fixture::new();
        bench.run(5, edit);
        bench.obey(Command::EngageOne(Side::Right));
        bench.run(1990, edit);
        assert_eq!((bench.states()[0], bench.refusals()), (LoopState::Ready, vec![]), "{why:?}");
        bench.run(20, edit);
        assert_eq!((bench.states()[0], bench.refusals()), (LoopState::Idle, vec![(Side::Right, why)]));
    }
}

#[test]
fn a_fault_of_one_takes_the_other_out_of_engagement() {
    let mut bench = Fixture::new();
    bench.obey(Command::Engage);
    bench.run(500, AS_IT_IS);
    bench.run(25, |side, inputs| (side == Side::Right).then_some(inputs));
    let [right, left] = bench.states();
    assert_eq!(left, LoopState::Faulted(Fault::SourceSilent));
    assert_eq!(right, LoopState::Faulted(Fault::OtherArm));
    assert_eq!(bench.outputs, [Outputs::SAFE; SIDES]);
}

#[test]
fn a_lost_device_is_a_fault_at_once_and_only_while_it_matters() {
    let lost =
        |t_s| DeviceEvent { t_s, device: 2, standing: ConnectionState::Lost(Loss::Silent), of_side: [true, false] };
    let mut bench = Fixture::new();
    bench.control.notice(&lost(bench.now_s()));
    assert_eq!(bench.states(), [LoopState::Idle; SIDES], "idle: it is shown, no fault");
    bench.obey(Command::Engage);
    bench.run(10, AS_IT_IS);
    bench.control.notice(&lost(bench.now_s()));
    bench.step(AS_IT_IS);
    let fault = Fault::DeviceLost { device: 2, loss: Loss::Silent };
    assert_eq!(bench.states(), [LoopState::Faulted(fault), LoopState::Faulted(Fault::OtherArm)]);
}

#[test]
fn the_clutch_frees_the_hand_and_coupling_again_never_moves_the_tip() {
    let mut bench = Fixture::new();
    bench.obey(Command::Engage);
    bench.run(2000, AS_IT_IS);
    for tick in 1..=300_u32 {
        bench.step(|_, mut inputs| {
            // Meanwhile the hand moves by 30 mm in 0.1 s.
            inputs.hand.position_m.x += 0.03 * f64::from(tick.min(100)) / 100.0;
            Some(Inputs { switches: Switches { clutch: true, presence: None }, ..inputs })
        });
    }
    assert_eq!(bench.states(), [LoopState::Clutched; SIDES]);
    assert!(bench.outputs.iter().all(|o| o.drives && o.tip_command_m.is_none() && o.hand_force_n.norm() < 1e-15));
    let moved = |_: Side, inputs: Inputs| {
        let mut inputs = inputs;
        inputs.hand.position_m += Vector3::new(0.03, 0.0, 0.0);
        Some(inputs)
    };
    // The first command is the tip's position; the following ones advance at the follower's speed limit.
    let mut last_m = bench.ticks.each_ref().map(|tick| tick.positions.tip_m);
    for _ in 0..50 {
        bench.step(moved);
        for side in Side::ALL {
            let asked_m = bench.outputs[side.index()].tip_command_m.unwrap();
            let step_m = (asked_m - last_m[side.index()]).norm();
            assert!(step_m < 0.31e-3, "a jump of {step_m} m");
            last_m[side.index()] = asked_m;
        }
    }
    assert_eq!(bench.states(), [LoopState::Engaged; SIDES]);
}

#[test]
fn engaging_begins_where_the_tip_is_and_the_force_rises_over_a_fifth_of_a_second() {
    let mut bench = Fixture::new();
    // Pressed against the tissue while idle: the tip is in the tissue, the hand elsewhere.
    bench.obey(Command::SetStaticHold(true));
    bench.obey(Command::SetMode(nima_core::impedance::Mode::Dfr));
    let pressed = |_: Side, inputs: Inputs| {
        Some(Inputs { sensed: nima_machine::rig::SensedForce::AtTip(Vector3::new(0.0, 0.0, 3.0)), ..inputs })
    };
    bench.run(500, pressed);
    bench.obey(Command::Engage);
    bench.step(pressed);
    assert_eq!(bench.states(), [LoopState::Engaged; SIDES]);
    for side in Side::ALL {
        let step_m = bench.outputs[side.index()].tip_command_m.unwrap() - bench.ticks[side.index()].positions.tip_m;
        assert!(step_m.norm() <= 0.2e-3, "{step_m}");
    }
    bench.run(99, pressed);
    let halfway_n = bench.ticks[0].rendering.rendered_n.z;
    assert!((halfway_n - 1.5).abs() < 0.05, "{halfway_n}");
    bench.run(101, pressed);
    assert!((bench.ticks[0].rendering.rendered_n.z - 3.0).abs() < 1e-6, "{}", bench.ticks[0].rendering.rendered_n);
}

#[test]
fn a_hand_that_lets_go_ends_the_engagement_and_drives_that_switch_off_are_a_fault() {
    let absent = |_: Side, inputs: Inputs| {
        Some(Inputs { switches: Switches { clutch: false, presence: Some(false) }, ..inputs })
    };
    let mut bench = Fixture::new();
    bench.obey(Command::Engage);
    bench.run(10, AS_IT_IS);
    bench.step(absent);
    assert_eq!(bench.states(), [LoopState::Idle; SIDES]);
    bench.run(100, AS_IT_IS);
    assert_eq!(bench.states(), [LoopState::Idle; SIDES]);
    bench.obey(Command::Engage);
    bench.run(10, AS_IT_IS);
    bench.step(|_, inputs| Some(Inputs { powered: false, ..inputs }));
    assert_eq!(bench.states(), [LoopState::Faulted(Fault::DrivesOff); SIDES]);
}

#[test]
fn a_scale_changes_the_way_and_never_the_place() {
    let mut bench = Fixture::new();
    bench.obey(Command::Engage);
    bench.run(300, AS_IT_IS);
    bench.obey(Command::SetScale(0.2));
    let before_m = bench.outputs[0].tip_command_m.unwrap();
    bench.step(AS_IT_IS);
    assert!((bench.outputs[0].tip_command_m.unwrap() - before_m).norm() < 0.31e-3, "no faster than it may be");
    bench.obey(Command::SetScale(7.0));
    assert_eq!(bench.refusals(), Side::ALL.map(|side| (side, Refusal::OutOfRange)));
}

#[test]
fn an_endoscope_that_is_tracked_turns_the_mapping_and_one_that_is_not_seen_keeps_hand_and_tip_apart() {
    let mut bench = Fixture::new();
    let world_from_view = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.7);
    let by_side = |side: Side, inputs: Inputs| {
        let view = if side == Side::Right { ViewOrientation::Seen(world_from_view) } else { ViewOrientation::Unseen };
        Some(Inputs { view, ..inputs })
    };
    bench.run(10, by_side);
    bench.obey(Command::Engage);
    bench.run(10, by_side);
    assert_eq!(bench.states(), [LoopState::Engaged, LoopState::Ready]);
    let mut moved_m = 0.0;
    let mut before: Option<(Vector3<f64>, Vector3<f64>)> = None;
    let hand_m = Cell::new(Vector3::zeros());
    for _ in 0..1500 {
        bench.step(|side, inputs| {
            if side == Side::Right {
                hand_m.set(inputs.hand.position_m);
            }
            by_side(side, inputs)
        });
        let leader_m = bench.ticks[0].positions.leader_m;
        if let Some((hand_before_m, leader_before_m)) = before {
            let [hand_m, leader_m] = [hand_m.get() - hand_before_m, leader_m - leader_before_m];
            assert!((leader_m - world_from_view * hand_m).norm() < 1e-9, "{hand_m} {leader_m}");
            moved_m += hand_m.norm();
        }
        before = Some((hand_m.get(), leader_m));
    }
    assert!(moved_m > 0.01, "{moved_m}");
    bench.run(1000, by_side);
    assert_eq!(bench.states()[1], LoopState::Idle, "it was not joined in time");
}

#[test]
fn a_handle_that_is_let_go_is_an_absent_hand_and_nothing_resumes() {
    let mut rig = RigConfig::load("simulated").unwrap();
    rig.gates.static_hold = true;
    let mut bench = Fixture::of(&rig);
    bench.obey(Command::SetGainAboveOne(2.0));
    bench.obey(Command::Engage);
    let hand_m = Cell::new([Vector3::zeros(); 20]);
    let mut pressed = 0;
    while pressed < 30 {
        bench.step(|side, inputs| {
            if side == Side::Right {
                let mut last_m = hand_m.get();
                last_m.rotate_right(1);
                last_m[0] = inputs.hand.position_m;
                hand_m.set(last_m);
            }
            Some(inputs)
        });
        let moved_m = (hand_m.get()[0] - hand_m.get()[19]).norm();
        pressed = if bench.ticks[0].rendering.rendered_n.norm() > 2.5 && moved_m < 2e-4 { pressed + 1 } else { 0 };
        assert!(bench.tick < 20_000, "the scene presses and holds");
    }
    // From here on the handle is released: 0.25 kg and 0.5 N s/m, read in steps of 10 um.
    let last_m = hand_m.get();
    let from_m = last_m[0];
    let mut travel_m = Vector3::zeros();
    let mut speed_m_s = (last_m[0] - last_m[19]) / 19e-3;
    for after in 1..=1000 {
        speed_m_s += (bench.outputs[0].hand_force_n - speed_m_s * 0.5) * (1e-3 / 0.25);
        travel_m += speed_m_s * 1e-3;
        bench.control.clear_events();
        bench.step(|side, mut inputs| {
            if side == Side::Right {
                inputs.hand.position_m = (from_m + travel_m).map(|x| (x / 1e-5).round() * 1e-5);
            }
            Some(inputs)
        });
        assert!(speed_m_s.norm() < 0.12 && travel_m.norm() < 2e-3, "after {after} ms: {travel_m:?} {speed_m_s:?}");
        let change = bench.control.events().find_map(|event| match *event {
            Event::StateChanged { side: Side::Right, to, why, .. } => Some((to, why)),
            _ => None,
        });
        if let Some(change) = change {
            assert_eq!(change, (LoopState::Idle, TransitionCause::Absent), "after {after} ms");
            assert!(after >= 150, "after {after} ms");
            assert_eq!(bench.outputs[0].hand_force_n.norm().to_bits(), 0);
            bench.run(500, AS_IT_IS);
            assert_eq!(bench.states(), [LoopState::Idle, LoopState::Engaged]);
            return;
        }
    }
    panic!("the release of the handle was not detected");
}
