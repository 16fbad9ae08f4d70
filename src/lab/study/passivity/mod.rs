//! Measures whether the loop gives the hand more energy than it takes: net power into the hand in four tasks, and
//! oscillation of a loose grip.
//!
//! Takes the clocks of the loop; returns a [`PassivityReport`]: one [`PassivityRow`] for every clock, mode, motion from which the leader
//! computes the force, task and delay. All gates have their defaults, except that the energy gate and the governor are
//! off, so that the result shows only the rendering.

mod present;

use std::f64::consts::TAU;

use nalgebra::Vector3;
use nima_core::{
    impedance::{Mode, OwnMotion, Recipe, SettingsError},
    safety::{ChainSettings, EnergyMode},
};
use nima_machine::runtime::{ClockProfile, VirtualClock};
use nima_simulation::scene::TissueModel;
use serde::Serialize;

use super::{
    pair::{BenchPair, LoneHandle, NOISE_N, PairGrip, PairTrial, RATE_HZ},
    release::{ReleaseError, TREMOR_M, pressed_tissue},
};

pub const DELAYS_MS: [f64; 5] = [0.0, 10.0, 50.0, 100.0, 300.0];
/// Stiffnesses of loose grips, N/m, with a damping of 5 N s/m.
pub const LOOSE_N_M: [f64; 3] = [150.0, 300.0, 600.0];
/// If a held handle moves faster than this, it counts as oscillating, m/s.
pub const STILL_M_S: f64 = 0.01;
/// Duration of a task, and time before the evaluation starts, s.
const TASK_S: f64 = 12.0;
const FROM_S: f64 = 1.5;
/// Duration of a hold with a loose grip, and of its evaluated last part, s.
const HOLD_S: f64 = 6.0;
const JUDGED_S: f64 = 1.0;
const LOOSE_N_S_M: f64 = 5.0;
/// Intended height above the tissue and depth in it, m.
const ABOVE_M: f64 = 0.004;
const DEPTH_M: f64 = 0.012;

/// Activity of the hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PassivityTask {
    /// Up and down at 1 Hz, always in contact at the deepest point.
    PalpationSlow,
    /// The same at 3 Hz.
    PalpationFast,
    /// Reach, press, drag sideways, hold, withdraw, move on.
    PegTransfer,
    /// Press, hold, and withdraw at 200 mm/s.
    Withdrawal,
}

impl PassivityTask {
    pub const ALL: [Self; 4] = [Self::PalpationSlow, Self::PalpationFast, Self::PegTransfer, Self::Withdrawal];

    /// Returns the time between two touches, s; the tip is outside the tissue at the beginning.
    const fn period_s(self) -> f64 {
        match self {
            Self::PalpationSlow => 1.0,
            Self::PalpationFast => 1.0 / 3.0,
            Self::PegTransfer => 2.15,
            Self::Withdrawal => 2.0,
        }
    }

    /// Returns the intended position of the hand (m) at this time (s).
    fn intended_m(self, t_s: f64) -> Vector3<f64> {
        let span_m = ABOVE_M + DEPTH_M;
        let way = |t_s: f64, from_s: f64, for_s: f64| smooth((t_s - from_s) / for_s);
        match self {
            Self::PalpationSlow | Self::PalpationFast => {
                Vector3::new(0.0, 0.0, ABOVE_M - span_m * 0.5 * (1.0 - (TAU * t_s / self.period_s()).cos()))
            }
            Self::PegTransfer => {
                let count = (t_s / self.period_s()).floor();
                let t_s = t_s.rem_euclid(self.period_s());
                let deep = way(t_s, 0.9, 0.45) - way(t_s, 1.7, 0.45);
                let side_m = if count.rem_euclid(2.0) < 1.0 { 0.03 } else { -0.03 };
                let across_m = side_m * (2.0 * way(t_s, 0.0, 0.9) - 1.0) + 0.004 * way(t_s, 0.9, 0.45);
                Vector3::new(across_m, 0.0, ABOVE_M - span_m * deep)
            }
            Self::Withdrawal => {
                let t_s = t_s.rem_euclid(self.period_s());
                Vector3::new(0.0, 0.0, ABOVE_M - span_m * (way(t_s, 0.2, 0.6) - linear((t_s - 1.4) * 0.2 / span_m)))
            }
        }
    }
}

