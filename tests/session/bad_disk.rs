//! A disk that is slow, full or unplugged while a session is recorded: told at once, the loop unmoved, what is written stays readable.

use std::{
    fs::{self, File},
    os::fd::AsRawFd as _,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use nima_machine::runtime::{self, Assembly, Clock, Handle, tap};
use nima_recording::session::{Encoding, Reader};
use nima_session::{
    file::Recorded,
    outlet::{Audience, Destination},
    recorder::{RecordError, Recorder},
    replay::replay,
};
use nima_testing::real_time::judged;
use nima_tests::plan;

use crate::file::{about, replayed};

/// Somebody who watches, and who can keep the recorder's thread waiting as a slow disk does.
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

fn run(to: Destination<'_>) -> (Recorder, Handle) {
    let plan = plan("peg_transfer");
    let (tap, end) = tap();
    let recorder = Recorder::start(to, about(), plan.origin(), end).unwrap();
    let assembly = Assembly { tap: Some(tap), clock: Clock::Simulated { speed: 4.0 }, ..plan.simulated().unwrap() };
    (recorder, runtime::start(assembly).unwrap())
}

fn wait_for(mut what: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !what() {
        assert!(begin.elapsed() < Duration::from_mins(1), "nothing for a minute");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Waits until the loop has made so many ticks more.
fn wait_for_ticks(handle: &Handle, count: u64) {
    let (mut first, mut newest) = (None, 0);
    wait_for(|| {
        handle.drain_ticks(|tick| newest = tick.index);
        newest >= *first.get_or_insert(newest) + count
    });
}

/// What the system says to every write to this file from now on: it is not open for writing.
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
        // SAFETY: both are open files of this process, and whoever has the second one goes on having an open file.
        assert!(unsafe { libc::dup2(broken.as_raw_fd(), number) } == number);
    }
}

fn times(path: &Path) -> Vec<u64> {
    let reader = Reader::open(path).unwrap();
    assert!(reader.notes().is_empty(), "{:?}", reader.notes());
    reader.messages(&["right/forces"], 0..u64::MAX).map(|message| message.unwrap().log_time_ns()).collect()
}

#[test]
fn a_slow_disk_is_told_and_the_loop_goes_on_and_the_file_says_what_is_missing() {
    // A machine that holds up the recorder's thread loses entries before and after.
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("session.mcap");
        let slow = Watching::default();
        let to = Destination { audiences: vec![Box::new(slow.clone())], ..Destination::file(&path) };
        let (recorder, handle) = run(to);
        wait_for(|| recorder.progress().ticks > 500);
        slow.blocks.store(true, Ordering::Relaxed);
        // There is room for 2.5 s, and nobody tells the loop.
        wait_for_ticks(&handle, 4000);
        let waits = recorder.progress().waits;
        assert!(waits > Duration::from_millis(300), "4 s of the loop, at four times its pace: {waits:?}");
        slow.blocks.store(false, Ordering::Relaxed);
        wait_for(|| recorder.progress().lost > 0);
        wait_for_ticks(&handle, 1000);
        wait_for(|| recorder.progress().waits < Duration::from_millis(200));
        let summary = handle.stop_and_join().unwrap();
        let told = recorder.finish().unwrap();
        assert!(told.ticks + told.lost >= summary.ticks && told.ticks < summary.ticks, "{told:?}, {}", summary.ticks);
        let outcome = replayed(&path).unwrap();
        let hole = outcome.hole.unwrap();
        assert!(outcome.differs.is_none() && hole.tick > 500 && hole.lost == told.lost, "{outcome:?}, {told:?}");
        let times = times(&path);
        assert_eq!(times.len() as u64, told.ticks, "what came after it is there too");
        assert!(times.windows(2).any(|pair| pair[1] - pair[0] > 500_000_000), "and a stretch between is not");
    });
}

#[test]
fn a_disk_that_is_unplugged_is_told_and_what_is_live_goes_on() {
    // A machine that holds up the recorder's thread loses entries.
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
        assert_eq!(watching.forces.load(Ordering::Relaxed), summary.ticks, "whoever watches has seen every tick");
        let outcome = replayed(&path).unwrap();
        assert!(outcome.differs.is_none() && outcome.ticks + 500 > 1500 && !outcome.closed, "{outcome:?}");
    });
}

#[test]
fn a_recording_goes_on_in_its_second_place_and_nothing_is_missing() {
    // A machine that holds up the recorder's thread loses entries.
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["session.mcap", "second.mcap"].map(|name| folder.path().join(name));
        let (recorder, handle) = run(Destination { second: Some(&second), ..Destination::file(&first) });
        wait_for(|| recorder.progress().ticks > 1500);
        unplug(&first);
        wait_for(|| recorder.moved().is_some());
        let moved = recorder.moved().unwrap();
        assert_eq!(moved.to, second);
        assert!(moved.why.to_string().contains("session.mcap"), "{}", moved.why);
        wait_for_ticks(&handle, 2000);
        let summary = handle.stop_and_join().unwrap();
        let told = recorder.finish().unwrap();
        assert_eq!((told.ticks, told.lost), (summary.ticks, 0));
        let (one, other) = (Recorded::open(&first).unwrap(), Recorded::open(&second).unwrap());
        let outcome = replay(one.journal_with(std::slice::from_ref(&other)).unwrap(), |_| {}).unwrap();
        assert_eq!((outcome.ticks, outcome.differs, outcome.hole), (summary.ticks, None, None));
        assert!(outcome.closed);
        let mut all: Vec<u64> = times(&first);
        assert!(all.len() > 1000, "the first file stays readable");
        all.extend(times(&second));
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len() as u64, summary.ticks, "every tick is plotted in one of them");
        // The second alone: its times are those of the session, and it says where it comes from.
        let about = other.about().unwrap();
        // It begins with what the first disk has not confirmed, which may be everything.
        assert!(about.stretch_from_s.is_some_and(|from_s| from_s < about.seconds - 1.0), "{about:?}");
        let tables = other.reader().metadata().unwrap();
        let (_, table) = tables.iter().find(|(name, _)| name == "cut").unwrap();
        assert!(table["session"] == "session.mcap" && table["why"].contains("session.mcap"), "{table:?}");
        assert!(tables.iter().any(|(name, _)| name == "calibrations right") && other.is_closed().unwrap());
    });
}

#[test]
fn where_no_place_can_be_written_both_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let first = folder.path().join("session.mcap");
    let second = PathBuf::from("/nowhere/second.mcap");
    let (recorder, handle) = run(Destination { second: Some(&second), ..Destination::file(&first) });
    wait_for(|| recorder.progress().ticks > 500);
    fs::remove_file(&first).unwrap();
    wait_for(|| recorder.trouble().is_some());
    let words = recorder.trouble().unwrap().to_string();
    assert!(words.contains("deleted") && words.contains("/nowhere/second.mcap"), "{words}");
    wait_for_ticks(&handle, 500);
    handle.stop_and_join().unwrap();
    assert!(matches!(recorder.finish(), Err(RecordError::Both { .. })));
}
