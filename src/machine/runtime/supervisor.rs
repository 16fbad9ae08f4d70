//! Monitors the loop from a separate thread: if the loop stalls while the drives are on, for whatever reason, the
//! drives are switched off.
//!
//! The loop calls `beat` once per tick. The supervisor checks every 2 ms; after [`STALL_MAX_S`] without a beat it calls
//! the [`Lever`](nima_devices::Lever) of every device (handle: force off, brakes on; arm: leave cyclic servoing) and
//! stores how long the loop was silent. The loop reads this in its next tick and enters a latched fault, so nothing
//! resumes without a person.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{Builder, JoinHandle},
    time::Duration,
};

use nima_devices::Lever;

use super::os;

/// Maximum time without a beat while drives are on, s: the age beyond which a sample is a fault too
/// (`teleop::samples`), because a force that is not renewed for longer is old.
pub const STALL_MAX_S: f64 = 0.020;
/// A tenth of the limit: it delays the release by this time at most, and costs next to nothing.
const LOOK_EVERY: Duration = Duration::from_millis(2);

#[derive(Debug, Default)]
pub(super) struct Pulse {
    beat_ns: AtomicU64,
    driven: AtomicBool,
    /// Silence of the loop if the emergency releases were called, ns; zero if they were not called.
    pulled_ns: AtomicU64,
}

impl Pulse {
    /// Reports that the loop is alive; `driven` is true while the drives are on.
    pub(super) fn beat(&self, now_ns: u64, driven: bool) {
        self.driven.store(driven, Ordering::Relaxed);
        // The beat is stored last, so that a reader of the new beat also has the state of the drives that belongs to it.
        let before_ns = self.beat_ns.swap(now_ns, Ordering::AcqRel);
        self.lengthen(now_ns.saturating_sub(before_ns));
    }

    /// Extends the stored silence to this one: the supervisor stores it when the limit is passed, but it may last longer.
    fn lengthen(&self, silent_ns: u64) {
        if self.pulled_ns.load(Ordering::Acquire) > 0 {
            self.pulled_ns.fetch_max(silent_ns, Ordering::AcqRel);
        }
    }

    /// Replaces a heartbeat while this watchdog is tested: to the supervisor, the loop appears to be hung with its
    /// drives on.
    pub(super) fn withhold(&self) {
        self.driven.store(true, Ordering::Relaxed);
    }

    /// Returns how long the loop had been silent, s, if the levers were pulled since the last call of this function; a
    /// silence that has not ended yet counts until now.
    pub(super) fn take_pulled(&self, now_ns: u64) -> Option<f64> {
        self.lengthen(now_ns.saturating_sub(self.beat_ns.load(Ordering::Acquire)));
        match self.pulled_ns.swap(0, Ordering::AcqRel) {
            0 => None,
            ns => Some(ns as f64 * 1e-9),
        }
    }
}

/// The supervisor's thread. Dropping this value stops it.
#[derive(Debug)]
pub(super) struct Supervisor {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Supervisor {
    pub(super) fn start(pulse: Arc<Pulse>, levers: Vec<Lever>, real_time: bool) -> std::io::Result<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        let thread = Builder::new().name("supervisor".to_owned()).spawn(move || {
            if real_time {
                os::prepare_supervisor();
            }
            let limit_ns = (STALL_MAX_S * 1e9) as u64;
            let mut pulled = false;
            // Levers that are still to be pulled in this stall.
            let mut waiting = vec![false; levers.len()];
            while !flag.load(Ordering::Acquire) {
                std::thread::sleep(LOOK_EVERY);
                let silent_ns = os::monotonic_ns().saturating_sub(pulse.beat_ns.load(Ordering::Acquire));
                // A stall without drives is harmless, and may be a rig that is being opened.
                let stalled = pulse.driven.load(Ordering::Relaxed) && silent_ns > limit_ns;
                // Once for each stall: the emergency release of some devices closes a connection, and a second call
                // would find it closed.
                if stalled != pulled {
                    waiting.fill(stalled);
                }
                for (lever, waits) in levers.iter().zip(&mut waiting).filter(|(_, waits)| **waits) {
                    *waits = !lever.pull();
                }
                if stalled && !pulled {
                    // A longer stall that the loop has not reported yet stays.
                    pulse.pulled_ns.fetch_max(silent_ns, Ordering::AcqRel);
                }
                pulled = stalled;
            }
        })?;
        Ok(Self { stop, thread: Some(thread) })
    }
}

impl Drop for Supervisor {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_that_stands_still_loses_its_drives_once_and_one_without_drives_may_stand() {
        let pulse = Arc::new(Pulse::default());
        let lever = Lever::default();
        let count = Arc::new(AtomicU64::new(0));
        let counted = Arc::clone(&count);
        lever.attach(move || {
            counted.fetch_add(1, Ordering::Relaxed);
        });
        let supervisor = Supervisor::start(Arc::clone(&pulse), vec![lever], true).unwrap();
        pulse.beat(os::monotonic_ns(), false);
        std::thread::sleep(Duration::from_millis(80));
        let taken = pulse.take_pulled(os::monotonic_ns());
        assert_eq!((count.load(Ordering::Relaxed), taken), (0, None), "nothing is driven");
        pulse.beat(os::monotonic_ns(), true);
        std::thread::sleep(Duration::from_millis(150));
        assert_eq!(count.load(Ordering::Relaxed), 1);
        let after_s = pulse.take_pulled(os::monotonic_ns()).unwrap();
        assert!(after_s > 0.14, "the whole silence counts, not only until the levers were pulled: {after_s} s");
        drop(supervisor);
    }

    #[test]
    fn a_silence_that_ends_within_a_tick_counts_to_its_end() {
        let pulse = Pulse::default();
        pulse.beat(0, true);
        pulse.pulled_ns.store(22_000_000, Ordering::Release);
        // A write to a device that took two seconds.
        pulse.beat(2_000_000_000, true);
        let silent_s = pulse.take_pulled(2_001_000_000);
        assert_eq!(silent_s, Some(2.0));
        assert_eq!(pulse.take_pulled(2_002_000_000), None, "it is reported once");
    }

    #[test]
    fn a_lever_that_another_thread_holds_is_pulled_later_and_delays_no_other() {
        let pulse = Arc::new(Pulse::default());
        let levers = [Lever::default(), Lever::default()];
        let counts: [Arc<AtomicU64>; 2] = std::array::from_fn(|_| Arc::default());
        let is_held = Arc::new(AtomicBool::new(true));
        for (lever, count) in levers.iter().zip(&counts) {
            let count = Arc::clone(count);
            let is_held = Arc::clone(&is_held);
            lever.attach(move || {
                count.fetch_add(1, Ordering::Relaxed);
                while is_held.load(Ordering::Relaxed) && std::thread::current().name() != Some("supervisor") {
                    std::thread::sleep(Duration::from_millis(1));
                }
            });
        }
        let count = |at: usize| counts[at].load(Ordering::Relaxed);
        std::thread::scope(|scope| {
            scope.spawn(|| levers[0].pull());
            while count(0) == 0 {
                std::thread::yield_now();
            }
            pulse.beat(os::monotonic_ns(), true);
            let _supervisor = Supervisor::start(Arc::clone(&pulse), levers.to_vec(), true).unwrap();
            std::thread::sleep(Duration::from_millis(100));
            assert_eq!([count(0), count(1)], [1, 1]);
            is_held.store(false, Ordering::Relaxed);
            std::thread::sleep(Duration::from_millis(100));
            assert_eq!([count(0), count(1)], [2, 1]);
        });
    }
}
