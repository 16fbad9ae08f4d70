//! The running sensor: reads frames, returns checked readings, and reports why readings are missing.

use nalgebra::Vector3;
use nima_core::frames::Wrench;

use super::{
    BotaSettings,
    clock::{BotaClock, BotaClockStep},
    codec::{BotaFrame, STATUS_BITS},
    link::BotaLink,
    opening::{self, OpenSensor},
    session::BotaTimeouts,
};
use crate::{
    ConnectionState, Device, DeviceError, DeviceIdentity, ForceReading, ForceStatus, Health, Loss, TimedReading,
};

/// The sensor is lost if nothing usable has arrived for this time, s, at rates that give at least five readings in it;
/// 2 ms remain of the 20 ms after which the loop removes the force, so that the sensor is named as the cause.
const SILENCE_S: f64 = 0.018;
/// At lower rates it is lost after this many periods, because a sensor at a low rate would otherwise be lost between
/// two readings.
const SILENCE_READINGS: f64 = 5.0;
/// Maximum force, N, larger than the range of any sensor of the family: a larger number is not a force.
const FORCE_MAX_N: f64 = 1e5;
/// Maximum torque, Nm, larger than the range of any sensor of the family.
const TORQUE_MAX_NM: f64 = 1e4;

/// Translates the status bits of the protocol.
pub const fn status_of(status: u16) -> ForceStatus {
    ForceStatus {
        throttled: status & 1 != 0,
        overrange: status & 2 != 0,
        invalid: status & 4 != 0,
        raw: status & 8 != 0,
    }
}

pub fn reading_of(frame: &BotaFrame) -> ForceReading {
    let vector = |values: [f32; 3]| Vector3::from(values.map(f64::from));
    ForceReading {
        wrench: Wrench { force_n: vector(frame.force_n), torque_nm: vector(frame.torque_nm) },
        acceleration_m_s2: frame.inertial.map(|inertial| vector(inertial.acceleration_m_s2)),
        angular_velocity_rad_s: frame.inertial.map(|inertial| vector(inertial.angular_velocity_rad_s)),
        temperature_c: f64::from(frame.temperature_c),
        status: status_of(frame.status),
    }
}

/// Returns whether all numbers are finite and within the range of such a sensor.
fn is_plausible(reading: &ForceReading) -> bool {
    let finite = |vector: Option<Vector3<f64>>| vector.is_none_or(|vector| vector.iter().all(|x| x.is_finite()));
    reading.wrench.force_n.iter().all(|x| x.abs() <= FORCE_MAX_N)
        && reading.wrench.torque_nm.iter().all(|x| x.abs() <= TORQUE_MAX_NM)
        && finite(reading.acceleration_m_s2)
        && finite(reading.angular_velocity_rad_s)
        && reading.temperature_c.is_finite()
}

/// An open, measuring sensor. Dropping it stops the measurement.
///
/// Only usable readings are returned: a reading that is overrange, invalid or raw, or has impossible numbers, is
/// refused and counted; a throttled reading is returned with its flag. If nothing usable arrives for 18 ms (or five
/// periods, if that is longer) the sensor is lost; the last data received decide the cause.
pub struct BotaDriver {
    link: BotaLink,
    judge: Judge,
    identity: DeviceIdentity,
    rate_hz: f64,
    low_latency: bool,
    silence_s: f64,
    stop: &'static [u8],
    /// Whether the sensor has been polled; data that arrived before the first poll are stale.
    begun: bool,
    /// Damage and skipped bytes before the first reading, which do not count because the stream was joined in the
    /// middle of a frame.
    base: (u64, u64),
}

impl std::fmt::Debug for BotaDriver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let health = &self.judge.health;
        f.debug_struct("Driver").field("identity", &self.identity).field("health", health).finish_non_exhaustive()
    }
}

impl BotaDriver {
    /// Opens, configures and starts the sensor (blocks: 4 s for the first generation, which restarts when its port is
    /// opened).
    ///
    /// # Errors
    /// [`DeviceError`] if a setting is invalid, the sensor cannot be reached or configured, or its readings are not usable.
    pub fn open(settings: &BotaSettings) -> Result<Self, DeviceError> {
        Self::open_within(settings, BotaTimeouts::default())
    }

    /// Opens the sensor with these timeouts.
    ///
    /// # Errors
    /// The errors of [`BotaDriver::open`].
    pub fn open_within(settings: &BotaSettings, timeouts: BotaTimeouts) -> Result<Self, DeviceError> {
        opening::open(settings, timeouts).map(Self::of)
    }

