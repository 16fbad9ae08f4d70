//! The test of a device: its data in about two seconds, and the findings.

use nalgebra::Vector3;
use nima_core::frames::GRAVITY_M_S2;

use super::{AGES, CHANNELS, Gauge, GaugeSpread, Gauges, Nominal, PartKind, RigPart};
use crate::config::RigConfig;

/// Number of 0.1 s blocks in a test: 2 s of measurement after the first block, whose counters are the starting values.
pub const BLOCKS: usize = 21;
/// Maximum deviation of the rate from the nominal one, as a fraction, because devices differ from their nominal rate by
/// a clock's tolerance only, and a wrong setting differs by far more. Design choice.
pub const RATE_OFF: f64 = 0.05;
/// Maximum fraction of lost readings: ten of the 2000 readings at 1 kHz. Design choice.
const LOST_MAX: f64 = 0.005;
/// Maximum fraction of damaged frames: one late call in 2 s on a busy computer is not a finding, because the device is
/// in order.
const DAMAGED_MAX: f64 = 0.001;
/// Maximum age of a reading, in periods of the device and in ticks.
/// A reading is up to one period old when the next one is due; twice that allows for one lost reading.
const AGE_PERIODS: f64 = 2.0;
// The loop polls once per tick, so a reading can be nearly one tick older than it is at the device.
const AGE_TICKS: f64 = 2.0;
/// Maximum age of a reading of a device without a nominal rate, s: half of the age that the loop accepts.
const AGE_MAX_S: f64 = 0.010;
/// Maximum deviation of an accelerometer at rest, m/s^2: 3 % of gravity.
const GRAVITY_OFF_M_S2: f64 = 0.3;
/// Fraction of a range above which its end is near, because a reading at the end itself is clipped and no longer true.
const NEAR_END: f64 = 0.95;
/// Minimum fraction of the frames that contain a marker.
/// Markers may be hidden for a moment: three of 60 frames.
const SEEN_MIN: f64 = 0.95;
/// Channels of a force sensor's accelerometer.
const ACCELERATION: std::ops::Range<usize> = 6..9;

/// A finding of a test; the screen shows its cause and remedy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CheckupFinding {
    Silent,
    Reopened,
    Rate {
        hz: f64,
        nominal_hz: f64,
    },
    Lost {
        count: u64,
    },
    Damaged {
        count: u64,
    },
    Refused {
        count: u64,
    },
    /// Readings are late or arrive in bursts.
    Late {
        p99_s: f64,
        max_s: f64,
    },
    /// A force sensor repeats the same numbers.
    Frozen,
    /// The device did not rest: noise and gravity cannot be evaluated.
    Moved {
        channel: usize,
    },
    /// More noise than is usual for the device.
    Noisy {
        channel: usize,
        deviation: f64,
        max: f64,
    },
    /// At rest, the accelerometer does not measure gravity.
    Gravity {
        size_m_s2: f64,
    },
    /// The value is close to the end of its range.
    AtTheEnd {
        channel: usize,
        value: f64,
        range: [f64; 2],
    },
    /// A marker is not visible, or not always.
    Hidden {
        tool: usize,
        fraction: f64,
    },
}

/// One number of a device's readings during the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CheckupNumber {
    pub channel: usize,
    /// Standard deviation within tenths of a second: the noise, without slow motion.
    pub noise: f64,
    pub low: f64,
    pub high: f64,
    pub range: Option<[f64; 2]>,
}

/// Returns the smallest intentional change of this number: m, rad, N, Nm, m/s^2.
pub const fn min(kind: PartKind, channel: usize) -> f64 {
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => 3e-4,
        (PartKind::Handle, 3..=6) | (PartKind::Servos, _) => 0.01,
        (PartKind::Arm, _) => 2e-3,
        (PartKind::Sensor, 0..=2) => 0.3,
        (PartKind::Sensor, 3..=5) => 0.02,
        (PartKind::Tracker, _) => 7e-4,
        // An acceleration, a button or a switch.
        (PartKind::Sensor | PartKind::Handle | PartKind::Pedal, _) => 0.5,
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Checkup {
    pub part: RigPart,
    pub took_s: f64,
    pub rate_hz: f64,
    pub nominal_hz: Option<f64>,
    pub measured: Vec<CheckupNumber>,
    /// Age of the newest reading in a tick, s: median and 99th percentile; `None` without any reading.
    pub age_s: Option<[f64; 2]>,
    pub lost: u64,
    pub damaged: u64,
    pub refused: u64,
    /// Mean acceleration, m/s^2; for a sensor at rest it points upwards.
    pub up_m_s2: Option<Vector3<f64>>,
    /// The findings; empty if the device is in order.
    pub findings: Vec<CheckupFinding>,
}

/// Properties of a device that its test needs.
#[derive(Clone, Copy, Debug)]
pub struct TestSubject<'a> {
    pub part: RigPart,
    pub place: usize,
    pub nominal: Nominal,
    pub period_s: f64,
    /// Number of tools that a tracker follows.
    pub tools: usize,
    /// The deliveries during the test, oldest first.
    pub blocks: &'a [&'a Gauges],
}

