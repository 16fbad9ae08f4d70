//! A released handle: a hand presses with 5 N, opens, and the handle moves alone under the force that the link still
//! delivers.
//!
//! Takes no options. Returns a [`Report`] for every mode and delay, in two situations (after holding for two seconds,
//! and while still pressing): without gates, with all gates but the release gate, and with all gates. The travel of the
//! handle is measured from the path that it would have taken without any force, so that its own momentum does not
//! count. When the release gate finds that the hand is gone, the loop rests and the device brakes. The strength of its
//! brakes is not published, so the travel is given for several viscosities of the brakes.

mod present;

use nalgebra::Vector3;
use nima_core::{
    impedance::{Mode, SettingsError},
    safety::{ChainSettings, Gate},
};
use nima_machine::config::ConfigError;
use nima_world::scene::{Scene, Tissue};
use serde::Serialize;

use super::pair::{HANDLE_KG, HANDLE_N_S_M, Pair, RATE_HZ, Trial};

/// Delays of the link, ms.
pub const DELAYS_MS: [f64; 6] = [0.0, 10.0, 50.0, 100.0, 200.0, 300.0];
/// Contact force at which the hand opens, N.
pub const CONTACT_N: f64 = 5.0;
/// Target: the force must be gone after this time, s.
pub const SOON_S: f64 = 0.020;
/// Target: a force below this counts as gone, N.
pub const AIM_N: f64 = 0.05;
/// Target: longest travel of the handle, m.
pub const AIM_M: f64 = 1e-3;
/// Viscosities of the brakes that are tried, N s/m. That of the real device is unknown; 30 is the most that chai3d
/// commands to an omega.7.
pub const BRAKES_N_S_M: [f64; 5] = [0.0, 5.0, 15.0, 30.0, 60.0];
/// Duration of the observation after the hand has opened, s.
const AFTER_S: f64 = 1.0;
/// Speed of pressing (m/s), initial height (m), time of holding (s), time limit for reaching the force (s).
const PRESS_M_S: f64 = 0.020;
const START_M: f64 = 0.005;
const HOLD_S: f64 = 2.0;
const PATIENCE_S: f64 = 20.0;
const TREMOR_M: f64 = 8e-5;
/// The modes that are let go of.
const MODES: [Mode; 4] = [Mode::Dfr, Mode::Linear, Mode::Literal, Mode::Anchored];
/// Modes with a steady force in the hand: only then can the handle's acceleration show that the hand has opened.
const STEADY: [Mode; 2] = [Mode::Dfr, Mode::Anchored];

/// Why the study could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ReleaseError {
    /// The scene with the tissue cannot be loaded.
    #[error(transparent)]
    Scene(#[from] ConfigError),
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The scene has no tissue.
    #[error("the scene peg_transfer has no [tissue]: there is nothing to press")]
    NoTissue,
    /// The contact force was never reached.
    #[error("{mode} at {delay_ms} ms: the hand did not reach {CONTACT_N} N within {PATIENCE_S} s")]
    NoContact {
        /// Mode under test.
        mode: Mode,
        /// Delay, ms.
        delay_ms: f64,
    },
}

/// Situation in which the hand opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Situation {
    /// After two seconds at about 5 N, with physiological tremor.
    Held,
    /// At the moment when 5 N are reached, while pressing at 20 mm/s.
    Pressing,
}

/// Which gates are active.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Gates {
    /// None: the requested force goes to the device unchanged.
    None,
    /// All but the release gate.
    WithoutRelease,
    /// All.
    All,
}

impl Gates {
    /// Every choice.
    pub const ALL: [Self; 3] = [Self::None, Self::WithoutRelease, Self::All];

    /// Text for tables.
    pub const fn words(self) -> &'static str {
        match self {
            Self::None => "no gates",
            Self::WithoutRelease => "without release gate",
            Self::All => "all gates",
        }
    }

    fn settings(self) -> Option<ChainSettings> {
        match self {
            Self::None => None,
            Self::WithoutRelease => Some(ChainSettings::default()),
            Self::All => Some(ChainSettings { handle_kg: HANDLE_KG, ..ChainSettings::default() }),
        }
    }
}

