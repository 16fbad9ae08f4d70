//! Drawings of a session over time, as SVG.

use std::fmt::Write as _;

use nima_charts::COLOURS;
use nima_session::report::{ArmFigures, Figures, Mark, MarkLevel, STATES, Span, Trace};

use super::html::escape;

const WIDTH: f64 = 960.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 14.0;
const BAND: f64 = 26.0;
const PLOT: f64 = 130.0;
/// Maximum number of marks in a band: more would hide it.
const MARKS: usize = 200;
/// Height of the row of mark numbers above the triangles; marks closer together than this share a label.
const NUMBERS: f64 = 14.0;
const APART: f64 = 20.0;
/// Ticks further apart than this are not consecutive, s.
const GAP_S: f64 = 0.02;
pub(super) const NOT_RECORDED: &str = "not recorded";

/// Name, colour and whether it is hatched: no two states differ by colour alone.
pub(super) const STATE: [(&str, &str, bool); STATES] = [
    ("no device", "#777777", true),
    ("idle", "#dddddd", false),
    ("ready", "#f0e442", false),
    ("engaged", "#009e73", false),
    ("clutched", "#56b4e9", true),
    ("stopped", "#e69f00", true),
    ("fault", "#d55e00", true),
];
const HATCH: &str = "<pattern id=\"hatch\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">\
    <rect width=\"2\" height=\"6\" fill=\"#000000\" fill-opacity=\"0.45\"/></pattern>";

fn across(t_s: f64, length_s: f64) -> f64 {
    LEFT + (t_s / length_s.max(1e-3)).clamp(0.0, 1.0) * (WIDTH - LEFT - RIGHT)
}

fn begin(height: f64, name: &str) -> String {
    format!(
        "<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{0}\" font-family=\"sans-serif\" font-size=\"12\">\n<title>{0}</title>\n",
        escape(name)
    )
}

/// A step of 1, 2 or 5 times a power of ten that divides a range into at most this many parts.
pub(crate) fn step(range: f64, parts: f64) -> f64 {
    let rough = (range / parts).max(1e-9);
    let power = 10.0_f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= rough).unwrap_or(rough)
}

fn time_axis(out: &mut String, length_s: f64, top: f64, bottom: f64) {
    let step_s = step(length_s, 10.0);
    let decimals = (-step_s.log10().floor()).max(0.0) as usize;
    let mut t_s = 0.0;
    while t_s <= length_s + 1e-9 {
        let x = across(t_s, length_s);
        // Writing to a String cannot fail, here and below.
        writeln!(out, "<path d=\"M{x:.1} {top}V{bottom}\" stroke=\"#cccccc\"/>").ok();
        writeln!(out, "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{t_s:.decimals$}</text>", bottom + 15.0).ok();
        t_s += step_s;
    }
    writeln!(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">time (s)</text>", LEFT - 8.0, bottom + 15.0).ok();
}

/// Draws the states of an arm as a band, with a triangle at each warning and error, and a numbered line at each operator
/// mark.
pub(super) fn states(session: &Figures, arm: &ArmFigures) -> String {
    let top = NUMBERS + 16.0;
    let bottom = top + BAND;
    let mut out = begin(bottom + 22.0, &format!("States of the {} arm over time", arm.side));
    writeln!(out, "<defs>{HATCH}</defs>").ok();
    time_axis(&mut out, session.length_s, top, bottom);
    gaps(&mut out, session.length_s, &arm.states, top);
    for span in &arm.states {
        let (name, colour, hatched) = STATE[usize::from(span.state).min(STATES - 1)];
        let x = across(span.from_s, session.length_s);
        let width = (across(span.to_s, session.length_s) - x).max(0.8);
        for fill in [Some(colour), hatched.then_some("url(#hatch)")].into_iter().flatten() {
            writeln!(out, "<rect x=\"{x:.1}\" y=\"{top}\" width=\"{width:.1}\" height=\"{BAND}\" fill=\"{fill}\"><title>{name}</title></rect>")
                .ok();
        }
    }
    let is_mark = |mark: &&Mark| mark.level == MarkLevel::Mark;
    for mark in session.marks.iter().filter(|mark| mark.level != MarkLevel::Info && !is_mark(mark)).take(MARKS) {
        let x = across(mark.t_s, session.length_s);
        let fill = if mark.level == MarkLevel::Error { "#000000" } else { "#ffffff" };
        writeln!(
            out,
            "<path d=\"M{x:.1} {top}l-5 -11h10z\" fill=\"{fill}\" stroke=\"#000000\"><title>{}</title></path>",
            escape(&mark.words)
        )
        .ok();
    }
    let marks: Vec<&Mark> = session.marks.iter().filter(is_mark).take(MARKS).collect();
    for mark in &marks {
        let x = across(mark.t_s, session.length_s);
        writeln!(
            out,
            "<path d=\"M{x:.1} {NUMBERS}V{bottom}\" stroke=\"#000000\" stroke-width=\"2\"><title>{}</title></path>",
            escape(&mark.words)
        )
        .ok();
    }
    let places: Vec<f64> = marks.iter().map(|mark| across(mark.t_s, session.length_s)).collect();
    for (x, label) in labels(&places) {
        let y = NUMBERS - 3.0;
        writeln!(out, "<text x=\"{x:.1}\" y=\"{y}\" text-anchor=\"middle\" font-weight=\"bold\">{label}</text>").ok();
    }
    out.push_str("</svg>\n");
    out
}

