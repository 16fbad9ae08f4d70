//! Every scene, commands and faults: what is replayed is what was recorded.

use nima_core::impedance::Mode;
use nima_machine::messages::{Command, Tick};
use nima_tests::plan;
use nima_world::scene::Scene;

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

/// Commands of every kind at odd times, also refused ones.
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
        let (mut modes, mut states) = (Vec::new(), Vec::new());
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