/// Returns a transition from 0 to 1 with continuous speed and acceleration.
fn smooth(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (-15.0 + 6.0 * s))
}

fn linear(s: f64) -> f64 {
    s.clamp(0.0, 1.0)
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct PassivityRow {
    pub clock: ClockProfile,
    /// Rendering mode.
    pub mode: Mode,
    /// Motion from which the leader computed the force.
    pub own_motion: OwnMotion,
    /// Task of the hand.
    pub task: PassivityTask,
    /// Delay of the link, ms.
    pub delay_ms: f64,
    /// Mean power into the hand, mW: positive where the loop drives the hand.
    pub power_mw: f64,
    /// Mean error of the force, compared with the tissue's force on the tip, N.
    pub error_n: f64,
}

/// A loose grip that holds still, 12 mm deep.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct StillGrip {
    pub clock: ClockProfile,
    /// Rendering mode.
    pub mode: Mode,
    /// Motion from which the leader computed the force.
    pub own_motion: OwnMotion,
    /// Stiffness of the grip, N/m.
    pub grip_n_m: f64,
    /// Delay of the link, ms.
    pub delay_ms: f64,
    /// Maximum speed in the last second, m/s.
    pub peak_m_s: f64,
}

/// Options of the study.
#[derive(Clone, Debug)]
pub struct PassivityOptions {
    /// Clocks of the loop, in the order of the tables.
    pub clocks: Vec<VirtualClock>,
}

#[derive(Clone, Debug, Serialize)]
pub struct PassivityReport {
    pub rows: Vec<PassivityRow>,
    pub held: Vec<StillGrip>,
}

/// The modes of the study with the applicable leader motions: a reflected force does not depend on the leader's motion.
pub const WAYS: [(Mode, OwnMotion); 7] = [
    (Mode::Dfr, OwnMotion::Follower),
    (Mode::Anchored, OwnMotion::Follower),
    (Mode::Best, OwnMotion::Follower),
    (Mode::Matched, OwnMotion::Follower),
    (Mode::Matched, OwnMotion::Handle),
    (Mode::Nima, OwnMotion::Follower),
    (Mode::Nima, OwnMotion::Handle),
];

/// Runs the study; before each part `progress` is called with the number of parts done, their total, and the name of the next.
///
/// # Errors
/// [`ReleaseError`] if the scene cannot be used.
pub fn study(
    options: &PassivityOptions,
    mut progress: impl FnMut(usize, usize, &str),
) -> Result<PassivityReport, ReleaseError> {
    let tissue = pressed_tissue()?;
    let mut rows = Vec::new();
    let mut held = Vec::new();
    let all = options.clocks.len() * WAYS.len() * DELAYS_MS.len();
    let ways = WAYS.into_iter().flat_map(|way| DELAYS_MS.map(|delay_ms| (way, delay_ms)));
    let ways = options.clocks.iter().flat_map(|clock| ways.clone().map(move |way| (*clock, way)));
    for (done, (clock, (way, delay_ms))) in ways.enumerate() {
        progress(done, all, way.0.name());
        for task in PassivityTask::ALL {
            rows.push(tasked(clock, way, task, delay_ms, tissue)?);
        }
        for grip_n_m in LOOSE_N_M {
            held.push(hold(clock, way, grip_n_m, delay_ms, tissue)?);
        }
    }
    progress(all, all, "done");
    Ok(PassivityReport { rows, held })
}

