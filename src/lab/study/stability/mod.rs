//! Numerical stability in extreme cases: every solver compared with the exact solution of the same problem.
//!
//! Takes the number of ticks of the long run; the cases are generated here. Returns a [`StabilityReport`] with table, CSV, JSON
//! and plots.
//!
//! The paper's solvers and the plain QR get the samples unchanged. This project's solver gets them through the
//! identifier's checks (a sample that is not finite, out of range, or whose time does not advance occupies its time in
//! the window without data). Each is compared with the arbitrary-precision solution of the same problem: same rows,
//! same constant, same ridge, minimum norm if the rows do not determine the solution. The error is the error of the
//! predicted force, at the newest sample and 50 ms later, relative to the force or to its root mean square in the
//! window, whichever is larger.

mod cases;
mod drift;
mod present;
mod rendering;
#[cfg(test)]
mod tests;
mod verdict;

use nalgebra::DMatrix;
use nima_core::{
    impedance::{Identifier, ImpedanceSettings, MAX_DEGREE, Mode, Scales, SettingsError},
    signal::{Differentiator, Lanes, Motion},
};
use serde::Serialize;

pub use drift::StabilityDrift;
pub use rendering::{Endurance, StabilityRendering};
pub use verdict::{Failures, RenderingVerdict, StabilityVerdict};

use self::cases::{StabilityCase, horizon, warm};
use super::{
    reference::{PRECISION_BITS, Reference},
    solvers::{CUT_OFF, LeastSquaresSolver, SlidingSolver, SolverFit, SolverRow},
};

/// Relative error that must be reached wherever the condition number is below [`ORDINARY_CONDITION`].
pub const TARGET: f64 = 1e-9;
/// Scaled condition number up to which [`TARGET`] must be reached.
pub const ORDINARY_CONDITION: f64 = 1e6;

#[derive(Clone, Debug)]
pub struct StabilityOptions {
    /// Ticks of the long run, within [`StabilityOptions::TICKS`].
    pub ticks: u64,
    /// Leave out windows longer than 300 samples (for tests).
    pub quick: bool,
}

impl StabilityOptions {
    /// Allowed number of ticks.
    pub const TICKS: std::ops::RangeInclusive<u64> = 10_000..=1_000_000_000;
}

