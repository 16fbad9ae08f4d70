//! Flaws of real devices that emulated devices show on request of a rig file.

use nima_devices::DeviceError;
use serde::{Deserialize, Serialize};

/// The flaws of an emulated rig (`[devices.flaws]`); none by default. Only for `emulated = true`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Flaws {
    /// The bias of the wrist sensors drifts with their temperature, N per minute along each axis.
    pub drift_n_per_min: f64,
    /// Maximum force with which the cables of the instrument pull at the wrist sensor, N, depending on the angle of its
    /// last joint.
    pub cable_n: f64,
    /// Additional rotation of the accelerometers relative to the scene, degrees.
    pub imu_askew_deg: f64,
    /// Delay of the marker poses from the tracker, s.
    pub tracker_late_s: f64,
    /// Fraction of the time in which the tracker does not detect the instruments' markers.
    pub tracker_missing: f64,
    /// Play between each joint and its encoder, degrees.
    pub backlash_deg: f64,
    /// Lateral compliance of the shaft, m per N at the tip.
    pub bend_m_per_n: f64,
}

impl Flaws {
    /// Checks every value; on a rig of real devices all must be zero.
    ///
    /// # Errors
    /// [`DeviceError::Setting`] for the first value out of its range.
    pub(super) fn check(&self, emulated: bool) -> Result<(), DeviceError> {
        let ranges = [
            ("drift_n_per_min", self.drift_n_per_min, 10.0),
            ("cable_n", self.cable_n, 10.0),
            ("imu_askew_deg", self.imu_askew_deg, 180.0),
            ("tracker_late_s", self.tracker_late_s, 1.0),
            ("tracker_missing", self.tracker_missing, 1.0),
            ("backlash_deg", self.backlash_deg, 5.0),
            ("bend_m_per_n", self.bend_m_per_n, 0.002),
        ];
        for (key, value, max) in ranges {
            // Written so that NaN is refused as well.
            let within = value >= 0.0 && value <= max;
            if !within || (!emulated && value > 0.0) {
                let allowed = if within { "0 on a rig of real devices".to_owned() } else { format!("0 to {max}") };
                return Err(DeviceError::Setting { key: format!("flaws.{key}"), value: value.to_string(), allowed });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flaws_are_for_emulated_rigs_and_within_their_ranges() {
        assert_eq!(Flaws::default().check(false), Ok(()));
        let drift = Flaws { drift_n_per_min: 0.2, ..Flaws::default() };
        assert_eq!(drift.check(true), Ok(()));
        let report = drift.check(false).unwrap_err().to_string();
        assert!(report.contains("flaws.drift_n_per_min") && report.contains("real devices"), "{report}");
        for bad in [f64::NAN, f64::INFINITY, -0.1] {
            let report = Flaws { backlash_deg: bad, ..Flaws::default() }.check(true).unwrap_err().to_string();
            assert!(report.contains("flaws.backlash_deg") && report.contains("0 to 5"), "{report}");
        }
    }
}
