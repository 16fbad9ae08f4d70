//! Driver of a Haply handle: one force out and one state back per tick.

use std::{
    io::Write,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
};

use nalgebra::Vector3;

use super::{
    codec::{HaplyDecoder, HaplyState, NextAnswer, STATE_BYTES, force_request},
    opening,
    settings::HaplySettings,
};
use crate::{
    ConnectionState, Device, DeviceError, DeviceIdentity, HandleReading, Health, Leader, Lever, Loss, TimedReading,
    transport::{ByteStream, Serial, SerialSettings},
};

/// Time without an answer after which the handle is lost, s: the limit of every device of the force path, so that no
/// force is older.
pub const SILENCE_S: f64 = 0.020;
/// An answer that has not arrived after this time counts as lost, s: five periods at 1 kHz, so that a lost answer costs
/// 5 ms and not the 20 ms of [`SILENCE_S`].
const ANSWER_MAX_S: f64 = 0.005;
/// Maximum number of unanswered requests: one in progress, and one that is late.
const OPEN_MAX: u32 = 2;
/// Number of consecutive impossible answers after which the handle is lost: 10 ms at 1 kHz, so that a single damaged
/// answer does no harm.
const BAD_MAX: u32 = 10;
/// Number of bytes skipped since the last answer after which the handle is lost: as much as [`BAD_MAX`] answers,
/// because damaged answers are skipped byte by byte.
const SKIPPED_MAX: u64 = 10 * STATE_BYTES as u64;
/// Maximum number of reads in one tick, so that a device that sends without pause cannot hold up the loop.
const READS_MAX: usize = 8;
/// A serial port on USB ignores the speed; the manufacturer's client sets none.
const BAUD: u32 = 115_200;

type HaplyWriter = Option<Box<dyn Write + Send>>;

pub struct HaplyDriver {
    line: Box<dyn ByteStream>,
    /// The same connection for the lever, which must not keep it open when the driver is closed. The loop never locks
    /// it.
    writer: Arc<Mutex<HaplyWriter>>,
    decoder: HaplyDecoder,
    centre_m: Vector3<f64>,
    force_max_n: f64,
    /// Whether force is wanted; the lever clears it from another thread.
    wanted: Arc<AtomicBool>,
    /// Whether the newest request had the force on. The device does not report its force state, so the force counts as
    /// on when the answer arrives.
    asked_on: bool,
    /// Whether the device may still apply a non-zero force to the hand.
    pushes: bool,
    reported: Option<bool>,
    /// Whether a force was sent since the last poll.
    report: bool,
    /// Number of unanswered requests, and time of the newest request, s.
    open: u32,
    asked_s: f64,
    now_s: f64,
    first_s: Option<f64>,
    bad_in_a_row: u32,
    skipped_before: u64,
    health: Health,
    identity: DeviceIdentity,
}

impl HaplyDriver {
    /// Opens the connection and identifies the device; may take half a second.
    ///
    /// # Errors
    /// [`DeviceError`] if a setting is invalid, or the port is missing, in use, not permitted, or no handle answers there.
    pub fn open(settings: &HaplySettings) -> Result<Self, DeviceError> {
        settings.check()?;
        let mut serial = Serial::open(&SerialSettings { port: settings.port.clone(), baud: BAUD })?;
        let identity = opening::meet(&mut serial, settings)?;
        let writer = serial.another_writer();
        Ok(Self::on(Box::new(serial), writer, identity, settings))
    }

    /// Opens the device over another connection, which the lever does not reach.
    ///
    /// # Errors
    /// The errors of [`open`](Self::open).
    pub fn over(mut line: Box<dyn ByteStream>, settings: &HaplySettings) -> Result<Self, DeviceError> {
        settings.check()?;
        let identity = opening::meet(&mut *line, settings)?;
        Ok(Self::on(line, None, identity, settings))
    }

    fn on(line: Box<dyn ByteStream>, writer: HaplyWriter, identity: DeviceIdentity, settings: &HaplySettings) -> Self {
        Self {
            line,
            writer: Arc::new(Mutex::new(writer)),
            decoder: HaplyDecoder::default(),
            centre_m: settings.centre_m.into(),
            force_max_n: settings.force_max_n,
            wanted: Arc::default(),
            asked_on: false,
            pushes: false,
            reported: None,
            report: false,
            open: 0,
            asked_s: 0.0,
            now_s: 0.0,
            first_s: None,
            bad_in_a_row: 0,
            skipped_before: 0,
            health: Health::opening(),
            identity,
        }
    }

    fn is_lost(&self) -> bool {
        matches!(self.health.standing, ConnectionState::Lost(_))
    }

    /// Applies a force to the hand, unless older requests are still unanswered: the device would have to catch up.
    /// Switching the force off is sent at once.
    fn ask(&mut self, force_n: Vector3<f64>) {
        let on = self.wanted.load(Ordering::Acquire);
        let force_n = if on { force_n } else { Vector3::zeros() };
        let lets_go = self.pushes && force_n == Vector3::zeros();
        if self.is_lost() || (self.open >= OPEN_MAX && !lets_go) {
            return;
        }
        self.asked_on = on;
        match self.line.send(&force_request(force_n.map(|axis| axis as f32).into())) {
            Ok(()) => {
                self.open += 1;
                self.asked_s = self.now_s;
                self.pushes = force_n != Vector3::zeros();
            }
            Err(loss) => self.lose(loss),
        }
    }

