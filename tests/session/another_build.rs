//! Sessions of one build in another one: by hand, with the same folder for both.
//!
//! `NIMA_SESSIONS=DIR cargo test -p nima-tests --test session -- --ignored another_build`, then the same with `--release`: the first
//! one records, every other one replays.

use std::path::PathBuf;

use nima_core::impedance::Mode;
use nima_machine::messages::{Command, Tick};
use nima_simulation::scene::Scene;
use nima_tests::plan;

use crate::file::{recorded, replayed};

/// Selects the modes one after the other, with their settings.
fn operator(tick: &Tick) -> Option<Command> {
    let all: Vec<Mode> = Mode::ALL.to_vec();
    match tick.index {
        3000 => Some(Command::SetDelay(0.15)),
        6000 => Some(Command::SetGain(0.7)),
        index if index % 1500 == 700 => Some(Command::SetMode(all[(index / 1500) as usize % all.len()])),
        _ => None,
    }
}

#[test]
#[ignore = "by hand: one build records, another one replays"]
fn sessions_of_another_build_replay_bit_for_bit() {
    let folder = PathBuf::from(std::env::var("NIMA_SESSIONS").expect("NIMA_SESSIONS names a folder"));
    let build = if cfg!(debug_assertions) { "debug" } else { "release" };
    let baselines = Mode::BASELINES.into_iter().map(|mode| ("peg_transfer", Some(mode)));
    for (scene, mode) in Scene::names().map(|scene| (scene, None)).chain(baselines) {
        let mut plan = plan(scene);
        plan.rig.mode = mode.unwrap_or(plan.rig.mode);
        plan.rig.identification.compare = true;
        let path = folder.join(format!("{scene}-{}.mcap", plan.rig.mode));
        if path.exists() {
            let begin = std::time::Instant::now();
            let outcome = replayed(&path).unwrap();
            let speed = outcome.seconds / begin.elapsed().as_secs_f64();
            println!("{build} replays {}: {} ticks, {speed:.0} times real time", path.display(), outcome.ticks);
            assert_eq!((outcome.ticks, outcome.differs, outcome.closed), (20_000, None, true), "{scene}");
        } else {
            recorded(&path, &plan, 20.0, operator);
            println!("{build} recorded {}, {} bytes", path.display(), std::fs::metadata(&path).unwrap().len());
        }
    }
}
