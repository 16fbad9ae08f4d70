//! Tests of every watchdog, triggered on purpose: it raises its own fault in the usual way, without force, and only
//! while idle.
use std::{
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
    time::{Duration, Instant},
};

use nima_devices::Lever;
use nima_machine::{
    messages::{Command, Event, LoopState, Refusal, Tick, Watchdog},
    rig::{Inputs, Outputs, Rig, Roster, SIDES, Side},
    teleop::{Calibrations, Loop, Timing},
};
use nima_simulation::{SimulationPlan, Worlds, run_virtual, start_on};

fn plan(engage: bool) -> SimulationPlan {
    let plan = nima_tests::plan("peg_transfer");
    SimulationPlan { scene: plan.scene.with_left_hand(), engage, ..plan }
}

/// Returns the sequence of states of both arms; the test begins at 0.3 s, is released as soon as both are faulted, and
/// engaged half a second later.
fn states(watchdog: Watchdog) -> [Vec<LoopState>; SIDES] {
    let mut states: [Vec<LoopState>; SIDES] = Default::default();
    let mut asked = false;
    let mut faulted_s = None;
    let mut released_s = None;
    let mut engaged = false;
    run_virtual(&plan(false), 5.0, |tick: &Tick| {
        let of_side = &mut states[tick.side.index()];
        if of_side.last() != Some(&tick.state) {
            of_side.push(tick.state);
        }
        if tick.state != LoopState::Engaged {
            assert!(
                tick.rendering.rendered_n.norm() == 0.0,
                "{watchdog:?}: {} N at {} s",
                tick.rendering.rendered_n,
                tick.t_s
            );
        }
        if !asked && tick.t_s > 0.3 {
            asked = true;
            return Some(Command::TestWatchdog(watchdog));
        }
        let all_faulted = states.iter().all(|of_side| matches!(of_side.last(), Some(LoopState::Faulted(_))));
        faulted_s = faulted_s.or_else(|| all_faulted.then_some(tick.t_s));
        if released_s.is_none() && faulted_s.is_some_and(|at_s| tick.t_s > at_s + 0.05) {
            released_s = Some(tick.t_s);
            return Some(Command::ReleaseStop);
        }
        if !engaged && released_s.is_some_and(|at_s| tick.t_s > at_s + 0.5) {
            engaged = true;
            return Some(Command::Engage);
        }
        None
    })
    .unwrap();
    states
}

#[test]
fn samples_and_parcels_that_are_withheld_raise_the_fault_of_their_watchdog_and_it_is_left_by_two_steps() {
    for watchdog in [Watchdog::Source, Watchdog::Link] {
        for of_side in states(watchdog) {
            let [idle, LoopState::Faulted(fault), released, .., last] = of_side[..] else { panic!("{of_side:?}") };
            assert_eq!([idle, released, last], [LoopState::Idle, LoopState::Idle, LoopState::Engaged]);
            assert!(watchdog.raises(fault), "{watchdog:?}: {fault:?}");
        }
    }
}

/// A simulated rig with an emergency release whose calls are counted.
struct Levered {
    worlds: Worlds,
    lever: Lever,
}

impl Rig for Levered {
    fn read(&mut self, now_s: f64) -> [Option<Inputs>; SIDES] {
        self.worlds.read(now_s)
    }

    fn write(&mut self, now_s: f64, outputs: &[Outputs; SIDES]) {
        assert!(outputs.iter().all(|outputs| outputs.hand_force_n.norm() == 0.0 && !outputs.drives));
        self.worlds.write(now_s, outputs);
    }

    fn levers(&self) -> Vec<Lever> {
        vec![self.lever.clone()]
    }
}

#[test]
fn a_heartbeat_that_is_withheld_makes_the_supervisor_pull_the_levers_and_the_loop_fault() {
    let plan = plan(false);
    let lever = Lever::default();
    let pulls = Arc::new(AtomicU32::new(0));
    let counted = Arc::clone(&pulls);
    lever.attach(move || {
        counted.fetch_add(1, Ordering::Relaxed);
    });
    let rig = Levered { worlds: Worlds::new(&plan.scene, plan.rig.rate_hz), lever };
    let handle = start_on(&plan, Box::new(rig), Roster::new()).unwrap();
    let mut states = [LoopState::Idle; SIDES];
    let mut until = |what: &str, good: &dyn Fn(&[LoopState; SIDES]) -> bool| {
        let began = Instant::now();
        while !good(&states) {
            assert!(began.elapsed() < Duration::from_mins(2), "{what}: {states:?}");
            handle.drain_ticks(|tick| states[tick.side.index()] = tick.state);
            std::thread::sleep(Duration::from_millis(1));
        }
    };
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(pulls.load(Ordering::Relaxed), 0);
    assert!(handle.send(Command::TestWatchdog(Watchdog::Loop)));
    let stalled = |state: &LoopState| matches!(state, LoopState::Faulted(fault) if Watchdog::Loop.raises(*fault));
    until("both stand still", &|states| states.iter().all(stalled));
    assert_eq!(pulls.load(Ordering::Relaxed), 1, "once");
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!(pulls.load(Ordering::Relaxed), 1, "the loop beats again");
    assert!(handle.send(Command::ReleaseStop));
    until("released", &|states| states == &[LoopState::Idle; SIDES]);
}

#[test]
fn while_one_arm_is_not_idle_no_watchdog_is_tested() {
    let mut control =
        Loop::new(&plan(false).rig, &[Some(Calibrations::default()), Some(Calibrations::default())]).unwrap();
    let mut worlds = Worlds::new(&plan(false).scene, 1000.0);
    let mut tick = |control: &mut Loop, k: u32| {
        let now_s = f64::from(k) * 1e-3;
        let (outputs, ticks) = control.step(worlds.read(now_s), &Timing { now_s, ..Timing::default() });
        worlds.write(now_s, &outputs);
        ticks.map(|tick| tick.unwrap().state)
    };
    for k in 0..100 {
        tick(&mut control, k);
    }
    control.obey(Command::EngageOne(Side::Left), 0.1);
    for k in 100..400 {
        tick(&mut control, k);
    }
    for watchdog in Watchdog::ALL {
        control.clear_events();
        control.obey(Command::TestWatchdog(watchdog), 0.4);
        let refused = control.events().filter(|event| matches!(event, Event::CommandRefused { .. })).count();
        assert_eq!(refused, 1);
        let why = Refusal::State(LoopState::Engaged);
        assert!(
            control.events().any(|event| matches!(event, Event::CommandRefused { why: report, .. } if *report == why))
        );
        assert!(!control.withholds_beat());
    }
    let after = (400..1000).map(|k| tick(&mut control, k)).last();
    assert_eq!(after, Some([LoopState::Idle, LoopState::Engaged]), "and nothing is disturbed");
}

#[test]
fn a_watchdog_that_does_not_bite_is_given_up() {
    // On the virtual clock the loop has no supervisor.
    let mut control = Loop::new(&plan(false).rig, &[Some(Calibrations::default()), None]).unwrap();
    control.obey(Command::TestWatchdog(Watchdog::Loop), 0.0);
    let step = |control: &mut Loop, now_s: f64| control.step([None; SIDES], &Timing { now_s, ..Timing::default() });
    step(&mut control, 1e-3);
    assert!(control.withholds_beat());
    for k in 2..1600_u32 {
        step(&mut control, f64::from(k) * 1e-3);
    }
    assert!(!control.withholds_beat());
}
