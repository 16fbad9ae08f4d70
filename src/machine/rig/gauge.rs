//! Deliveries of each device in a short time: its readings summed up in constant memory, for the screen.
//!
//! The loop adds every reading and, in every tick, the age of the newest one; ten times per second it passes on the
//! sums and resets them. Nothing here allocates. The screen joins blocks to the duration that it needs.

use nalgebra::{UnitQuaternion, Vector3};
use nima_devices::{
    ArmReading, ForceReading, HandleReading, Health, PedalReading, SERVOS, ServoReading, TRACKED_TOOLS, TrackedTool,
    TrackerReading,
};

use super::DEVICES_MAX;

/// Maximum number of values of a reading that are summed up: three for each of a tracker's tools.
pub const CHANNELS: usize = 3 * TRACKED_TOOLS;
/// Number of distinguished ages, in periods of the loop; the last one includes everything older.
/// 48 ms at 1 kHz: beyond the age at which a reading counts as missing.
pub const AGES: usize = 48;

/// Count, mean, spread and range of one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaugeSpread {
    pub count: u32,
    pub mean: f64,
    /// Sum of the squared distances from the mean.
    pub squares: f64,
    pub low: f64,
    pub high: f64,
}

impl GaugeSpread {
    pub const NONE: Self = Self { count: 0, mean: 0.0, squares: 0.0, low: f64::INFINITY, high: f64::NEG_INFINITY };

    /// Adds a value; a non-finite value is ignored.
    pub fn add(&mut self, value: f64) {
        if value.is_finite() {
            // Combined like two groups, so that one value and a whole block use the same formula.
            self.join(&Self { count: 1, mean: value, squares: 0.0, low: value, high: value });
        }
    }

    pub fn join(&mut self, other: &Self) {
        let count = self.count + other.count;
        if other.count == 0 {
            return;
        }
        let fraction = f64::from(other.count) / f64::from(count);
        let apart = other.mean - self.mean;
        self.squares += other.squares + apart * apart * fraction * f64::from(self.count);
        self.mean += apart * fraction;
        self.low = self.low.min(other.low);
        self.high = self.high.max(other.high);
        self.count = count;
    }

    /// Returns the standard deviation; zero with fewer than two values.
    pub fn deviation(&self) -> f64 {
        if self.count < 2 { 0.0 } else { (self.squares / f64::from(self.count - 1)).sqrt() }
    }

    /// Returns the distance between the highest and the lowest value; zero without values.
    pub fn extent(&self) -> f64 {
        (self.high - self.low).max(0.0)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauge {
    /// The numbers of its readings:
    ///
    /// - handle: position (m), rotation since its first reading (rad), opening of the gripper (rad), buttons;
    /// - arm: joint angles (rad); servos: angles (rad);
    /// - force sensor: force (N), torque (Nm), acceleration (m/s^2);
    /// - tracker: position of each tool in the camera's frame (m), whenever it is visible;
    /// - pedal: its switches as one number.
    pub channels: [GaugeSpread; CHANNELS],
    /// Ticks by the age of the newest reading, in periods of the loop.
    pub ages: [u16; AGES],
    /// Number of accepted readings since the device was opened.
    pub readings: u64,
    /// Number of readings that never arrived, since the device was opened.
    pub lost: u64,
    /// Number of frames refused for their checksum or structure, since the device was opened.
    pub damaged: u64,
    /// Number of readings refused for their status or numbers, since the device was opened.
    pub refused: u64,
}

impl Gauge {
    pub const NONE: Self =
        Self { channels: [GaugeSpread::NONE; CHANNELS], ages: [0; AGES], readings: 0, lost: 0, damaged: 0, refused: 0 };

    fn add(&mut self, values: impl IntoIterator<Item = f64>) {
        self.channels.iter_mut().zip(values).for_each(|(channel, value)| channel.add(value));
    }

    /// Adds a reading of a handle; rotations are relative to `from`.
    pub fn handle(&mut self, reading: &HandleReading, from: &UnitQuaternion<f64>) {
        let turned = reading.orientation.map_or(NOWHERE, |now| (from.inverse() * now).scaled_axis());
        let rest = [reading.gripper_rad.unwrap_or(f64::NAN), f64::from(reading.buttons)];
        self.add(reading.position_m.iter().chain(&turned).copied().chain(rest));
    }

    /// Adds a reading of an arm with this number of joints.
    pub fn arm(&mut self, reading: &ArmReading, joints: usize) {
        self.add(reading.joint_rad.into_iter().take(joints));
    }

    pub fn sensor(&mut self, reading: &ForceReading) {
        let acceleration = reading.acceleration_m_s2.unwrap_or(NOWHERE);
        self.add(reading.wrench.force_n.iter().chain(&reading.wrench.torque_nm).chain(&acceleration).copied());
    }

    pub fn servos(&mut self, reading: &ServoReading) {
        self.add(reading.position_rad[..SERVOS].iter().copied());
    }

    pub fn tracker(&mut self, reading: &TrackerReading) {
        for (tool, channels) in reading.tools.iter().zip(self.channels.chunks_exact_mut(3)) {
            if let TrackedTool::Seen { position_in_c_m, .. } = tool {
                channels.iter_mut().zip(position_in_c_m).for_each(|(channel, value)| channel.add(*value));
            }
        }
    }

    pub fn pedal(&mut self, reading: PedalReading) {
        self.add([f64::from(reading.pressed)]);
    }

    /// Records the age of the newest reading in this tick, and the device's counters.
    pub fn tick(&mut self, health: &Health, now_s: f64, period_s: f64) {
        let age = (health.age_s(now_s) / period_s).round().clamp(0.0, (AGES - 1) as f64);
        self.ages[age as usize] = self.ages[age as usize].saturating_add(1);
        let Health { readings, lost, damaged, refused, .. } = *health;
        self.readings = readings;
        self.lost = lost;
        self.damaged = damaged;
        self.refused = refused;
    }
}

/// Marks numbers that a device does not have.
const NOWHERE: Vector3<f64> = Vector3::new(f64::NAN, f64::NAN, f64::NAN);

/// Deliveries of every device of a rig in a block of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gauges {
    /// Start of the block, s on the loop's clock.
    pub from_s: f64,
    /// End of the block, s on the loop's clock.
    pub to_s: f64,
    /// Gauges, in the order of the roster.
    pub devices: [Gauge; DEVICES_MAX],
}

#[cfg(test)]
mod tests {
    use nima_devices::ARM_JOINTS;