/// Why the study could not run.
#[derive(Debug, thiserror::Error)]
pub enum StabilityError {
    #[error("{ticks} ticks are out of range; use 10000 to 1000000000")]
    Ticks { ticks: u64 },
    #[error(transparent)]
    Settings(#[from] SettingsError),
}

/// One solver and degree in one case, with the worst result over its windows.
#[derive(Clone, Debug, Serialize)]
pub struct StabilityEntry {
    pub solver: LeastSquaresSolver,
    /// Polynomial degree.
    pub degree: usize,
    pub asked: usize,
    /// Number of finite predictions.
    pub finite: usize,
    /// Worst relative error of the finite predictions; `None` if there were none or the window itself is not finite.
    pub error: Option<f64>,
    pub unknowns: usize,
    /// Lowest rank that the solver used (pseudo-inverse: above its cut-off; sliding: above the ridge; others: exact
    /// rank).
    pub rank: usize,
    /// Whether the rows do not determine the solution exactly, so that only predictions can be compared.
    pub deficient: bool,
    /// Maximum condition number of the solver's own columns (sliding: with the ridge); `None` if infinite or undefined.
    pub condition: Option<f64>,
    /// Maximum relative difference between working in metres and in millimetres (pseudo-inverse and sliding).
    pub unit_difference: Option<f64>,
}

#[derive(Clone, Debug, Serialize)]
pub struct StabilityExtreme {
    /// Group of cases.
    pub group: &'static str,
    pub name: String,
    pub rate_hz: f64,
    /// Samples in the window.
    pub window: usize,
    /// Whether the whole identifier, with all four modes, returned finite numbers at every tick.
    pub identifier_finite: bool,
    pub entries: Vec<StabilityEntry>,
    /// The modes that send only parameters.
    pub renderings: Vec<StabilityRendering>,
}

#[derive(Clone, Debug, Serialize)]
pub struct StabilityReport {
    pub reference_bits: usize,
    /// Comparison with the targets.
    pub verdict: StabilityVerdict,
    /// The solver's long run.
    pub drift: StabilityDrift,
    /// The long run of the modes that send only parameters.
    pub endurance: Vec<Endurance>,
    pub extremes: Vec<StabilityExtreme>,
}

/// Runs the study; before each part `progress` is called with the number of parts done, their total, and the name of
/// the next.
///
/// # Errors
/// [`StabilityError`] if the number of ticks is out of range or a setting is invalid.
pub fn study(
    options: &StabilityOptions,
    mut progress: impl FnMut(usize, usize, &str),
) -> Result<StabilityReport, StabilityError> {
    if !StabilityOptions::TICKS.contains(&options.ticks) {
        return Err(StabilityError::Ticks { ticks: options.ticks });
    }
    let cases = cases::all(options.quick);
    let count = cases.len() + 2;
    let mut extremes = Vec::with_capacity(cases.len());
    for (done, case) in cases.iter().enumerate() {
        progress(done, count, &case.name);
        extremes.push(extreme(case)?);
    }
    progress(count - 2, count, "long run of the solver");
    let drift = drift::run(options.ticks);
    progress(count - 1, count, "long run of the modes");
    let endurance = rendering::endurance(options.ticks)?;
    progress(count, count, "done");
    let verdict = StabilityVerdict::of(&extremes, &drift, &endurance);
    Ok(StabilityReport { reference_bits: PRECISION_BITS, verdict, drift, endurance, extremes })
}

/// Rows of a case, and whether each is used in the window.
struct StabilityStream {
    rows: Vec<SolverRow>,
    used: Vec<bool>,
}

/// Returns the motion of a case as the loop computes it, lengths multiplied by `unit`; with `guard`, after the
/// identifier's checks.
fn stream(case: &StabilityCase, unit: f64, guard: bool) -> StabilityStream {
    let settings = ImpedanceSettings::default();
    let mut differentiator = Differentiator::new(settings.differentiator, case.rate_hz);
    let bridge = (0.01 * case.rate_hz).ceil() as usize;
    let mut motions = Vec::new();
    let mut last = Motion::default();
    let mut last_t_s = f64::NEG_INFINITY;
    let mut missing = 0;
    let mut rows = Vec::new();
    let mut used = Vec::new();
    for raw in &case.samples {
        let usable = raw.position_m.is_finite() && raw.force_n.is_finite() && raw.t_s > last_t_s;
        last_t_s = last_t_s.max(raw.t_s);
        let position = if usable || !guard {
            missing = 0;
            Lanes::splat(raw.position_m * unit)
        } else {
            missing += 1;
            if missing <= bridge { last.x + last.v * case.rate_hz.recip() } else { last.x }
        };
        last = differentiator.step(position);
        motions.push(last);
        let then: Motion = motions[motions.len().saturating_sub(case.window + 1)];
        let position = [last.x, last.v, last.a].map(|lanes| lanes[0]);
        let increment = [last.x - then.x, last.v - then.v, last.a - then.a].map(|lanes| lanes[0]);
        rows.push(SolverRow { position, increment, force_n: raw.force_n });
        used.push((usable || !guard) && differentiator.settled());
    }
    StabilityStream { rows, used }
}

/// Returns the scales, lengths multiplied by `unit`.
fn scales(unit: f64) -> Scales {
    let Scales { position_m, velocity_m_s, acceleration_m_s2, force_n } = Scales::default();
    Scales {
        position_m: position_m * unit,
        velocity_m_s: velocity_m_s * unit,
        acceleration_m_s2: acceleration_m_s2 * unit,
        force_n,
    }
}

/// Fits of one solver at every instant of a case, and the state of the sliding window.
fn fits(
    case: &StabilityCase,
    solver: LeastSquaresSolver,
    stream: &StabilityStream,
    unit: f64,
) -> Vec<(SolverFit, Option<SlidingSolver>)> {
    let scales = scales(unit);
    let ridge = ImpedanceSettings::default().ridge;
    if solver != LeastSquaresSolver::Sliding {
        let window = |k: usize| solver.fit(&stream.rows[k + 1 - case.window..=k], MAX_DEGREE, &scales, 0.0);
        return instants(case).map(|k| (window(k), None)).collect();
    }
    let mut sliding = SlidingSolver::new(case.window / 2, MAX_DEGREE, scales, ridge);
    let mut found = Vec::new();
    for k in 0..stream.rows.len() {
        sliding.push(stream.used[k].then_some(&stream.rows[k]));
        if instants(case).any(|instant| instant == k) {
            found.push((sliding.fit(), Some(sliding.clone())));
        }
    }
    found
}

/// Returns the ticks at which the window is evaluated.
fn instants(case: &StabilityCase) -> impl Iterator<Item = usize> {
    let first = warm(case.rate_hz, case.window);
    let window = case.window;
    [0, window / 2, window].into_iter().map(move |later| first + later)
}

/// Returns the rows of columns with the force as last column, the format of the reference.
fn columns_of(
    solver: LeastSquaresSolver,
    stream: &StabilityStream,
    window: std::ops::RangeInclusive<usize>,
    force: bool,
) -> Vec<Vec<f64>> {
    let unknowns = solver.unknowns(MAX_DEGREE);
    let row = |row: &SolverRow| {
        let mut columns = solver.columns(row, MAX_DEGREE, &scales(1.0))[..unknowns].to_vec();
        columns.extend(force.then_some(row.force_n));
        columns
    };
    window.filter(|k| stream.used[*k]).map(|k| row(&stream.rows[k])).collect()
}

fn extreme(case: &StabilityCase) -> Result<StabilityExtreme, StabilityError> {
    let bare = stream(case, 1.0, false);
    let guarded = stream(case, 1.0, true);
    let mut entries = Vec::new();
    for solvers in [&LeastSquaresSolver::ALL[..3], &LeastSquaresSolver::ALL[3..4], &LeastSquaresSolver::ALL[4..]] {
        let ours = solvers[0] == LeastSquaresSolver::Sliding;
        let seen = if ours { &guarded } else { &bare };
        let windows: Vec<_> = instants(case).map(|k| StabilityWindow::new(case, solvers[0], seen, k)).collect();
        for &solver in solvers {
            let fits = fits(case, solver, seen, 1.0);
            let other_unit = matches!(solver, LeastSquaresSolver::PseudoInverse | LeastSquaresSolver::Sliding)
                .then(|| stream(case, 1e3, ours))
                .map(|stream| (self::fits(case, solver, &stream, 1e3), stream));
            for degree in 1..=MAX_DEGREE {
                let mut entry = StabilityEntry::new(solver, degree);
                for (i, window) in windows.iter().enumerate() {
                    entry.compare(window, &fits[i], seen);
                    if let Some((other, stream)) = &other_unit {
                        entry.compare_units(window, [&fits[i].0, &other[i].0], [seen, stream]);
                    }
                }
                entries.push(entry);
            }
        }
    }
    let identifier_finite = identifier_finite(case)?;
    let renderings = rendering::extreme(case)?;
    let StabilityCase { group, name, rate_hz, window, .. } = case.clone();
    Ok(StabilityExtreme { group, name, rate_hz, window, identifier_finite, entries, renderings })
}

/// One window of one problem: its exact solution and its singular values.
struct StabilityWindow {
    reference: Option<Reference>,
    exact: Vec<Vec<Option<f64>>>,
    /// Singular values of the first columns, by degree.
    singular: Vec<Vec<f64>>,
    force_rms_n: f64,
    at: [usize; 2],
}

impl StabilityWindow {
    fn new(case: &StabilityCase, solver: LeastSquaresSolver, stream: &StabilityStream, k: usize) -> Self {
        let unknowns = solver.unknowns(MAX_DEGREE);
        let rows = columns_of(solver, stream, k + 1 - case.window..=k, true);
        let ridge = if solver == LeastSquaresSolver::Sliding { ImpedanceSettings::default().ridge } else { 0.0 };
        let reference = Reference::new(&rows, unknowns, (ridge * case.window as f64).sqrt());
        let at = [k, k + horizon(case.rate_hz, case.window)];
        // The motion at those two instants is used even if the sample was rejected.
        let seen = StabilityStream { rows: at.map(|k| stream.rows[k]).to_vec(), used: vec![true; 2] };
        let places = columns_of(solver, &seen, 0..=1, false);
        let prefix = |degree| solver.unknowns(degree);
        let exact = (1..=MAX_DEGREE)
            .map(|degree| {
                reference.as_ref().map_or_else(|| vec![None; 2], |exact| exact.predict(prefix(degree), &places))
            })
            .collect();
        let singular = (1..=MAX_DEGREE).map(|degree| singular_values(&rows, prefix(degree))).collect();
        let squares: f64 = rows.iter().map(|row| row[unknowns] * row[unknowns]).sum();
        let force_rms_n = (squares / rows.len().max(1) as f64).sqrt();
        Self { reference, exact, singular, force_rms_n, at }
    }

