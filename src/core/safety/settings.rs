//! Settings of a chain and their safe defaults.

use super::FreeHandle;
use crate::limits::{DEAD_BAND_M_S, GAIN_ABOVE_ONE, OMEGA7_FORCE_N, OMEGA7_GRIPPER_N, USUAL_CEILING_N};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EnergyMode {
    /// No observation, no limit.
    Off,
    Observe,
    /// Removes the force that would give the hand more energy than it put in.
    #[default]
    Control,
}

impl EnergyMode {
    pub const ALL: [Self; 3] = [Self::Off, Self::Observe, Self::Control];

    /// Returns the word used in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Observe => "observe",
            Self::Control => "control",
        }
    }
}

/// Settings of the chain. The defaults are the project's safe values. In a chain of torques, read Nm for N and rad/s
/// for m/s.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChainSettings {
    /// Feedback gain, 0 to 1 (a chain starts with at most 1; above 1 see
    /// [`SafetyChain::set_gain_above_one`](super::SafetyChain)).
    pub gain: f64,
    /// Maximum rate of change of the gain, 1/s: a jump of the slider becomes a ramp.
    pub gain_rate_per_s: f64,
    /// Maximum force at the hand, N (norm of the vector).
    pub ceiling_n: f64,
    /// Maximum force of the device itself, N; the ceiling is never above it.
    pub device_limit_n: f64,
    pub slew_n_per_s: f64,
    /// Age beyond the link's own delay at which the force begins to fade, s.
    pub fade_after_s: f64,
    /// Age beyond the link's own delay at which the force is zero, s.
    pub zero_after_s: f64,
    /// Speed below which no force is rendered, m/s.
    pub dead_band_m_s: f64,
    /// Keeps the force at standstill instead of fading it in the dead band.
    pub static_hold: bool,
    pub energy: EnergyMode,
    /// Apparent mass of the handle alone, kg; the governor recognises a released handle by it. 0 if unknown: the
    /// governor then passes every force.
    pub handle_kg: f64,
    /// Viscous friction of the handle's bearings and cables, N s/m.
    pub handle_n_s_m: f64,
    /// Step of the handle's reading, m; it determines the accuracy of the hand's speed.
    pub handle_step_m: f64,
    /// Maximum viscous damping that the device can render without oscillating, N s/m: the governor's brake.
    pub brake_n_s_m: f64,
}

impl Default for ChainSettings {
    fn default() -> Self {
        Self {
            gain: 1.0,
            gain_rate_per_s: 2.0,
            ceiling_n: USUAL_CEILING_N,
            device_limit_n: OMEGA7_FORCE_N,
            // 5 N within 10 ms: too fast to be felt as a ramp, slow enough that one bad sample changes the force by
            // only 0.5 N.
            slew_n_per_s: 500.0,
            // Design choice for both ages: shorter ones let the jitter of a link fade the force, longer ones hold a
            // force whose cause may be gone.
            fade_after_s: 0.005,
            zero_after_s: 0.020,
            // The paper's 1 mm/s (Validation III: no force below it).
            dead_band_m_s: 1e-3,
            static_hold: false,
            energy: EnergyMode::default(),
            // Effective mass of an omega.7 at its grip.
            handle_kg: 0.25,
            // Roughly an omega.7's (`docs/results/release.md`).
            handle_n_s_m: 0.5,
            // Position resolution of an omega.7, and of the simulated handles.
            handle_step_m: 1e-5,
            // The maximum damping that chai3d uses for an omega.7.
            brake_n_s_m: 30.0,
        }
    }
}

impl ChainSettings {
    /// Returns the settings for a gripper force (N between the fingers): the same gates, but a held object is felt at
    /// standstill.
    pub fn gripper() -> Self {
        Self { device_limit_n: OMEGA7_GRIPPER_N, static_hold: true, ..Self::default() }.without_governor()
    }

