//! The modes that send only parameters, in the extreme cases: always finite, the same in every unit, and the same after
//! a long time.

use nalgebra::Vector3;
use nima_core::impedance::{Identifier, ImpedanceSettings, Mode, ModeSet, Sample, SettingsError};
use serde::Serialize;

use super::{StabilityCase, scales, worse};

const MODES: [Mode; 2] = [Mode::Matched, Mode::Nima];
/// Delay of the link (s).
const DELAY_S: f64 = 0.05;

/// One of these modes in one extreme case.
#[derive(Clone, Debug, Serialize)]
pub struct StabilityRendering {
    pub mode: Mode,
    /// Ticks since its first force.
    pub asked: usize,
    /// Ticks among these with a finite force in metres and in millimetres.
    pub finite: usize,
    /// Maximum difference between metres and millimetres, relative to the force or to its root mean square in the case,
    /// whichever is larger.
    pub unit_difference: Option<f64>,
}

/// One of these modes after a long run, compared with one that started about [`Endurance::FRESH`] ticks before its end.
#[derive(Clone, Debug, Serialize)]
pub struct Endurance {
    pub mode: Mode,
    pub ticks: u64,
    /// Ticks since the first force without a finite one.
    pub not_finite: u64,
    /// Maximum difference of force in the last 1000 ticks, relative to the root mean square; `None` if the run was too
    /// short for a second one.
    pub difference: Option<f64>,
}

impl Endurance {
    /// After this many ticks (500 s at 1 kHz; the longest memory has 20 s) only rounding depends on the length of a
    /// run.
    pub(super) const FRESH: u64 = 500_000;
    const COMPARED: u64 = 1000;
    /// Runs that begin this many ticks apart, or a multiple, begin at the same position, which they keep as their
    /// origin, and renew their fits, each every 7, 14 or 5 ticks, in the same ticks: only then must they be equal to
    /// the last digits.
    const ALIKE: u64 = 7 * Self::PERIOD;
    /// Ticks after which the motion repeats.
    const PERIOD: u64 = 10_000;
}

fn settings(unit: f64, mode: Mode) -> ImpedanceSettings {
    ImpedanceSettings {
        delay_s: DELAY_S,
        axes: 1,
        scales: scales(unit),
        modes: ModeSet::only(mode),
        ..ImpedanceSettings::default()
    }
}

pub(super) fn sample(t_s: f64, position_m: f64, force_n: f64) -> Sample {
    let [position_m, force_n] = [position_m, force_n].map(|value| Vector3::new(value, 0.0, 0.0));
    Sample { t_s, position_m, force_n }
}

/// Returns the result of every mode at the horizon over the samples of a case.
pub(super) fn extreme(case: &StabilityCase) -> Result<Vec<StabilityRendering>, SettingsError> {
    MODES.into_iter().map(|mode| rendering(case, mode)).collect()
}

fn rendering(case: &StabilityCase, mode: Mode) -> Result<StabilityRendering, SettingsError> {
    let identifier = |unit| {
        let window_s = case.window as f64 / case.rate_hz;
        Identifier::new(&ImpedanceSettings { rate_hz: case.rate_hz, window_s, ..settings(unit, mode) })
    };
    let units = [1.0, 1e3];
    let mut identifiers = [identifier(units[0])?, identifier(units[1])?];
    let usable: Vec<f64> = case.samples.iter().map(|raw| raw.force_n).filter(|force| force.abs() < 1e3).collect();
    let rms_n = (usable.iter().map(|force| force * force).sum::<f64>() / usable.len().max(1) as f64).sqrt();
    let mut rendering = StabilityRendering { mode, asked: 0, finite: 0, unit_difference: None };
    for raw in &case.samples {
        let mut said = [None; 2];
        for ((identifier, unit), said) in identifiers.iter_mut().zip(units).zip(&mut said) {
            identifier.step(&sample(raw.t_s, raw.position_m * unit, raw.force_n));
            *said = identifier.report().prediction(mode).map(|force| force.x);
        }
        rendering.asked += usize::from(rendering.asked > 0 || said.iter().any(Option::is_some));
        if let [Some(metres), Some(millimetres)] = said
            && (metres + millimetres).is_finite()
        {
            rendering.finite += 1;
            let size_n = metres.abs().max(rms_n).max(f64::MIN_POSITIVE);
            rendering.unit_difference = worse(rendering.unit_difference, Some((metres - millimetres).abs() / size_n));
        }
    }
    Ok(rendering)
}

/// Returns a hand that presses soft tissue again and again: position (m) and force (N) at a tick, equal after every
/// period.
fn palpation(tick: u64) -> [f64; 2] {
    let t = (tick % Endurance::PERIOD) as f64 / Endurance::PERIOD as f64 * std::f64::consts::TAU;
    let x = 0.01 * ((7.0 * t).sin() + 0.4 * (19.0 * t + 1.0).sin() + 0.1 * (53.0 * t + 2.0).cos());
    let v = 0.01 * (7.0 * (7.0 * t).cos() + 7.6 * (19.0 * t + 1.0).cos() - 5.3 * (53.0 * t + 2.0).sin()) * 0.628;
    [x, if x > 0.0 { -300.0 * x - 4e3 * x * x - 8.0 * v } else { 0.0 }]
}

/// Runs every mode for this many ticks.
pub(super) fn endurance(ticks: u64) -> Result<Vec<Endurance>, SettingsError> {
    MODES.into_iter().map(|mode| long_run(ticks, mode)).collect()
}

fn long_run(ticks: u64, mode: Mode) -> Result<Endurance, SettingsError> {
    let mut old = Identifier::new(&settings(1.0, mode))?;
    let mut fresh = old.clone();
    let fresh_from = ticks.checked_sub(Endurance::FRESH).map(|from| from - from % Endurance::ALIKE);
    let mut endurance = Endurance { mode, ticks, not_finite: 0, difference: None };
    let mut started = false;
    let mut off_n = None;
    let mut squares_n2 = 0.0;
    for tick in 0..ticks {
        let [x, force_n] = palpation(tick);
        let now = sample(tick as f64 * 1e-3, x, force_n);
        old.step(&now);
        let said = old.report().prediction(mode).map(|force| force.x).filter(|force| force.is_finite());
        started |= said.is_some();
        endurance.not_finite += u64::from(started && said.is_none());
        if fresh_from.is_some_and(|from| tick >= from) {
            fresh.step(&now);
            if tick + Endurance::COMPARED >= ticks {
                let beside = fresh.report().prediction(mode).map(|force| force.x);
                off_n = worse(off_n, said.zip(beside).map(|(old, fresh)| (old - fresh).abs()));
                squares_n2 += force_n * force_n;
            }
        }
    }
    let rms_n = (squares_n2 / Endurance::COMPARED as f64).sqrt();
    endurance.difference = off_n.map(|off_n| off_n / rms_n.max(f64::MIN_POSITIVE));
    Ok(endurance)
}
