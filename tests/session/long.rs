//! Tests of a long session: its size on the disk and in memory.

use std::{fs, time::Instant};

use nima_machine::runtime::{self, Assembly, tap};
use nima_recording::session::{SessionReader, SessionWriter};
use nima_session::{
    file::RecordedFile,
    recorder::{JOURNAL_TOPIC, SessionRecorder},
    replay::{Journal, ReplayOutcome, StepsMessages, replay, verify},
    sinks::Destination,
};
use nima_tests::plan;

use crate::file::{about, recorded};

/// Returns the memory of this process, MB; `None` if the system does not report it.
fn memory_mb() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1000.0)
}

/// Two arms on the virtual clock for `NIMA_MINUTES`, or one.
#[test]
#[ignore = "minutes: figures for docs/results/replay.md"]
fn figures_of_a_long_session() {
    let minutes: u64 = std::env::var("NIMA_MINUTES").map_or(1, |minutes| minutes.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let [path, journal] = ["session.mcap", "journal.mcap"].map(|name| folder.path().join(name));
    let plan = plan("bimanual");
    let (tap, end) = tap();
    let recorder = SessionRecorder::start(Destination::file(&path), about(), plan.origin(), end).unwrap();
    let begin = Instant::now();
    let mut memory = Vec::new();
    runtime::run_virtual(Assembly { tap: Some(tap), ..plan.simulated().unwrap() }, minutes as f64 * 60.0, |tick| {
        if tick.side.index() == 0 && tick.index % 60_000 == 59_999 {
            memory.extend(memory_mb());
        }
        None
    });
    let report = recorder.finish().unwrap();
    let took_s = begin.elapsed().as_secs_f64();
    assert_eq!((report.ticks, report.lost), (minutes * 60_000, 0));
    let reader = SessionReader::open(&path).unwrap();
    let forces = reader.channels().iter().find(|channel| channel.topic == "left/forces").unwrap();
    assert_eq!(forces.messages, Some(minutes * 60_000), "every sample is present");
    // Only the journal, in chunks as long as the session's.
    let mut alone = SessionWriter::create(&journal, "figures").unwrap();
    let channel = reader.channels().iter().find(|channel| channel.topic == JOURNAL_TOPIC).unwrap();
    let channel = alone.channel(JOURNAL_TOPIC, channel.encoding.clone()).unwrap();
    for message in reader.messages(&[JOURNAL_TOPIC], 0..u64::MAX) {
        let message = message.unwrap();
        alone.message(channel, message.log_time_ns(), message.data()).unwrap();
    }
    alone.finish().unwrap();
    let per_minute = |path| fs::metadata(path).unwrap().len() as f64 * 1e-6 / minutes as f64;
    let all_mb = per_minute(&path);
    let journal_mb = per_minute(&journal);
    println!(
        "{minutes} min in {took_s:.0} s: {} ticks, 0 lost; all {all_mb:.1} MB/min, journal {journal_mb:.1} MB/min; 8 h: {:.1} GB",
        report.ticks,
        all_mb * 0.48
    );
    println!("memory after each minute, MB: {memory:.1?}");
    if let [.., second, last] = &*[memory.get(1), memory.last()].into_iter().flatten().copied().collect::<Vec<_>>() {
        let per_hour_mb = (last - second) / (minutes as f64 - 2.0).max(1.0) * 60.0;
        println!("after the second minute it grows by {per_hour_mb:.1} MB an hour");
        assert!(minutes < 5 || per_hour_mb < 2.0, "{per_hour_mb} MB an hour");
    }
    assert!(all_mb <= 75.0 && journal_mb <= 25.0);
}

/// Two arms and one, replayed tick by tick in one thread and like `nima replay`, in turn.
#[test]
#[ignore = "a minute: figures for docs/results/replay.md"]
fn figures_of_replay() {
    const SECONDS: f64 = 120.0;
    let folder = tempfile::tempdir().unwrap();
    for scene in ["bimanual", "peg_transfer"] {
        let path = folder.path().join(scene);
        recorded(&path, &plan(scene), SECONDS, |_| None);
        let file = RecordedFile::open(&path).unwrap();
        let timed = |way: &dyn Fn(Journal<StepsMessages>) -> ReplayOutcome| {
            let begin = Instant::now();
            let outcome = way(file.journal().unwrap());
            assert!(outcome.differs.is_none() && outcome.closed, "{outcome:?}");
            SECONDS / begin.elapsed().as_secs_f64()
        };
        let mut speeds = [(); 5].map(|()| {
            [
                timed(&|journal| replay(journal, |_| ()).unwrap()),
                timed(&|journal| verify(journal, &(0.0..f64::INFINITY), |_| ()).unwrap()),
            ]
        });
        let ratios = speeds.map(|[one, side_by_side]| side_by_side / one);
        println!("{scene}: times real time in one thread and side by side: {speeds:.0?}; ratios {ratios:.2?}");
        let mut median = |way: usize| {
            speeds.sort_by(|a, b| a[way].total_cmp(&b[way]));
            speeds[2][way]
        };
        println!("{scene}: median of 5: {:.0} and {:.0} times real time", median(0), median(1));
    }
}