/// Frames the gaps of the recording, so that they are not mistaken for a state.
fn gaps(out: &mut String, length_s: f64, states: &[Span], top: f64) {
    let mut before_s = 0.0;
    let ends = states.iter().map(|span| (span.from_s, span.to_s));
    for (from_s, to_s) in ends.chain([(length_s, length_s)]) {
        if from_s - before_s > GAP_S {
            let [x, end] = [before_s, from_s].map(|t_s| across(t_s, length_s));
            writeln!(
                out,
                "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#ffffff\" stroke=\"#444444\" \
                 stroke-dasharray=\"3 2\"><title>{NOT_RECORDED}</title></rect>",
                top + 0.5,
                (end - x).max(0.8),
                BAND - 1.0
            )
            .ok();
        }
        before_s = before_s.max(to_s);
    }
}

/// Positions and texts of the mark numbers; close marks share one label, such as 1-3.
fn labels(places: &[f64]) -> Vec<(f64, String)> {
    // First and last number, first and last position.
    let mut groups: Vec<(usize, usize, f64, f64)> = Vec::new();
    for (number, x) in (1..).zip(places) {
        match groups.last_mut() {
            Some((_, last, _, end)) if x - *end < APART => (*last, *end) = (number, *x),
            _ => groups.push((number, number, *x, *x)),
        }
    }
    let label = |(first, last, begin, end): (usize, usize, f64, f64)| {
        let text = if first == last { first.to_string() } else { format!("{first}-{last}") };
        (f64::midpoint(begin, end), text)
    };
    groups.into_iter().map(label).collect()
}

/// Draws the magnitudes of the three forces, one above the other on the same scale.
pub(super) fn forces(session: &Figures, arm: &ArmFigures) -> String {
    let largest_n = arm.traces.iter().map(Trace::largest).fold(0.1, f64::max);
    let names = [("measured", COLOURS[4]), ("delayed", COLOURS[3]), ("rendered", COLOURS[0])];
    let mut out = begin(3.0 * PLOT + 20.0, &format!("Forces of the {} arm over time", arm.side));
    for (i, (trace, (name, colour))) in arm.traces.iter().zip(names).enumerate() {
        let top = PLOT * i as f64 + 20.0;
        let bottom = PLOT * (i + 1) as f64 - 6.0;
        let up = |force_n: f64| bottom - force_n / (1.05 * largest_n) * (bottom - top);
        let step_n = step(largest_n, 4.0);
        let decimals = (-step_n.log10().floor()).max(0.0) as usize;
        let mut force_n = 0.0;
        while force_n <= 1.05 * largest_n {
            let y = up(force_n);
            writeln!(out, "<path d=\"M{LEFT} {y:.1}H{}\" stroke=\"#dddddd\"/>", WIDTH - RIGHT).ok();
            writeln!(
                out,
                "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{force_n:.decimals$}</text>",
                LEFT - 6.0,
                y + 4.0
            )
            .ok();
            force_n += step_n;
        }
        writeln!(out, "<text x=\"{LEFT}\" y=\"{}\" font-weight=\"bold\">{name} (N)</text>", top - 6.0).ok();
        let mut path = String::new();
        for (bucket, range) in trace.buckets.iter().enumerate() {
            let Some([least_n, most_n]) = range else { continue };
            let x = across((bucket as f64 + 0.5) * trace.step_s, session.length_s);
            let high = up(*most_n);
            let low = up(*least_n);
            write!(path, "M{x:.1} {:.1}V{:.1}", high - 0.6, low + 0.6).ok();
        }
        writeln!(out, "<path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"1.7\" fill=\"none\"/>").ok();
        if i == 2 {
            time_axis(&mut out, session.length_s, bottom, bottom);
        }
    }
    out.push_str("</svg>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_marks_that_are_close_together_do_not_cover_each_other() {
        let told = labels(&[100.0, 104.0, 108.0, 300.0, 940.0, 944.0]);
        let texts: Vec<&str> = told.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["1-3", "4", "5-6"]);
        assert!(told.windows(2).all(|pair| pair[1].0 - pair[0].0 >= APART), "{told:?}");
    }

    #[test]
    fn what_was_not_recorded_is_no_state() {
        let span = |from_s, to_s, state| Span { from_s, to_s, state };
        let frames = |states: &[Span]| {
            let mut out = String::new();
            gaps(&mut out, 10.0, states, 0.0);
            out.matches(NOT_RECORDED).count()
        };
        assert_eq!(frames(&[span(0.0, 4.0, 3), span(4.7, 10.0, 6)]), 1);
        assert_eq!(frames(&[span(0.0, 4.0, 3), span(4.001, 10.0, 6)]), 0, "the next tick");
        assert_eq!(frames(&[span(2.0, 4.0, 3)]), 2, "before and after");
    }
}
