//! Tests in real time. They must not fail because the machine is busy with other work.

use std::{
    num::NonZero,
    panic::{AssertUnwindSafe, catch_unwind, panic_any, resume_unwind},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicU64, Ordering::Relaxed},
    },
    thread::{JoinHandle, available_parallelism, sleep, spawn},
    time::{Duration, Instant},
};

use crate::unjudged;

const ATTEMPTS: usize = 5;
/// If a busy machine has delayed a test for this long, stop retrying, and judge the test when nothing else runs.
const PATIENCE: Duration = Duration::from_mins(1);
/// Limit for all tests of a program together; after that, each test has one attempt.
const PATIENCE_OF_ALL: Duration = Duration::from_mins(2);
/// Time spent so far on attempts on a busy machine, ms.
static HELD_UP_MS: AtomicU64 = AtomicU64::new(0);
/// Failures allowed on a machine that was not busy. One may be chance: the machine can delay the emulators' threads
/// alone.
const FAILURES_MAX: usize = 2;
const NAP: Duration = Duration::from_millis(1);
/// A quiet machine wakes a sleeping thread within this time, and never later than `PAUSE`: half of the 20 ms after which
/// a device counts as silent, because a device and the loop can be delayed in turn.
const LATE: Duration = Duration::from_millis(3);
const PAUSE: Duration = Duration::from_millis(10);
/// If the idle fraction of processor time is smaller than this, threads other than the sleeping one may be delayed
/// unnoticed.
const IDLE_FRACTION: f64 = 0.1;
/// With a larger fraction of time taken by the virtual machine's host, threads are delayed in a way that no clock here
/// shows.
const STOLEN_FRACTION: f64 = 0.03;

/// Lets only one test of a program run at a time: devices in real time appear silent while other work takes every core.
pub fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

struct TooBusy;

/// Ends an attempt within `judged` if the test itself has detected that it was delayed.
pub fn too_busy() -> ! {
    panic_any(TooBusy)
}

/// Runs a test in real time. A failure on a busy machine is not judged, and the test is tried again; two failures on a
/// quiet machine fail it. A test that never ran on a quiet machine is reported (`unjudged`); `./dev test` runs it again
/// after all others.
pub fn judged(test: impl Fn()) {
    let watch = || {
        let watch = WakeWatch::start();
        move || watch.was_busy()
    };
    let left = PATIENCE_OF_ALL.saturating_sub(Duration::from_millis(HELD_UP_MS.load(Relaxed)));
    let begin = Instant::now();
    let is_judged = judged_on(test, watch, PATIENCE.min(left));
    if !is_judged {
        HELD_UP_MS.fetch_add(begin.elapsed().as_millis() as u64, Relaxed);
        unjudged::too_busy();
    }
}

/// `watch` starts to observe the machine; the closure that it returns reports, at the end of an attempt, whether the
/// machine was busy. Returns `false` if the test neither passed nor failed.
fn judged_on<Busy: FnOnce() -> bool>(test: impl Fn(), watch: impl Fn() -> Busy, patience: Duration) -> bool {
    let begin = Instant::now();
    let mut failures = 0;
    for _ in 0..ATTEMPTS {
        let was_busy = watch();
        let Err(cause) = catch_unwind(AssertUnwindSafe(&test)) else { return true };
        let busy = was_busy() || cause.is::<TooBusy>();
        failures += usize::from(!busy);
        if failures == FAILURES_MAX {
            resume_unwind(cause);
        }
        if busy && begin.elapsed() >= patience {
            return false;
        }
    }
    false
}

/// Threads that sleep for one millisecond at a time and count how often they wake late: as many as processors, because a
/// host may pause a single one.
struct WakeWatch {
    end: Arc<AtomicBool>,
    threads: Vec<JoinHandle<bool>>,
    spent: Option<ProcessorTime>,
}

/// Time of all processors since the machine started, in kernel ticks.
#[derive(Clone, Copy, Debug)]
struct ProcessorTime {
    idle: f64,
    stolen: f64,
    all: f64,
}

