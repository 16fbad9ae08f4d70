//! The thread that owns a device. Every call of the SDK waits for USB, which the real-time loop must not do.
//!
//! In each cycle it applies the newest force command, reads and reports; a cycle begins with the loop's next command. A
//! command is valid for [`COMMAND_AGE_MAX`]; after that the force is zero until the next one, so a hanging loop cannot
//! leave a force applied. If this thread hangs, the device's watchdog switches the force off. Force is switched on only
//! by command. However the thread ends (stopped, device lost, panic, end of the program), the brakes of the device are
//! on afterwards.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::park_timeout,
    time::{Duration, Instant},
};

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use rtrb::{Consumer, Producer};

use super::{
    Counters, HandleEvent, IdleMode,
    sdk::{OpenDevice, is_ending},
    status::{ForceDimensionStatus, ForceOffCause, SdkError, Success},
};
use crate::{HandleReading, Loss};

/// A force command older than this is not applied.
pub(super) const COMMAND_AGE_MAX: Duration = Duration::from_millis(10);
/// Time without a new reading after which the device is lost. The remaining time to the specified 20 ms is for the
/// report to reach the loop.
const SILENCE_MAX: Duration = Duration::from_millis(14);
/// Number of consecutive impossible readings after which the device is lost, so that a single one does no harm.
const IMPLAUSIBLE_MAX: u32 = 10;
/// If the force is not on this long after the request, the device has refused it.
const ENABLE_MAX: Duration = Duration::from_millis(50);
/// The status is read once in this many cycles, because it costs a call to the library, and none of its values changes
/// within a millisecond.
const STATUS_EVERY: u64 = 4;
/// Maximum plausible distance of a handle from its base, m; the workspace of an omega.7 is 160 mm wide (manufacturer's
/// data sheet).
const POSITION_MAX_M: f64 = 1.0;
/// Maximum plausible deviation of a rotation matrix from an orthonormal one: the SDK calculates with 64-bit numbers, so
/// that a larger deviation is not rounding.
const FRAME_TOLERANCE: f64 = 1e-3;

/// A force for the hand, N.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceCommand {
    pub(super) force_n: [f64; 3],
    pub(super) gripper_n: f64,
    pub(super) given: Instant,
}

/// The thread's report to the loop, once per cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct WorkerReport {
    pub(super) cycle: u64,
    pub(super) reading: Option<HandleReading>,
    pub(super) status: ForceDimensionStatus,
    pub(super) counters: Counters,
    pub(super) loss: Option<Loss>,
    /// The loss to report if calls continue to fail.
    pub(super) failing: Option<Loss>,
}

#[derive(Debug, Default)]
pub(super) struct WorkerShared {
    pub(super) force_wanted: AtomicBool,
    pub(super) stop: AtomicBool,
}

pub(super) struct QueueEnds {
    pub(super) reports: Producer<WorkerReport>,
    pub(super) events: Producer<HandleEvent>,
    pub(super) commands: Consumer<ForceCommand>,
    pub(super) shared: Arc<WorkerShared>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum WorkerDrive {
    Off,
    /// Requested, but not yet confirmed by the status.
    Asked(Instant),
    On,
}

pub(super) struct ForceDimensionWorker {
    device: OpenDevice,
    ends: QueueEnds,
    left_handed: bool,
    idle: IdleMode,
    period: Duration,
    /// Whether the loop's force started this cycle.
    is_led: bool,
    drive: WorkerDrive,
    command: Option<ForceCommand>,
    status: ForceDimensionStatus,
    counters: Counters,
    cycle: u64,
    last: Option<HandleReading>,
    fresh_at: Instant,
    failure: Option<SdkError>,
    implausible: u32,
    loss: Option<Loss>,
}

impl ForceDimensionWorker {
    pub(super) fn new(
        device: OpenDevice,
        ends: QueueEnds,
        left_handed: bool,
        idle: IdleMode,
        period: Duration,
    ) -> Self {
        Self {
            device,
            ends,
            left_handed,
            idle,
            period,
            is_led: false,
            drive: WorkerDrive::Off,
            command: None,
            status: ForceDimensionStatus::default(),
            counters: Counters::default(),
            cycle: 0,
            last: None,
            fresh_at: Instant::now(),
            failure: None,
            implausible: 0,
            loss: None,
        }
    }

    /// Runs until it is stopped or the device is lost.
    pub(super) fn run(mut self) {
        self.rest();
        let mut begin = Instant::now();
        self.fresh_at = begin;
        while self.loss.is_none() && !self.ends.shared.stop.load(Ordering::Acquire) && !is_ending() {
            self.step();
            begin = self.wait(begin);
        }
        // A full queue must not hide the loss of the device.
        while self.loss.is_some() && !self.ends.shared.stop.load(Ordering::Acquire) && !is_ending() {
            if self.ends.reports.push(self.report(None)).is_ok() || self.ends.reports.is_abandoned() {
                return;
            }
            std::thread::sleep(self.period);
        }
    }

