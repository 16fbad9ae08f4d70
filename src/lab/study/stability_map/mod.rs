//! Gains, delays and tissue stiffnesses for which the loop is stable together with a gripping hand: simulated once,
//! stored in a file, and used to mark the range of the gain slider.
//!
//! One trial: a hand presses on elastic tissue until about 1.2 N, is displaced 3 mm sideways for a moment, and then
//! holds still. Five seconds later it must be at rest. The force is kept at standstill and the energy gate is off,
//! which is less stable than the default settings, so the map is conservative. Slew limit and force limit (4 N) act, so
//! an unstable loop shows as a limit cycle.
//!
//! [`StabilityMap::committed`] reads `assets/stability_map.csv` (`mode,delay_ms,stiffness_n_m` and one letter for each
//! gain: S, M, U). Between grid points the result is the worst of the neighbouring points; outside the grid the nearest
//! edge counts.

#[cfg(test)]
mod tests;

use std::{fmt::Write as _, sync::OnceLock};

use nalgebra::Vector3;
use nima_core::{
    impedance::{Mode, OwnMotion, Recipe, SettingsError},
    safety::{ChainSettings, EnergyMode},
};
use nima_machine::runtime::VirtualClock;
use nima_simulation::scene::TissueModel;
use serde::{Serialize, Serializer};

use crate::{
    Experiment, Findings,
    pair::{BenchPair, LoneHandle, NOISE_N, PairGrip, PairTrial, RATE_HZ},
};

pub const GAINS: [f64; 8] = [0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0];
pub const DELAYS_S: [f64; 8] = [0.0, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3];
/// Tissue stiffnesses of the map, N/m: from fat to a stiff wall.
pub const STIFFNESSES_N_M: [f64; 8] = [12.0, 50.0, 100.0, 200.0, 400.0, 800.0, 2000.0, 6000.0];
/// Modes, in the order of the map.
const MODES: [Mode; 7] =
    [Mode::Literal, Mode::Linear, Mode::Dfr, Mode::Anchored, Mode::Matched, Mode::Nima, Mode::Best];
const POINTS: usize = MODES.len() * DELAYS_S.len() * STIFFNESSES_N_M.len() * GAINS.len();
/// Contact force, N, without the force rendered by the loop.
const CONTACT_N: f64 = 1.2;
/// A hand whose motion is smaller than this, peak to peak, is at rest, m.
const STILL_M: f64 = 1e-4;
const SHAKING_M: f64 = 5e-4;
/// Duration of a trial, of its approach and of the final part that is judged, s; time and distance of the sideways
/// displacement.
const TRIAL_S: f64 = 6.5;
const APPROACH_S: f64 = 0.5;
const JUDGED_S: f64 = 1.0;
const KNOCK_S: [f64; 2] = [1.0, 1.1];
const KNOCK_M: f64 = 3e-3;

#[derive(Clone, Copy, Debug)]
pub struct StabilityMapOptions;

/// Behaviour of the loop at one point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StabilityMapVerdict {
    /// The hand comes to rest.
    Stable,
    /// A motion of 0.1 to 0.5 mm remains.
    Marginal,
    /// A motion of more than 0.5 mm remains.
    Unstable,
}

impl StabilityMapVerdict {
    const fn letter(self) -> char {
        match self {
            Self::Stable => 'S',
            Self::Marginal => 'M',
            Self::Unstable => 'U',
        }
    }

    const fn of_letter(letter: char) -> Option<Self> {
        match letter {
            'S' => Some(Self::Stable),
            'M' => Some(Self::Marginal),
            'U' => Some(Self::Unstable),
            _ => None,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "line {line} of the stability map does not consist of \"{expected}\" and eight letters S, M or U; create the map again with nima study stability-map"
)]
pub struct MapError {
    /// Line number, from 1.
    pub line: usize,
    /// Expected beginning of the line.
    pub expected: String,
}

/// Verdicts by mode, delay, stiffness and gain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StabilityMap {
    verdicts: Vec<StabilityMapVerdict>,
}

const fn index(mode: usize, delay: usize, stiffness: usize, gain: usize) -> usize {
    ((mode * DELAYS_S.len() + delay) * STIFFNESSES_N_M.len() + stiffness) * GAINS.len() + gain
}

/// Returns the indices of the points of `grid` (rising) on both sides of `value`; the last index twice if `value` is
/// beyond the end or NaN.
fn around(grid: &[f64], value: f64) -> [usize; 2] {
    let last = grid.len() - 1;
    let above = grid.iter().position(|point| value <= point * (1.0 + 1e-9)).unwrap_or(last);
    let on_it = (grid[above] - value).abs() <= 1e-9 * grid[above].max(1e-3);
    [if on_it || value > grid[last] { above } else { above.saturating_sub(1) }, above]
}