impl<'a> TestSubject<'a> {
    /// Returns the properties of the part at this index of the roster; `None` if the rig has no devices.
    pub fn of(part: RigPart, place: usize, rig: &RigConfig, blocks: &'a [&'a Gauges]) -> Option<Self> {
        let devices = rig.devices.as_ref()?;
        let nominal = Nominal::of(part, devices, rig.rate_hz);
        let tools = devices.tracker.as_ref().map_or(0, |tracker| tracker.tools.len());
        Some(Self { part, place, nominal, period_s: 1.0 / rig.rate_hz, tools, blocks })
    }
}

impl Checkup {
    /// Tests a device from these blocks, oldest first; returns `None` with fewer than two blocks.
    pub fn of(subject: &TestSubject<'_>) -> Option<Self> {
        let (first, rest) = subject.blocks.split_first()?;
        let last = rest.last()?;
        let [before, after] = [first, last].map(|block| &block.devices[subject.place]);
        let took_s = last.to_s - first.to_s;
        let readings = after.readings.saturating_sub(before.readings);
        let gauges: Vec<&Gauge> = rest.iter().map(|block| &block.devices[subject.place]).collect();
        let mut this = Self {
            part: subject.part,
            took_s,
            rate_hz: readings as f64 / took_s.max(1e-9),
            nominal_hz: subject.nominal.rate_hz,
            measured: (0..CHANNELS).filter_map(|channel| measured(channel, &gauges, &subject.nominal)).collect(),
            age_s: ages(&gauges, subject.period_s),
            lost: after.lost.saturating_sub(before.lost),
            damaged: after.damaged.saturating_sub(before.damaged),
            refused: after.refused.saturating_sub(before.refused),
            up_m_s2: None,
            findings: Vec::new(),
        };
        if subject.nominal.inertial {
            let mean = ACCELERATION.map(|channel| whole(channel, &gauges)).filter(|spread| spread.count > 0);
            let mean: Vec<f64> = mean.map(|spread| spread.mean).collect();
            this.up_m_s2 = <[f64; 3]>::try_from(mean).ok().map(Vector3::from);
        }
        if after.readings < before.readings {
            this.findings.push(CheckupFinding::Reopened);
        } else if readings == 0 && Nominal::is_steady(subject.part) {
            this.findings.push(CheckupFinding::Silent);
        } else {
            let ticks: u64 = gauges.iter().flat_map(|gauge| gauge.ages).map(u64::from).sum();
            this.judge_delivery(subject, readings, ticks);
            this.judge_values(subject, &gauges);
        }
        Some(this)
    }

    fn judge_delivery(&mut self, subject: &TestSubject<'_>, readings: u64, ticks: u64) {
        // An arm answers once per tick: ticks that the loop missed are not its fault.
        let max_hz = if subject.part.kind() == PartKind::Arm { ticks as f64 / self.took_s } else { f64::INFINITY };
        if let Some(nominal_hz) = self.nominal_hz
            && (self.rate_hz / nominal_hz.min(max_hz) - 1.0).abs() > RATE_OFF
        {
            self.findings.push(CheckupFinding::Rate { hz: self.rate_hz, nominal_hz });
        }
        if self.lost as f64 > LOST_MAX * readings as f64 {
            self.findings.push(CheckupFinding::Lost { count: self.lost });
        }
        if self.damaged as f64 > DAMAGED_MAX * readings as f64 {
            self.findings.push(CheckupFinding::Damaged { count: self.damaged });
        }
        if self.refused > 0 {
            self.findings.push(CheckupFinding::Refused { count: self.refused });
        }
        let max_s = self.nominal_hz.map_or(AGE_MAX_S, |hz| AGE_PERIODS / hz + AGE_TICKS * subject.period_s);
        if let Some([_, p99_s]) = self.age_s.filter(|_| Nominal::is_steady(subject.part))
            // Half a period: ages are counted in whole periods.
            && p99_s > max_s + 0.5 * subject.period_s
        {
            self.findings.push(CheckupFinding::Late { p99_s, max_s });
        }
    }

