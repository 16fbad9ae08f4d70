//! Refuses lengths that are not plausible in metres, because they would move an arm to another place.

use nalgebra::Vector3;
use nima_core::{
    kinematics::{ArmError, ArmSettings, Rcm, RcmError},
    units,
};

use super::ArmSet;

/// Maximum distance between base and trocar, m: the reach of an arm with the longest shaft.
const REACH_MAX_M: f64 = 2.5;
/// Maximum distance of a marker from the wrist sensor, m.
const MARKER_MAX_M: f64 = 1.0;
/// Maximum distance of the tracker's camera from the base, m.
const CAMERA_MAX_M: f64 = 10.0;

impl ArmSet {
    /// Checks that mount, trocar and hand-eye are plausible lengths in m; returns key, value and remedy otherwise.
    pub(super) fn check_lengths(&self) -> Result<(), (&'static str, String, String)> {
        let words = |vector: &Vector3<f64>| format!("{:?}", vector.as_slice());
        self.kinematics().map_err(|error| match error {
            ArmError::ShaftLength { shaft_m } => ("mount.shaft_m", shaft_m.to_string(), error.to_string()),
            ArmError::NotFinite { field } | ArmError::TooFar { field, .. } => {
                let ArmSettings { base_m, base_deg, sensor_m, sensor_deg, .. } = &self.mount;
                let (key, vector) = match field {
                    "base_m" => ("mount.base_m", base_m),
                    "base_deg" => ("mount.base_deg", base_deg),
                    "sensor_m" => ("mount.sensor_m", sensor_m),
                    _ => ("mount.sensor_deg", sensor_deg),
                };
                (key, words(vector), error.to_string())
            }
            ArmError::NoModel | ArmError::Model(_) => ("model", "given".to_owned(), error.to_string()),
        })?;
        let trocar_m = words(&self.rcm.trocar_m);
        Rcm::new(&self.rcm).map_err(|error| match error {
            RcmError::TooFar { setting: "insertion_max_m", value_m, .. } => {
                ("rcm.insertion_max_m", value_m.to_string(), error.to_string())
            }
            RcmError::TooFar { setting: "insertion_min_m", value_m, .. } => {
                ("rcm.insertion_min_m", value_m.to_string(), error.to_string())
            }
            RcmError::TooFar { .. } => ("rcm.trocar_m", trocar_m.clone(), error.to_string()),
            other => ("rcm", format!("{:?}", self.rcm), other.to_string()),
        })?;
        let lengths = [
            ("rcm.trocar_m", Some(self.rcm.trocar_m), self.mount.base_m, REACH_MAX_M),
            ("s1_from_m_m", self.s1_from_m_m, Vector3::zeros(), MARKER_MAX_M),
            ("base_from_c_m", self.base_from_c_m, Vector3::zeros(), CAMERA_MAX_M),
        ];
        for (key, place_m, from_m, max_m) in lengths {
            let Some(place_m) = place_m else { continue };
            let distance_m = (place_m - from_m).norm();
            if distance_m > max_m {
                let remedy = units::length_remedy(distance_m, max_m);
                return Err((key, words(&place_m), format!("it is {distance_m:.3} m away: {remedy}")));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::{config::RigConfig, rig::ArmSet};

    /// A change of an arm, and the key that it makes invalid.
    type Case = (fn(&mut ArmSet), &'static str);

    #[test]
    fn a_length_in_another_unit_is_refused_with_the_unit() {
        let good = RigConfig::load("paper").unwrap().devices.unwrap();
        let report = |change: fn(&mut ArmSet)| {
            let mut settings = good.clone();
            change(settings.right.as_mut().unwrap());
            settings.check().expect_err("not in metres").to_string()
        };
        let cases: [Case; 7] = [
            (|set| set.mount.base_m *= 1000.0, "devices.right.mount.base_m"),
            (|set| set.mount.sensor_m *= 1000.0, "devices.right.mount.sensor_m"),
            (|set| set.mount.shaft_m *= 1000.0, "devices.right.mount.shaft_m"),
            (|set| set.rcm.trocar_m *= 1000.0, "devices.right.rcm.trocar_m"),
            (|set| set.rcm.trocar_m *= 100.0, "devices.right.rcm.trocar_m"),
            (|set| set.rcm.insertion_max_m *= 1000.0, "devices.right.rcm.insertion_max_m"),
            (|set| set.s1_from_m_m = Some([40.0, 0.0, 20.0].into()), "devices.right.s1_from_m_m"),
        ];
        for (change, key) in cases {
            let words = report(change);
            assert!(words.contains(key) && words.contains("enter metres") && words.contains("mm"), "{words}");
        }
    }
}
