//! Release: a hand presses the tissue with up to 5 N and opens, and the released handle is exposed to the force that
//! the link still delivers.
//!
//! Takes the clocks of the loop; returns a [`ReleaseReport`]: one [`ReleaseRow`] for every clock, mode and baseline, delay, force and
//! situation (after holding for two seconds, and while still pressing), with and without the governor, with all other
//! gates at their defaults; and, with the governor, the worst case over handles that differ from the assumed one, and
//! over the viscosity of its brake.

mod grid;
mod present;

use nalgebra::Vector3;
use nima_core::{
    impedance::{Mode, OwnMotion, Recipe, SettingsError},
    safety::ChainSettings,
};
use nima_machine::{
    config::ConfigError,
    runtime::{ClockProfile, VirtualClock},
};
use nima_simulation::scene::{Scene, TissueModel};
use serde::Serialize;

use super::pair::{BenchPair, LoneHandle, NOISE_N, PairGrip, PairTrial, RATE_HZ};

pub const DELAYS_MS: [f64; 6] = [0.0, 10.0, 50.0, 100.0, 200.0, 300.0];
/// Contact forces at the release, N: the strongest one, and weak ones.
pub const CONTACTS_N: [f64; 4] = [5.0, 2.0, 1.0, 0.5];
/// Up to this contact force a release counts as weak, N.
pub const WEAK_N: f64 = 2.0;
/// Targets: travel (mm; of weak releases), speed (m/s), energy (mJ), and force 100 ms later (N).
pub const AIM_MM: f64 = 2.0;
/// Travel of weak releases, mm.
pub const WEAK_AIM_MM: f64 = 25.0;
pub const AIM_M_S: f64 = 0.12;
pub const AIM_MJ: f64 = 2.0;
/// Force later than 100 ms, N: the brake's response to the quantisation of the reading at rest, near the handle's own
/// friction.
pub const AIM_N: f64 = 0.2;
/// Tested brakes, N s/m. The brake of a real device is unknown; 30 is the maximum that chai3d commands on an omega.7.
pub const BRAKES_N_S_M: [f64; 3] = [5.0, 15.0, 30.0];
/// Tested handles, by mass (kg) and Coulomb friction (N).
const HANDLES: [(f64, f64); 6] = [(0.20, 0.0), (0.20, 0.15), (0.25, 0.0), (0.25, 0.15), (0.31, 0.0), (0.31, 0.15)];
/// Observation time after the hand has opened, and time after which there must be no force, s.
const AFTER_S: f64 = 1.0;
const LATE_S: f64 = 0.1;
/// Speed of pressing (m/s), height at the start (m), time of holding and its last part (s), timeout (s).
const PRESS_M_S: f64 = 0.020;
const START_M: f64 = 0.005;
const HOLD_S: f64 = 2.0;
const SHAKE_S: f64 = 0.3;
const PATIENCE_S: f64 = 20.0;
pub(super) const TREMOR_M: f64 = 8e-5;
/// Number of modes: the program's own, and the baselines.
const METHODS: usize = Mode::ALL.len() + Mode::BASELINES.len();
/// Modes with a steady force in the hand, for which the worst cases are computed.
const STEADY: [Mode; 2] = [Mode::Dfr, Mode::Anchored];