    /// Marks the handle as lost. The loop sends it no more force, but because it may still receive, its last force is
    /// set to zero.
    fn lose(&mut self, loss: Loss) {
        self.health.lose(loss);
        self.line.send(&force_request([0.0; 3])).ok();
    }

    fn reading(&self, state: &HaplyState) -> HandleReading {
        let [position_m, velocity_m_s] =
            [state.position_m, state.velocity_m_s].map(|values| Vector3::from(values).map(f64::from));
        HandleReading {
            position_m: position_m - self.centre_m,
            orientation: None,
            gripper_rad: None,
            velocity_m_s: Some(velocity_m_s),
            buttons: 0,
        }
    }

    /// Reads the data that have arrived; returns the newest state.
    fn take(&mut self) -> Option<HaplyState> {
        let mut newest = None;
        for _ in 0..READS_MAX {
            match self.line.receive(self.decoder.room()) {
                Ok(0) => break,
                Ok(count) => self.decoder.filled(count),
                Err(loss) => {
                    self.lose(loss);
                    return None;
                }
            }
            while let Some(next) = self.decoder.next() {
                self.open = self.open.saturating_sub(1);
                match next {
                    NextAnswer::State(state) => {
                        newest = Some(state);
                        self.bad_in_a_row = 0;
                        self.skipped_before = self.decoder.skipped();
                        self.health.accept(self.now_s);
                    }
                    NextAnswer::Impossible => {
                        self.health.refused += 1;
                        self.bad_in_a_row += 1;
                    }
                }
            }
        }
        newest
    }

    /// Gives up waiting for a missing answer and discards its partial data.
    fn give_up(&mut self) {
        if self.open > 0 && self.now_s - self.asked_s > ANSWER_MAX_S {
            self.health.lost += u64::from(std::mem::take(&mut self.open));
            self.health.damaged += u64::from(self.decoder.clear() > 0);
        }
        self.health.skipped_bytes = self.decoder.skipped();
    }

    fn watch(&mut self, first_s: f64) {
        let cause = if self.bad_in_a_row >= BAD_MAX {
            Loss::Implausible
        } else if self.decoder.skipped() - self.skipped_before > SKIPPED_MAX {
            Loss::Corrupt
        } else if self.now_s - self.health.newest_s.unwrap_or(first_s) > SILENCE_S {
            // Without answers few requests are sent, so the error of the last answers is the most likely cause.
            if self.bad_in_a_row > 0 {
                Loss::Implausible
            } else if self.decoder.skipped() > self.skipped_before {
                Loss::Corrupt
            } else {
                Loss::Silent
            }
        } else {
            return;
        };
        self.lose(cause);
    }
}

impl Device for HaplyDriver {
    type Reading = HandleReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<HandleReading>> {
        if self.is_lost() || !now_s.is_finite() {
            return None;
        }
        let first_s = *self.first_s.get_or_insert(now_s);
        self.now_s = now_s;
        let answers_on = self.asked_on;
        let newest = self.take();
        self.give_up();
        self.watch(first_s);
        // If the loop sets no force, the position is still requested, with zero force.
        if !std::mem::take(&mut self.report) {
            self.ask(Vector3::zeros());
        }
        if self.is_lost() {
            return None;
        }
        let state = newest?;
        self.reported = Some(answers_on);
        Some(TimedReading { device_s: None, arrival_s: now_s, value: self.reading(&state) })
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.health, &self.identity)
    }
}

impl Leader for HaplyDriver {
    fn switch_force(&mut self, on: bool) {
        self.wanted.store(on, Ordering::Release);
    }

    fn set_force(&mut self, force_n: Vector3<f64>, _gripper_n: f64) {
        let is_finite = force_n.iter().all(|axis| axis.is_finite());
        // Clamp each axis first, so that the squares of large numbers stay finite.
        let cut_n = force_n.map(|axis| if is_finite { axis.clamp(-self.force_max_n, self.force_max_n) } else { 0.0 });
        self.ask(cut_n.cap_magnitude(self.force_max_n));
        self.report = true;
    }

    fn force_change(&mut self) -> Option<bool> {
        self.reported.take()
    }

    fn attach(&self, lever: &Lever) {
        let wanted = Arc::clone(&self.wanted);
        let writer = Arc::clone(&self.writer);
        lever.attach(move || {
            wanted.store(false, Ordering::Release);
            // The loop has stopped: its last force must not persist. If the lock is held, the driver is being dropped, which
            // also removes the force.
            let Ok(mut writer) = writer.try_lock() else { return };
            if let Some(writer) = &mut *writer {
                writer.write_all(&force_request([0.0; 3])).ok();
            }
        });
    }
}

impl Drop for HaplyDriver {
    fn drop(&mut self) {
        // In any state: a handle that no longer answers may still receive commands.
        self.line.send(&force_request([0.0; 3])).ok();
        self.writer.lock().unwrap_or_else(PoisonError::into_inner).take();
    }
}
