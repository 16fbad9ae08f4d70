//! Expected data of a device, as far as they are specified: the reference for its test.

use std::f64::consts::PI;

use nima_devices::dynamixel;

use super::{PartKind, RigPart, RigSettings, SensorSettings, gauge::CHANNELS};

/// Minimum reach of an omega.7 from the centre, m (the manufacturer's workspace).
const HANDLE_REACH_M: f64 = 0.075;
/// Maximum opening of its gripper, rad (30 degrees, chai3d's device table).
const GRIPPER_RAD: f64 = PI / 6.0;
/// Channel of the gripper.
const GRIPPER: usize = 6;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nominal {
    /// Rate of the readings, Hz; `None` for a device that is queried as often as its connection allows, or sends only
    /// changes.
    pub rate_hz: Option<f64>,
    /// Lowest and highest value of each number of a reading ([`super::Gauge::channels`]), if it has limits.
    pub ranges: [Option<[f64; 2]>; CHANNELS],
    pub inertial: bool,
}

impl Nominal {
    /// Returns the expected deliveries of a part of a rig with these devices and a loop of this rate (Hz).
    pub fn of(part: RigPart, devices: &RigSettings, loop_hz: f64) -> Self {
        let mut nominal = Self { rate_hz: None, ranges: [None; CHANNELS], inertial: false };
        let set = part.side().and_then(|side| devices.arm(side));
        match part {
            RigPart::Handle(_) => {
                nominal.rate_hz = set.map(|set| set.handle.rate_hz().min(loop_hz));
                // The reach of a user's handle is unknown.
                if set.is_some_and(|set| set.handle.force_dimension().is_some()) {
                    nominal.ranges[..3].fill(Some([-HANDLE_REACH_M, HANDLE_REACH_M]));
                    nominal.ranges[GRIPPER] = Some([0.0, GRIPPER_RAD]);
                }
            }
            RigPart::Arm(_) => {
                // The device is queried once per tick.
                nominal.rate_hz = Some(loop_hz);
                if let Some(Ok(model)) = set.map(super::ArmSet::model) {
                    for (joint, range) in nominal.ranges.iter_mut().enumerate().take(model.joints()) {
                        *range = Some(model.range_rad(joint)).filter(|range| range.iter().all(|rad| rad.is_finite()));
                    }
                }
            }
            RigPart::Sensor(_) | RigPart::TissueSensor => {
                let sensor = if part == RigPart::TissueSensor {
                    devices.tissue_sensor.as_ref()
                } else {
                    set.map(|set| &set.sensor)
                };
                nominal.rate_hz = sensor.map(SensorSettings::expected_hz);
                nominal.inertial = sensor.is_some_and(SensorSettings::is_inertial);
            }
            RigPart::Servos(_) => nominal.ranges = ranges_of(set.and_then(|set| set.servos.as_ref())),
            RigPart::Tracker => nominal.rate_hz = devices.tracker.as_ref().map(|tracker| tracker.frame_hz),
            RigPart::Pedal => {}
        }
        nominal
    }

    /// Returns whether the device delivers continuously; silence is then a fault.
    pub const fn is_steady(part: RigPart) -> bool {
        !matches!(part.kind(), PartKind::Pedal)
    }
}

fn ranges_of(servos: Option<&dynamixel::DynamixelSettings>) -> [Option<[f64; 2]>; CHANNELS] {
    let mut ranges = [None; CHANNELS];
    for (range, servo) in ranges.iter_mut().zip(servos.iter().flat_map(|settings| &settings.servos)) {
        *range = Some([servo.position_min_rad, servo.position_max_rad]);
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::RigConfig;

    #[test]
    fn every_part_of_the_emulated_rig_has_its_yardstick() {
        let rig = RigConfig::load("emulated").unwrap();
        let devices = rig.devices.unwrap();
        let rates: Vec<_> = RigPart::ALL.iter().map(|part| Nominal::of(*part, &devices, rig.rate_hz).rate_hz).collect();
        let [thousand, none] = [Some(1000.0), None];
        let of_side = [thousand, thousand, thousand, none];
        assert_eq!(rates[..4], of_side);
        assert_eq!(rates[4..8], of_side);
        assert_eq!(rates[8..], [Some(800.0), Some(60.0), None]);
        let inertial: Vec<_> =
            RigPart::ALL.into_iter().filter(|part| Nominal::of(*part, &devices, 1000.0).inertial).collect();
        assert_eq!(inertial.len(), 2, "a first-generation sensor has none: {inertial:?}");
        let servos = Nominal::of(RigPart::ALL[3], &devices, 1000.0);
        assert_eq!(servos.ranges[3..5], [Some([-1.6, 1.6]), None]);
        let arm = Nominal::of(RigPart::ALL[1], &devices, 1000.0);
        assert!(arm.ranges[0].is_none() && arm.ranges[1].is_some(), "joint 1 turns without end");
    }
}
