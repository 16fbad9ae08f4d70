//! Limits and knobs of a chain, and their safe values.

use super::{Handle, MAX_GAIN};

/// What the energy gate does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EnergyMode {
    /// Nothing.
    Off,
    /// Counts the energy, takes nothing away.
    Observe,
    /// Takes away what would give the hand more than it gave.
    #[default]
    Control,
}

impl EnergyMode {
    /// Every mode.
    pub const ALL: [Self; 3] = [Self::Off, Self::Observe, Self::Control];

    /// The word in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Observe => "observe",
            Self::Control => "control",
        }
    }
}

/// Limits and knobs of the chain. Defaults are the project's safe values. A chain of torques reads Nm for N and rad/s for m/s.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChainSettings {
    /// Feedback gain, 0 to 1 (a chain starts at 1 at most; above 1 it goes by [`Chain::set_gain_above_one`](super::Chain)).
    pub gain: f64,
    /// Fastest change of the gain, 1/s: a slider jump becomes a ramp.
    pub gain_rate_per_s: f64,
    /// Largest force that ever reaches the hand, N (norm of the vector).
    pub ceiling_n: f64,
    /// What the device itself can give, N; the ceiling is never above it.
    pub device_limit_n: f64,
    /// Fastest change of the force, N/s.
    pub slew_n_per_s: f64,
    /// Age beyond the link's own delay at which the force begins to fade, s.
    pub fade_after_s: f64,
    /// Age beyond the link's own delay at which it is zero, s.
    pub zero_after_s: f64,
    /// Speed below which nothing is rendered, m/s.
    pub dead_band_m_s: f64,
    /// Keep the force at standstill instead of fading it in the dead band.
    pub static_hold: bool,
    /// What the energy gate does.
    pub energy: EnergyMode,
    /// Apparent mass of the handle alone, kg, by which the governor tells a handle that nobody holds; 0: not known, then it passes
    /// everything.
    pub handle_kg: f64,
    /// What the handle's bearings and cables brake, N s/m.
    pub handle_n_s_m: f64,
    /// Step of the handle's reading, m: what the hand's speed is told from.
    pub handle_step_m: f64,
    /// Most viscous damping that the device can make of its force without shaking, N s/m: the governor's brake.
    pub brake_n_s_m: f64,
}

impl Default for ChainSettings {
    fn default() -> Self {
        Self {
            gain: 1.0,
            gain_rate_per_s: 2.0,
            ceiling_n: 4.0,
            // An omega.7 gives 12 N.
            device_limit_n: 12.0,
            // 5 N within 10 ms: faster than a hand can feel as a ramp, slow enough that one bad sample moves 0.5 N.
            slew_n_per_s: 500.0,
            fade_after_s: 0.005,
            zero_after_s: 0.020,
            dead_band_m_s: 1e-3,
            static_hold: false,
            energy: EnergyMode::default(),
            // An omega.7 at its grip.
            handle_kg: 0.25,
            handle_n_s_m: 0.5,
            // Of an omega.7, and of the simulated handles.
            handle_step_m: 1e-5,
            // The most that chai3d asks of an omega.7.
            brake_n_s_m: 30.0,
        }
    }
}

impl ChainSettings {
    /// For the force of a gripper (N between the fingers; an omega.7 gives 8 N): the same gates, but what is held is felt.
    pub fn gripper() -> Self {
        Self { device_limit_n: 8.0, static_hold: true, ..Self::default() }.without_governor()
    }

    /// For a torque on the handle (Nm, rad/s; a sigma.7 gives 0.4 Nm, an omega.7 none: then the limit is 0).
    pub fn torque(device_limit_nm: f64) -> Self {
        Self {
            ceiling_n: 0.1,
            device_limit_n: device_limit_nm,
            slew_n_per_s: 12.5,
            dead_band_m_s: 0.02,
            // The allowance of the energy gate is one of forces; a torque's energy is a hundredth of it.
            energy: EnergyMode::Observe,
            ..Self::default()
        }
        .without_governor()
    }

    /// The same for what has no handle of known mass. A gripper: what its finger weighs is told nowhere, and one that is let go opens
    /// to its stop, which is how it rests. A torque: so it is with the wrist's inertia.
    #[must_use]
    pub fn without_governor(self) -> Self {
        Self { handle_kg: 0.0, ..self }
    }

    /// The handle that the governor observes.
    pub(super) const fn handle(&self) -> Handle {
        Handle {
            mass_kg: self.handle_kg,
            damping_n_s_m: self.handle_n_s_m,
            brake_n_s_m: self.brake_n_s_m,
            step_m: self.handle_step_m,
        }
    }

    /// Every value within its range; one that is not a number takes its safe value.
    #[must_use]
    pub(super) fn pulled_in(self) -> Self {
        let safe = Self::default();
        let fit = |value: f64, least: f64, most: f64, safe: f64| {
            if value.is_nan() { safe } else { value.clamp(least, most) }
        };
        let fade_after_s = fit(self.fade_after_s, 0.0, 1.0, safe.fade_after_s);
        Self {
            gain: fit(self.gain, 0.0, MAX_GAIN, 0.0),
            gain_rate_per_s: fit(self.gain_rate_per_s, 0.0, 1e3, safe.gain_rate_per_s),
            ceiling_n: fit(self.ceiling_n, 0.0, 1e3, 0.0),
            device_limit_n: fit(self.device_limit_n, 0.0, 1e3, 0.0),
            slew_n_per_s: fit(self.slew_n_per_s, 0.0, 1e9, safe.slew_n_per_s),
            fade_after_s,
            zero_after_s: fit(self.zero_after_s, fade_after_s + 1e-6, 2.0, fade_after_s + 1e-6),
            handle_kg: fit(self.handle_kg, 0.0, 100.0, safe.handle_kg),
            handle_step_m: fit(self.handle_step_m, 1e-7, 1e-3, safe.handle_step_m),
            brake_n_s_m: fit(self.brake_n_s_m, 0.0, 1e3, safe.brake_n_s_m),
            handle_n_s_m: fit(self.handle_n_s_m, 0.0, 100.0, safe.handle_n_s_m),
            dead_band_m_s: fit(self.dead_band_m_s, 0.0, DEAD_BAND_MAX_M_S, safe.dead_band_m_s),
            ..self
        }
    }
}

/// Widest dead band that can be chosen, m/s.
pub const DEAD_BAND_MAX_M_S: f64 = 0.1;

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
