//! Real-time scheduling, memory locking and sleeping until a deadline: the only system calls of this crate.
#![cfg_attr(
    target_os = "linux",
    expect(unsafe_code, reason = "memory locking, absolute sleep and processor time have no safe interface in std")
)]

#[cfg(target_os = "linux")]
use std::time::Duration;
use std::time::{SystemTime, UNIX_EPOCH};

#[cfg(target_os = "linux")]
use thread_priority::{
    DeadlineFlags, RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
    set_thread_priority_and_policy,
};

use crate::{config::SchedulingClass, messages::Scheduling};

/// Returns the processor time used so far, s: by this thread and by the whole process. Zeros if it cannot be read.
#[cfg(target_os = "linux")]
pub(super) fn cpu_s() -> [f64; 2] {
    [libc::CLOCK_THREAD_CPUTIME_ID, libc::CLOCK_PROCESS_CPUTIME_ID].map(|clock| {
        let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        // SAFETY: a plain system call; `time` is valid for writing.
        let report = unsafe { libc::clock_gettime(clock, &raw mut time) } == 0;
        if report { time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9 } else { 0.0 }
    })
}

/// Returns the processor time used so far, s: by this thread and by the whole process. Zeros if it cannot be read.
#[cfg(not(target_os = "linux"))]
pub(super) fn cpu_s() -> [f64; 2] {
    [0.0; 2]
}

/// Priority of the loop: above ordinary audio (70), below the kernel's own threads (99).
const PRIORITY: u8 = 80;
/// Bytes of stack touched in advance, so that no page fault occurs in a tick.
const STACK_TOUCHED: usize = 128 * 1024;

/// Requests scheduling and locked memory for the calling thread. A refusal is reported in the result and is not an
/// error.
pub(super) fn prepare_thread(class: SchedulingClass, period_ns: u64) -> Scheduling {
    touch_stack();
    match class {
        SchedulingClass::Ordinary => Scheduling::default(),
        SchedulingClass::Fifo => granted(None),
        SchedulingClass::Deadline => granted(Some(period_ns)),
    }
}

#[inline(never)]
#[expect(clippy::large_stack_arrays, reason = "its only purpose is to touch the stack")]
fn touch_stack() {
    let mut stack = [0_u8; STACK_TOUCHED];
    for page in stack.chunks_mut(4096) {
        page[0] = 1;
    }
    std::hint::black_box(&stack);
}

/// Gives the calling thread (the supervisor) a priority above the loop's, if the system permits it.
pub(super) fn prepare_supervisor() {
    raised(PRIORITY + 5);
}

/// Requests `SCHED_FIFO` with this priority for the calling thread. Returns whether it was granted.
#[cfg(target_os = "linux")]
fn raised(priority: u8) -> bool {
    let fifo = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    ThreadPriorityValue::try_from(priority).map(ThreadPriority::Crossplatform).is_ok_and(|priority| {
        set_thread_priority_and_policy(thread_priority::thread_native_id(), priority, fifo).is_ok()
    })
}

/// Requests the highest priority that the system gives to ordinary programs. Returns whether it was granted.
#[cfg(not(target_os = "linux"))]
fn raised(_: u8) -> bool {
    thread_priority::ThreadPriority::Max.set_for_current().is_ok()
}

/// Fraction of the period that `SCHED_DEADLINE` lets the loop use before the kernel suspends it until the next period.
#[cfg(target_os = "linux")]
const BUDGET: f64 = 0.8;

/// The calling thread, for `sched_setattr(2)`. The library passes its argument to the kernel unchanged, and the kernel
/// expects a thread number here, not a handle of the C library.
#[cfg(target_os = "linux")]
const THIS_THREAD: thread_priority::ThreadId = 0;

