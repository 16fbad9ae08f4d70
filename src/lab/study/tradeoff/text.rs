//! The results as text for a terminal.

use std::fmt::Write as _;

use nima_core::impedance::Mode;

use super::{Knob, ParameterChoice, PlanMethod, SourceFigures, SweepPoint, SweepStudy};
use crate::Findings;

impl Findings for SweepStudy {
    fn text(&self) -> String {
        let mut text = String::new();
        for figures in &self.sources {
            source_text(figures, &mut text);
        }
        text.push_str(
            "cost: time of one tick of identification on this computer, the quietest pass; error: mean 3-D distance between the \
             force rendered for t from data up to t - D and the force measured at t; ratio: to delayed DFR; *: no other choice is both faster and more accurate",
        );
        text
    }

    fn files(&self) -> Vec<(String, String)> {
        let images = self.images().into_iter().map(|(name, svg)| (format!("-{name}.svg"), svg));
        [(".csv".to_owned(), self.csv())].into_iter().chain(images).collect()
    }
}

/// Writes the description of a source. Writing to a String cannot fail, so its results are ignored.
fn source_text(figures: &SourceFigures, text: &mut String) {
    let SourceFigures { source, unit, rate_hz, samples, axes, judged_from_s, .. } = figures;
    writeln!(
        text,
        "{source}: {samples} samples at {rate_hz:.0} Hz, {axes} axes, force in {unit}, evaluated from {judged_from_s:.1} s + delay"
    )
    .ok();
    for curve in figures.curves.iter().filter(|curve| curve.knob != Knob::Grid) {
        writeln!(text, "  {} ({})", curve.knob.name(), curve.method.name()).ok();
        for &index in &curve.points {
            row(&figures.points[index], &value(curve.knob, &figures.points[index].choice), text);
        }
    }
    let mut front: Vec<&SweepPoint> = figures.points.iter().filter(|p| p.pareto && p.choice.every == 1).collect();
    front.sort_by(|a, b| a.choice.delay_ms.total_cmp(&b.choice.delay_ms).then(a.cost_us.p50.total_cmp(&b.cost_us.p50)));
    writeln!(text, "  Pareto front (delay, mode, degree, window)").ok();
    for point in front {
        let ParameterChoice { method, degree, window_ms, delay_ms, .. } = point.choice;
        let mode = method.mode();
        let degree = if mode.is_some_and(Mode::has_degrees) { format!(" N={degree}") } else { String::new() };
        let window = if mode.is_some_and(Mode::has_window) { format!(" {window_ms:.0} ms") } else { String::new() };
        row(point, &format!("{delay_ms:.0} ms {}{degree}{window}", method.name()), text);
    }
    if let Some(first) = figures.skipped.first() {
        writeln!(text, "  {} points skipped; the first: {}", figures.skipped.len(), first.reason).ok();
    }
    text.push('\n');
}

fn row(point: &SweepPoint, name: &str, text: &mut String) {
    let mark = if point.pareto { '*' } else { ' ' };
    writeln!(
        text,
        "  {mark} {name:<34} p50 {:>9.2} us   p99 {:>9.2} us   error {:<11.4e} ratio {:.3e}",
        point.cost_us.p50, point.cost_us.p99, point.error, point.ratio
    )
    .ok();
}

fn value(knob: Knob, choice: &ParameterChoice) -> String {
    match knob {
        Knob::Degree => format!("N = {}", choice.degree),
        Knob::Window => format!("{:.0} ms", choice.window_ms),
        Knob::Rate => format!("{:.1} Hz", choice.rate_hz),
        Knob::Delay => format!("{:.0} ms", choice.delay_ms),
        Knob::Differentiator => choice.differentiator.name().to_owned(),
        Knob::Mode | Knob::Grid => match choice.method {
            PlanMethod::Mode(mode) => mode.name().to_owned(),
            PlanMethod::Solver(solver) => solver.name().to_owned(),
        },
    }
}
