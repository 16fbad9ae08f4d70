//! The thread that holds a device: every call into the SDK waits for USB, which the real-time loop must not.
//!
//! Each cycle it reads, applies the newest force command and reports. A command counts for [`COMMAND_AGE_MAX`]; after that the force
//! is zero until the next one, so that a loop that hangs cannot leave a force standing; a thread that hangs itself is what the
//! device's watchdog is for. Force is on only after the command for it. However the thread ends (told, lost, panic, end of
//! the program) the device is left with its brakes on.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use crossbeam_channel::{Receiver, Sender, TrySendError};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::{
    Counters, HandleEvent, IdleMode,
    sdk::{OpenDevice, is_ending},
    status::{ForceOffCause, SdkError, Status, Success},
};
use crate::{HandleReading, Loss};

/// A force command older than this is no longer applied.
pub(super) const COMMAND_AGE_MAX: Duration = Duration::from_millis(10);
/// Without a new reading for so long the device is lost. The rest of the promised 20 ms is for the way to the loop.
const SILENCE_MAX: Duration = Duration::from_millis(14);
/// Impossible readings in a row that make it lost.
const IMPLAUSIBLE_MAX: u32 = 10;
/// Force that was asked for and is not on after so long was refused by the device.
const ENABLE_MAX: Duration = Duration::from_millis(50);
/// Cycles between two readings of the status.
const STATUS_EVERY: u64 = 4;
/// No handle of this make is so far from its base, m.
const POSITION_MAX_M: f64 = 1.0;
/// How far a rotation matrix may be from orthonormal.
const FRAME_TOLERANCE: f64 = 1e-3;

/// A force for the hand, N.
#[derive(Clone, Copy, Debug)]
pub(super) struct ForceCommand {
    pub(super) force_n: [f64; 3],
    pub(super) gripper_n: f64,
    pub(super) given: Instant,
}

/// What the thread tells the loop, once a cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Report {
    /// Number of the cycle.
    pub(super) cycle: u64,
    pub(super) reading: Option<HandleReading>,
    pub(super) status: Status,
    pub(super) counters: Counters,
    pub(super) loss: Option<Loss>,
    /// What it will be lost to if calls go on failing as the last one.
    pub(super) failing: Option<Loss>,
}

/// What both threads share.
#[derive(Debug, Default)]
pub(super) struct Shared {
    /// The loop wants force.
    pub(super) force_wanted: AtomicBool,
    /// The driver is being dropped.
    pub(super) stop: AtomicBool,
}

/// Ends of the queues on the thread's side.
pub(super) struct Ends {
    pub(super) reports: Sender<Report>,
    pub(super) events: Sender<HandleEvent>,
    pub(super) commands: Receiver<ForceCommand>,
    pub(super) shared: Arc<Shared>,
}

/// Whether force is on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drive {
    Off,
    /// Asked for, not yet seen in the status.
    Asked(Instant),
    On,
}

/// The thread's work.
pub(super) struct Worker {
    device: OpenDevice,
    ends: Ends,
    left_handed: bool,
    idle: IdleMode,
    period: Duration,
    drive: Drive,
    command: Option<ForceCommand>,
    status: Status,
    counters: Counters,
    cycle: u64,
    last: Option<HandleReading>,
    fresh_at: Instant,
    failure: Option<SdkError>,
    implausible: u32,
    loss: Option<Loss>,
}

impl Worker {
    pub(super) fn new(device: OpenDevice, ends: Ends, left_handed: bool, idle: IdleMode, period: Duration) -> Self {
        Self {
            device,
            ends,
            left_handed,
            idle,
            period,
            drive: Drive::Off,
            command: None,
            status: Status::default(),
            counters: Counters::default(),
            cycle: 0,
            last: None,
            fresh_at: Instant::now(),
            failure: None,
            implausible: 0,
            loss: None,
        }
    }

    /// Works until it is told to stop or the device is lost.
    pub(super) fn run(mut self) {
        self.rest();
        let mut deadline = Instant::now();
        self.fresh_at = deadline;
        while self.loss.is_none() && !self.ends.shared.stop.load(Ordering::Acquire) && !is_ending() {
            self.step();
            deadline += self.period;
            let now = Instant::now();
            if deadline > now {
                std::thread::sleep(deadline - now);
            } else {
                // Periods that passed are skipped, never caught up.
                self.counters.late_cycles += 1;
                deadline = now;
            }
        }
        // A full queue must not hide a loss.
        while self.loss.is_some() && !self.ends.shared.stop.load(Ordering::Acquire) && !is_ending() {
            match self.ends.reports.try_send(self.report(None)) {
                Err(TrySendError::Full(_)) => std::thread::sleep(self.period),
                _ => return,
            }
        }
    }