/// Result of one release.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Outcome {
    /// Situation in which the hand opened.
    pub situation: Situation,
    /// Active gates.
    pub gates: Gates,
    /// Mode under test.
    pub mode: Mode,
    /// Delay of the link, ms.
    pub delay_ms: f64,
    /// Force on the handle when the hand opened, N.
    pub before_n: f64,
    /// Whether the release gate had removed the force before, wrongly, while the hand was still there.
    pub closed_before: bool,
    /// Largest distance from where the handle would have been without force, mm.
    pub travel_mm: f64,
    /// The same within the first 20 ms, mm.
    pub travel_soon_mm: f64,
    /// Largest force on the handle, N.
    pub peak_n: f64,
    /// Largest force later than 20 ms, N.
    pub late_n: f64,
    /// Largest energy given to the handle, mJ.
    pub energy_mj: f64,
}

/// A release with all gates and a device that brakes.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Braked {
    /// Viscosity of the brakes, N s/m.
    pub brake_n_s_m: f64,
    /// Result.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// Options of this study: none.
#[derive(Clone, Copy, Debug)]
pub struct Options;

/// Result of this study.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// All releases without brakes.
    pub outcomes: Vec<Outcome>,
    /// Releases with brakes, for the two modes with a steady force.
    pub braked: Vec<Braked>,
}

/// Runs the study; before each part `progress` is called with the number of parts done, their total, and the name of
/// the next.
///
/// # Errors
/// [`ReleaseError`] if the scene cannot be used or the contact force is not reached.
pub fn study(mut progress: impl FnMut(usize, usize, &str)) -> Result<Report, ReleaseError> {
    let tissue = Scene::load("peg_transfer")?.tissue.ok_or(ReleaseError::NoTissue)?;
    let mut outcomes = Vec::new();
    let alone = 2 * Gates::ALL.len() * MODES.len() * DELAYS_MS.len();
    let all = alone + 2 * STEADY.len() * DELAYS_MS.len() * BRAKES_N_S_M.len();
    for situation in [Situation::Held, Situation::Pressing] {
        for gates in Gates::ALL {
            for mode in MODES {
                for delay_ms in DELAYS_MS {
                    progress(outcomes.len(), all, mode.name());
                    outcomes.push(let_go(situation, gates, mode, delay_ms, tissue)?);
                }
            }
        }
    }
    let mut braked = Vec::new();
    for situation in [Situation::Held, Situation::Pressing] {
        for mode in STEADY {
            for delay_ms in DELAYS_MS {
                for brake_n_s_m in BRAKES_N_S_M {
                    progress(alone + braked.len(), all, "brakes");
                    let outcome = tried(situation, Gates::All, mode, delay_ms, tissue, brake_n_s_m)?;
                    braked.push(Braked { brake_n_s_m, outcome });
                }
            }
        }
    }
    progress(all, all, "done");
    Ok(Report { outcomes, braked })
}

/// Simulates one release of a handle without brakes.
///
/// # Errors
/// [`ReleaseError`] if the scene cannot be used or the contact force is not reached.
pub fn let_go(
    situation: Situation,
    gates: Gates,
    mode: Mode,
    delay_ms: f64,
    tissue: Tissue,
) -> Result<Outcome, ReleaseError> {
    tried(situation, gates, mode, delay_ms, tissue, 0.0)
}

fn tried(
    situation: Situation,
    gates: Gates,
    mode: Mode,
    delay_ms: f64,
    tissue: Tissue,
    brake_n_s_m: f64,
) -> Result<Outcome, ReleaseError> {
    let trial = Trial {
        mode,
        delay_s: 1e-3 * delay_ms,
        gates: gates.settings(),
        gain: 1.0,
        tissue,
        tremor_m: TREMOR_M,
        brake_n_s_m,
        seed: 1,
    };
    let mut intended_m = Vector3::new(0.0, 0.0, START_M);
    let mut pair = Pair::new(&trial, intended_m)?;
    let mut patience = (PATIENCE_S * RATE_HZ) as u32;
    while pair.tip_n().z < CONTACT_N {
        patience = patience.checked_sub(1).ok_or(ReleaseError::NoContact { mode, delay_ms })?;
        intended_m.z -= PRESS_M_S / RATE_HZ;
        pair.step(&intended_m);
    }
    if situation == Situation::Held {
        for _ in 0..(HOLD_S * RATE_HZ) as u32 {
            // A person who holds 5 N corrects slowly: 2 mm/s per newton of error.
            intended_m.z += 0.002 / RATE_HZ * (pair.tip_n().z - CONTACT_N).clamp(-1.0, 1.0);
            pair.step(&intended_m);
        }
    }
    let start = Outcome {
        situation,
        gates,
        mode,
        delay_ms,
        before_n: pair.force_n().norm(),
        closed_before: pair.report().acted(Gate::Release),
        travel_mm: 0.0,
        travel_soon_mm: 0.0,
        peak_n: 0.0,
        late_n: 0.0,
        energy_mj: 0.0,
    };
    Ok(watch(pair, &intended_m, start, brake_n_s_m > 0.0))
}

