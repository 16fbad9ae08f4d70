//! What a session file tells of the calibrations in force, for readers who do not replay it.

use std::collections::BTreeMap;

use nima_machine::teleop::Calibrations;
use nima_recording::tip_force::model_to_bytes;

use crate::digest::digest_of_bytes;

/// Keys and values for the calibrations of a side.
pub(crate) fn described(calibrations: &Calibrations) -> BTreeMap<String, String> {
    let Calibrations { gravity, tip_force } = calibrations;
    let mut told = BTreeMap::new();
    let mut tell = |key: &str, value: String| drop(told.insert(key.to_owned(), value));
    if let Some(text) = gravity.as_ref().and_then(|gravity| toml::to_string(gravity).ok()) {
        tell("gravity_digest", format!("{:016x}", digest_of_bytes(text.as_bytes())));
        tell("gravity", text);
    }
    if let Some(model) = tip_force.as_ref().map(nima_core::tip_force::TipForce::model) {
        let origin = &model.origin;
        for (key, value) in [("network_sensor", &origin.sensor), ("network_tool", &origin.tool)] {
            tell(key, value.clone().unwrap_or_default());
        }
        tell("network_date", origin.date.clone());
        // The bytes are those of the network's file.
        if let Ok(bytes) = model_to_bytes(model) {
            tell("network_digest", format!("{:016x}", digest_of_bytes(&bytes)));
        }
    }
    told
}