/// Why the study could not run.
#[derive(Debug, thiserror::Error)]
pub enum ReleaseError {
    /// The scene with the tissue cannot be loaded.
    #[error(transparent)]
    Scene(#[from] ConfigError),
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The scene has no tissue.
    #[error("the scene peg_transfer has no [tissue]: there is nothing to press; add it")]
    NoTissue,
    #[error("{mode} at {delay_ms} ms: the hand did not reach {contact_n} N within {PATIENCE_S} s")]
    NoContact {
        mode: Mode,
        delay_ms: f64,
        /// Force to be reached, N.
        contact_n: f64,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ReleaseSituation {
    /// After two seconds at about the contact force, with the hand's tremor.
    Held,
    /// While pressing at 20 mm/s, when the contact force is reached.
    Pressing,
}

impl ReleaseSituation {
    pub const ALL: [Self; 2] = [Self::Held, Self::Pressing];
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct ReleaseRow {
    pub clock: ClockProfile,
    /// Rendering mode.
    pub mode: Mode,
    /// Delay of the link, ms.
    pub delay_ms: f64,
    /// Whether the governor was on.
    pub governor: bool,
    /// When the hand opened.
    pub situation: ReleaseSituation,
    /// Force of the tissue at that time, N.
    pub contact_n: f64,
    /// Force on the handle at that time, N.
    pub before_n: f64,
    /// Maximum speed of a held handle in the last 0.3 s, m/s; 0 while it was pressing.
    pub shake_m_s: f64,
    /// Whether the governor withheld force at that moment although the hand held the handle.
    pub closed_before: bool,
    /// Maximum distance from the point of release, or from where the handle would have swung without the loop,
    /// whichever is smaller, mm.
    pub travel_mm: f64,
    /// Maximum speed, m/s.
    pub peak_m_s: f64,
    /// Maximum energy given to the handle, mJ.
    pub energy_mj: f64,
    /// Maximum force on the handle later than 100 ms, N.
    pub force_after_100_ms_n: f64,
}

impl ReleaseRow {
    /// Returns whether the held force was large enough to be evaluated, by the governor's criterion.
    pub fn counts(&self) -> bool {
        self.before_n > 0.5 * self.contact_n.min(4.0) && !self.closed_before
    }

    pub fn meets_the_aims(&self) -> bool {
        let weak = self.contact_n <= WEAK_N;
        self.travel_mm <= if weak { WEAK_AIM_MM } else { AIM_MM }
            && self.peak_m_s <= AIM_M_S
            && self.energy_mj <= AIM_MJ
            && (weak || self.force_after_100_ms_n <= AIM_N)
    }
}

/// Worst case over delays, situations and steady modes with one handle and one brake, the governor on.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Worst {
    pub clock: ClockProfile,
    /// Force of the contact, N.
    pub contact_n: f64,
    /// Viscosity of the governor's brake, N s/m.
    pub brake_n_s_m: f64,
    /// True mass of the handle, kg; the governor assumes 0.25.
    pub handle_kg: f64,
    /// Coulomb friction, N.
    pub coulomb_n: f64,
    pub travel_mm: f64,
    pub peak_m_s: f64,
    pub energy_mj: f64,
    /// Force later than 100 ms, N.
    pub force_after_100_ms_n: f64,
}

/// Options of the study.
#[derive(Clone, Debug)]
pub struct ReleaseOptions {
    /// Clocks of the loop, in the order of the tables.
    pub clocks: Vec<VirtualClock>,
}

#[derive(Clone, Debug, Default, Serialize)]
pub struct ReleaseReport {
    /// Every release of a handle with the mass that the governor assumes.
    pub rows: Vec<ReleaseRow>,
    /// Other handles and brakes.
    pub worst: Vec<Worst>,
}

#[derive(Clone, Copy, Debug)]
pub struct ReleaseStyle {
    pub clock: VirtualClock,
    pub situation: ReleaseSituation,
    pub governor: bool,
    /// Rendering mode.
    pub mode: Mode,
    /// Delay, ms.
    pub delay_ms: f64,
    /// Force of the contact, N.
    pub contact_n: f64,
}

/// Returns every mode, the program's own first.
fn methods() -> impl Iterator<Item = Mode> {
    nima_baselines::provide();
    Mode::ALL.into_iter().chain(Mode::BASELINES)
}

/// Returns the tissue of the studies with a hand: the one of the peg transfer.
pub(super) fn pressed_tissue() -> Result<TissueModel, ReleaseError> {
    Scene::load("peg_transfer")?.tissue.ok_or(ReleaseError::NoTissue)
}

fn worst_of(
    clock: VirtualClock,
    contact_n: f64,
    brake_n_s_m: f64,
    handle: &LoneHandle,
    tissue: TissueModel,
) -> Result<Worst, ReleaseError> {
    let gates = ChainSettings { brake_n_s_m, ..ChainSettings::default() };
    let mut worst = Worst {
        clock: clock.profile,
        contact_n,
        brake_n_s_m,
        handle_kg: handle.kg,
        coulomb_n: handle.coulomb_n,
        travel_mm: 0.0,
        peak_m_s: 0.0,
        energy_mj: 0.0,
        force_after_100_ms_n: 0.0,
    };
    for situation in ReleaseSituation::ALL {
        for mode in STEADY {
            for delay_ms in DELAYS_MS {
                let way = ReleaseStyle { clock, situation, governor: true, mode, delay_ms, contact_n };
                let row = tried(&way, gates, handle, tissue)?;
                worst.travel_mm = worst.travel_mm.max(row.travel_mm);
                worst.peak_m_s = worst.peak_m_s.max(row.peak_m_s);
                worst.energy_mj = worst.energy_mj.max(row.energy_mj);
                worst.force_after_100_ms_n = worst.force_after_100_ms_n.max(row.force_after_100_ms_n);
            }
        }
    }
    Ok(worst)
}

/// Simulates one release of a handle with the mass that the governor assumes.
pub fn let_go(way: &ReleaseStyle, tissue: TissueModel) -> Result<ReleaseRow, ReleaseError> {
    let gates = ChainSettings::default();
    let gates = if way.governor { gates } else { gates.without_governor() };
    tried(way, gates, &LoneHandle::OMEGA, tissue)
}

fn tried(
    way: &ReleaseStyle,
    gates: ChainSettings,
    handle: &LoneHandle,
    tissue: TissueModel,
) -> Result<ReleaseRow, ReleaseError> {
    let ReleaseStyle { clock, situation, mode, delay_ms, contact_n, .. } = *way;
    let trial = PairTrial {
        mode,
        own_motion: OwnMotion::Follower,
        literal: Recipe::default(),
        delay_s: 1e-3 * delay_ms,
        gates,
        gain: 1.0,
        tissue,
        tremor_m: TREMOR_M,
        noise_n: NOISE_N,
        handle: *handle,
        grip: PairGrip::FIRM,
        seed: 1,
        clock,
    };
    release(&trial, situation, contact_n)
}

/// Returns a hand presses as set by this trial, and opens.
pub(super) fn release(
    trial: &PairTrial,
    situation: ReleaseSituation,
    contact_n: f64,
) -> Result<ReleaseRow, ReleaseError> {
    let mode = trial.mode;
    let delay_ms = 1e3 * trial.delay_s;
    let mut intended_m = Vector3::new(0.0, 0.0, START_M);
    let mut pair = BenchPair::new(trial, intended_m)?;
    while pair.tip_n().z < contact_n {
        if pair.now_s() > PATIENCE_S {
            return Err(ReleaseError::NoContact { mode, delay_ms, contact_n });
        }
        pair.step(|_, passed_s| {
            intended_m.z -= PRESS_M_S * passed_s;
            intended_m
        });
    }
    let mut shake_m_s = 0.0_f64;
    if situation == ReleaseSituation::Held {
        let end_s = pair.now_s() + HOLD_S - 0.5 / RATE_HZ;
        let judged_s = end_s - SHAKE_S + 1.0 / RATE_HZ;
        while pair.now_s() < end_s {
            // A person who holds a force corrects slowly: 2 mm/s per newton of error.
            let corrects_m_s = 0.002 * (pair.tip_n().z - contact_n).clamp(-1.0, 1.0);
            pair.step(|_, passed_s| {
                intended_m.z += corrects_m_s * passed_s;
                intended_m
            });
            if pair.now_s() > judged_s {
                shake_m_s = shake_m_s.max(pair.handle_m_s().norm());
            }
        }
    }
    let start = ReleaseRow {
        clock: trial.clock.profile,
        mode,
        delay_ms,
        governor: trial.gates.handle_kg > 0.0,
        situation,
        contact_n,
        before_n: pair.force_n().norm(),
        shake_m_s,
        closed_before: pair.report().governed > 0.0,
        travel_mm: 0.0,
        peak_m_s: 0.0,
        energy_mj: 0.0,
        force_after_100_ms_n: 0.0,
    };
    Ok(watch(pair, &intended_m, &trial.handle, start))
}

/// Opens the hand and observes the handle.
fn watch(mut pair: BenchPair, intended_m: &Vector3<f64>, handle: &LoneHandle, mut row: ReleaseRow) -> ReleaseRow {
    let from_m = pair.handle_m();
    let swing_m_s = pair.handle_m_s();
    let swing_s = handle.kg / handle.n_s_m;
    let mut energy_j = 0.0;
    let mut travel_m = 0.0_f64;
    let mut beyond_swing_m = 0.0_f64;
    pair.let_go();
    let from_s = pair.now_s();
    let mut t_s = 0.0;
    while t_s < AFTER_S - 0.5 / RATE_HZ {
        let held_n = pair.force_n();
        let position_m = pair.handle_m();
        pair.step(|_, _| *intended_m);
        t_s = pair.now_s() - from_s;
        let moved_m = pair.handle_m() - from_m;
        let swing_m = swing_m_s * (swing_s * (1.0 - (-t_s / swing_s).exp()));
        travel_m = travel_m.max(moved_m.norm());
        beyond_swing_m = beyond_swing_m.max((moved_m - swing_m).norm());
        energy_j += held_n.dot(&(pair.handle_m() - position_m));
        row.peak_m_s = row.peak_m_s.max(pair.handle_m_s().norm());
        row.energy_mj = row.energy_mj.max(1e3 * energy_j);
        if t_s > LATE_S + 0.5 / RATE_HZ {
            row.force_after_100_ms_n = row.force_after_100_ms_n.max(pair.force_n().norm());
        }
    }
    row.travel_mm = 1e3 * travel_m.min(beyond_swing_m);
    row
}

#[cfg(test)]
mod tests;
