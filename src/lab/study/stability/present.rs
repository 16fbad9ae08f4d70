//! The report as a table, as CSV and as a picture.

use std::fmt::Write as _;

use nima_charts::{Axis, Chart, Series, SeriesStyle, svg};

use super::{
    LeastSquaresSolver, ORDINARY_CONDITION, RenderingVerdict, StabilityEntry, StabilityError, StabilityExtreme,
    StabilityOptions, StabilityReport, TARGET, study,
};
use crate::{Experiment, Findings};

impl StabilityReport {
    /// Returns CSV with one row per case, solver and degree; a missing value is empty.
    pub fn csv(&self) -> String {
        let mut out = String::from(
            "group,name,rate_hz,window,solver,degree,asked,finite,error,unknowns,rank,deficient,condition,unit_difference\n",
        );
        let figure = |value: Option<f64>| value.map(|value| format!("{value:e}")).unwrap_or_default();
        for extreme in &self.extremes {
            let StabilityExtreme { group, name, rate_hz, window, .. } = extreme;
            for entry in &extreme.entries {
                let StabilityEntry { degree, asked, finite, unknowns, rank, deficient, .. } = entry;
                // Writing into a String cannot fail.
                writeln!(
                    out,
                    "{group},{name},{rate_hz},{window},{},{degree},{asked},{finite},{},{unknowns},{rank},{deficient},{},{}",
                    entry.solver.name(),
                    figure(entry.error),
                    figure(entry.condition),
                    figure(entry.unit_difference),
                )
                .ok();
            }
        }
        out
    }

    fn as_text(&self) -> String {
        let verdict = &self.verdict;
        let drift = &self.drift;
        let mut out = String::from(
            "\nWorst relative error of the predicted force, degrees 1 to 5, against an exact solution of the same problem;\n\
             k/30: k of 30 predictions were finite; *: the rows do not determine the solution;\n\
             condition: of the scaled columns with the ridge (ours).\n\n",
        );
        for failures in &verdict.failures {
            writeln!(
                out,
                "{:<15} of {} cases and degrees: {} not finite, {} off by more than 1 %",
                failures.solver.name(),
                failures.tried,
                failures.not_finite,
                failures.wrong
            )
            .ok();
        }
        writeln!(
            out,
            "ours            finite {:.1} %, error {:.1e} (target {TARGET:.0e} below condition {ORDINARY_CONDITION:.0e}; anywhere {:.1e}, largest condition {:.1e})",
            verdict.ours_finite_fraction * 100.0,
            verdict.ours_worst_error,
            verdict.ours_worst_error_anywhere,
            verdict.ours_worst_condition,
        )
        .ok();
        writeln!(
            out,
            "m against mm     ours {:.1e}, pseudo-inverse {:.1e}",
            verdict.ours_unit_difference, verdict.pseudo_inverse_unit_difference
        )
        .ok();
        let late = drift.running_sums_late.map_or_else(|| "none".into(), |late| format!("{late:.1e}"));
        writeln!(
            out,
            "{} ticks  ours {:.1e} early, {:.1e} late; running sums {:.1e} early, {late} late",
            drift.ticks, drift.ours_early, drift.ours_late, drift.running_sums_early
        )
        .ok();
        for RenderingVerdict { mode, finite_fraction, unit_difference, worst_case, long_run_difference, .. } in
            &verdict.renderings
        {
            let long = long_run_difference.map_or_else(|| "too few to judge".into(), |late| format!("{late:.1e}"));
            writeln!(
                out,
                "{:<15} finite {:.1} %, m against mm {unit_difference:.1e} ({worst_case}), {} ticks against the last 500000 alone {long}",
                mode.name(),
                finite_fraction * 100.0,
                drift.ticks,
            )
            .ok();
        }
        write!(out, "targets {}", if verdict.reached { "reached" } else { "MISSED" }).ok();
        out
    }

    /// Draws plots of error over condition for every case and degree, and of error over amplitude at degree 5.
    pub fn svg(&self) -> String {
        svg(&[self.by_condition(), self.by_amplitude()])
    }

