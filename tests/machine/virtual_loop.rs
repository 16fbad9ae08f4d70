//! The whole loop on the virtual clock, over whole scenes, including faults.
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering::Relaxed},
};

use nalgebra::Vector3;
use nima_core::impedance::{LinkPacket, Mode, ModeSet, OwnMotion};
use nima_machine::{
    config::RigConfig,
    messages::{Command, Event, Fault, LoopState, Refusal, Tick},
    rig::{Inputs, Outputs, SensedForce, Side},
    runtime::RuntimeSummary,
    teleop::{Calibrations, Link, Pair, ProgrammedLink, Timing},
};
use nima_simulation::{SimulationPlan, World, run_virtual};
use nima_tests::plan;

fn error_of(summary: &RuntimeSummary, mode: Mode) -> f64 {
    summary.error.iter().find(|error| error.mode == mode).unwrap().mae_n
}

#[test]
fn anchored_and_best_are_nearer_to_the_truth_than_delayed_reflection_at_every_delay() {
    for delay_s in [0.01, 0.05, 0.1, 0.3] {
        let mut plan = plan("peg_transfer");
        plan.rig.delay_s = delay_s;
        let summary = run_virtual(&plan, 30.0, |_| None).unwrap();
        let [best, anchored, dfr] = [Mode::Best, Mode::Anchored, Mode::Dfr].map(|mode| error_of(&summary, mode));
        println!("delay {delay_s} s: {:?}", summary.error);
        assert!(anchored < dfr, "delay {delay_s} s: anchored {anchored} N, delayed reflection {dfr} N");
        assert!(best < 1.02 * anchored, "delay {delay_s} s: best {best} N, anchored {anchored} N");
    }
}

#[test]
fn a_change_of_mode_takes_no_force_from_the_hand_and_leaves_one_mode_computed() {
    let mut plan = plan("peg_transfer");
    plan.rig.delay_s = 0.3;
    plan.rig.gates.static_hold = true;
    let mut changed_s = None;
    let mut min_n = f64::INFINITY;
    let mut computed = Vec::new();
    run_virtual(&plan, 20.0, |tick: &Tick| {
        let felt_n = tick.rendering.rendered_n.norm();
        match changed_s {
            None if tick.t_s > 5.0 && felt_n > 1.5 => {
                changed_s = Some(tick.t_s);
                return Some(Command::SetMode(Mode::Matched));
            }
            Some(at_s) if tick.t_s < at_s + 0.1 => min_n = min_n.min(felt_n),
            _ => {}
        }
        computed.push(tick.identification.modes);
        None
    })
    .unwrap();
    let changed_s = changed_s.expect("the tip presses on the tissue");
    assert!(min_n > 0.8, "{min_n} N just after {changed_s} s");
    let of = |mode| ModeSet::only(mode);
    assert_eq!((computed[0], *computed.last().unwrap()), (of(Mode::Best), of(Mode::Matched)));
    assert!(computed.contains(&of(Mode::Matched).with(Mode::Best)), "both while the new one learns");
    assert!(!computed.contains(&ModeSet::ALL), "nothing else is computed");
}

#[test]
fn the_handles_own_motion_is_ahead_of_the_follower_and_so_is_its_force() {
    let error_n = |own_motion| {
        let mut plan = plan("peg_transfer");
        plan.rig.mode = Mode::Matched;
        plan.rig.identification.own_motion = own_motion;
        error_of(&run_virtual(&plan, 20.0, |_| None).unwrap(), Mode::Matched)
    };
    let [follower_n, handle_n] = [OwnMotion::Follower, OwnMotion::Handle].map(error_n);
    assert!(follower_n + 0.02 < handle_n && handle_n < 3.0 * follower_n, "{follower_n} N, {handle_n} N");
}

