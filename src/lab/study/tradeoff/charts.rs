//! The curves as pictures.

use nima_charts::{Axis, Chart, Series, SeriesStyle, svg};
use nima_core::impedance::Mode;

use super::{Knob, PlanMethod, SourceFigures, SweepPoint, SweepStudy};
use crate::solvers::LeastSquaresSolver;

impl SweepStudy {
    /// Returns the images by name: error over cost for every source (under the source's name), then one for every
    /// parameter.
    pub fn images(&self) -> Vec<(String, String)> {
        let mut images: Vec<(String, String)> = Vec::new();
        for figures in &self.sources {
            let mut name = slug(&figures.source);
            while images.iter().any(|(known, _)| *known == name) {
                name.push_str("-2");
            }
            images.push((name, svg(&[cost_against_error(figures)])));
        }
        let knobs = [
            (Knob::Delay, Mode::Best, "Delay of the link (ms)"),
            (Knob::Rate, Mode::Best, "Sampling rate (Hz)"),
            (Knob::Degree, Mode::Nima, "Highest degree N"),
            (Knob::Window, Mode::Nima, "Window (ms)"),
        ];
        for (knob, mode, label) in knobs {
            images.push((format!("knob-{}", knob.name()), svg(&[self.along(knob, mode, label)])));
        }
        if let Some(first) = self.sources.iter().find(|figures| solver_curves(figures).next().is_some()) {
            images.push(("knob-solver-cost".to_owned(), svg(&[solvers(first, "Median time of one solve (us)", cost)])));
            let error = |point: &SweepPoint| point.error_p50;
            images.push(("knob-solver-error".to_owned(), svg(&[solvers(first, "Median error at the horizon", error)])));
        }
        images
    }

    /// Returns the ratio of the error to that of delayed DFR along one parameter, a line for every source.
    fn along(&self, knob: Knob, mode: Mode, label: &'static str) -> Chart {
        let line = |figures: &SourceFigures| {
            let curve =
                figures.curves.iter().find(|curve| curve.knob == knob && curve.method == PlanMethod::Mode(mode))?;
            let points = curve.points.iter().map(|&i| &figures.points[i]);
            let mut places: Vec<[f64; 2]> = points.map(|point| [setting(knob, point), point.ratio]).collect();
            places.sort_by(|a, b| a[0].total_cmp(&b[0]));
            Some((figures.source.clone(), places))
        };
        let lines: Vec<_> = self.sources.iter().filter_map(line).collect();
        let title = format!("{}, {}: error relative to delayed DFR", capital(mode.name()), knob.name());
        let mut chart =
            chart(title, [label, "Mean error / that of delayed DFR"], lines, SeriesStyle::Line, knob != Knob::Degree);
        // Always show the ratio 1, the error of delayed DFR.
        chart.y.range = [chart.y.range[0].min(0.9), chart.y.range[1].max(1.1)];
        let ends = chart.x.range.map(|x| [x, 1.0]).to_vec();
        chart.series.push(Series {
            name: "delayed DFR".to_owned(),
            colour: 6,
            style: SeriesStyle::Dashed,
            points: ends,
        });
        chart
    }
}

/// Returns the chart with all points of the modes at the base's delay and rate, and the Pareto front through them.
fn cost_against_error(figures: &SourceFigures) -> Chart {
    let base_ms = figures
        .curves
        .iter()
        .find(|curve| curve.knob == Knob::Mode)
        .and_then(|curve| curve.points.first())
        .map_or(0.0, |&index| figures.points[index].choice.delay_ms);
    let shown = |point: &&SweepPoint| point.choice.every == 1 && (point.choice.delay_ms - base_ms).abs() < f64::EPSILON;
    let modes = Mode::ALL
        .into_iter()
        .map(|mode| {
            let of_mode = |point: &&SweepPoint| point.choice.method == PlanMethod::Mode(mode);
            (mode.name().to_owned(), figures.points.iter().filter(shown).filter(of_mode).map(place).collect())
        })
        .collect();
    let mut front: Vec<[f64; 2]> =
        figures.points.iter().filter(shown).filter(|point| point.pareto).map(place).collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let title = format!("{}: cost against error at {base_ms:.0} ms (force in {})", figures.source, figures.unit);
    let mut chart =
        chart(title, ["Median time of one tick (us)", "Mean error at the horizon"], modes, SeriesStyle::Points, true);
    chart.series.push(Series { name: "Pareto front".to_owned(), colour: 6, style: SeriesStyle::Dashed, points: front });
    chart
}

/// Returns a chart of these series with a logarithmic vertical axis.
fn chart(
    title: String,
    [x, y]: [&str; 2],
    series: Vec<(String, Vec<[f64; 2]>)>,
    style: SeriesStyle,
    x_logarithmic: bool,
) -> Chart {
    let all = |axis: usize| series.iter().flat_map(|(_, points)| points).map(move |point| point[axis]);
    let x = Axis::around(x, all(0), x_logarithmic);
    let y = Axis::around(y, all(1), true);
    let numbered = series.into_iter().enumerate();
    Chart {
        title,
        x,
        y,
        series: numbered.map(|(colour, (name, points))| Series { name, colour, style, points }).collect(),
    }
}

fn place(point: &SweepPoint) -> [f64; 2] {
    [point.cost_us.p50, point.error]
}

fn cost(point: &SweepPoint) -> f64 {
    point.cost_us.p50
}

fn solver_curves(figures: &SourceFigures) -> impl Iterator<Item = (LeastSquaresSolver, &[usize])> {
    figures.curves.iter().filter_map(|curve| match curve.method {
        PlanMethod::Solver(solver) if curve.knob == Knob::Window => Some((solver, &curve.points[..])),
        _ => None,
    })
}

/// Returns the chart with one value of every solver over the length of the window.
fn solvers(figures: &SourceFigures, label: &'static str, figure: impl Fn(&SweepPoint) -> f64) -> Chart {
    let line = |(solver, points): (LeastSquaresSolver, &[usize])| {
        let places = points.iter().map(|&i| &figures.points[i]);
        (solver.name().to_owned(), places.map(|point| [point.choice.window_ms, figure(point)]).collect())
    };
    let title = format!("{}: solvers of the plain model, all degrees", figures.source);
    chart(title, ["Window (ms)", label], solver_curves(figures).map(line).collect(), SeriesStyle::Line, true)
}

fn setting(knob: Knob, point: &SweepPoint) -> f64 {
    match knob {
        Knob::Degree => point.choice.degree as f64,
        Knob::Rate => point.choice.rate_hz,
        Knob::Delay => point.choice.delay_ms,
        _ => point.choice.window_ms,
    }
}

/// Returns a name that is safe in a path.
fn slug(name: &str) -> String {
    let mut slug = String::new();
    for c in name.chars() {
        if c.is_ascii_alphanumeric() || c == '_' {
            slug.push(c.to_ascii_lowercase());
        } else if !slug.ends_with('-') {
            slug.push('-');
        }
    }
    slug.trim_matches('-').to_owned()
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| first.to_ascii_uppercase().to_string() + letters.as_str())
}