    /// Waits for the loop's next force, which starts the next cycle: the force does not wait for a period of this
    /// thread, and the reading that follows is available when the loop reads again. Without a force a cycle takes a
    /// period. Returns the time at which the next cycle was due.
    fn wait(&mut self, begin: Instant) -> Instant {
        // The loop sends once per period, with some jitter, so accept a force from half a period on.
        let earliest = begin + self.period / 2;
        let mut latest = begin + self.period;
        if self.is_led {
            latest += self.period / 2;
        }
        let mut now = Instant::now();
        if now >= latest {
            // Missed periods are skipped; the cycles are not caught up.
            self.counters.late_cycles += 1;
            return now;
        }
        loop {
            self.is_led = !self.ends.commands.is_empty();
            match (self.is_led, now) {
                (true, now) if now >= earliest => return now,
                (false, now) if now >= latest => return latest,
                // Woken by `ForceDimensionDriver::set_force`.
                (is_led, now) => park_timeout(if is_led { earliest } else { latest } - now),
            }
            now = Instant::now();
        }
    }

    fn step(&mut self) {
        self.cycle += 1;
        // After a failed reading, retry the reading at once, because other calls would only fail in the same way.
        if self.failure.is_none() {
            if self.cycle % STATUS_EVERY == 1 {
                self.read_status();
            }
            self.drive();
        }
        let reading = self.read();
        self.judge_silence();
        // The loop counts missing reports by the cycle numbers.
        self.ends.reports.push(self.report(reading)).ok();
    }

    const fn report(&self, reading: Option<HandleReading>) -> WorkerReport {
        let cycle = self.cycle;
        let status = self.status;
        let counters = self.counters;
        let failing = match self.failure {
            Some(error) => Some(error.loss()),
            None => None,
        };
        WorkerReport { cycle, reading, status, counters, loss: self.loss, failing }
    }

    fn fail(&mut self, error: SdkError) {
        let calls = if error == SdkError::TIMED_OUT {
            &mut self.counters.timed_out_calls
        } else {
            &mut self.counters.failed_calls
        };
        *calls += 1;
        self.failure = Some(error);
        if error.is_final() {
            self.loss.get_or_insert(error.loss());
        }
    }

    /// Returns a new reading; `None` if there is none, or if it is impossible.
    fn read(&mut self) -> Option<HandleReading> {
        let read = self.device.pose().and_then(|pose| Ok((pose, self.device.gripper_rad()?)));
        let ((pose, success), gripper_rad) = match read {
            Ok(read) => read,
            Err(error) => {
                self.fail(error);
                return None;
            }
        };
        self.failure = None;
        // The velocity is missing until two positions were read within its averaging window; that is not a fault.
        let velocity = self.device.velocity_m_s().ok();
        // Left-handed devices use the opposite sign.
        let gripper_rad = if self.left_handed { gripper_rad.abs() } else { gripper_rad };
        let Some(reading) = plausible(pose, gripper_rad, velocity, self.device.buttons()) else {
            self.counters.implausible += 1;
            self.implausible += 1;
            if self.implausible >= IMPLAUSIBLE_MAX {
                self.loss.get_or_insert(Loss::Implausible);
            }
            return None;
        };
        self.implausible = 0;
        // The SDK's time guard repeats the last data: the reading is new only if it differs.
        if success == Success::TimeGuard && self.last.is_some_and(|last| same_place(&last, &reading)) {
            self.counters.time_guarded += 1;
            return None;
        }
        self.fresh_at = Instant::now();
        self.last = Some(reading);
        Some(reading)
    }

    fn judge_silence(&mut self) {
        if self.fresh_at.elapsed() > SILENCE_MAX && self.implausible == 0 {
            self.loss.get_or_insert(self.failure.map_or(Loss::Silent, SdkError::loss));
        }
    }

    fn read_status(&mut self) {
        match self.device.status() {
            Ok(status) => {
                self.status = status;
                self.loss = self.loss.or(status.loss());
            }
            Err(error) => return self.fail(error),
        }
        match self.drive {
            WorkerDrive::Asked(_) if self.status.force => {
                self.drive = WorkerDrive::On;
                self.send_event(HandleEvent::ForceOn);
            }
            WorkerDrive::Asked(since) if since.elapsed() > ENABLE_MAX => {
                self.give_up(HandleEvent::ForceRefused { cause: self.status.force_off });
            }
            WorkerDrive::On if !self.status.force => {
                self.give_up(HandleEvent::ForceOff { cause: self.status.force_off });
            }
            _ => {}
        }
    }

    /// Handles a force that the device has switched off: it stays off until the loop requests it again.
    fn give_up(&mut self, event: HandleEvent) {
        self.ends.shared.force_wanted.store(false, Ordering::Release);
        self.counters.force_cut += 1;
        self.send_event(event);
        self.rest();
    }

    fn send_event(&mut self, event: HandleEvent) {
        // If the events are not read, the status still shows the loss.
        self.ends.events.push(event).ok();
    }

