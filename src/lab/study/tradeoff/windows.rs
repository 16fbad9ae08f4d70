//! Cost and error of the plain model `f = M X` in a window, for each of the solvers that can compute `M`.
//!
//! For time t every solver gets the window that ends at t - D, fits all degrees up to the chosen one, and predicts the
//! force from the motion at t; the prediction is not anchored, blended or bounded. Solving a whole window is slow, so
//! it is done at a number of instants spread over the source, the same for all solvers; the sliding solver processes
//! every sample. Solvers that work per axis are timed for all axes together; the sliding one computes up to three axes
//! in the lanes of one factor, so one axis is timed.

use std::{hint::black_box, sync::atomic::AtomicBool, time::Instant};

use nima_core::{
    impedance::{ImpedanceSettings, MAX_DEGREE, Sample},
    signal::{DelayLine, Differentiator, Lanes, Motion},
    statistics::Percentiles,
};

use super::{
    modes::{ModeErrors, ModeResult, look},
    sweep::{CostUs, SweepError},
};
use crate::solvers::{LeastSquaresSolver, SlidingSolver, SolverFit, SolverRow};

/// Rows of a source for one window length, one list per axis.
struct WindowsRows {
    axes: Vec<Vec<SolverRow>>,
    window: usize,
}

impl WindowsRows {
    fn new(samples: &[Sample], settings: &ImpedanceSettings) -> Self {
        let block = ((settings.window_s * settings.rate_hz / 2.0).round() as usize).max(5);
        let window = 2 * block;
        let mut differentiator = Differentiator::new(settings.differentiator, settings.rate_hz);
        let mut history = DelayLine::new(window, Motion::default());
        let mut axes = vec![Vec::with_capacity(samples.len()); settings.axes];
        for sample in samples {
            let now = differentiator.step(Lanes::from(sample.position_m));
            history.push(now);
            let then = history.get_or_oldest(window).copied().unwrap_or_default();
            for (axis, rows) in axes.iter_mut().enumerate() {
                let [x, v, a] = [now.x, now.v, now.a].map(|lanes| lanes[axis]);
                let increment = [x - then.x[axis], v - then.v[axis], a - then.a[axis]];
                rows.push(SolverRow { position: [x, v, a], increment, force_n: sample.force_n[axis] });
            }
        }
        Self { axes, window }
    }
}

/// Measures `solver` at about `instants` instants from `from_s` on.
pub(super) fn measure(
    samples: &[Sample],
    settings: &ImpedanceSettings,
    solver: LeastSquaresSolver,
    from_s: f64,
    instants: usize,
    cancel: &AtomicBool,
) -> Result<ModeResult, SweepError> {
    let rows = WindowsRows::new(samples, settings);
    let delay = (settings.delay_s * settings.rate_hz).round() as usize;
    let first = samples.partition_point(|sample| sample.t_s < from_s).max(rows.window + delay);
    let every = (samples.len().saturating_sub(first) / instants.max(1)).max(1);
    let mut sliding: Vec<SlidingSolver> = (0..settings.axes)
        .map(|_| SlidingSolver::new(rows.window / 2, settings.max_degree, settings.scales, settings.ridge))
        .collect();
    let mut errors = ModeErrors::default();
    let mut times = Percentiles::new();
    let end = samples.len().saturating_sub(delay);
    for known in 0..end {
        let now = known + delay;
        let asked = now >= first && (now - first).is_multiple_of(every);
        if known % 256 == 0 || asked {
            look(cancel)?;
        }
        if solver == LeastSquaresSolver::Sliding {
            let spent_s = slide(&mut sliding, &rows, known);
            if now >= first {
                times.record(spent_s);
            }
        }
        if asked {
            let fits = if solver == LeastSquaresSolver::Sliding {
                sliding.iter().map(SlidingSolver::fit).collect()
            } else {
                let start = Instant::now();
                let fits = black_box(fit_afresh(solver, &rows, known, settings));
                times.record(start.elapsed().as_secs_f64());
                fits
            };
            judge(&fits, &rows, (known, now), settings.max_degree, &mut errors);
        }
    }
    Ok(errors.measured(CostUs::WORST.quieter(&times.quantiles())))
}

/// Adds row `known` of every axis; returns the time for the first axis, s.
fn slide(sliding: &mut [SlidingSolver], rows: &WindowsRows, known: usize) -> f64 {
    let mut spent_s = 0.0;
    for (axis, (sliding, rows)) in sliding.iter_mut().zip(&rows.axes).enumerate() {
        let start = Instant::now();
        sliding.push(Some(&rows[known]));
        if axis == 0 {
            spent_s = start.elapsed().as_secs_f64();
        }
    }
    spent_s
}

fn fit_afresh(
    solver: LeastSquaresSolver,
    rows: &WindowsRows,
    known: usize,
    settings: &ImpedanceSettings,
) -> Vec<SolverFit> {
    let from = (known + 1).saturating_sub(rows.window);
    let fit =
        |rows: &Vec<SolverRow>| solver.fit(&rows[from..=known], settings.max_degree, &settings.scales, settings.ridge);
    rows.axes.iter().map(fit).collect()
}

fn judge(fits: &[SolverFit], rows: &WindowsRows, (known, now): (usize, usize), degree: usize, errors: &mut ModeErrors) {
    let mut squares = 0.0;
    let mut dfr_squares = 0.0;
    let mut rendered = true;
    for (fit, rows) in fits.iter().zip(&rows.axes) {
        let force = fit.predict(&rows[now])[degree.clamp(1, MAX_DEGREE) - 1];
        rendered &= force.is_some();
        squares += (force.unwrap_or_default() - rows[now].force_n).powi(2);
        dfr_squares += (rows[known].force_n - rows[now].force_n).powi(2);
    }
    errors.add(squares.sqrt(), dfr_squares.sqrt(), rendered);
}
