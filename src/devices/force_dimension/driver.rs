//! Opens an omega.7 and exchanges readings and forces with it from the real-time loop.
//!
//! The loop's side neither waits nor allocates: readings, events and force commands go through wait-free queues to and
//! from the thread that owns the device ([`super::worker`]). That thread has a higher priority than the loop, so a queue
//! on which one of them spins for the other would stop both on a single processor.

use std::{
    sync::{Arc, atomic::Ordering, mpsc},
    thread::{Builder, JoinHandle},
    time::{Duration, Instant},
};

use nalgebra::Vector3;
use rtrb::{Consumer, PopError, Producer, RingBuffer};
use serde::Serialize;

use super::{
    settings::ForceDimensionSettings,
    status::{ForceDimensionKind, ForceDimensionStatus, ForceOffCause},
    worker::{ForceCommand, ForceDimensionWorker, QueueEnds, WorkerReport, WorkerShared},
};
use crate::{Device, DeviceError, DeviceIdentity, HandleReading, Health, Loss, TimedReading};

/// Time without a reading after which the device is lost, s: the limit of every device of the force path, so that no
/// force is older.
pub const SILENCE_S: f64 = 0.020;
/// Capacity of the queues of reports and commands: 32 ms at the highest rate (2 kHz), so that a late loop loses no
/// report before the device counts as lost.
pub(super) const QUEUE: usize = 64;
// Reports of the device (lost, refused): few, and the loop takes them in every tick.
const EVENTS: usize = 32;
/// Time limit for the first reading while opening.
const FIRST_READING_MAX: Duration = Duration::from_secs(1);
/// Time for which dropping waits for the thread; if the library hangs, the thread is then left running.
const JOIN_MAX: Duration = Duration::from_secs(2);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "handle")]
pub enum HandleEvent {
    ForceOn,
    /// Force is off; the cause is [`ForceOffCause::Software`] if this was requested. It stays off until it is enabled
    /// again.
    ForceOff {
        cause: ForceOffCause,
    },
    /// Force was requested and did not come on.
    ForceRefused {
        cause: ForceOffCause,
    },
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counters {
    /// Number of SDK calls that the device did not answer in time, by chance or because this computer is busy.
    pub timed_out_calls: u64,
    /// Calls of the SDK that failed for another reason.
    pub failed_calls: u64,
    /// Readings that repeated the last one (`DHD_TIMEGUARD`).
    pub time_guarded: u64,
    pub implausible: u64,
    /// Number of forces that the device reduced to the capability of its motors.
    pub saturated: u64,
    /// Cycles in which zero was applied because the newest force command was too old.
    pub stale_commands: u64,
    pub late_cycles: u64,
    /// Number of times that the device switched its force off by itself.
    pub force_cut: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceAnswer {
    Taken,
    Clamped,
    NotFinite,
    /// The queue is full because the device's thread hangs; the force ends when the last command expires, or by the
    /// watchdog.
    Full,
}

#[derive(Debug)]
pub struct ForceDimensionDriver {
    identity: DeviceIdentity,
    health: Health,
    status: ForceDimensionStatus,
    counters: Counters,
    velocity_threshold: Option<u32>,
    limits_n: (f64, f64),
    cycle: Option<u64>,
    first_poll_s: Option<f64>,
    failing: Option<Loss>,
    reports: Consumer<WorkerReport>,
    events: Consumer<HandleEvent>,
    commands: Producer<ForceCommand>,
    shared: Arc<WorkerShared>,
    thread: Option<JoinHandle<()>>,
}

/// The thread's report once it has opened the device.
struct OpeningReport {
    identity: DeviceIdentity,
    velocity_threshold: Option<u32>,
}

/// Opens a device: loads the library, opens and configures the device on the thread that will own it, and waits for the
/// first reading. Afterwards the brakes are on (or the handle is free, depending on the settings), without force.
///
/// # Errors
/// [`DeviceError`] if a setting is invalid, the library is missing or unusable, or the device is missing, in use or not
/// ready.
pub fn open(settings: &ForceDimensionSettings) -> Result<ForceDimensionDriver, DeviceError> {
    settings.check()?;
    let sdk = super::library::of(settings)?;
    let (give_reports, reports) = RingBuffer::new(QUEUE);
    let (give_events, events) = RingBuffer::new(EVENTS);
    let (commands, take_commands) = RingBuffer::new(QUEUE);
    let (answer, answered) = mpsc::sync_channel(1);
    let shared = Arc::new(WorkerShared::default());
    let ends =
        QueueEnds { reports: give_reports, events: give_events, commands: take_commands, shared: Arc::clone(&shared) };
    let of_thread = settings.clone();
    let work = move || {
        super::sdk::prepare_thread();
        match super::opening::open(sdk, &of_thread) {
            Ok(super::opening::OpenHandle { device, identity, left_handed, velocity_threshold }) => {
                let period = Duration::from_secs_f64(1.0 / of_thread.rate_hz);
                answer.send(Ok(OpeningReport { identity, velocity_threshold })).ok();
                ForceDimensionWorker::new(device, ends, left_handed, of_thread.idle, period).run();
            }
            Err(trouble) => drop(answer.send(Err(trouble))),
        }
    };
    let place = super::opening::place(settings);
    let failed = |reason: String| DeviceError::Other { place: place.clone(), reason };
    let thread = Builder::new().name("handle".to_owned()).spawn(work).map_err(|error| failed(error.to_string()))?;
    let opened = match answered.recv() {
        Ok(opened) => opened?,
        Err(_) => return Err(failed("the SDK's thread ended while opening".to_owned())),
    };
    let mut driver = ForceDimensionDriver {
        identity: opened.identity,
        health: Health::opening(),
        status: ForceDimensionStatus::default(),
        counters: Counters::default(),
        velocity_threshold: opened.velocity_threshold,
        limits_n: (settings.force_max_n, settings.gripper_max_n),
        cycle: None,
        first_poll_s: None,
        failing: None,
        reports,
        events,
        commands,
        shared,
        thread: Some(thread),
    };
    driver.wait_for_first_reading(&place)?;
    Ok(driver)
}

impl ForceDimensionDriver {
    fn wait_for_first_reading(&mut self, place: &str) -> Result<(), DeviceError> {
        let begin = Instant::now();
        while begin.elapsed() < FIRST_READING_MAX {
            match self.reports.pop() {
                Ok(WorkerReport { reading: Some(_), .. }) => return Ok(()),
                Ok(WorkerReport { loss: Some(loss), .. }) => return Err(super::opening::lost_at_once(place, loss)),
                Ok(_) => {}
                Err(PopError::Empty) if self.reports.is_abandoned() => break,
                Err(PopError::Empty) => std::thread::sleep(Duration::from_millis(1)),
            }
        }
        Err(DeviceError::Silent { place: place.to_owned() })
    }

    /// Requests force; [`HandleEvent::ForceOn`] reports when it is on. The force is zero until it is set.
    pub fn enable_force(&self) {
        self.shared.force_wanted.store(true, Ordering::Release);
    }

    /// Switches force off and brakes on (or free, depending on the settings) within a cycle.
    pub fn disable_force(&self) {
        self.shared.force_wanted.store(false, Ordering::Release);
    }

    /// For emergencies: returns a function for another thread that switches the force off and engages the brakes within
    /// one cycle of the device's thread.
    pub fn lever(&self) -> impl FnMut() + Send + 'static {
        let shared = Arc::clone(&self.shared);
        move || shared.force_wanted.store(false, Ordering::Release)
    }

    /// Returns whether force is requested; becomes false when the device switches it off.
    pub fn is_force_wanted(&self) -> bool {
        self.shared.force_wanted.load(Ordering::Acquire)
    }

    /// Sets the force on the hand and on the gripper, N, in the device's frame. Valid for 10 ms, so it must be set in
    /// every tick. Has no effect while force is off.
    pub fn set_force(&mut self, force_n: Vector3<f64>, gripper_n: f64) -> ForceAnswer {
        let (force_max_n, gripper_max_n) = self.limits_n;
        let mut answer = ForceAnswer::Taken;
        let mut force_n = force_n;
        let mut gripper_n = gripper_n;
        if !force_n.iter().chain([&gripper_n]).all(|x| x.is_finite()) {
            force_n = Vector3::zeros();
            gripper_n = 0.0;
            answer = ForceAnswer::NotFinite;
        }
        // Clamp each axis first, so that the squares of large numbers stay finite.
        let cut_n = force_n.map(|axis| axis.clamp(-force_max_n, force_max_n));
        let size_n = cut_n.norm();
        let bounded_n = if size_n > force_max_n { cut_n * (force_max_n / size_n) } else { cut_n };
        let bounded_gripper_n = gripper_n.clamp(-gripper_max_n, gripper_max_n);
        if bounded_n != force_n || bounded_gripper_n.to_bits() != gripper_n.to_bits() {
            answer = ForceAnswer::Clamped;
        }
        let command = ForceCommand { force_n: bounded_n.into(), gripper_n: bounded_gripper_n, given: Instant::now() };
        if self.commands.push(command).is_err() {
            return ForceAnswer::Full;
        }
        // `unpark` does not lock.
        if let Some(thread) = &self.thread {
            thread.thread().unpark();
        }
        answer
    }

    pub fn take_event(&mut self) -> Option<HandleEvent> {
        self.events.pop().ok()
    }

    pub const fn status(&self) -> &ForceDimensionStatus {
        &self.status
    }

    pub const fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Returns the device's velocity threshold (in its own unit), which this driver never changes; `None` if the device
    /// does not report it.
    pub const fn velocity_threshold(&self) -> Option<u32> {
        self.velocity_threshold
    }

    fn take(&mut self, report: &WorkerReport, now_s: f64) -> Option<HandleReading> {
        let missing = self.cycle.map_or(0, |last| report.cycle.saturating_sub(last + 1));
        let timed_out = report.counters.timed_out_calls - self.counters.timed_out_calls;
        self.health.lost += missing + timed_out;
        self.cycle = Some(report.cycle);
        self.status = report.status;
        self.counters = report.counters;
        self.health.damaged = report.counters.failed_calls;
        self.health.refused = report.counters.implausible;
        self.failing = report.failing;
        if let Some(loss) = report.loss {
            self.health.lose(loss);
            return None;
        }
        if report.reading.is_some() {
            self.health.accept(now_s);
        }
        report.reading
    }
}

impl Device for ForceDimensionDriver {
    type Reading = HandleReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<HandleReading>> {
        let first_s = *self.first_poll_s.get_or_insert(now_s);
        let mut newest = None;
        for _ in 0..QUEUE {
            // Read before the queue, which then has every report of a thread that has ended.
            let is_over = self.reports.is_abandoned();
            match self.reports.pop() {
                Ok(report) => newest = self.take(&report, now_s).or(newest),
                Err(PopError::Empty) if is_over => {
                    self.health.lose(Loss::Disconnected);
                    break;
                }
                Err(PopError::Empty) => break,
            }
        }
        if now_s - self.health.newest_s.unwrap_or(first_s) > SILENCE_S {
            self.health.lose(self.failing.unwrap_or(Loss::Silent));
        }
        if matches!(self.health.standing, crate::ConnectionState::Lost(_)) {
            return None;
        }
        newest.map(|value| TimedReading { device_s: None, arrival_s: now_s, value })
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.health, &self.identity)
    }
}

impl Drop for ForceDimensionDriver {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Release);
        let Some(thread) = self.thread.take() else { return };
        let begin = Instant::now();
        while !thread.is_finished() {
            if begin.elapsed() > JOIN_MAX {
                // The library hangs; by now the device's own watchdog has switched the force off.
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        thread.join().ok();
    }
}

impl DeviceIdentity {
    pub(super) fn of_handle(
        kind: ForceDimensionKind,
        name: Option<String>,
        serial: Option<u16>,
        firmware: Option<f64>,
    ) -> Self {
        Self {
            product: name.unwrap_or_else(|| kind.name()),
            serial: serial.map(|serial| serial.to_string()).unwrap_or_default(),
            firmware: firmware.map(|version| version.to_string()).unwrap_or_default(),
        }
    }
}