    use super::*;

    #[test]
    fn joined_spreads_are_those_of_all_values() {
        let values: Vec<f64> = (0..500).map(|k| 100.0 + f64::from(k * k % 97) * 1e-3).collect();
        let mut whole = GaugeSpread::NONE;
        let mut joined = GaugeSpread::NONE;
        for block in values.chunks(37) {
            let mut part = GaugeSpread::NONE;
            for value in block {
                part.add(*value);
            }
            joined.join(&part);
        }
        for value in &values {
            whole.add(*value);
        }
        let mean = values.iter().sum::<f64>() / 500.0;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        for spread in [whole, joined] {
            assert!((spread.mean - mean).abs() < 1e-12, "{spread:?}");
            assert!((spread.deviation() - (squares / 499.0).sqrt()).abs() < 1e-12, "{spread:?}");
            assert_eq!((spread.count, spread.low, spread.high), (500, 100.0, 100.096));
        }
        whole.add(f64::NAN);
        whole.join(&GaugeSpread::NONE);
        assert_eq!(whole.count, 500);
        assert_eq!((GaugeSpread::NONE.deviation(), GaugeSpread::NONE.extent()), (0.0, 0.0));
    }

    #[test]
    fn what_a_device_does_not_have_or_does_not_see_is_not_counted() {
        let mut gauge = Gauge::NONE;
        gauge.sensor(&ForceReading::default());
        let counts = |gauge: &Gauge| gauge.channels.map(|channel| channel.count);
        assert_eq!(counts(&gauge), [1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0]);
        let mut gauge = Gauge::NONE;
        let zeros = [0.0; ARM_JOINTS];
        let still = ArmReading { joint_rad: zeros, joint_rad_s: zeros, joint_nm: zeros, servoing: false };
        gauge.arm(&still, 6);
        assert_eq!(counts(&gauge)[5..7], [1, 0], "an arm of six joints has no seventh angle, not one of zero");
        let mut gauge = Gauge::NONE;
        let seen = TrackedTool::Seen {
            c_from_tool: UnitQuaternion::identity(),
            position_in_c_m: Vector3::new(0.1, 0.2, 0.3),
            error_m: 0.0,
            at_the_edge: false,
        };
        let missing = TrackedTool::Missing { out_of_volume: false };
        gauge.tracker(&TrackerReading { frame: 1, tools: [missing, seen, TrackedTool::Absent, TrackedTool::Disabled] });
        assert_eq!(counts(&gauge), [0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0]);
        assert!((gauge.channels[5].mean - 0.3).abs() < 1e-12);
    }

    #[test]
    fn ages_are_counted_in_periods_and_a_device_that_was_never_heard_is_as_old_as_can_be() {
        let mut gauge = Gauge::NONE;
        let mut health = Health::default();
        gauge.tick(&health, 1.0, 1e-3);
        assert_eq!(gauge.ages[AGES - 1], 1);
        health.accept(1.001);
        for tick in 1..4 {
            gauge.tick(&health, 1.0 + f64::from(tick) * 1e-3, 1e-3);
        }
        assert_eq!((gauge.ages[..3].to_vec(), gauge.readings), (vec![1, 1, 1], 1));
    }
}
