//! A disk that is slow, full or unplugged while a session is recorded: it is reported at once, the loop is unaffected,
//! and written data stay readable.

use std::{
    fs::{self, File},
    os::fd::AsRawFd as _,
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use nima_machine::runtime::{self, Assembly, LoopHandle, RuntimeClock, tap};
use nima_recording::session::{Encoding, SessionReader};
use nima_session::{
    recorder::{RecordError, SessionRecorder},
    sinks::{Audience, Destination},
};
use nima_testing::real_time::judged;
use nima_tests::plan;

use crate::file::{about, replayed};

/// Blocks the recorder's thread on request, like a slow disk.
#[derive(Clone, Debug, Default)]
struct Watching {
    blocks: Arc<AtomicBool>,
    forces: Arc<AtomicU64>,
    topics: Vec<String>,
}

impl Audience for Watching {
    fn channel(&mut self, topic: &str, _: &Encoding) {
        self.topics.push(topic.to_owned());
    }

    fn message(&mut self, channel: usize, _: u64, _: &[u8]) {
        while self.blocks.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(2));
        }
        if self.topics[channel] == "right/forces" {
            self.forces.fetch_add(1, Ordering::Relaxed);
        }
    }
}

fn run(to: Destination<'_>) -> (SessionRecorder, LoopHandle) {
    let plan = plan("peg_transfer");
    let (tap, end) = tap();
    let recorder = SessionRecorder::start(to, about(), plan.origin(), end).unwrap();
    let assembly =
        Assembly { tap: Some(tap), clock: RuntimeClock::Simulated { speed: 4.0 }, ..plan.simulated().unwrap() };
    (recorder, runtime::start(assembly).unwrap())
}

fn wait_for(mut what: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !what() {
        assert!(begin.elapsed() < Duration::from_mins(1), "nothing for a minute");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Waits until the loop has executed this many more ticks.
fn wait_for_ticks(handle: &LoopHandle, count: u64) {
    let mut first = None;
    let mut newest = 0;
    wait_for(|| {
        handle.drain_ticks(|tick| newest = tick.index);
        newest >= *first.get_or_insert(newest) + count
    });
}

/// Makes every later write to this file fail: it is not open for writing.
#[expect(unsafe_code, reason = "std exchanges no open file for another one")]
fn unplug(path: &Path) {
    let broken = File::open(path).unwrap();
    let descriptors = fs::read_dir("/proc/self/fd").unwrap().map(|entry| entry.unwrap().path());
    let of_file: Vec<i32> = descriptors
        .filter(|link| fs::read_link(link).is_ok_and(|to| to == path))
        .filter_map(|link| link.file_name()?.to_str()?.parse().ok())
        .filter(|number| *number != broken.as_raw_fd())
        .collect();
    assert_eq!(of_file.len(), 2, "one is written to, and one is synchronised");
    for number in of_file {
        // SAFETY: both are open files of this process, and the owner of the second one still has an open file
        // afterwards.
        assert!(unsafe { libc::dup2(broken.as_raw_fd(), number) } == number);
    }
}

fn times(path: &Path) -> Vec<u64> {
    let reader = SessionReader::open(path).unwrap();
    assert!(reader.notes().is_empty(), "{:?}", reader.notes());
    reader.messages(&["right/forces"], 0..u64::MAX).map(|message| message.unwrap().log_time_ns()).collect()
}

#[test]
fn a_slow_disk_is_told_and_the_loop_goes_on_and_the_file_says_what_is_missing() {
    // A machine that delays the recorder's thread loses entries before and after.
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("session.mcap");
        let slow = Watching::default();
        let to = Destination { audiences: vec![Box::new(slow.clone())], ..Destination::file(&path) };
        let (recorder, handle) = run(to);
        wait_for(|| recorder.progress().ticks > 500);
        slow.blocks.store(true, Ordering::Relaxed);
        // There is room for 2.5 s of data, and the loop is not informed.
        wait_for_ticks(&handle, 4000);
        let waits = recorder.progress().waits;
        assert!(waits > Duration::from_millis(300), "4 s of the loop, at four times its pace: {waits:?}");
        slow.blocks.store(false, Ordering::Relaxed);
        wait_for(|| recorder.progress().lost > 0);
        wait_for_ticks(&handle, 1000);
        wait_for(|| recorder.progress().waits < Duration::from_millis(200));
        let summary = handle.stop_and_join().unwrap();
        let report = recorder.finish().unwrap();
        assert!(
            report.ticks + report.lost >= summary.ticks && report.ticks < summary.ticks,
            "{report:?}, {}",
            summary.ticks
        );
        let outcome = replayed(&path).unwrap();
        let hole = outcome.hole.unwrap();
        assert!(outcome.differs.is_none() && hole.tick > 500 && hole.lost == report.lost, "{outcome:?}, {report:?}");
        let times = times(&path);
        assert_eq!(times.len() as u64, report.ticks, "later data are present too");
        assert!(times.windows(2).any(|pair| pair[1] - pair[0] > 500_000_000), "and a stretch between is not");
    });
}

#[test]
fn a_disk_that_is_unplugged_is_told_and_what_is_live_goes_on() {
    // A machine that delays the recorder's thread loses entries.
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("session.mcap");
        let watching = Watching::default();
        let to = Destination { audiences: vec![Box::new(watching.clone())], ..Destination::file(&path) };
        let (recorder, handle) = run(to);
        wait_for(|| recorder.progress().ticks > 1500);
        unplug(&path);
        wait_for(|| recorder.trouble().is_some());
        let words = recorder.trouble().unwrap().to_string();
        assert!(words.contains("session.mcap") && words.contains("check the disk"), "{words}");
        let then = watching.forces.load(Ordering::Relaxed);
        wait_for(|| watching.forces.load(Ordering::Relaxed) > then + 2000);
        let summary = handle.stop_and_join().unwrap();
        assert!(matches!(recorder.finish(), Err(RecordError::Write(_) | RecordError::System { .. })));
        assert_eq!(watching.forces.load(Ordering::Relaxed), summary.ticks, "the audience has seen every tick");
        let outcome = replayed(&path).unwrap();
        assert!(outcome.differs.is_none() && outcome.ticks + 500 > 1500 && !outcome.closed, "{outcome:?}");
    });
}
