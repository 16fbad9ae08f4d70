//! Cost of recording a tick of two arm pairs, while another thread writes the journal: time and allocations.
//!
//! `./dev bench`. Runs once with one tick after the other, and once at the pace of the real loop, where the caches have
//! gone cold.
#![expect(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

#[path = "../tests/allocation/counting.rs"]
mod counting;

use std::{
    thread,
    time::{Duration, Instant},
};

use counting::calls;
use nima_machine::{
    config::RigConfig,
    messages::Command,
    rig::Rig as _,
    runtime::{TapEnd, TapItem, tap},
    teleop::{Calibrations, Loop, LoopOrigin, Timing},
};
use nima_session::{journal::JournalStart, journal_writer::JournalWriter};
use nima_simulation::{Worlds, scene::Scene};

/// Writes the journal into memory; returns its bytes, ticks and lost entries.
fn read(start: &JournalStart, end: &TapEnd) -> (usize, u64, u64) {
    let (mut scribe, _) = JournalWriter::new(start).unwrap();
    let mut kept = Vec::new();
    loop {
        match end.next(Duration::from_millis(100)) {
            TapItem::Entry(entry) => scribe.take(entry, end, &mut kept).unwrap(),
            TapItem::Nothing => {}
            TapItem::End => break,
        }
    }
    let end = scribe.end(end, &mut kept).unwrap();
    (kept.iter().map(Vec::len).sum(), end.ticks, end.lost)
}

fn run(ticks: u64, pause: Duration, words: &str) {
    let rig = RigConfig::load("simulated").unwrap();
    let origin = LoopOrigin {
        rig: rig.clone(),
        calibrations: [const { Some(Calibrations { gravity: None, gravity_check: None, tip_force: None }) }; 2],
        suspended: false,
    };
    let mut control: Loop = origin.control().unwrap();
    let mut world = Worlds::new(&Scene::load("bimanual").unwrap(), rig.rate_hz);
    let (mut tap, end) = tap();
    let start = JournalStart { program: "bench".to_owned(), origin };
    let reader = thread::spawn(move || read(&start, &end));
    control.obey(Command::Engage, 0.0);
    let mut times_us = Vec::with_capacity(ticks as usize);
    let before = calls();
    let mut due = Instant::now();
    for k in 0..ticks {
        due += pause;
        thread::sleep(due.saturating_duration_since(Instant::now()));
        let timing = Timing { now_s: k as f64 * 1e-3, ..Timing::default() };
        let inputs = world.read(timing.now_s);
        control.clear_events();
        let (outputs, ticks) = control.step(inputs, &timing);
        world.write(timing.now_s, &outputs);
        let begin = Instant::now();
        tap.tick(control.events(), &timing, &inputs, &outputs, &ticks);
        times_us.push(begin.elapsed().as_secs_f64() * 1e6);
    }
    let allocations = calls() - before;
    drop(tap);
    let (bytes, kept, lost) = reader.join().unwrap();
    times_us.sort_by(f64::total_cmp);
    let at = |fraction: f64| times_us[(fraction * (times_us.len() - 1) as f64) as usize];
    println!(
        "{words:24} p50 {:.2} us   p99 {:.2} us   p99.9 {:.2} us   max {:.1} us   {allocations} allocations   {kept} ticks kept, {lost} entries lost, {bytes} bytes",
        at(0.5),
        at(0.99),
        at(0.999),
        at(1.0),
    );
}

fn main() {
    run(20_000, Duration::from_micros(100), "ten times the real pace");
    run(20_000, Duration::from_millis(1), "at the real pace");
}