    fn judge_values(&mut self, subject: &TestSubject<'_>, gauges: &[&Gauge]) {
        let kind = subject.part.kind();
        if kind == PartKind::Tracker {
            let frames = (self.rate_hz * self.took_s).max(1.0);
            let fraction = |tool: usize| f64::from(whole(3 * tool, gauges).count) / frames;
            let hidden = (0..subject.tools).map(|tool| CheckupFinding::Hidden { tool, fraction: fraction(tool) });
            self.findings.extend(
                hidden.filter(|one| matches!(one, CheckupFinding::Hidden { fraction, .. } if *fraction < SEEN_MIN)),
            );
        }
        if matches!(kind, PartKind::Sensor)
            && !self.measured.is_empty()
            && self.measured.iter().all(|one| one.high <= one.low)
        {
            self.findings.push(CheckupFinding::Frozen);
        }
        let at_the_end = self.measured.iter().filter_map(|&CheckupNumber { channel, low, high, range, .. }| {
            let range = range?;
            let reach = NEAR_END * (range[1] - range[0]) / 2.0;
            let middle = f64::midpoint(range[0], range[1]);
            let value = if high - middle > middle - low { high } else { low };
            // A closed gripper is at the end of its range on purpose.
            let on_purpose = kind == PartKind::Handle && channel == 6;
            ((value - middle).abs() > reach && !on_purpose).then_some(CheckupFinding::AtTheEnd {
                channel,
                value,
                range,
            })
        });
        self.findings.extend(at_the_end);
        if let Some(channel) = moved(kind, gauges) {
            self.findings.push(CheckupFinding::Moved { channel });
            return;
        }
        let noisy = self.measured.iter().filter_map(|one| {
            let max = noise_max(kind, one.channel)?;
            (one.noise > max).then_some(CheckupFinding::Noisy { channel: one.channel, deviation: one.noise, max })
        });
        self.findings.extend(noisy);
        if let Some(up) = self.up_m_s2
            && (up.norm() - GRAVITY_M_S2).abs() > GRAVITY_OFF_M_S2
        {
            self.findings.push(CheckupFinding::Gravity { size_m_s2: up.norm() });
        }
    }
}

/// Returns the index of the value that moved most during the test, if any did.
fn moved(kind: PartKind, gauges: &[&Gauge]) -> Option<usize> {
    let change = |channel: usize| {
        let mut means = GaugeSpread::NONE;
        let blocks = gauges.iter().map(|gauge| &gauge.channels[channel]).filter(|block| block.count > 0);
        for block in blocks {
            means.add(block.mean);
        }
        means.extent() / (2.0 * min(kind, channel))
    };
    let max = (0..CHANNELS).map(|channel| (channel, change(channel))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (max.1 > 1.0).then_some(max.0)
}

fn whole(channel: usize, gauges: &[&Gauge]) -> GaugeSpread {
    let mut whole = GaugeSpread::NONE;
    for gauge in gauges {
        whole.join(&gauge.channels[channel]);
    }
    whole
}

fn measured(channel: usize, gauges: &[&Gauge], nominal: &Nominal) -> Option<CheckupNumber> {
    let GaugeSpread { count, low, high, .. } = whole(channel, gauges);
    if count == 0 {
        return None;
    }
    let blocks = || gauges.iter().map(|gauge| &gauge.channels[channel]).filter(|block| block.count > 1);
    let free: u32 = blocks().map(|block| block.count - 1).sum();
    let squares: f64 = blocks().map(|block| block.squares).sum();
    let noise = if free == 0 { 0.0 } else { (squares / f64::from(free)).sqrt() };
    Some(CheckupNumber { channel, noise, low, high, range: nominal.ranges[channel] })
}

/// Returns median and 99th percentile of the age, s; `None` without any reading.
fn ages(gauges: &[&Gauge], period_s: f64) -> Option<[f64; 2]> {
    let counts: [u64; AGES] = std::array::from_fn(|age| gauges.iter().map(|gauge| u64::from(gauge.ages[age])).sum());
    let total: u64 = counts.iter().sum();
    let at = |fraction: f64| {
        let mut left = (fraction * total as f64).ceil() as u64;
        let place = counts.iter().position(|count| {
            let reached = *count >= left;
            left = left.saturating_sub(*count);
            reached
        });
        place.unwrap_or(AGES - 1) as f64 * period_s
    };
    (total > 0 && counts[AGES - 1] < total).then(|| [at(0.5), at(0.99)])
}

/// Returns the maximum noise of a device in order, standard deviation; `None` if noise is meaningless. For force
/// sensors: the noise for which the calibrations are designed. For the others: well above their resolution.
const fn noise_max(kind: PartKind, channel: usize) -> Option<f64> {
    match (kind, channel) {
        (PartKind::Handle, 0..=2) => Some(1e-4),
        (PartKind::Handle, 3..=6) | (PartKind::Servos, _) | (PartKind::Sensor, 3..=5) => Some(5e-3),
        (PartKind::Arm, _) => Some(5e-4),
        (PartKind::Sensor, 0..=2) => Some(0.1),
        (PartKind::Sensor, _) => Some(0.2),
        (PartKind::Tracker, _) => Some(3e-4),
        (PartKind::Handle | PartKind::Pedal, _) => None,
    }
}
