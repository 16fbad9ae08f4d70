//! Measures all points of all sources; returns them with their curves and Pareto front.

use std::sync::atomic::AtomicBool;

use nima_core::{
    impedance::{ImpedanceSettings, Mode, SettingsError},
    statistics::Quantiles,
};
use serde::Serialize;

use super::{
    modes::{self, ModeResult, look},
    plan::{Knob, ParameterChoice, PlanCurve, PlanMethod, TradeoffPlan},
    source::TradeoffSource,
    windows,
};

/// Maximum window or delay as a fraction of the source; longer ones leave too few samples to judge.
const LONGEST_FRACTION: f64 = 0.25;

/// Why a sweep failed.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    #[error("cancelled; nothing was saved")]
    Cancelled,
    #[error("{name}: no point of the plan can be measured: {reason}; record longer or at a higher rate")]
    Nothing {
        name: String,
        /// Reason why its first point was left out.
        reason: String,
    },
    /// An invalid choice that the plan's checks did not find.
    #[error("{choice:?}: {source}")]
    Settings { choice: Box<ParameterChoice>, source: SettingsError },
}

/// Time of one tick, us.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CostUs {
    pub p50: f64,
    pub p99: f64,
}

impl CostUs {
    pub(super) const WORST: Self = Self { p50: f64::INFINITY, p99: f64::INFINITY };

    /// Returns the lower of both: disturbances by other programs only ever add time.
    pub(super) fn quieter(self, other: &Quantiles) -> Self {
        Self { p50: self.p50.min(other.p50), p99: self.p99.min(other.p99) }
    }
}

/// A choice, its cost and its error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SweepPoint {
    #[serde(flatten)]
    pub choice: ParameterChoice,
    /// Time of one tick, us; the minimum of the passes.
    pub cost_us: CostUs,
    /// Fraction of one processor used by the median tick at this rate.
    pub load: f64,
    /// Mean prediction error at the horizon, in the unit of the source.
    pub error: f64,
    pub error_p50: f64,
    pub error_p95: f64,
    /// Mean error of delayed DFR on the same samples.
    pub dfr_error: f64,
    /// `error / dfr_error`; NaN if DFR's error is zero.
    pub ratio: f64,
    /// Fraction of samples without a rendered force (their error is the whole force).
    pub not_rendered: f64,
    /// Samples judged and timed.
    pub judged: usize,
    /// On the Pareto front: no other grid point (mode, degree, window) at the same delay has both lower cost and lower
    /// error.
    pub pareto: bool,
}

/// A choice that was left out, and the reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SkippedChoice {
    #[serde(flatten)]
    pub choice: ParameterChoice,
    pub reason: String,
}

#[derive(Clone, Debug, Serialize)]
pub struct SourceFigures {
    pub source: String,
    pub unit: String,
    pub rate_hz: f64,
    pub samples: usize,
    pub axes: usize,
    /// Only samples later than this and the delay are judged, s, so that the longest window is full.
    pub judged_from_s: f64,
    pub points: Vec<SweepPoint>,
    pub curves: Vec<PlanCurve>,
    pub skipped: Vec<SkippedChoice>,
}

#[derive(Clone, Debug, Serialize)]
pub struct SweepStudy {
    pub sources: Vec<SourceFigures>,
}

/// Measures all points of `plan` on all `sources`. `progress` is called with the number of points done and their total;
/// setting `cancel` stops the sweep within milliseconds.
///
/// # Errors
/// [`SweepError`] if the sweep is cancelled or no point can be measured on a source.
pub fn sweep(
    sources: &[TradeoffSource],
    plan: &TradeoffPlan,
    cancel: &AtomicBool,
    mut progress: impl FnMut(usize, usize),
) -> Result<SweepStudy, SweepError> {
    let layouts: Vec<_> = sources.iter().map(|source| plan.lay_out(source)).collect();
    let total = layouts.iter().map(|(choices, _)| choices.len()).sum();
    let mut done = 0;
    progress(0, total);
    let mut figures = Vec::with_capacity(sources.len());
    for (source, (choices, curves)) in sources.iter().zip(layouts) {
        let one_done = || {
            done += 1;
            progress(done, total);
        };
        figures.push(measure_source(source, plan, &choices, curves, cancel, one_done)?);
    }
    Ok(SweepStudy { sources: figures })
}