    fn step(&mut self) {
        self.cycle += 1;
        let reading = self.read();
        // After a reading that failed the next one is tried at once: more calls would only wait for the same trouble.
        if self.failure.is_none() {
            if self.cycle % STATUS_EVERY == 1 {
                self.read_status();
            }
            self.drive();
        }
        self.judge_silence();
        if self.ends.reports.try_send(self.report(reading)).is_err() {
            // Counted by the loop from the numbers of the cycles.
        }
    }

    const fn report(&self, reading: Option<HandleReading>) -> Report {
        let (cycle, status, counters) = (self.cycle, self.status, self.counters);
        let failing = match self.failure {
            Some(error) => Some(error.loss()),
            None => None,
        };
        Report { cycle, reading, status, counters, loss: self.loss, failing }
    }

    fn fail(&mut self, error: SdkError) {
        self.counters.failed_calls += 1;
        self.failure = Some(error);
        if error.is_final() {
            self.loss.get_or_insert(error.loss());
        }
    }

    /// A new reading; `None` when there is none, or an impossible one.
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
        // Until two positions were read within its window there is no velocity, which is no fault.
        let velocity = self.device.velocity_m_s().ok();
        // The sign on left-handed devices is the other one.
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
        // The time guard gives the last data again: new only if they differ.
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
            Drive::Asked(_) if self.status.force => {
                self.drive = Drive::On;
                self.tell(HandleEvent::ForceOn);
            }
            Drive::Asked(since) if since.elapsed() > ENABLE_MAX => {
                self.give_up(HandleEvent::ForceRefused { cause: self.status.force_off });
            }
            Drive::On if !self.status.force => {
                self.give_up(HandleEvent::ForceOff { cause: self.status.force_off });
            }
            _ => {}
        }
    }

    /// The device took force away: it stays off until the loop asks again.
    fn give_up(&mut self, event: HandleEvent) {
        self.ends.shared.force_wanted.store(false, Ordering::Release);
        self.counters.force_cut += 1;
        self.tell(event);
        self.rest();
    }

    fn tell(&self, event: HandleEvent) {
        // With nobody listening the status still tells it.
        self.ends.events.try_send(event).ok();
    }

    /// No force: brakes, or a free handle.
    fn rest(&mut self) {
        self.drive = Drive::Off;
        self.command = None;
        let rested = match self.idle {
            IdleMode::Brake => self.device.stop(),
            IdleMode::Free => self.device.stop().and_then(|_| self.device.set_brakes(false)),
        };
        if let Err(error) = rested {
            self.fail(error);
        }
    }

    /// Follows what the loop wants, and applies the newest command.
    fn drive(&mut self) {
        // As many as the queue holds at most.
        let newest = self.ends.commands.try_iter().take(super::driver::QUEUE).last();
        let wanted = self.ends.shared.force_wanted.load(Ordering::Acquire);
        match (self.drive, wanted) {
            (Drive::Off, false) => return,
            (Drive::Off, true) => {
                if let Err(error) = self.device.enable_force(true) {
                    return self.fail(error);
                }
                // Only what is asked for from now on counts.
                self.command = None;
                self.drive = Drive::Asked(Instant::now());
            }
            (_, false) => {
                self.rest();
                return self.tell(HandleEvent::ForceOff { cause: ForceOffCause::Software });
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

/// A reading, if its numbers are possible.
fn plausible(
    (position_m, frame): super::sdk::Pose,
    gripper_rad: f64,
    velocity_m_s: Option<[f64; 3]>,
    buttons: u32,
) -> Option<HandleReading> {
    let position_m = Vector3::from(position_m);
    let frame = Matrix3::from_row_slice(&frame);
    // Comparisons with a number that is not finite are false.
    let placed = position_m.norm() < POSITION_MAX_M && gripper_rad.abs() < std::f64::consts::PI;
    let error = frame * frame.transpose() - Matrix3::identity();
    let turned = error.iter().all(|entry| entry.abs() < FRAME_TOLERANCE) && frame.determinant() > 0.0;
    if !placed || !turned {
        return None;
    }
    let orientation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(frame));
    let velocity_m_s = velocity_m_s.map(Vector3::from).filter(|velocity| velocity.iter().all(|x| x.is_finite()));
    let (orientation, gripper_rad) = (Some(orientation), Some(gripper_rad));
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
        assert!(plausible((good.0, mirror), 0.2, None, 0).is_none(), "a reflection is no rotation");
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
