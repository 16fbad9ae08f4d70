//! Cost and error of a mode as the loop runs it: an identifier with memory for every mode that computes this one and DFR (which
//! costs nothing).

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

use nima_core::{
    impedance::{Identifier, ImpedanceSettings, Mode, ModeSet, Sample, SettingsError},
    statistics::Percentiles,
};

use super::{
    plan::ParameterChoice,
    sweep::{CostUs, SweepError},
};

/// Ticks between two checks for cancellation.
const LOOK_EVERY: usize = 512;

/// Results at one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct ModeResult {
    pub(super) cost_us: CostUs,
    pub(super) error: f64,
    pub(super) error_p50: f64,
    pub(super) error_p95: f64,
    pub(super) dfr_error: f64,
    pub(super) not_rendered: f64,
    pub(super) judged: usize,
}

/// Sums of a mode's error and of delayed DFR's on the same samples.
#[derive(Debug, Default)]
pub(super) struct ModeErrors {
    norms: Vec<f64>,
    dfr: f64,
    not_rendered: usize,
}

impl ModeErrors {
    pub(super) fn add(&mut self, error: f64, dfr_error: f64, rendered: bool) {
        self.norms.push(error);
        self.dfr += dfr_error;
        self.not_rendered += usize::from(!rendered);
    }

    pub(super) fn measured(mut self, cost_us: CostUs) -> ModeResult {
        let judged = self.norms.len();
        let count = judged.max(1) as f64;
        let error = self.norms.iter().sum::<f64>() / count;
        self.norms.sort_unstable_by(f64::total_cmp);
        let rank = |q: f64| ((q * count).ceil() as usize).clamp(1, judged.max(1)) - 1;
        let quantile = |q: f64| self.norms.get(rank(q)).copied().unwrap_or(0.0);
        ModeResult {
            cost_us,
            error,
            error_p50: quantile(0.5),
            error_p95: quantile(0.95),
            dfr_error: self.dfr / count,
            not_rendered: self.not_rendered as f64 / count,
            judged,
        }
    }
}

/// Returns an error if the sweep was cancelled.
pub(super) fn look(cancel: &AtomicBool) -> Result<(), SweepError> {
    if cancel.load(Ordering::Relaxed) { Err(SweepError::Cancelled) } else { Ok(()) }
}

/// Returns an identifier that computes only `mode`, as the loop does: its settings include every mode, so that any can
/// be chosen while it runs.
pub(super) fn identifier(settings: &ImpedanceSettings, mode: Mode) -> Result<Identifier, SettingsError> {
    let mut identifier = Identifier::new(&ImpedanceSettings { modes: settings.modes.with(mode), ..settings.clone() })?;
    identifier.compute(ModeSet::only(mode));
    Ok(identifier)
}

/// Runs `mode` over `samples` `passes` times; only samples from `from_s` on are judged and timed.
pub(super) fn measure(
    samples: &[Sample],
    settings: &ImpedanceSettings,
    (mode, choice): (Mode, &ParameterChoice),
    from_s: f64,
    passes: usize,
    cancel: &AtomicBool,
) -> Result<ModeResult, SweepError> {
    let mut errors = ModeErrors::default();
    let mut cost_us = CostUs::WORST;
    for pass in 0..passes.max(1) {
        let mut identifier =
            identifier(settings, mode).map_err(|source| SweepError::Settings { choice: Box::new(*choice), source })?;
        let mut times = Percentiles::new();
        for (k, sample) in samples.iter().enumerate() {
            if k % LOOK_EVERY == 0 {
                look(cancel)?;
            }
            let start = Instant::now();
            identifier.step(sample);
            let spent_s = start.elapsed().as_secs_f64();
            if sample.t_s < from_s {
                continue;
            }
            times.record(spent_s);
            if pass == 0 {
                judge(&identifier, mode, sample, &mut errors);
            }
        }
        cost_us = cost_us.quieter(&times.quantiles());
    }
    Ok(errors.measured(cost_us))
}

fn judge(identifier: &Identifier, mode: Mode, sample: &Sample, errors: &mut ModeErrors) {
    let report = identifier.report();
    let rendered = report.prediction(mode);
    let held = report.prediction(Mode::Dfr);
    // If no force is rendered, the error is the whole force.
    let error = (rendered.unwrap_or_default() - sample.force_n).norm();
    let dfr_error = (held.unwrap_or_default() - sample.force_n).norm();
    errors.add(error, dfr_error, rendered.is_some());
}