/// Returns the processor times; `None` if the kernel does not report them.
fn spent() -> Option<ProcessorTime> {
    let text = std::fs::read_to_string("/proc/stat").ok()?;
    let times = text.lines().next()?.strip_prefix("cpu ")?.split_whitespace().take(8);
    let times: Vec<f64> = times.map_while(|field| field.parse().ok()).collect();
    // user, nice, system, idle, iowait, irq, softirq, steal
    Some(ProcessorTime { idle: times.get(3)? + times.get(4)?, stolen: *times.get(7)?, all: times.iter().sum() })
}

impl WakeWatch {
    fn start() -> Self {
        let end = Arc::new(AtomicBool::new(false));
        let processors = available_parallelism().map_or(1, NonZero::get);
        let watch = |_| {
            let ends = Arc::clone(&end);
            spawn(move || wakes_late(&ends))
        };
        let threads = (0..processors).map(watch).collect();
        Self { end, threads, spent: spent() }
    }

    fn was_busy(self) -> bool {
        self.end.store(true, Relaxed);
        let late = self.threads.into_iter().any(|thread| thread.join().unwrap_or(true));
        late || self.spent.zip(spent()).is_some_and(|(before, now)| is_full(before, now))
    }
}

/// Naps until `end`; returns whether it woke late too often or far too late.
fn wakes_late(end: &AtomicBool) -> bool {
    let mut naps = 0_u32;
    let mut late = 0_u32;
    let mut longest = Duration::ZERO;
    while !end.load(Relaxed) {
        let begin = Instant::now();
        sleep(NAP);
        let over = begin.elapsed().saturating_sub(NAP);
        naps += 1;
        late += u32::from(over > LATE);
        longest = longest.max(over);
    }
    longest > PAUSE || late * 100 > naps
}

fn is_full(before: ProcessorTime, now: ProcessorTime) -> bool {
    let all = now.all - before.all;
    now.idle - before.idle < IDLE_FRACTION * all || now.stolen - before.stolen > STOLEN_FRACTION * all
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Returns the number of attempts for a test that fails until attempt `good`, and whether it was judged; `None` if
    /// it failed.
    fn attempts(good: usize, busy: bool, patience: Duration) -> Option<(usize, bool)> {
        let made = Cell::new(0);
        let test = || {
            made.set(made.get() + 1);
            assert!(made.get() >= good, "attempt {}", made.get());
        };
        let judged = catch_unwind(AssertUnwindSafe(|| judged_on(test, || move || busy, patience))).ok()?;
        Some((made.get(), judged))
    }

    #[test]
    fn processors_that_never_rest_or_are_taken_away_are_full() {
        let before = ProcessorTime { idle: 100.0, stolen: 50.0, all: 1000.0 };
        let after =
            |idle, stolen| is_full(before, ProcessorTime { idle: 100.0 + idle, stolen: 50.0 + stolen, all: 1200.0 });
        assert!(after(5.0, 0.0) && !after(50.0, 0.0));
        assert!(after(50.0, 10.0) && !after(50.0, 4.0), "taken by the host");
        let machine = spent();
        assert!(machine.is_none_or(|now| now.idle >= 0.0 && now.all > now.idle + now.stolen), "{machine:?}");
    }

    #[test]
    fn an_attempt_that_was_held_up_is_no_failure() {
        let made = Cell::new(0);
        let held_up = || {
            made.set(made.get() + 1);
            too_busy();
        };
        assert!(!judged_on(held_up, || || false, PATIENCE));
        assert_eq!(made.get(), ATTEMPTS);
    }

    #[test]
    fn two_failures_on_a_quiet_machine_fail_and_none_on_a_busy_one_does() {
        let on_quiet = |patience| [1, 2, 3].map(|good| attempts(good, false, patience));
        assert_eq!(on_quiet(PATIENCE), [Some((1, true)), Some((2, true)), None]);
        assert_eq!(on_quiet(Duration::ZERO), on_quiet(PATIENCE), "a failure on a quiet machine is never put off");
        let on_busy = |patience| [1, 3, 9].map(|good| attempts(good, true, patience));
        assert_eq!(on_busy(PATIENCE), [Some((1, true)), Some((3, true)), Some((ATTEMPTS, false))]);
        assert_eq!(on_busy(Duration::ZERO), [Some((1, true)), Some((1, false)), Some((1, false))]);
    }
}