    fn by_condition(&self) -> Chart {
        let mut series: Vec<Series> = LeastSquaresSolver::ALL
            .iter()
            .enumerate()
            .map(|(colour, solver)| {
                let entries = self.extremes.iter().flat_map(|extreme| &extreme.entries);
                let points = entries
                    .filter(|entry| entry.solver == *solver)
                    .filter(|entry| entry.error.is_some() || entry.finite < entry.asked)
                    .map(|entry| [entry.condition.unwrap_or(f64::MAX), height(entry)])
                    .collect();
                Series { name: solver.name().into(), colour, style: SeriesStyle::Points, points }
            })
            .collect();
        let target = vec![[1.0, TARGET], [ORDINARY_CONDITION, TARGET], [ORDINARY_CONDITION, 1e-17]];
        series.push(Series {
            name: "target: below the line, or to the right of it".into(),
            colour: 6,
            style: SeriesStyle::Dashed,
            points: target,
        });
        Chart {
            title: "Every case and degree (upper edge: no finite answer)".into(),
            x: Axis::log("condition of the solver's own columns (right edge: infinite)", 1.0, 1e18),
            y: Axis::log("worst relative error of the force", 1e-17, 1e6),
            series,
        }
    }

    fn by_amplitude(&self) -> Chart {
        let sizes = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.2];
        let amplitudes = || self.extremes.iter().filter(|extreme| extreme.group == "amplitude");
        let series = LeastSquaresSolver::ALL.iter().enumerate().map(|(colour, solver)| {
            let five = |extreme: &StabilityExtreme| {
                extreme.entries.iter().find(|entry| entry.solver == *solver && entry.degree == 5).map(height)
            };
            let points = sizes.iter().zip(amplitudes()).filter_map(|(size, extreme)| Some([*size, five(extreme)?]));
            Series { name: solver.name().into(), colour, style: SeriesStyle::Line, points: points.collect() }
        });
        Chart {
            title: "Degree 5, 300 samples at 1 kHz".into(),
            x: Axis::log("amplitude of the motion (m)", 7e-7, 0.3),
            y: Axis::log("worst relative error of the force", 1e-17, 1e6),
            series: series.collect(),
        }
    }
}

/// Returns the vertical position of an error; the upper edge if there is no answer.
fn height(entry: &StabilityEntry) -> f64 {
    if entry.finite < entry.asked { f64::MAX } else { entry.error.unwrap_or(f64::MAX) }
}

fn worst(extreme: &StabilityExtreme, solver: LeastSquaresSolver) -> String {
    let of = || extreme.entries.iter().filter(|entry| entry.solver == solver);
    let (asked, finite) = of().fold((0, 0), |(a, f), entry| (a + entry.asked, f + entry.finite));
    let mark = if of().any(|entry| entry.deficient) { "*" } else { "" };
    if finite < asked {
        return format!("{finite}/{asked}{mark}");
    }
    let error = of().filter_map(|entry| entry.error).reduce(f64::max);
    error.map_or_else(|| "-".into(), |error| format!("{error:.1e}{mark}"))
}

fn condition(extreme: &StabilityExtreme) -> String {
    let ours = extreme.entries.iter().filter(|entry| entry.solver == LeastSquaresSolver::Sliding);
    let condition = ours.filter_map(|entry| entry.condition).reduce(f64::max);
    condition.map_or_else(|| "-".into(), |condition| format!("{condition:.1e}"))
}

impl Experiment for StabilityOptions {
    const NAME: &'static str = "stability";
    const FILES: &'static [&'static str] = &[".csv", ".svg"];
    type Findings = StabilityReport;
    type Error = StabilityError;

    fn run(&self, progress: &mut dyn FnMut(usize, usize, &str)) -> Result<StabilityReport, StabilityError> {
        study(self, progress)
    }
}

impl Findings for StabilityReport {
    /// Returns the table of every solver's worst relative error over degrees 1 to 5 in every case, then the comparison
    /// with the targets.
    fn text(&self) -> String {
        let mut out = format!("{:<10} {:<37}", "extreme", "");
        for solver in LeastSquaresSolver::ALL {
            write!(out, " {:>14}", solver.name()).ok();
        }
        out.push_str("  condition\n");
        for extreme in &self.extremes {
            write!(out, "{:<10} {:<37}", extreme.group, extreme.name).ok();
            for solver in LeastSquaresSolver::ALL {
                write!(out, " {:>14}", worst(extreme, solver)).ok();
            }
            writeln!(out, "  {:>9}", condition(extreme)).ok();
        }
        out.push_str(&self.as_text());
        out
    }

    fn files(&self) -> Vec<(String, String)> {
        vec![(".csv".to_owned(), self.csv()), (".svg".to_owned(), self.svg())]
    }
}
