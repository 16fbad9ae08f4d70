//! Describes the active calibrations in a session file, for readers that do not replay it.

use std::collections::BTreeMap;

use nima_core::calibration::Verdict;
use nima_machine::teleop::{Calibrations, GravityCheck};
use nima_recording::tip_force::model_to_bytes;

use crate::digest::digest_of_bytes;

/// Entries whose values are one of [`verdicts`].
pub(crate) const VERDICTS: [&str; 2] = ["gravity_verdict", "network_verdict"];
/// Entries whose values are numbers. None of them reveals a person, place or date.
pub(crate) const FIGURES: [&str; 5] =
    ["gravity_error_n", "gravity_poses", "network_error_n", "network_rows", "network_doubt_share"];
const UNCHECKED: &str = "never checked on new data";

/// Returns keys and values for the calibrations of a side.
pub(crate) fn described(calibrations: &Calibrations) -> BTreeMap<String, String> {
    let Calibrations { gravity, tip_force, gravity_check } = calibrations;
    let mut entries = BTreeMap::new();
    let mut add = |key: &str, value: String| drop(entries.insert(key.to_owned(), value));
    if let Some(text) = gravity.as_ref().and_then(|gravity| toml::to_string(gravity).ok()) {
        add("gravity_digest", format!("{:016x}", digest_of_bytes(text.as_bytes())));
        add("gravity", text);
    }
    if let (Some(_), Some(GravityCheck { verdict, is_overridden, held_out_n, poses })) = (gravity, gravity_check) {
        add("gravity_verdict", verdict_text(*verdict, *is_overridden).to_owned());
        add("gravity_error_n", held_out_n.to_string());
        add("gravity_poses", poses.to_string());
    }
    if let Some(model) = tip_force.as_ref().map(nima_core::tip_force::LiveTipForce::model) {
        let origin = &model.origin;
        for (key, value) in [("network_sensor", &origin.sensor), ("network_tool", &origin.tool)] {
            add(key, value.clone().unwrap_or_default());
        }
        add("network_date", origin.date.clone());
        // The same bytes as in the network's file.
        if let Ok(bytes) = model_to_bytes(model) {
            add("network_digest", format!("{:016x}", digest_of_bytes(&bytes)));
        }
        add("network_verdict", UNCHECKED.to_owned());
        if let Some(check) = &origin.check {
            let judgement = &check.judgement;
            add("network_verdict", verdict_text(judgement.verdict, judgement.override_by.is_some()).to_owned());
            add("network_error_n", (check.mae_n.iter().sum::<f64>() / 3.0).to_string());
            add("network_rows", check.rows.to_string());
            add("network_doubt_share", check.doubt_fraction.to_string());
        }
    }
    entries
}

/// Returns every possible value of a verdict in a session.
pub(crate) fn verdicts() -> impl Iterator<Item = &'static str> {
    let all = [Verdict::Accepted, Verdict::InsufficientMotion, Verdict::PoorData];
    all.into_iter().flat_map(|verdict| [false, true].map(|kept| verdict_text(verdict, kept))).chain([UNCHECKED])
}

/// Returns the text of a verdict, and whether a person has overridden it. The person's name is never stored in a
/// session.
const fn verdict_text(verdict: Verdict, is_overridden: bool) -> &'static str {
    match (verdict, is_overridden) {
        (Verdict::Accepted, _) => "accepted",
        (Verdict::InsufficientMotion, true) => "kept by a person: insufficient motion",
        (Verdict::PoorData, true) => "kept by a person: poor data",
        (Verdict::InsufficientMotion, false) => "not accepted: insufficient motion",
        (Verdict::PoorData, false) => "not accepted: poor data",
    }
}

#[cfg(test)]
mod tests {
    use nima_core::calibration::gravity::{GravityModel, GravityParameters, GravitySource};

    use super::*;

    #[test]
    fn the_verdict_of_a_gravity_calibration_is_told_with_its_figures() {
        let parameters = GravityParameters::Physical {
            mass_kg: 0.2,
            s1_from_source_wxyz: [1.0, 0.0, 0.0, 0.0],
            bias_n: [0.0; 3],
            torque: None,
        };
        let gravity = Some(GravityModel { source: GravitySource::Imu, imu_sign: 1, parameters });
        let check = GravityCheck { verdict: Verdict::PoorData, is_overridden: true, held_out_n: 0.0625, poses: 14 };
        let entries = described(&Calibrations { gravity, gravity_check: Some(check), tip_force: None });
        let expected = [
            ("gravity_verdict", "kept by a person: poor data"),
            ("gravity_error_n", "0.0625"),
            ("gravity_poses", "14"),
        ];
        assert!(expected.iter().all(|(key, value)| entries[*key] == *value), "{entries:?}");
        assert!(verdicts().any(|known| known == entries["gravity_verdict"]));
        let unknown = described(&Calibrations { gravity, ..Calibrations::default() });
        assert!(!unknown.contains_key("gravity_verdict") && unknown.contains_key("gravity"), "{unknown:?}");
    }
}