/// Requests a time budget in every period (`SCHED_DEADLINE`). The kernel refuses if the thread may not use all
/// processors, or if their time is already reserved.
#[cfg(target_os = "linux")]
fn deadline_granted(period_ns: u64) -> bool {
    let period = Duration::from_nanos(period_ns);
    let runtime = period.mul_f64(BUDGET);
    let flags = DeadlineFlags::empty();
    let budget = ThreadPriority::Deadline { runtime, deadline: period, period, flags };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Deadline);
    set_thread_priority_and_policy(THIS_THREAD, budget, policy).is_ok()
}

/// Requests `SCHED_DEADLINE` with this budget if there is one, otherwise `SCHED_FIFO`, which is also the fallback.
#[cfg(target_os = "linux")]
fn granted(period_ns: Option<u64>) -> Scheduling {
    let deadline = period_ns.is_some_and(deadline_granted);
    let fifo = !deadline && raised(PRIORITY);
    // SAFETY: plain system calls on the calling thread with valid, initialised arguments.
    unsafe {
        libc::prctl(libc::PR_SET_TIMERSLACK, 1_usize);
        // Lock only without a limit: with a finite limit the process soon fails to map memory.
        let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
        let unlimited = libc::geteuid() == 0
            || (libc::getrlimit(libc::RLIMIT_MEMLOCK, &raw mut limit) == 0 && limit.rlim_cur == libc::RLIM_INFINITY);
        // MCL_ONFAULT locks pages when they are first touched, so memory that other threads reserve and never use is
        // not committed.
        let flags = libc::MCL_CURRENT | libc::MCL_FUTURE | libc::MCL_ONFAULT;
        Scheduling { fifo, deadline, memory_locked: unlimited && libc::mlockall(flags) == 0 }
    }
}

#[cfg(not(target_os = "linux"))]
fn granted(_: Option<u64>) -> Scheduling {
    raised(PRIORITY);
    Scheduling::default()
}

/// Returns the nanoseconds of the monotonic clock.
#[cfg(target_os = "linux")]
pub(super) fn monotonic_ns() -> u64 {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `now` is valid for the call; the monotonic clock always exists.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &raw mut now) };
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

/// Returns the nanoseconds of the monotonic clock.
#[cfg(not(target_os = "linux"))]
pub(super) fn monotonic_ns() -> u64 {
    use std::{sync::OnceLock, time::Instant};
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_nanos() as u64
}

/// Number of measurements of the difference between two clocks.
const MEASUREMENTS: usize = 5;

/// Returns the difference of the system's clock (UTC) from the monotonic clock, ns: the measurement, of several, that was
/// interrupted least. `None` if the system's clock is before 1970.
pub(super) fn utc_offset_ns() -> Option<i64> {
    let measure = |_| {
        let before_ns = monotonic_ns();
        let utc = SystemTime::now().duration_since(UNIX_EPOCH).ok()?;
        let took_ns = monotonic_ns().saturating_sub(before_ns);
        let middle_ns = i64::try_from(before_ns + took_ns / 2).ok()?;
        Some((took_ns, i64::try_from(utc.as_nanos()).ok()? - middle_ns))
    };
    (0..MEASUREMENTS).filter_map(measure).min().map(|(_, offset_ns)| offset_ns)
}

/// Sleeps until this instant of the monotonic clock, ns.
#[cfg(target_os = "linux")]
pub(super) fn sleep_until_ns(deadline_ns: u64) {
    let deadline = libc::timespec {
        tv_sec: (deadline_ns / 1_000_000_000).cast_signed(),
        tv_nsec: (deadline_ns % 1_000_000_000).cast_signed(),
    };
    // SAFETY: `deadline` is valid for the call; an early return by a signal is repeated.
    while unsafe {
        libc::clock_nanosleep(libc::CLOCK_MONOTONIC, libc::TIMER_ABSTIME, &raw const deadline, std::ptr::null_mut())
    } == libc::EINTR
    {}
}

/// Sleeps until this instant of the monotonic clock, ns.
#[cfg(not(target_os = "linux"))]
pub(super) fn sleep_until_ns(deadline_ns: u64) {
    std::thread::sleep(std::time::Duration::from_nanos(deadline_ns.saturating_sub(monotonic_ns())));
}
