//! Palpation and the wire in the closed loop: simulated hands, and a person's actions on the screen.

use nalgebra::Vector3;
use nima_core::{
    impedance::Mode,
    task::{TaskEvent, TimedTaskEvent},
};
use nima_machine::{
    messages::{Command, LoopState},
    rig::{Side, TaskAction},
    runtime,
};
use nima_simulation::SimulationPlan;
use nima_tests::plan;

fn of(scene: &str, mode: Mode) -> SimulationPlan {
    let mut plan = plan(scene);
    plan.rig.mode = mode;
    plan
}

/// Runs this many seconds with these commands at these times; returns the events, and the bits of the measurements.
fn played(plan: &SimulationPlan, seconds: f64, commands: &[(f64, Command)]) -> (Vec<TimedTaskEvent>, Vec<u64>) {
    let (assembly, watched) = plan.watched().unwrap();
    let watched = watched.unwrap();
    let mut happenings = Vec::new();
    let mut bits = Vec::new();
    let mut given = 0;
    let summary = runtime::run_virtual(assembly, seconds, |tick| {
        happenings.extend(watched.happenings());
        bits.extend(tick.measured_n.iter().chain(&tick.positions.tip_m).map(|x| x.to_bits()));
        let (at_s, command) = commands.get(given)?;
        (tick.t_s >= *at_s).then(|| {
            given += 1;
            *command
        })
    });
    assert_eq!((summary.final_state, given), (LoopState::Engaged, commands.len()));
    happenings.extend(watched.happenings());
    (happenings, bits)
}

#[test]
fn a_hand_that_feels_lumps_finds_them_wherever_they_are() {
    for (seed, mode) in [(23, Mode::Matched), (4, Mode::Best), (11, Mode::Matched)] {
        let mut plan = of("find_lumps", mode);
        plan.scene.seed = seed;
        let (happenings, _) = played(&plan, 115.0, &[]);
        let marks = happenings.iter().filter_map(|happening| match happening.event {
            TaskEvent::LumpMarked { lump, .. } => Some(lump),
            _ => None,
        });
        let marks: Vec<Option<usize>> = marks.collect();
        let mut found: Vec<usize> = marks.iter().flatten().copied().collect();
        found.sort_unstable();
        found.dedup();
        let wrong = marks.iter().filter(|lump| lump.is_none()).count();
        assert!(found.len() >= 4 && wrong <= 1, "seed {seed}, {mode}: {marks:?}");
        assert_eq!(happenings.last().map(|happening| happening.event), Some(TaskEvent::Ended));
    }
}

#[test]
fn a_hand_that_follows_the_wire_reaches_its_end_and_one_that_aims_better_touches_less() {
    let touches = |aim_error_m: f64| {
        let mut plan = of("wire", Mode::Matched);
        plan.scene.hand.aim_error_m = aim_error_m;
        let (happenings, _) = played(&plan, 40.0, &[]);
        assert_eq!(happenings.last().map(|happening| happening.event), Some(TaskEvent::Ended), "{aim_error_m}");
        happenings.iter().filter(|happening| matches!(happening.event, TaskEvent::WireTouched { .. })).count()
    };
    let counts = [0.0, 0.0022, 0.0036].map(touches);
    assert!(counts[0] == 0 && counts[1] >= 1 && counts[2] > counts[1], "{counts:?}");
}

#[test]
fn the_same_training_gives_the_same_bits() {
    for scene in ["find_lumps", "wire"] {
        let plan = of(scene, Mode::Matched);
        let one = played(&plan, 12.0, &[]);
        let other = played(&plan, 12.0, &[]);
        assert!(one == other, "{scene}");
    }
}

#[test]
fn a_person_marks_begins_anew_and_ends_from_the_screen() {
    let plan = of("find_lumps", Mode::Matched);
    let lump = plan.scene.placed_lumps().unwrap().list[2];
    let beside = Vector3::new(lump.position_m[0], lump.position_m[1], 0.004);
    let task = |at_s: f64, act: TaskAction| (at_s, Command::Task(Side::Right, act));
    let commands = [
        (0.5, Command::Guide(Side::Right, Some(beside))),
        task(2.5, TaskAction::Mark),
        task(2.6, TaskAction::Begin),
        task(2.7, TaskAction::Mark),
        (2.8, Command::Guide(Side::Right, Some(Vector3::new(0.055, 0.042, 0.004)))),
        task(4.8, TaskAction::Mark),
        task(4.9, TaskAction::End),
        task(5.0, TaskAction::Mark),
        task(5.1, TaskAction::End),
    ];
    let (happenings, _) = played(&plan, 6.0, &commands);
    let side = Side::Right;
    let found = TaskEvent::LumpMarked { side, lump: Some(2) };
    let wrong = TaskEvent::LumpMarked { side, lump: None };
    let events: Vec<TaskEvent> = happenings.iter().map(|happening| happening.event).collect();
    assert_eq!(events, [found, TaskEvent::Begun, found, wrong, TaskEvent::Ended]);
}
