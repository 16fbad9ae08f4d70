//! Ranges of the gates' settings.

use nima_core::{
    limits::{GAIN, MAX_CEILING_N},
    safety::ChainSettings,
};

use super::{ConfigError, Ranges};

pub(super) fn check(gates: &ChainSettings, ranges: &Ranges<'_>) -> Result<(), ConfigError> {
    ranges.check(
        "gates.gain",
        gates.gain,
        GAIN.contains(gates.gain),
        format!("{GAIN} (only the operator can set more)"),
    )?;
    ranges.check(
        "gates.ceiling_n",
        gates.ceiling_n,
        gates.ceiling_n > 0.0 && gates.ceiling_n <= MAX_CEILING_N,
        format!("above 0, at most {MAX_CEILING_N} N"),
    )?;
    ranges.positive("gates.slew_n_per_s", gates.slew_n_per_s)?;
    ranges.positive("gates.gain_rate_per_s", gates.gain_rate_per_s)?;
    ranges.not_negative("gates.dead_band_m_s", gates.dead_band_m_s)?;
    ranges.not_negative("gates.handle_kg", gates.handle_kg)?;
    ranges.not_negative("gates.handle_n_s_m", gates.handle_n_s_m)?;
    ranges.positive("gates.handle_step_m", gates.handle_step_m)?;
    ranges.not_negative("gates.brake_n_s_m", gates.brake_n_s_m)?;
    // Far above every useful value, and below the same value in mm or g.
    for (key, value, max, unit) in [
        ("gates.dead_band_m_s", gates.dead_band_m_s, 0.2, "m/s"),
        ("gates.handle_kg", gates.handle_kg, 10.0, "kg"),
        ("gates.handle_step_m", gates.handle_step_m, 0.1, "m"),
        ("gates.zero_after_s", gates.zero_after_s, 5.0, "s"),
    ] {
        ranges.check(key, value, value <= max, format!("at most {max} {unit}; check the unit"))?;
    }
    let ages = gates.fade_after_s >= 0.0 && gates.zero_after_s > gates.fade_after_s;
    ranges.check("gates.zero_after_s", gates.zero_after_s, ages, "later than fade_after_s")
}

#[cfg(test)]
mod tests {
    use crate::config::RigConfig;

    #[test]
    fn a_gate_in_another_unit_is_refused() {
        let refused = |change: fn(&mut RigConfig)| {
            let mut rig = RigConfig::load("simulated").unwrap();
            change(&mut rig);
            rig.validate().expect_err("in another unit").to_string()
        };
        assert!(refused(|rig| rig.gates.dead_band_m_s = 1.0).contains("gates.dead_band_m_s"));
        assert!(refused(|rig| rig.gates.handle_kg = 250.0).contains("gates.handle_kg"));
        assert!(refused(|rig| rig.gates.zero_after_s = 20.0).contains("gates.zero_after_s"));
        assert!(refused(|rig| rig.follower_speed_max_m_s = 300.0).contains("follower_speed_max_m_s"));
    }
}