#[test]
fn every_baseline_runs_behind_the_gates() {
    let ceiling_n = plan("peg_transfer").rig.gates.ceiling_n;
    for mode in Mode::BASELINES {
        let mut plan = plan("peg_transfer");
        plan.rig.mode = mode;
        plan.rig.delay_s = 0.1;
        let mut largest_n = 0.0_f64;
        let summary = run_virtual(&plan, 6.0, |tick| {
            largest_n = largest_n.max(tick.rendering.rendered_n.norm());
            None
        })
        .unwrap();
        assert_eq!(summary.final_state, LoopState::Engaged, "{mode}");
        assert!(largest_n > 0.5 && largest_n <= ceiling_n + 1e-9, "{mode}: {largest_n} N");
        let error = error_of(&summary, mode);
        assert!(error < 1.6 * error_of(&summary, Mode::Dfr), "{mode}: {error} N");
    }
}

#[test]
fn of_the_baselines_only_the_one_of_the_rig_can_be_chosen() {
    nima_baselines::provide();
    for mode in Mode::BASELINES {
        let rig = RigConfig { mode, ..RigConfig::load("simulated").unwrap() };
        let mut pair = Pair::new(&rig, Side::Right, &Calibrations::default()).unwrap();
        for other in Mode::ALL.into_iter().chain(Mode::BASELINES) {
            let computed = other == mode || !matches!(other, Mode::Baseline(_));
            let expected = if computed { Ok(()) } else { Err(Refusal::OutOfRange) };
            assert_eq!(pair.obey(Command::SetMode(other), 0.0), expected, "{other} compared with {mode}");
        }
    }
}

#[test]
fn without_delay_the_reflected_force_is_the_measured_one() {
    let mut plan = plan("peg_transfer");
    plan.rig.delay_s = 0.0;
    let summary = run_virtual(&plan, 5.0, |_| None).unwrap();
    assert!(error_of(&summary, Mode::Dfr) < 1e-12);
}

#[test]
fn the_same_plan_gives_the_same_run() {
    let run = || {
        let mut forces = Vec::new();
        run_virtual(&plan("peg_transfer"), 3.0, |tick| {
            forces.push(tick.rendering.rendered_n);
            None
        })
        .unwrap();
        forces
    };
    assert_eq!(run(), run());
}

#[test]
fn the_hand_never_feels_more_than_the_ceiling_and_nothing_when_stopped() {
    let mut plan = plan("peg_transfer");
    plan.rig.mode = Mode::Dfr;
    let mut felt = 0.0_f64;
    run_virtual(&plan, 20.0, |tick: &Tick| {
        assert!(tick.rendering.rendered_n.norm() <= 4.0 + 1e-9);
        felt = felt.max(tick.rendering.rendered_n.norm());
        match tick.index {
            15_000 => Some(Command::Stop),
            15_001.. => {
                assert_eq!(tick.state, LoopState::Stopped);
                assert!(tick.rendering.rendered_n.norm() < f64::EPSILON);
                Some(Command::Engage)
            }
            _ => None,
        }
    })
    .unwrap();
    assert!(felt > 0.5, "the hand feels the tissue: {felt} N");
}

#[test]
fn a_command_out_of_range_is_refused_and_changes_nothing() {
    let mut control = Pair::new(&RigConfig::load("simulated").unwrap(), Side::Right, &Calibrations::default()).unwrap();
    let bad = [
        Command::SetGain(1.5),
        Command::SetGain(f64::NAN),
        Command::SetGainAboveOne(3.5),
        Command::SetDelay(-0.1),
        Command::SetDelay(f64::NAN),
        Command::SetDeadBand(-1.0),
        Command::ReleaseStop,
    ];
    for command in bad {
        assert!(control.obey(command, 0.0).is_err(), "{command:?}");
    }
}

/// Steps a loop and a world by hand, so that samples can be removed or corrupted.
struct Fixture {
    world: World,
    control: Pair,
    outputs: Outputs,
    tick: u64,
}

impl Fixture {
    fn engaged(mode: Mode) -> Self {
        let SimulationPlan { mut rig, scene, .. } = plan("peg_transfer");
        rig.mode = mode;
        let mut control = Pair::new(&rig, Side::Right, &Calibrations::default()).unwrap();
        control.obey(Command::Engage, 0.0).unwrap();
        Self { world: World::new(&scene, rig.rate_hz), control, outputs: Outputs::SAFE, tick: 0 }
    }