/// Opens the hand and observes the handle. A braked handle loses its momentum, so its travel is measured from where it
/// was released.
fn watch(mut pair: Pair, intended_m: &Vector3<f64>, mut outcome: Outcome, braked: bool) -> Outcome {
    let (from_m, swing_m_s) = (pair.handle_m(), pair.handle_m_s());
    let from_m_s = if braked { Vector3::zeros() } else { swing_m_s };
    let swing_s = HANDLE_KG / HANDLE_N_S_M;
    let mut energy_j = 0.0;
    pair.let_go();
    for tick in 1..=(AFTER_S * RATE_HZ) as u32 {
        let (held_n, at_m) = (pair.force_n(), pair.handle_m());
        pair.step(intended_m);
        let t_s = f64::from(tick) / RATE_HZ;
        let alone_m = from_m + from_m_s * (swing_s * (1.0 - (-t_s / swing_s).exp()));
        let travel_mm = 1e3 * (pair.handle_m() - alone_m).norm();
        energy_j += held_n.dot(&(pair.handle_m() - at_m));
        let force_n = pair.force_n().norm();
        outcome.travel_mm = outcome.travel_mm.max(travel_mm);
        outcome.peak_n = outcome.peak_n.max(held_n.norm());
        outcome.energy_mj = outcome.energy_mj.max(1e3 * energy_j);
        if t_s <= SOON_S {
            outcome.travel_soon_mm = outcome.travel_soon_mm.max(travel_mm);
        } else {
            outcome.late_n = outcome.late_n.max(force_n);
        }
    }
    outcome
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(gates: Gates, mode: Mode, delay_ms: f64) -> Outcome {
        let tissue = Scene::load("peg_transfer").unwrap().tissue.unwrap();
        let_go(Situation::Held, gates, mode, delay_ms, tissue).unwrap()
    }

    #[test]
    fn late_reflection_kicks_and_the_gates_take_the_kick_away() {
        let [bare, energy, all] = Gates::ALL.map(|gates| held(gates, Mode::Dfr, 300.0));
        assert!(bare.travel_mm > 500.0 && bare.energy_mj > 1000.0, "{bare:?}");
        assert!(energy.energy_mj < 0.05 * bare.energy_mj, "{energy:?}");
        assert!(!all.closed_before && all.before_n > 3.5, "{all:?}");
        assert!(all.energy_mj < 0.1 * energy.energy_mj && all.travel_soon_mm < 0.7 * energy.travel_soon_mm, "{all:?}");
    }

    #[test]
    fn a_hand_that_is_gone_gets_no_force_any_more_and_brakes_shorten_the_way() {
        let tissue = Scene::load("peg_transfer").unwrap().tissue.unwrap();
        for (situation, mode) in [(Situation::Held, Mode::Dfr), (Situation::Pressing, Mode::Anchored)] {
            let [free, braked] =
                [0.0, 60.0].map(|brake| tried(situation, Gates::All, mode, 100.0, tissue, brake).unwrap());
            assert!(free.late_n < 1e-12 && braked.late_n < 1e-12, "{free:?}");
            assert!(
                !free.closed_before && free.before_n > 3.5 && braked.travel_mm < 0.1 * free.travel_mm,
                "{braked:?}"
            );
        }
    }

    #[test]
    fn without_a_delay_anchored_is_reflection() {
        let [anchored, dfr] = [Mode::Anchored, Mode::Dfr].map(|mode| held(Gates::None, mode, 0.0));
        assert!((anchored.travel_mm - dfr.travel_mm).abs() < 1e-9 && dfr.travel_mm > 1.0, "{anchored:?}");
    }
}
