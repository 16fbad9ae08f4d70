//! Every scene, commands and faults: the replay equals the recording.

use nalgebra::Vector3;
use nima_core::impedance::Mode;
use nima_machine::{
    messages::{Command, Tick},
    rig::{Side, TaskAction},
};
use nima_simulation::scene::Scene;
use nima_tests::plan;

use crate::bench::record;

#[test]
fn every_scene_replays_bit_for_bit() {
    for scene in Scene::names() {
        let plan = plan(scene);
        let kept = record(&plan, 10.0, |_| None);
        let begin = std::time::Instant::now();
        let outcome = kept.replayed(|_| {}).unwrap();
        println!(
            "{scene}: {outcome:?}, {:.0} times real time, {} bytes a minute before compression",
            outcome.seconds / begin.elapsed().as_secs_f64(),
            kept.0.iter().map(Vec::len).sum::<usize>() * 6
        );
        assert_eq!(
            (outcome.ticks, outcome.differs, outcome.hole, outcome.closed),
            (10_000, None, None, true),
            "{scene}"
        );
    }
}

/// Returns commands of every kind at arbitrary times, including refused ones.
fn operator(tick: &Tick) -> Option<Command> {
    Some(match tick.index {
        700 => Command::SetMode(Mode::Dfr),
        1500 => Command::SetDelay(0.123),
        1800 => Command::SetGain(0.4),
        2000 => Command::SetGain(7.0),
        2500 => Command::SetMode(Mode::Matched),
        3000 => Command::Stop,
        3500 => Command::ReleaseStop,
        3100 | 3600 => Command::Engage,
        4500 => Command::SetScale(0.5),
        5000 => Command::LetGo(true),
        6000 => Command::Compare(true),
        6500 => Command::Rest,
        7000 => Command::EngageOne(tick.side),
        _ => return None,
    })
}

#[test]
fn commands_are_replayed_when_they_came() {
    for scene in ["peg_transfer", "bimanual"] {
        let kept = record(&plan(scene), 10.0, operator);
        let mut modes = Vec::new();
        let mut states = Vec::new();
        let outcome = kept
            .replayed(|tick| {
                modes.push(tick.mode);
                states.push(tick.state);
            })
            .unwrap();
        assert_eq!((outcome.ticks, outcome.differs), (10_000, None), "{scene}");
        modes.dedup();
        states.dedup();
        assert!(modes.len() >= 3 && states.len() >= 6, "{scene}: {modes:?}, {states:?}");
    }
}

/// Leads the right instrument from the screen for a while, opens and closes its jaws, and restarts the trial.
fn by_mouse(tick: &Tick) -> Option<Command> {
    Some(match tick.index {
        9_000 => Command::Guide(Side::Right, Some(Vector3::new(0.02, -0.01, 0.02))),
        9_500 => Command::Grip(Side::Right, Some(0.7)),
        11_000 => Command::Guide(Side::Right, Some(Vector3::new(0.02, 0.0, 0.004))),
        12_000 => Command::Grip(Side::Right, Some(0.0)),
        13_000 => Command::Task(Side::Right, TaskAction::Begin),
        14_000 => Command::Grip(Side::Right, None),
        14_500 => Command::Guide(Side::Right, None),
        _ => return None,
    })
}

#[test]
fn rings_and_a_wire_replay_bit_for_bit_and_are_the_same_when_they_are_done_again() {
    for scene in ["rings", "wire"] {
        let mut plan = plan(scene);
        plan.rig.mode = Mode::Matched;
        let bits = |tick: &Tick| {
            let felt = tick
                .measured_n
                .iter()
                .chain(&tick.positions.tip_m)
                .chain(&tick.rendering.rendered_n)
                .map(|x| x.to_bits());
            felt.collect::<Vec<u64>>()
        };
        let done = || {
            let mut report = Vec::new();
            let kept = record(&plan, 30.0, |tick| {
                report.extend(bits(tick));
                by_mouse(tick)
            });
            (kept, report)
        };
        let [(kept, first), (_, second)] = [done(), done()];
        assert!(first == second, "{scene}: the same commands give the same simulation");
        let mut replayed = Vec::new();
        let outcome = kept.replayed(|tick| replayed.extend(bits(tick))).unwrap();
        assert_eq!((outcome.ticks, outcome.differs, outcome.hole), (30_000, None, None), "{scene}");
        assert!(replayed == first, "{scene}: the replay has every bit");
        let felt = |tick: &&[u64]| tick[..3].iter().any(|bits| f64::from_bits(*bits).abs() > 0.3);
        let touched = first.chunks(9).filter(felt).count();
        assert!(touched > 100, "{scene}: something was touched: {touched}");
    }
}