    fn step(&mut self, edit: impl Fn(Inputs) -> Option<Inputs>) -> Tick {
        let now_s = self.tick as f64 * 1e-3;
        let inputs = self.world.exchange(now_s, &self.outputs).and_then(edit);
        let (outputs, tick) = self.control.step(false, inputs, &Timing { now_s, ..Timing::default() });
        self.outputs = outputs;
        self.tick += 1;
        tick
    }

    /// Runs until at least 1 N is rendered.
    fn until_contact(mode: Mode) -> Self {
        let mut bench = Self::engaged(mode);
        for _ in 0..20_000 {
            if bench.step(Some).rendering.rendered_n.norm() > 1.0 {
                return bench;
            }
        }
        panic!("{mode}: no contact in 20 s");
    }
}

#[test]
fn a_silent_or_poisoned_source_takes_the_force_away_within_20_ms_and_latches() {
    let poison = |inputs: Inputs| Some(Inputs { sensed: SensedForce::AtTip(Vector3::repeat(f64::NAN)), ..inputs });
    for edit in [&poison as &dyn Fn(Inputs) -> Option<Inputs>, &|_| None] {
        for mode in Mode::ALL {
            let mut bench = Fixture::until_contact(mode);
            let after: Vec<Tick> = (0..40).map(|_| bench.step(edit)).collect();
            assert!(
                after[20].rendering.rendered_n.norm() < f64::EPSILON,
                "{mode}: {} N after 20 ms",
                after[20].rendering.rendered_n.norm()
            );
            assert_eq!(after[39].state, LoopState::Faulted(Fault::SourceSilent));
            assert_eq!(
                bench.control.obey(Command::ReleaseStop, 1e-3 * bench.tick as f64),
                Err(Refusal::StillPresent(Fault::SourceSilent)),
                "released in silence"
            );
            let again: Vec<Tick> = (0..1000).map(|_| bench.step(Some)).collect();
            assert!(
                again.iter().all(|tick| tick.rendering.rendered_n.norm() < f64::EPSILON),
                "{mode}: force came back by itself"
            );
        }
    }
}

#[test]
fn who_engages_right_after_a_silence_waits_for_the_first_new_parcel() {
    let mut bench = Fixture::until_contact(Mode::Dfr);
    for _ in 0..300 {
        bench.step(|_| None);
    }
    bench.step(Some);
    let now_s = 1e-3 * bench.tick as f64;
    bench.control.obey(Command::ReleaseStop, now_s).unwrap();
    bench.control.obey(Command::Engage, now_s).unwrap();
    let ticks: Vec<Tick> = (0..100).map(|_| bench.step(Some)).collect();
    let waited = ticks.iter().take_while(|tick| tick.state == LoopState::Ready).count();
    assert!((48..=52).contains(&waited), "the link has 50 ms: {waited}");
    assert!(ticks[waited..].iter().all(|tick| tick.state == LoopState::Engaged), "{:?}", ticks[99].state);
}

/// A link that can be cut.
#[derive(Debug)]
struct Cut {
    link: ProgrammedLink,
    is_cut: Arc<AtomicBool>,
}

impl Link for Cut {
    fn set_delay(&mut self, delay_s: f64) {
        self.link.set_delay(delay_s);
    }

    fn clear(&mut self) {
        self.link.clear();
    }

    fn send(&mut self, parcel: &LinkPacket) {
        if !self.is_cut.load(Relaxed) {
            self.link.send(parcel);
        }
    }

    fn receive(&mut self, now_s: f64) -> Option<&LinkPacket> {
        self.link.receive(now_s)
    }
}

#[test]
fn over_a_link_that_stays_silent_nobody_is_engaged() {
    let SimulationPlan { rig, scene, .. } = plan("peg_transfer");
    let is_cut = Arc::new(AtomicBool::new(false));
    let link = Cut { link: ProgrammedLink::new(rig.rate_hz, rig.delay_s), is_cut: Arc::clone(&is_cut) };
    let mut control = Pair::over(&rig, Side::Right, &Calibrations::default(), link).unwrap();
    let mut world = World::new(&scene, rig.rate_hz);
    let mut outputs = Outputs::SAFE;
    let mut refused = Vec::new();
    for tick in 0..4000 {
        let now_s = f64::from(tick) * 1e-3;
        control.clear_events();
        if tick == 500 {
            is_cut.store(true, Relaxed);
        } else if tick == 1000 {
            control.obey(Command::Engage, now_s).unwrap();
        }
        let inputs = world.exchange(now_s, &outputs);
        let report = control.step(false, inputs, &Timing { now_s, ..Timing::default() });
        outputs = report.0;
        assert!(matches!(report.1.state, LoopState::Idle | LoopState::Ready), "{:?}", report.1.state);
        refused.extend(control.events().filter_map(|event| match event {
            Event::CommandRefused { why, .. } => Some(*why),
            _ => None,
        }));
    }
    assert_eq!(refused, [Refusal::StillPresent(Fault::LinkSilent)]);
}