impl StabilityMap {
    /// Returns the map built into the program; `None` if its file is damaged (a test checks it).
    pub fn committed() -> Option<&'static Self> {
        static MAP: OnceLock<Option<StabilityMap>> = OnceLock::new();
        MAP.get_or_init(|| Self::parse(include_str!("../../../../assets/stability_map.csv")).ok()).as_ref()
    }

    /// Parses the format of [`StabilityMap::csv`].
    ///
    /// # Errors
    /// [`MapError`] for the first malformed line.
    pub fn parse(text: &str) -> Result<Self, MapError> {
        let mut lines = text.lines().enumerate().skip(1);
        let mut verdicts = Vec::with_capacity(POINTS);
        for row in rows() {
            let (at, line) = lines.next().unwrap_or((verdicts.len() / GAINS.len() + 1, ""));
            let wrong = || MapError { line: at + 1, expected: row.clone() };
            let letters = line.strip_prefix(&row).ok_or_else(wrong)?.trim_end();
            let found: Option<Vec<StabilityMapVerdict>> = letters.chars().map(StabilityMapVerdict::of_letter).collect();
            verdicts.extend(found.filter(|found| found.len() == GAINS.len()).ok_or_else(wrong)?);
        }
        Ok(Self { verdicts })
    }

    /// Returns the map as CSV, the format of `assets/stability_map.csv`.
    pub fn csv(&self) -> String {
        let mut text = "mode,delay_ms,stiffness_n_m,gain 0.25 0.5 0.75 1 1.5 2 2.5 3\n".to_owned();
        for (row, verdicts) in rows().zip(self.verdicts.chunks(GAINS.len())) {
            let letters: String = verdicts.iter().map(|verdict| verdict.letter()).collect();
            // Writing into a String cannot fail.
            writeln!(text, "{row}{letters}").ok();
        }
        text
    }

    /// Simulates the map, which takes minutes; `progress` is called with the number of points done and their total.
    ///
    /// # Errors
    /// [`SettingsError`] if the loop's settings are invalid.
    pub fn simulate(mut progress: impl FnMut(usize, usize, &str)) -> Result<Self, SettingsError> {
        let mut verdicts = Vec::with_capacity(POINTS);
        for mode in MODES {
            for delay_s in DELAYS_S {
                for stiffness_n_m in STIFFNESSES_N_M {
                    progress(verdicts.len(), POINTS, mode.name());
                    for gain in GAINS {
                        verdicts.push(trial(mode, gain, delay_s, stiffness_n_m)?);
                    }
                }
            }
        }
        progress(POINTS, POINTS, "done");
        Ok(Self { verdicts })
    }

    /// Returns whether this mode was simulated for the map.
    pub fn has(mode: Mode) -> bool {
        MODES.contains(&mode)
    }

    /// Returns the worst verdict of the grid points around this point. A gain of zero is stable; a value beyond the
    /// grid, or NaN, counts as the grid's last. A mode that is not in the map counts as unstable.
    pub fn at(&self, mode: Mode, gain: f64, delay_s: f64, stiffness_n_m: f64) -> StabilityMapVerdict {
        if gain <= 0.0 {
            return StabilityMapVerdict::Stable;
        }
        let gains = around(&GAINS, gain);
        let delays = around(&DELAYS_S, delay_s);
        let Some(mode) = MODES.iter().position(|mapped| *mapped == mode) else { return StabilityMapVerdict::Unstable };
        let mut worst = StabilityMapVerdict::Stable;
        for delay in delays {
            for stiffness in around(&STIFFNESSES_N_M, stiffness_n_m) {
                for gain in gains {
                    worst = worst.max(self.verdicts[index(mode, delay, stiffness, gain)]);
                }
            }
        }
        worst
    }

    /// Returns the largest gain of the grid up to which all gains are stable at this delay (s) and stiffness (N/m); 0
    /// if there is none.
    ///
    /// ```
    /// use nima_core::impedance::Mode;
    /// use nima_study::stability_map::{StabilityMap, StabilityMapVerdict};
    ///
    /// let map = StabilityMap::committed().expect("the map is part of the program");
    /// let greatest = |delay_s: f64| map.greatest_stable_gain(Mode::Anchored, delay_s, 200.0);
    /// assert!(greatest(0.3) <= greatest(0.0), "a delay never helps");
    /// assert_eq!(map.at(Mode::Anchored, greatest(0.0), 0.0, 200.0), StabilityMapVerdict::Stable);
    /// ```
    pub fn greatest_stable_gain(&self, mode: Mode, delay_s: f64, stiffness_n_m: f64) -> f64 {
        let stable = |gain: &&f64| self.at(mode, **gain, delay_s, stiffness_n_m) == StabilityMapVerdict::Stable;
        GAINS.iter().take_while(stable).last().copied().unwrap_or(0.0)
    }
}

impl Experiment for StabilityMapOptions {
    const NAME: &'static str = "stability_map";
    const FILES: &'static [&'static str] = &[".csv", ".md"];
    type Findings = StabilityMap;
    type Error = SettingsError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<StabilityMap, SettingsError> {
        StabilityMap::simulate(progress)
    }
}