    pub(super) fn of(opened: OpenSensor) -> Self {
        let OpenSensor { link, identity, rate_hz, low_latency, stop } = opened;
        let judge = Judge::new(1e6 / rate_hz);
        let silence_s = SILENCE_S.max(SILENCE_READINGS / rate_hz);
        Self { link, judge, identity, rate_hz, low_latency, silence_s, stop, begun: false, base: (0, 0) }
    }

    pub const fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Returns whether the port delivers bytes without delay; if not, readings through an FTDI adapter arrive up to 16
    /// ms late and in batches.
    pub const fn has_low_latency(&self) -> bool {
        self.low_latency
    }

    /// Returns the status of the newest frame, even if it was refused.
    pub const fn status(&self) -> ForceStatus {
        status_of(self.judge.status)
    }

    pub fn close(self) {}

    /// Handles the data that have arrived; damage is counted from the first reading on.
    fn take_in(&mut self, now_s: f64) -> Result<Option<TimedReading<ForceReading>>, Loss> {
        let before = (self.link.damaged(), self.link.skipped());
        let mut newest = None;
        let judge = &mut self.judge;
        let received = self.link.receive(|frame| {
            if let Some(reading) = judge.take(&frame, now_s) {
                newest = Some(reading);
            }
        });
        let after = (self.link.damaged(), self.link.skipped());
        if self.judge.clock_runs {
            self.judge.health.damaged = after.0 - self.base.0;
            self.judge.health.skipped_bytes = after.1 - self.base.1;
        } else {
            self.base = after;
        }
        if newest.is_none() && after != before {
            self.judge.suspect = Loss::Corrupt;
        }
        received.map(|()| newest)
    }
}

impl Device for BotaDriver {
    type Reading = ForceReading;

    fn poll(&mut self, now_s: f64) -> Option<TimedReading<ForceReading>> {
        if matches!(self.judge.health.standing, ConnectionState::Lost(_)) {
            return None;
        }
        if !self.begun {
            self.begun = true;
            self.judge.usable_s = now_s;
            if let Err(loss) = self.link.discard() {
                self.judge.health.lose(loss);
                return None;
            }
            self.base = (self.link.damaged(), self.link.skipped());
        }
        match self.take_in(now_s) {
            Err(loss) => {
                self.judge.health.lose(loss);
                None
            }
            Ok(None) if now_s - self.judge.usable_s > self.silence_s => {
                self.judge.health.lose(self.judge.suspect);
                None
            }
            Ok(newest) => newest,
        }
    }

    fn about(&self) -> (&Health, &DeviceIdentity) {
        (&self.judge.health, &self.identity)
    }
}

impl Drop for BotaDriver {
    fn drop(&mut self) {
        // If a connection is closed with unread data, the operating system may discard this last command.
        if self.link.discard().is_ok() {
            self.link.send(self.stop).ok();
        }
    }
}

#[derive(Debug)]
struct Judge {
    clock: BotaClock,
    clock_runs: bool,
    health: Health,
    status: u16,
    /// Arrival time of the newest usable reading, s.
    usable_s: f64,
    /// The cause to report if no usable data arrive any more.
    suspect: Loss,
}

impl Judge {
    fn new(period_us: f64) -> Self {
        let health = Health::opening();
        Self {
            clock: BotaClock::new(period_us),
            clock_runs: false,
            health,
            status: 0,
            usable_s: 0.0,
            suspect: Loss::Silent,
        }
    }

    fn take(&mut self, frame: &BotaFrame, now_s: f64) -> Option<TimedReading<ForceReading>> {
        self.clock_runs = true;
        self.status = frame.status;
        let device_s = match self.clock.step(frame.timestamp_us) {
            BotaClockStep::Newer { device_s, missing } => {
                self.health.lost += missing;
                device_s
            }
            BotaClockStep::Late => {
                self.health.lost = self.health.lost.saturating_sub(1);
                return self.stale();
            }
            BotaClockStep::Stale => return self.stale(),
        };
        let reading = reading_of(frame);
        if !reading.status.is_usable() {
            return self.refuse(Loss::Device { code: u32::from(frame.status & STATUS_BITS) });
        }
        if !is_plausible(&reading) {
            return self.refuse(Loss::Implausible);
        }
        self.health.accept(now_s);
        self.usable_s = now_s;
        self.suspect = Loss::Silent;
        Some(TimedReading { device_s: Some(device_s), arrival_s: now_s, value: reading })
    }

    /// Handles a clock that is stopped or goes back, which must not happen.
    const fn stale(&mut self) -> Option<TimedReading<ForceReading>> {
        self.health.out_of_order += 1;
        self.suspect = Loss::Implausible;
        None
    }

    const fn refuse(&mut self, loss: Loss) -> Option<TimedReading<ForceReading>> {
        self.health.refused += 1;
        self.suspect = loss;
        None
    }
}

#[cfg(test)]
#[path = "driver_tests.rs"]
mod tests;