#[test]
fn a_stall_is_a_fault_with_zero_force() {
    let mut bench = Fixture::until_contact(Mode::Dfr);
    let inputs = bench.world.exchange(bench.tick as f64 * 1e-3, &bench.outputs);
    let timing = Timing { now_s: bench.tick as f64 * 1e-3 + 0.1, missed_now: 100, ..Timing::default() };
    let (outputs, tick) = bench.control.step(false, inputs, &timing);
    assert_eq!(tick.state, LoopState::Faulted(Fault::LoopStalled { periods: 100 }));
    assert_eq!(outputs, Outputs::SAFE);
}

#[test]
fn a_short_stall_is_left_by_one_step_and_a_long_one_by_two() {
    for (missed, leaves) in [(500, true), (1001, false)] {
        let mut bench = Fixture::until_contact(Mode::Dfr);
        let stall_s = missed as f64 * 1e-3;
        let inputs = bench.world.exchange(bench.tick as f64 * 1e-3, &bench.outputs);
        let mut now_s = bench.tick as f64 * 1e-3 + stall_s;
        let timing = Timing { now_s, missed_now: missed, ..Timing::default() };
        let (mut outputs, tick) = bench.control.step(false, inputs, &timing);
        assert_eq!(tick.state, LoopState::Faulted(Fault::LoopStalled { periods: missed }));
        let mut tick_with = |now_s: f64, command: Option<Command>, has_data: bool| {
            let obeyed = command.map(|command| bench.control.obey(command, now_s));
            let inputs = bench.world.exchange(now_s, &outputs).filter(|_| has_data);
            let report = bench.control.step(false, inputs, &Timing { now_s, ..Timing::default() });
            outputs = report.0;
            (obeyed, report.1.state)
        };
        let faulted = LoopState::Faulted(Fault::LoopStalled { periods: missed });
        // Nothing resumes by itself, and while the devices are silent the fault remains.
        for step in 0..100 {
            now_s += 1e-3;
            assert_eq!(tick_with(now_s, None, step < 50).1, faulted);
        }
        let (obeyed, state) = tick_with(now_s + 1e-3, Some(Command::Engage), false);
        assert!(obeyed.unwrap().is_err() && state == faulted, "{obeyed:?}");
        for step in 2..200 {
            tick_with(now_s + f64::from(step) * 1e-3, None, true);
        }
        let (obeyed, _) = tick_with(now_s + 0.2, Some(Command::Engage), true);
        assert_eq!(obeyed.unwrap().is_ok(), leaves, "{obeyed:?}");
        let mut state = faulted;
        for step in 201..1000 {
            state = tick_with(now_s + f64::from(step) * 1e-3, None, true).1;
        }
        assert_eq!(state, if leaves { LoopState::Engaged } else { faulted });
    }
}

#[test]
fn a_stall_while_no_drives_are_on_harms_nobody_and_is_no_fault() {
    let SimulationPlan { rig, scene, .. } = plan("peg_transfer");
    let mut control = Pair::new(&rig, Side::Right, &Calibrations::default()).unwrap();
    let inputs = World::new(&scene, rig.rate_hz).exchange(0.1, &Outputs::SAFE);
    let (outputs, tick) = control.step(false, inputs, &Timing { now_s: 0.1, missed_now: 100, ..Timing::default() });
    assert_eq!((tick.state, outputs), (LoopState::Idle, Outputs::SAFE));
    assert_eq!(tick.timing.missed, 100, "it is counted");
}