fn trial(
    clock: VirtualClock,
    (mode, own_motion): (Mode, OwnMotion),
    delay_ms: f64,
    grip: PairGrip,
    tissue: TissueModel,
    tremor_m: f64,
) -> PairTrial {
    let gates = ChainSettings { static_hold: true, energy: EnergyMode::Off, ..ChainSettings::default() };
    PairTrial {
        mode,
        own_motion,
        literal: Recipe::default(),
        delay_s: 1e-3 * delay_ms,
        gates: gates.without_governor(),
        gain: 1.0,
        tissue,
        tremor_m,
        noise_n: NOISE_N,
        handle: LoneHandle::OMEGA,
        grip,
        seed: 1,
        clock,
    }
}

/// # Errors
/// [`SettingsError`] if the loop's settings are invalid.
pub fn tasked(
    clock: VirtualClock,
    way: (Mode, OwnMotion),
    task: PassivityTask,
    delay_ms: f64,
    tissue: TissueModel,
) -> Result<PassivityRow, SettingsError> {
    tasked_over(clock, way, task, delay_ms, |_| tissue)
}

/// Runs one task over a tissue that may change at every touch.
///
/// # Errors
/// [`SettingsError`] if the loop's settings are invalid.
pub fn tasked_over(
    clock: VirtualClock,
    way: (Mode, OwnMotion),
    task: PassivityTask,
    delay_ms: f64,
    tissue: impl Fn(u32) -> TissueModel,
) -> Result<PassivityRow, SettingsError> {
    let trial = trial(clock, way, delay_ms, PairGrip::FIRM, tissue(0), TREMOR_M);
    let mut pair = BenchPair::new(&trial, task.intended_m(0.0))?;
    let mut touch = 0;
    let mut energy_j = 0.0;
    let mut error_n = 0.0;
    let mut judged_s = 0.0;
    while pair.now_s() < TASK_S - 0.5 / RATE_HZ {
        let t_s = pair.now_s();
        let now = (t_s / task.period_s()) as u32;
        if now != touch {
            touch = now;
            pair.exchange_tissue(tissue(touch));
        }
        let force_n = pair.force_n();
        let position_m = pair.handle_m();
        // The hand lags by one period, as in simulations that count ticks.
        pair.step(|t_s, _| task.intended_m(t_s - 1.0 / RATE_HZ));
        if t_s >= FROM_S - 0.5 / RATE_HZ {
            let passed_s = pair.now_s() - t_s;
            energy_j += force_n.dot(&(pair.handle_m() - position_m));
            error_n += (pair.force_n() - pair.tip_n()).norm() * passed_s;
            judged_s += passed_s;
        }
    }
    let (mode, own_motion) = way;
    Ok(PassivityRow {
        clock: clock.profile,
        mode,
        own_motion,
        task,
        delay_ms,
        power_mw: 1e3 * energy_j / judged_s,
        error_n: error_n / judged_s,
    })
}

/// # Errors
/// [`SettingsError`] if the loop's settings are invalid.
pub fn hold(
    clock: VirtualClock,
    way: (Mode, OwnMotion),
    grip_n_m: f64,
    delay_ms: f64,
    tissue: TissueModel,
) -> Result<StillGrip, SettingsError> {
    let grip = PairGrip { n_m: grip_n_m, n_s_m: LOOSE_N_S_M, ..PairGrip::FIRM };
    let above_m = Vector3::new(0.0, 0.0, ABOVE_M);
    let mut pair = BenchPair::new(&trial(clock, way, delay_ms, grip, tissue, 0.0), above_m)?;
    let mut peak_m_s = 0.0_f64;
    while pair.now_s() < HOLD_S - 0.5 / RATE_HZ {
        let t_s = pair.now_s();
        pair.step(|t_s, _| above_m - Vector3::z() * (ABOVE_M + DEPTH_M) * smooth((t_s - 1.0 / RATE_HZ) / 0.6));
        if t_s >= HOLD_S - JUDGED_S - 0.5 / RATE_HZ {
            peak_m_s = peak_m_s.max(pair.handle_m_s().norm());
        }
    }
    let (mode, own_motion) = way;
    Ok(StillGrip { clock: clock.profile, mode, own_motion, grip_n_m, delay_ms, peak_m_s })
}

#[cfg(test)]
mod tests;