impl Findings for StabilityMap {
    /// Returns a Markdown table of the largest stable gain by delay and stiffness, for every mode.
    fn text(&self) -> String {
        let mut text = String::new();
        for mode in MODES.into_iter().rev() {
            let stiffnesses = STIFFNESSES_N_M.map(|n_m| format!(" {n_m:.0} N/m |")).concat();
            writeln!(
                text,
                "{mode}, greatest stable gain:\n\n| delay (ms) |{stiffnesses}\n|---|{}",
                "---|".repeat(STIFFNESSES_N_M.len())
            )
            .ok();
            for delay_s in DELAYS_S {
                let gains =
                    STIFFNESSES_N_M.map(|n_m| format!(" {} |", self.greatest_stable_gain(mode, delay_s, n_m))).concat();
                writeln!(text, "| {:.0} |{gains}", 1e3 * delay_s).ok();
            }
            text.push('\n');
        }
        text
    }

    fn files(&self) -> Vec<(String, String)> {
        vec![(".csv".to_owned(), self.csv()), (".md".to_owned(), self.text())]
    }
}

impl Serialize for StabilityMap {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct StabilityMapPoint {
            mode: Mode,
            delay_s: f64,
            stiffness_n_m: f64,
            /// Verdicts, in the order of the gains.
            verdicts: [StabilityMapVerdict; GAINS.len()],
        }
        #[derive(Serialize)]
        struct StabilityMapMap {
            gains: [f64; GAINS.len()],
            points: Vec<StabilityMapPoint>,
        }
        let points = points().zip(self.verdicts.as_chunks().0);
        let points = points.map(|((mode, delay_s, stiffness_n_m), verdicts)| StabilityMapPoint {
            mode,
            delay_s,
            stiffness_n_m,
            verdicts: *verdicts,
        });
        StabilityMapMap { gains: GAINS, points: points.collect() }.serialize(serializer)
    }
}

/// Returns the points in the order of the verdicts: mode, delay (s), stiffness (N/m).
fn points() -> impl Iterator<Item = (Mode, f64, f64)> {
    MODES.into_iter().flat_map(|mode| {
        DELAYS_S.into_iter().flat_map(move |delay_s| STIFFNESSES_N_M.into_iter().map(move |n_m| (mode, delay_s, n_m)))
    })
}

fn rows() -> impl Iterator<Item = String> {
    points().map(|(mode, delay_s, n_m)| format!("{mode},{:.0},{n_m:.0},", 1e3 * delay_s))
}

/// Simulates one trial and judges whether the gripping hand comes to rest.
///
/// # Errors
/// [`SettingsError`] if the loop's settings are invalid.
pub fn trial(mode: Mode, gain: f64, delay_s: f64, stiffness_n_m: f64) -> Result<StabilityMapVerdict, SettingsError> {
    let tissue = TissueModel {
        surface_z_m: 0.0,
        size_m: [1.0, 1.0],
        stiffness: stiffness_n_m,
        exponent: 1.0,
        damping_s_m: 0.0,
        friction: 0.0,
        shear_stiffness_n_m: 0.0,
    };
    let gates =
        ChainSettings { static_hold: true, energy: EnergyMode::Off, gain_rate_per_s: 1e3, ..ChainSettings::default() }
            .without_governor();
    let seed = 1;
    let clock = VirtualClock::PERFECT;
    let above_m = Vector3::new(0.0, 0.0, 2e-3);
    // The intended position of the hand at which tissue and feedback together balance it at the contact force.
    let deep_m =
        Vector3::new(0.0, 0.0, -CONTACT_N / stiffness_n_m - gain.min(4.0 / CONTACT_N) * CONTACT_N / PairGrip::FIRM.n_m);
    let own_motion = OwnMotion::Follower;
    let literal = Recipe::default();
    let handle = LoneHandle::OMEGA;
    let grip = PairGrip::FIRM;
    let tremor_m = 0.0;
    let noise_n = NOISE_N;
    let trial = PairTrial {
        mode,
        own_motion,
        literal,
        delay_s,
        gates,
        gain,
        tissue,
        tremor_m,
        noise_n,
        handle,
        grip,
        seed,
        clock,
    };
    let mut pair = BenchPair::new(&trial, above_m)?;
    let mut low_m = Vector3::repeat(f64::INFINITY);
    let mut high_m = Vector3::repeat(f64::NEG_INFINITY);
    for tick in 0..(TRIAL_S * RATE_HZ) as u32 {
        let t_s = f64::from(tick) / RATE_HZ;
        let s = (t_s / APPROACH_S).min(1.0);
        let knock_m = if (KNOCK_S[0]..KNOCK_S[1]).contains(&t_s) { KNOCK_M } else { 0.0 };
        let way = s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
        pair.step(|_, _| above_m + (deep_m - above_m) * way + Vector3::z() * knock_m);
        if t_s >= TRIAL_S - JUDGED_S {
            low_m = low_m.inf(&pair.handle_m());
            high_m = high_m.sup(&pair.handle_m());
        }
    }
    let moved_m = (high_m - low_m).amax();
    Ok(if moved_m < STILL_M {
        StabilityMapVerdict::Stable
    } else if moved_m < SHAKING_M {
        StabilityMapVerdict::Marginal
    } else {
        StabilityMapVerdict::Unstable
    })
}