    fn relative(&self, found: f64, expected: f64) -> f64 {
        let off = (found - expected).abs();
        if off == 0.0 { 0.0 } else { off / expected.abs().max(self.force_rms_n).max(f64::MIN_POSITIVE) }
    }
}

/// Returns the largest first; empty if an entry is not finite.
fn singular_values(rows: &[Vec<f64>], columns: usize) -> Vec<f64> {
    if !rows.iter().flatten().all(|entry| entry.is_finite()) {
        return Vec::new();
    }
    let x = DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]);
    let mut values = x.qr().r().singular_values().as_slice().to_vec();
    values.sort_by(|a, b| b.total_cmp(a));
    values.resize(columns, 0.0);
    values
}

impl StabilityEntry {
    fn new(solver: LeastSquaresSolver, degree: usize) -> Self {
        let unknowns = solver.unknowns(degree);
        Self {
            solver,
            degree,
            asked: 0,
            finite: 0,
            error: None,
            unknowns,
            rank: unknowns,
            deficient: false,
            condition: Some(1.0),
            unit_difference: None,
        }
    }

    fn compare(
        &mut self,
        window: &StabilityWindow,
        (fit, sliding): &(SolverFit, Option<SlidingSolver>),
        stream: &StabilityStream,
    ) {
        let degree = self.degree;
        for (i, at) in window.at.iter().enumerate() {
            self.asked += 1;
            let Some(found) = fit.predict(&stream.rows[*at])[degree - 1] else { continue };
            self.finite += 1;
            if let Some(exact) = window.exact[degree - 1][i] {
                self.error = worse(self.error, Some(window.relative(found, exact)));
            }
        }
        let exact_rank = window.reference.as_ref().map_or(0, |reference| reference.rank(self.unknowns));
        let singular = &window.singular[degree - 1];
        let largest = singular.first().copied().unwrap_or(0.0);
        self.deficient |= exact_rank < self.unknowns;
        let condition = match sliding {
            Some(sliding) => sliding.condition(degree),
            None => largest / singular.last().copied().unwrap_or(0.0),
        };
        self.condition = self.condition.filter(|_| condition.is_finite()).map(|worst| worst.max(condition));
        self.rank = self.rank.min(match (sliding, self.solver) {
            (Some(sliding), _) => sliding.rank(degree, ImpedanceSettings::default().ridge),
            (None, LeastSquaresSolver::PseudoInverse) => {
                singular.iter().filter(|value| **value > CUT_OFF * largest).count()
            }
            (None, _) => exact_rank,
        });
    }