    /// Removes the force: brakes on, or a free handle.
    fn rest(&mut self) {
        self.drive = WorkerDrive::Off;
        self.command = None;
        let rested = match self.idle {
            IdleMode::Brake => self.device.stop(),
            IdleMode::Free => self.device.stop().and_then(|_| self.device.set_brakes(false)),
        };
        if let Err(error) = rested {
            self.fail(error);
        }
    }

    /// Follows the loop's request for force, and applies the newest command.
    fn drive(&mut self) {
        // At most as many as the queue can hold.
        let commands = std::iter::from_fn(|| self.ends.commands.pop().ok());
        let newest = commands.take(super::driver::QUEUE).last();
        let wanted = self.ends.shared.force_wanted.load(Ordering::Acquire);
        match (self.drive, wanted) {
            (WorkerDrive::Off, false) => return,
            (WorkerDrive::Off, true) => {
                if let Err(error) = self.device.enable_force(true) {
                    return self.fail(error);
                }
                // Only commands sent from now on count.
                self.command = None;
                self.drive = WorkerDrive::Asked(Instant::now());
            }
            (_, false) => {
                self.rest();
                return self.send_event(HandleEvent::ForceOff { cause: ForceOffCause::Software });
            }
            (_, true) => self.command = newest.or(self.command),
        }
        let command = self.command.filter(|command| command.given.elapsed() <= COMMAND_AGE_MAX);
        if self.command.is_some() && command.is_none() {
            self.counters.stale_commands += 1;
        }
        let (force_n, gripper_n) = command.map_or(([0.0; 3], 0.0), |command| (command.force_n, command.gripper_n));
        match self.device.set_force(force_n, gripper_n) {
            Ok(Success::Saturated) => self.counters.saturated += 1,
            Ok(_) => {}
            Err(error) => self.fail(error),
        }
    }
}

fn plausible(
    (position_m, frame): super::sdk::SdkPose,
    gripper_rad: f64,
    velocity_m_s: Option<[f64; 3]>,
    buttons: u32,
) -> Option<HandleReading> {
    let position_m = Vector3::from(position_m);
    let frame = Matrix3::from_row_slice(&frame);
    // Comparisons with NaN are false.
    let placed = position_m.norm() < POSITION_MAX_M && gripper_rad.abs() < std::f64::consts::PI;
    let error = frame * frame.transpose() - Matrix3::identity();
    let turned = error.iter().all(|entry| entry.abs() < FRAME_TOLERANCE) && frame.determinant() > 0.0;
    if !placed || !turned {
        return None;
    }
    let orientation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(frame));
    let velocity_m_s = velocity_m_s.map(Vector3::from).filter(|velocity| velocity.iter().all(|x| x.is_finite()));
    let orientation = Some(orientation);
    let gripper_rad = Some(gripper_rad);
    Some(HandleReading { position_m, orientation, gripper_rad, velocity_m_s, buttons })
}

fn same_place(a: &HandleReading, b: &HandleReading) -> bool {
    (a.position_m, a.orientation, a.gripper_rad) == (b.position_m, b.orientation, b.gripper_rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRAIGHT: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

    #[test]
    fn impossible_numbers_make_no_reading() {
        let good = ([0.01, -0.02, 0.03], STRAIGHT);
        assert!(plausible(good, 0.2, None, 0).is_some());
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 2.0, 1e18] {
            for axis in 0..3 {
                let mut position_m = good.0;
                position_m[axis] = bad;
                assert!(plausible((position_m, STRAIGHT), 0.2, None, 0).is_none());
            }
            for entry in 0..9 {
                let mut frame = STRAIGHT;
                frame[entry] = bad;
                assert!(plausible((good.0, frame), 0.2, None, 0).is_none());
            }
        }
        assert!(plausible(good, f64::NAN, None, 0).is_none());
        let mirror = [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        assert!(plausible((good.0, mirror), 0.2, None, 0).is_none(), "a reflection is not a rotation");
        let without = plausible(good, 0.2, Some([f64::NAN, 0.0, 0.0]), 0).unwrap();
        assert!(without.velocity_m_s.is_none());
    }

    #[test]
    fn any_rotation_comes_through_as_it_is() {
        let mut random = fastrand::Rng::with_seed(7);
        for _ in 0..1000 {
            let angle = |random: &mut fastrand::Rng| (random.f64() - 0.5) * std::f64::consts::TAU;
            let turn = UnitQuaternion::from_euler_angles(angle(&mut random), angle(&mut random), angle(&mut random));
            let matrix = turn.to_rotation_matrix().matrix().transpose();
            let mut rows = [0.0; 9];
            rows.copy_from_slice(matrix.as_slice());
            let read = plausible(([0.0; 3], rows), 0.0, None, 0).and_then(|reading| reading.orientation).unwrap();
            assert!(read.angle_to(&turn) < 1e-6, "{read} instead of {turn}");
        }
    }
}
