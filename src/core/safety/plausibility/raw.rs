//! Raw readings of the devices, each in its device's own frame and units, before any rotation or calibration.
//!
//! A rotation of the arm changes every component of a force in the workspace, even for a sensor that has stopped
//! measuring. The plausibility check therefore judges these readings, only new ones, at the times of the device.

/// Numbers of a haptic handle: position, m.
pub const HANDLE_CHANNELS: usize = 3;
/// Numbers of an arm: joint angles, rad.
pub const ARM_CHANNELS: usize = 7;
/// Numbers of a force sensor: force (N), torque (Nm), acceleration (m/s^2).
pub const CHANNELS: usize = 9;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawReading<const N: usize> {
    /// The numbers of the reading; NaN for a number that the device lacks.
    pub channels: [f64; N],
    /// Time on the device's own clock, s; `None` if it sends no time.
    pub device_s: Option<f64>,
    /// Time of arrival, s on the loop's clock. Two readings with the same time are one reading.
    pub arrival_s: f64,
}

/// The newest readings of one side; `None` for a device at another machine or a missing device.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RawReadings {
    pub handle: Option<RawReading<HANDLE_CHANNELS>>,
    pub arm: Option<RawReading<ARM_CHANNELS>>,
    pub sensor: Option<RawReading<CHANNELS>>,
}

impl RawReadings {
    pub const NONE: Self = Self { handle: None, arm: None, sensor: None };

    /// Returns whether every number that a device must have is finite; a force sensor may lack some.
    pub fn is_finite(&self) -> bool {
        self.handle.is_none_or(|raw| raw.is_finite())
            // A force sensor without torque or accelerometer has NaN there on purpose, so only its time is checked.
            && self.arm.is_none_or(|raw| raw.is_finite())
            && self.sensor.is_none_or(|raw| raw.arrival_s.is_finite())
    }
}

impl<const N: usize> RawReading<N> {
    fn is_finite(&self) -> bool {
        self.arrival_s.is_finite() && self.channels.iter().all(|number| number.is_finite())
    }
}

impl RawReading<CHANNELS> {
    /// Creates a force sensor's reading from its parts: force (N), torque (Nm), acceleration (m/s^2).
    pub fn of_sensor(parts: [Option<[f64; 3]>; 3], device_s: Option<f64>, arrival_s: f64) -> Self {
        let mut channels = [f64::NAN; CHANNELS];
        for (to, part) in channels.chunks_exact_mut(3).zip(parts) {
            to.copy_from_slice(&part.unwrap_or([f64::NAN; 3]));
        }
        Self { channels, device_s, arrival_s }
    }
}

/// Number of readings over which the usual interval is averaged.
/// 16 intervals: 16 ms at 1 kHz, long enough to average one late poll, short enough to follow a changed rate.
const AVERAGED: f64 = 16.0;
/// A longer interval counts as this many nominal ones: the loop was late and missed the readings in between.
const LONGEST_INTERVALS: f64 = 2.0;
/// A device's clock may be ahead of the arrivals by this time, s, because connections delay readings by less.
const HELD_BACK_S: f64 = 0.02;
/// If the time of a reading is earlier than the previous one by less than this, it arrived out of order, s; if a clock
/// was set back, the difference is larger.
const SWAPPED_S: f64 = 1.0;

#[derive(Clone, Copy, Debug)]
pub(super) struct RawStep {
    /// Sum of the intervals so far, s; each counts for at most [`LONGEST_INTERVALS`] nominal intervals.
    pub(super) t_s: f64,
    /// Time for which the device may have moved since the previous reading, s.
    pub(super) moved_s: f64,
}

/// Distinguishes new readings from old ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct RawPace {
    last: Option<(f64, Option<f64>)>,
    interval_s: f64,
    t_s: f64,
}

/// Result of checking a device for a new reading.
#[derive(Clone, Copy, Debug)]
pub(super) enum RawOutcome {
    /// The same reading as before, or a reading without a time.
    Old,
    /// The first reading, or the first after the clock was set back.
    First,
    New(RawStep),
}

impl RawPace {
    pub(super) const NEW: Self = Self { last: None, interval_s: 0.0, t_s: 0.0 };

    pub(super) fn look<const N: usize>(&mut self, raw: &RawReading<N>) -> RawOutcome {
        let now = (raw.arrival_s, raw.device_s);
        let Some((arrival_s, device_s)) = self.last else {
            self.last = Some(now).filter(|_| raw.arrival_s.is_finite());
            return self.last.map_or(RawOutcome::Old, |_| RawOutcome::First);
        };
        // The loop polls faster than some devices send: the same time is the same reading.
        let arrived_s = raw.arrival_s - arrival_s;
        if arrived_s.is_nan() || arrived_s == 0.0 {
            return RawOutcome::Old;
        }
        if arrived_s < 0.0 && arrived_s > -SWAPPED_S {
            return RawOutcome::Old;
        }
        self.last = Some(now);
        if arrived_s < 0.0 {
            self.interval_s = 0.0;
            self.t_s = 0.0;
            return RawOutcome::First;
        }
        // The device's own clock may show a longer interval than the arrivals, when several readings arrived
        // together.
        let reported_s = raw.device_s.zip(device_s).map_or(0.0, |(now_s, before_s)| now_s - before_s);
        let moved_s = arrived_s.max(reported_s.min(arrived_s + HELD_BACK_S));
        // The first interval has no predecessor, so it is its own average.
        let usual_s = if self.interval_s > 0.0 { self.interval_s } else { arrived_s };
        let counted_s = arrived_s.min(LONGEST_INTERVALS * usual_s);
        self.interval_s = usual_s + (counted_s - usual_s) / AVERAGED;
        self.t_s += counted_s;
        RawOutcome::New(RawStep { t_s: self.t_s, moved_s })
    }
}
