//! Times of the loop as UTC: in sessions and for live viewers.

use std::{
    sync::{Arc, Mutex},
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use nima_machine::{
    messages::{Event, Tick},
    rig::SIDES,
    runtime::{self, Assembly, RuntimeClock, tap},
};
use nima_recording::session::{Encoding, SessionReader};
use nima_session::{
    plot_channels,
    recorder::SessionRecorder,
    sinks::{Audience, Destination},
};
use nima_testing::real_time::{alone, judged};
use nima_tests::plan;

use crate::file::about;

/// Largest error of a time, s.
const ERROR_MAX_S: f64 = 1e-3;

#[derive(Clone, Debug, Default)]
struct Stamps(Arc<Mutex<Seen>>);

#[derive(Debug, Default)]
struct Seen {
    started_ns: u64,
    clocks: usize,
    /// Delay with which each message, and each tick, arrived, s.
    messages_s: Vec<f64>,
    ticks_s: Vec<f64>,
}

fn utc_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos() as u64
}

impl Audience for Stamps {
    fn clock(&mut self, started_ns: u64) {
        let mut seen = self.0.lock().unwrap();
        seen.started_ns = started_ns;
        seen.clocks += 1;
    }

    fn channel(&mut self, _topic: &str, _encoding: &Encoding) {}

    fn message(&mut self, _channel: usize, log_time_ns: u64, _data: &[u8]) {
        let mut seen = self.0.lock().unwrap();
        if seen.clocks > 0 {
            seen.messages_s.push((utc_ns().cast_signed() - log_time_ns.cast_signed()) as f64 * 1e-9);
        }
    }

    fn tick(&mut self, t_s: f64, _ticks: &[Option<Tick>; SIDES], _events: &[Event]) {
        let mut seen = self.0.lock().unwrap();
        let since_s = (utc_ns() - seen.started_ns) as f64 * 1e-9;
        seen.ticks_s.push(since_s - t_s);
    }
}

#[test]
fn a_time_of_the_loop_is_the_same_moment_in_utc() {
    let _alone = alone();
    judged(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("session.mcap");
        let stamps = Stamps::default();
        let plan = plan("peg_transfer");
        let (tap, end) = tap();
        let to = Destination { file: Some(&path), audiences: vec![Box::new(stamps.clone())] };
        let recorder = SessionRecorder::start(to, about(), plan.origin(), end).unwrap();
        // Opening a rig takes a while.
        std::thread::sleep(Duration::from_millis(50));
        let assembly = plan.simulated().unwrap();
        let handle = runtime::start(Assembly { tap: Some(tap), clock: RuntimeClock::Real, ..assembly }).unwrap();
        std::thread::sleep(Duration::from_millis(2500));
        handle.stop_and_join().unwrap();
        recorder.finish().unwrap();
        let seen = stamps.0.lock().unwrap();
        assert!(seen.clocks >= 2, "it is followed");
        // The earliest arrivals show the error: the others were delayed on the way.
        for (what, late_s) in [("messages", &seen.messages_s), ("ticks", &seen.ticks_s)] {
            let error_s = late_s.iter().copied().fold(f64::INFINITY, f64::min);
            println!("{what}: {:.0} us", 1e6 * error_s);
            assert!(error_s.abs() < ERROR_MAX_S, "{what}: {error_s} s");
        }
        let reader = SessionReader::open(&path).unwrap();
        let begin_ns = plot_channels::beginning_ns(&reader).unwrap();
        assert!(begin_ns.abs_diff(seen.started_ns) < 1_000_000, "{begin_ns}");
        let first = reader.messages(&["right/forces"], 0..u64::MAX).next().unwrap().unwrap();
        assert!(first.log_time_ns() - begin_ns < 20_000_000, "times begin with the loop");
    });
}
