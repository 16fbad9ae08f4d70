//! Rings, jaws, pins and the loop on the wire are shown in their recorded states.

use std::path::Path;

use nima_core::impedance::Mode;
use nima_machine::{
    config::RigConfig,
    messages::Command,
    rig::{SIDES, Side, TaskAction},
    runtime::{self, Assembly, VirtualClock},
};
use nima_screen::{
    objects::{OfSimulation, objects},
    recording,
};
use nima_session::{file::LineKind, objects::ObjectStates, sinks::Destination};
use nima_simulation::{SimulationPlan, Training, scene::Scene};

use super::{Playback, open, settled, until};

/// Returns a session of a scene with a training task, and the objects that the screen received. Before each tick of the
/// right arm, by its number, a command may be given.
fn record_task(scene: &str, path: &Path, seconds: f64, command: impl Fn(u64) -> Option<Command>) -> Vec<ObjectStates> {
    let mut rig = RigConfig::load("simulated").unwrap();
    let scene = Scene::load(scene).unwrap();
    let has_jaws = [scene.objects.is_some(); SIDES];
    rig.mode = Mode::Matched;
    let plan = SimulationPlan { rig, scene, calibrations: Default::default(), engage: true };
    let (tap, recorder) = recording::begin(Destination::file(path), &plan, Some(VirtualClock::PERFECT)).unwrap();
    let (assembly, watched) = plan.watched().unwrap();
    let mut watched = watched.unwrap();
    recorder.watch(OfSimulation::source(&plan, watched.another().unwrap()));
    let mut report = Vec::new();
    runtime::run_virtual(Assembly { tap: Some(tap), ..assembly }, seconds, |tick| {
        report.extend(watched.moments().map(|moment| objects(&moment, has_jaws)));
        (tick.side == Side::Right).then(|| command(tick.index)).flatten()
    });
    recorder.finish().unwrap();
    report
}

#[test]
fn rings_and_jaws_are_shown_as_they_were_and_move_while_it_is_played() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.mcap");
    let report = record_task("rings", &path, 6.0, |_| None);
    assert_eq!(report.len(), 600);
    let mut past = open(&path);
    until(&mut past, "read", |past| past.read_share() > 0.999);
    // Objects on the screen are at most 0.01 s old.
    let then = |t_s: f64| report.iter().rfind(|objects| objects.t_s < t_s + 1e-7).unwrap();
    let shown = |past: &Playback| past.live.as_ref().and_then(|live| live.objects.clone());
    let same = |past: &Playback| {
        let mut objects = shown(past)?;
        let expected = then(past.shown_s());
        assert!((objects.t_s - expected.t_s).abs() < 1e-8, "{} s, not {} s", objects.t_s, expected.t_s);
        objects.t_s = expected.t_s;
        Some(objects == *expected)
    };
    for t_s in [0.005, 1.234, 4.0, 5.99] {
        settled(&mut past, t_s);
        assert_eq!(same(&past), Some(true), "at {t_s} s");
    }
    past.show(3.0);
    past.live = None;
    until(&mut past, "shown at once", |past| past.live.is_some());
    assert_eq!(same(&past), Some(true));
    // The left instrument's jaws close on the first ring at 2 s.
    settled(&mut past, 1.4);
    past.toggle();
    let openings = (0..60).map(|_| {
        let before = past.shown_s();
        past.step(0.05, false);
        until(&mut past, "went on", |past| past.shown_s() > before);
        assert_eq!(same(&past), Some(true), "at {} s", past.shown_s());
        shown(&past).unwrap().jaws[1].unwrap().opening_rad
    });
    let openings: Vec<f64> = openings.collect();
    assert!(openings.iter().any(|rad| *rad > 0.5) && openings.iter().any(|rad| *rad < 0.3), "{openings:?}");
    let grasped = past.overview.notes.iter().find(|note| note.kind == LineKind::Happening);
    assert!(grasped.is_some_and(|note| note.words.contains("grasped by the left instrument")), "{grasped:?}");
}

#[test]
fn pins_and_the_loop_on_the_wire_are_shown_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lumps.mcap");
    let act = |tick: u64, at: u64, act| (tick == at).then_some(Command::Task(Side::Right, act));
    let report = record_task("find_lumps", &path, 3.0, |tick| {
        let marks = act(tick, 900, TaskAction::Mark).or_else(|| act(tick, 1800, TaskAction::Mark));
        marks.or_else(|| act(tick, 2400, TaskAction::End))
    });
    let shown_of = |path: &Path, report: &[ObjectStates], times_s: &[f64]| -> Vec<Training> {
        let mut past = open(path);
        until(&mut past, "read", |past| past.read_share() > 0.999);
        let shown = times_s.iter().map(|t_s| {
            settled(&mut past, *t_s);
            let live = past.live.as_ref().unwrap();
            let expected = report.iter().rfind(|objects| objects.t_s < past.shown_s() + 1e-7).unwrap();
            assert_eq!(live.objects.as_ref().unwrap().task, expected.task, "at {t_s} s");
            live.training.unwrap()
        });
        shown.collect()
    };
    let shown = shown_of(&path, &report, &[0.5, 1.5, 2.2, 2.9]);
    let marks = |training: &Training| training.marks.iter().flatten().count();
    assert_eq!(shown.iter().map(marks).collect::<Vec<_>>(), [0, 1, 2, 2]);
    assert_eq!(shown.iter().map(|training| training.ended).collect::<Vec<_>>(), [false, false, false, true]);
    let path = folder.path().join("wire.mcap");
    let report = record_task("wire", &path, 8.0, |_| None);
    let touches_s = report.iter().find(|objects| objects.task.as_ref().is_some_and(|task| task.loops[0].touches));
    let touches_s = touches_s.unwrap().t_s;
    let shown = shown_of(&path, &report, &[0.2, touches_s + 1e-4, 7.9]);
    assert!(!shown[0].loops[0].touches && shown[1].loops[0].touches && shown[1].loops[0].on_wire, "{shown:?}");
    assert!(shown[2].fraction > 0.1 && shown[2].touches >= 1, "{shown:?}");
}