    fn compare_units(&mut self, window: &StabilityWindow, fits: [&SolverFit; 2], streams: [&StabilityStream; 2]) {
        for at in window.at {
            let [metres, millimetres] = [0, 1].map(|i| fits[i].predict(&streams[i].rows[at])[self.degree - 1]);
            if let (Some(metres), Some(millimetres)) = (metres, millimetres) {
                self.unit_difference = worse(self.unit_difference, Some(window.relative(millimetres, metres)));
            }
        }
    }
}

fn worse(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).reduce(f64::max)
}

/// Runs the identifier with all modes, as the loop does, over the samples of a case.
fn identifier_finite(case: &StabilityCase) -> Result<bool, StabilityError> {
    let settings = ImpedanceSettings {
        rate_hz: case.rate_hz,
        window_s: case.window as f64 / case.rate_hz,
        axes: 1,
        ..ImpedanceSettings::default()
    };
    let mut identifier = Identifier::new(&settings)?;
    let mut finite = true;
    for raw in &case.samples {
        identifier.step(&rendering::sample(raw.t_s, raw.position_m, raw.force_n));
        let report = identifier.report();
        finite &= Mode::ALL.iter().filter_map(|mode| report.prediction(*mode)).all(|force| force.x.is_finite());
        finite &= report.condition.is_finite();
    }
    Ok(finite)
}