    /// Returns the settings for a torque on the handle (Nm, rad/s; a sigma.7 renders up to 0.4 Nm, an omega.7 none: its
    /// limit is 0).
    pub fn torque(device_limit_nm: f64) -> Self {
        Self {
            // A quarter of a sigma.7's 0.4 Nm.
            ceiling_n: 0.1,
            device_limit_n: device_limit_nm,
            // From zero to the ceiling in 8 ms, as for forces (4 N at 500 N/s).
            slew_n_per_s: 12.5,
            dead_band_m_s: 0.02,
            // The energy gate's allowance is meant for forces; the energy of a torque is a hundredth of it, so only
            // observe.
            energy: EnergyMode::Observe,
            ..Self::default()
        }
        .without_governor()
    }

    /// Returns the settings without the governor, for a device of unknown inertia. The mass of a gripper's finger is
    /// not documented, and a released gripper opens to its stop, where it rests. The same applies to the inertia of a
    /// wrist.
    #[must_use]
    pub fn without_governor(self) -> Self {
        Self { handle_kg: 0.0, ..self }
    }

    /// Returns the handle that the governor observes.
    pub(super) const fn handle(&self) -> FreeHandle {
        FreeHandle {
            mass_kg: self.handle_kg,
            damping_n_s_m: self.handle_n_s_m,
            brake_n_s_m: self.brake_n_s_m,
            step_m: self.handle_step_m,
        }
    }

    /// Returns the settings with every value clamped to its range; NaN becomes the safe default.
    #[must_use]
    pub(super) fn pulled_in(self) -> Self {
        let safe = Self::default();
        let fit = |value: f64, min: f64, max: f64, safe: f64| {
            // NaN passes `clamp` unchanged, so it is replaced first.
            if value.is_nan() { safe } else { value.clamp(min, max) }
        };
        let fade_after_s = fit(self.fade_after_s, 0.0, 1.0, safe.fade_after_s);
        Self {
            // NaN and out-of-range gains and limits become zero force, not the default: it is the one value that is
            // always safe.
            gain: fit(self.gain, GAIN_ABOVE_ONE.min, GAIN_ABOVE_ONE.max, 0.0),
            gain_rate_per_s: fit(self.gain_rate_per_s, 0.0, 1e3, safe.gain_rate_per_s),
            ceiling_n: fit(self.ceiling_n, 0.0, 1e3, 0.0),
            device_limit_n: fit(self.device_limit_n, 0.0, 1e3, 0.0),
            slew_n_per_s: fit(self.slew_n_per_s, 0.0, 1e9, safe.slew_n_per_s),
            fade_after_s,
            // A microsecond above the start: the fraction divides by the difference.
            zero_after_s: fit(self.zero_after_s, fade_after_s + 1e-6, 2.0, fade_after_s + 1e-6),
            handle_kg: fit(self.handle_kg, 0.0, 100.0, safe.handle_kg),
            handle_step_m: fit(self.handle_step_m, 1e-7, 1e-3, safe.handle_step_m),
            brake_n_s_m: fit(self.brake_n_s_m, 0.0, 1e3, safe.brake_n_s_m),
            handle_n_s_m: fit(self.handle_n_s_m, 0.0, 100.0, safe.handle_n_s_m),
            dead_band_m_s: fit(self.dead_band_m_s, DEAD_BAND_M_S.min, DEAD_BAND_M_S.max, safe.dead_band_m_s),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_that_are_no_numbers_become_safe_ones() {
        let n = f64::NAN;
        let poisoned = ChainSettings {
            gain: n,
            gain_rate_per_s: n,
            ceiling_n: n,
            device_limit_n: n,
            slew_n_per_s: n,
            fade_after_s: n,
            zero_after_s: n,
            dead_band_m_s: n,
            ..ChainSettings::default()
        };
        let ChainSettings { gain, ceiling_n, device_limit_n, zero_after_s, fade_after_s, .. } = poisoned.pulled_in();
        assert!([gain, ceiling_n, device_limit_n].iter().all(|limit| limit.abs() < f64::EPSILON));
        assert!(zero_after_s > fade_after_s);
        let safe = ChainSettings::default();
        assert_eq!(safe.pulled_in(), safe);
    }

    #[test]
    fn the_energy_modes_have_the_words_that_files_use() {
        for mode in EnergyMode::ALL {
            assert_eq!(serde_json::to_value(mode).unwrap(), mode.name());
        }
    }
}
