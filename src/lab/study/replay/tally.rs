//! Sums over a replay; its results are computed from them.

use nalgebra::Vector3;
use nima_core::{
    impedance::{IdentificationReport, ImpedanceSettings, MAX_DEGREE, Mode},
    statistics::Percentiles,
};

use super::{
    ReplayMotion, ReplayRow,
    figures::{ErrorFigures, FigureSpread, IdentificationTime, Reconstruction, Reconstructions, ReplayFigures},
    renewal::ForceRenewals,
    unit::PositionUnit,
};

#[derive(Default)]
pub(super) struct ReplayTally {
    error: TallyErrors,
    hold: TallyErrors,
    reconstruction: [TallyErrors; MAX_DEGREE],
    selected: TallyErrors,
    degrees: [u64; MAX_DEGREE + 1],
    conditions: Vec<f64>,
    rejected: u64,
    holes: u64,
    longest_hole_s: f64,
    renewals: ForceRenewals,
    pub(super) tick: Percentiles,
}

impl ReplayTally {
    pub(super) fn hole(&mut self, seconds: f64) {
        self.holes += 1;
        self.longest_hole_s = self.longest_hole_s.max(seconds);
    }

    pub(super) fn add(&mut self, row: &ReplayRow, report: &IdentificationReport) {
        self.renewals.add(&row.measured);
        if let Some(chosen) = usize::from(report.degrees.paper).checked_sub(1) {
            for (errors, residual) in self.reconstruction.iter_mut().zip(&report.reconstruction_n) {
                errors.add(residual);
            }
            self.selected.add(&report.reconstruction_n[chosen]);
        }
        if report.condition > 0.0 {
            self.conditions.push(report.condition);
        }
        let Some(held) = row.held else { return };
        // A mode without a valid force renders none, so its error is the whole force.
        self.error.add(&(row.rendered.unwrap_or_else(Vector3::zeros) - row.measured));
        self.hold.add(&(held - row.measured));
        self.degrees[row.degree.min(MAX_DEGREE)] += 1;
        self.rejected += u64::from(row.rendered.is_none());
    }

    pub(super) fn figures(
        mut self,
        motion: &ReplayMotion<'_>,
        mode: Mode,
        settings: &ImpedanceSettings,
        unit: &PositionUnit,
    ) -> ReplayFigures {
        let compared = self.error.norms.len();
        let fraction = |count: u64| count as f64 / compared.max(1) as f64;
        let [degree_1, degree_2, degree_3, degree_4, degree_5] =
            self.reconstruction.map(|errors| errors.reconstruction());
        let tick = self.tick.quantiles();
        self.conditions.sort_unstable_by(f64::total_cmp);
        ReplayFigures {
            samples: motion.samples,
            rate_hz: motion.rate_hz,
            own_motion: settings.own_motion,
            axes: motion.axes.iter().map(|&axis| nima_recording::csv::AXIS_NAMES[axis]).collect(),
            mode,
            window_ms: tidy_ms(settings.window_s),
            delay_ms: tidy_ms(settings.delay_s),
            compared,
            error: self.error.figures(),
            hold: self.hold.figures(),
            reconstruction: Reconstructions {
                degree_1,
                degree_2,
                degree_3,
                degree_4,
                degree_5,
                selected: self.selected.reconstruction(),
            },
            degree_fraction: std::array::from_fn(|i| fraction(self.degrees[i + 1])),
            nonlinear_fraction: fraction(self.degrees[2..].iter().sum()),
            condition: FigureSpread {
                p50: quantile(&self.conditions, 0.5),
                p95: quantile(&self.conditions, 0.95),
                max: quantile(&self.conditions, 1.0),
            },
            rejected: self.rejected,
            holes: self.holes,
            longest_hole_s: tidy_ms(self.longest_hole_s) * 1e-3,
            force_renewal_hz: self.renewals.slow_hz(motion.rate_hz),
            position_scale: unit.scale,
            tick_us: IdentificationTime { p50: tick.p50, p99: tick.p99, max: tick.max },
        }
    }
}

/// Converts seconds to milliseconds, rounded to remove the error of the division.
fn tidy_ms(seconds: f64) -> f64 {
    (seconds * 1e9).round() * 1e-6
}

/// Errors stored to compute percentiles.
#[derive(Default)]
struct TallyErrors {
    norms: Vec<f64>,
    sum: Vector3<f64>,
    squares: f64,
}

impl TallyErrors {
    fn add(&mut self, error: &Vector3<f64>) {
        self.norms.push(error.norm());
        self.sum += error;
        self.squares += error.norm_squared();
    }

    fn reconstruction(&self) -> Reconstruction {
        let count = self.norms.len().max(1) as f64;
        let mae = self.norms.iter().sum::<f64>() / count;
        let variance = self.squares / count - (self.sum / count).norm_squared();
        Reconstruction { mae, sd: variance.max(0.0).sqrt() }
    }

    fn figures(&mut self) -> ErrorFigures {
        let Reconstruction { mae, sd } = self.reconstruction();
        self.norms.sort_unstable_by(f64::total_cmp);
        ErrorFigures { mae, sd, p95: quantile(&self.norms, 0.95), max: quantile(&self.norms, 1.0) }
    }
}

/// Returns the quantile of sorted values (nearest rank); 0 if there are none.
fn quantile(sorted: &[f64], q: f64) -> f64 {
    let rank = (q * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.clamp(1, sorted.len().max(1)) - 1).copied().unwrap_or(0.0)
}