fn measure_source(
    source: &TradeoffSource,
    plan: &TradeoffPlan,
    choices: &[ParameterChoice],
    mut curves: Vec<PlanCurve>,
    cancel: &AtomicBool,
    mut one_done: impl FnMut(),
) -> Result<SourceFigures, SweepError> {
    let recording = &source.recording;
    let axes = recording.axes.len();
    let longest_s = LONGEST_FRACTION * source.seconds();
    let settle_s = longest_usable(choices, longest_s);
    let mut points = Vec::new();
    let mut skipped = Vec::new();
    let mut places = vec![None; choices.len()];
    for (place, choice) in places.iter_mut().zip(choices) {
        look(cancel)?;
        let settings = plan.settings(choice, axes);
        if let Some(reason) = unfit(choice, &settings, longest_s) {
            skipped.push(SkippedChoice { choice: *choice, reason });
        } else {
            *place = Some(points.len());
            points.push(measure_point(source, plan, choice, &settings, settle_s, cancel)?);
        }
        one_done();
    }
    if points.is_empty() {
        let reason = skipped.first().map_or_else(|| "the plan is empty".to_owned(), |first| first.reason.clone());
        return Err(SweepError::Nothing { name: source.name.clone(), reason });
    }
    for curve in &mut curves {
        curve.points = curve.points.iter().filter_map(|&index| places[index]).collect();
    }
    let on_grid: Vec<usize> =
        curves.iter().filter(|curve| curve.knob == Knob::Grid).flat_map(|curve| curve.points.iter().copied()).collect();
    mark_front(&mut points, &on_grid);
    Ok(SourceFigures {
        source: source.name.clone(),
        unit: source.unit.clone(),
        rate_hz: recording.rate_hz,
        samples: recording.samples.len(),
        axes,
        judged_from_s: settle_s,
        points,
        curves,
        skipped,
    })
}

/// Returns the longest window that is measured. Judging starts only when it is full, so that all points are judged on
/// the same samples.
fn longest_usable(choices: &[ParameterChoice], longest_s: f64) -> f64 {
    choices.iter().map(|choice| choice.window_ms * 1e-3).filter(|&s| s <= longest_s).fold(0.0, f64::max)
}

fn unfit(choice: &ParameterChoice, settings: &ImpedanceSettings, longest_s: f64) -> Option<String> {
    if settings.window_s > longest_s || settings.delay_s > longest_s {
        return Some(format!(
            "a window of {} ms and a delay of {} ms must each be at most a quarter of the {:.1} s recorded",
            choice.window_ms,
            choice.delay_ms,
            longest_s / LONGEST_FRACTION
        ));
    }
    settings.validate().err().map(|error| error.to_string())
}

fn measure_point(
    source: &TradeoffSource,
    plan: &TradeoffPlan,
    choice: &ParameterChoice,
    settings: &ImpedanceSettings,
    settle_s: f64,
    cancel: &AtomicBool,
) -> Result<SweepPoint, SweepError> {
    let recording = source.slower(choice.every);
    let first_s = recording.samples.first().map_or(0.0, |first| first.t_s);
    let from_s = first_s + settle_s + settings.delay_s;
    let samples = &recording.samples;
    let measured = match choice.method {
        PlanMethod::Mode(mode) => modes::measure(samples, settings, (mode, choice), from_s, plan.passes, cancel)?,
        PlanMethod::Solver(solver) => windows::measure(samples, settings, solver, from_s, plan.instants, cancel)?,
    };
    Ok(point(choice, &measured))
}

fn point(choice: &ParameterChoice, measured: &ModeResult) -> SweepPoint {
    let ModeResult { cost_us, error, error_p50, error_p95, dfr_error, not_rendered, judged } = *measured;
    SweepPoint {
        choice: *choice,
        cost_us,
        load: cost_us.p50 * 1e-6 * choice.rate_hz,
        error,
        error_p50,
        error_p95,
        dfr_error,
        ratio: error / dfr_error,
        not_rendered,
        judged,
        pareto: false,
    }
}

/// Marks the grid points that are not beaten in both cost (median) and error by another grid point at the same delay.
pub(super) fn mark_front(points: &mut [SweepPoint], on_grid: &[usize]) {
    let grid: Vec<SweepPoint> = on_grid.iter().map(|&index| points[index]).collect();
    for &index in on_grid {
        let point = &mut points[index];
        let mut rivals =
            grid.iter().filter(|other| (other.choice.delay_ms - point.choice.delay_ms).abs() < f64::EPSILON);
        point.pareto = point.error.is_finite() && rivals.all(|other| !beats(other, point));
    }
}

/// Returns whether `a` is at least as good in both and better in one.
fn beats(a: &SweepPoint, b: &SweepPoint) -> bool {
    let cost = a.cost_us.p50;
    let error = a.error;
    cost <= b.cost_us.p50 && error <= b.error && (cost < b.cost_us.p50 || error < b.error)
}

impl SourceFigures {
    /// Returns the point of delayed DFR at this delay (ms) and at the source's own rate, if it was measured.
    pub fn dfr(&self, delay_ms: f64) -> Option<&SweepPoint> {
        let wanted = PlanMethod::Mode(Mode::Dfr);
        self.points.iter().find(|point| {
            point.choice.method == wanted
                && point.choice.every == 1
                && (point.choice.delay_ms - delay_ms).abs() < f64::EPSILON
        })
    }
}
