//! Drawings of a session over time, as SVG.

use maud::{Markup, html};
use nima_charts::COLOURS;
use nima_session::report::{ArmFigures, EventMark, MarkLevel, STATES, SessionFigures, SignalTrace, StateSpan};

use super::html::drawing;

const WIDTH: f64 = 960.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 14.0;
const BAND: f64 = 26.0;
const PLOT: f64 = 130.0;
/// Maximum number of marks in a band: more would hide it.
const MARKS: usize = 200;
/// Height of the row of mark numbers above the triangles; marks closer together than this have one label.
const NUMBERS: f64 = 14.0;
const APART: f64 = 20.0;
/// Ticks further apart than this are not consecutive, s.
const GAP_S: f64 = 0.02;
pub(super) const NOT_RECORDED: &str = "not recorded";

/// Name, colour, and whether it is hatched: no two states differ by colour alone.
pub(super) const STATE: [(&str, &str, bool); STATES] = [
    ("no device", "#777777", true),
    ("idle", "#dddddd", false),
    ("ready", "#f0e442", false),
    ("engaged", "#009e73", false),
    ("clutched", "#56b4e9", true),
    ("stopped", "#e69f00", true),
    ("fault", "#d55e00", true),
];
fn across(t_s: f64, length_s: f64) -> f64 {
    LEFT + (t_s / length_s.max(1e-3)).clamp(0.0, 1.0) * (WIDTH - LEFT - RIGHT)
}

/// Returns a step of 1, 2 or 5 times a power of ten that divides a range into at most this many parts.
pub fn step(range: f64, parts: f64) -> f64 {
    let rough = (range / parts).max(1e-9);
    let power = 10.0_f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= rough).unwrap_or(rough)
}

fn time_axis(length_s: f64, top: f64, bottom: f64) -> Markup {
    let step_s = step(length_s, 10.0);
    let decimals = (-step_s.log10().floor()).max(0.0) as usize;
    let y = bottom + 15.0;
    html! {
        @for tick in 0..=((length_s + 1e-9) / step_s) as usize {
            @let t_s = tick as f64 * step_s;
            @let x = across(t_s, length_s);
            path d=(format_args!("M{x:.1} {top}V{bottom}")) stroke="#cccccc" {}
            text x=(format_args!("{x:.1}")) y=(y) text-anchor="middle" { (format_args!("{t_s:.decimals$}")) }
        }
        text x=(LEFT - 8.0) y=(y) text-anchor="end" { "time (s)" }
    }
}

/// Draws the states of an arm as a band, with a triangle at each warning and error, and a numbered line at each operator
/// mark.
pub(super) fn states(session: &SessionFigures, arm: &ArmFigures) -> Markup {
    let top = NUMBERS + 16.0;
    let bottom = top + BAND;
    let place = |t_s| across(t_s, session.length_s);
    let (marks, alarms): (Vec<&EventMark>, Vec<&EventMark>) = session
        .marks
        .iter()
        .filter(|mark| mark.level != MarkLevel::Info)
        .partition(|mark| mark.level == MarkLevel::Mark);
    let places: Vec<f64> = marks.iter().take(MARKS).map(|mark| place(mark.t_s)).collect();
    let body = html! {
        defs {
            pattern id="hatch" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)" {
                rect width="2" height="6" fill="#000000" fill-opacity="0.45" {}
            }
        }
        (time_axis(session.length_s, top, bottom))
        @for [from_s, to_s] in gaps(session.length_s, &arm.states) {
            rect x=(format_args!("{:.1}", place(from_s))) y=(top + 0.5) width=(width(place(from_s), place(to_s))) height=(BAND - 1.0)
                fill="#ffffff" stroke="#444444" stroke-dasharray="3 2" { title { (NOT_RECORDED) } }
        }
        @for span in &arm.states {
            @let (name, colour, hatched) = STATE[usize::from(span.state).min(STATES - 1)];
            @for fill in [Some(colour), hatched.then_some("url(#hatch)")].into_iter().flatten() {
                rect x=(format_args!("{:.1}", place(span.from_s))) y=(top) width=(width(place(span.from_s), place(span.to_s)))
                    height=(BAND) fill=(fill) { title { (name) } }
            }
        }
        @for alarm in alarms.iter().take(MARKS) {
            @let fill = if alarm.level == MarkLevel::Error { "#000000" } else { "#ffffff" };
            path d=(format_args!("M{:.1} {top}l-5 -11h10z", place(alarm.t_s))) fill=(fill) stroke="#000000" { title { (alarm.words) } }
        }
        @for (x, mark) in places.iter().zip(&marks) {
            path d=(format_args!("M{x:.1} {NUMBERS}V{bottom}")) stroke="#000000" stroke-width="2" { title { (mark.words) } }
        }
        @for (x, label) in labels(&places) {
            text x=(format_args!("{x:.1}")) y=(NUMBERS - 3.0) text-anchor="middle" font-weight="bold" { (label) }
        }
    };
    drawing([WIDTH, bottom + 22.0], &format!("States of the {} arm over time", arm.side), &body)
}

/// Returns the width between two positions; never too small to be visible.
fn width(from: f64, to: f64) -> String {
    format!("{:.1}", (to - from).max(0.8))
}

/// Returns the beginning and end of each period in which nothing was recorded, s, so that it is not mistaken for a
/// state.
fn gaps(length_s: f64, states: &[StateSpan]) -> Vec<[f64; 2]> {
    let mut before_s = 0.0_f64;
    let mut gaps = Vec::new();
    let ends = states.iter().map(|span| (span.from_s, span.to_s));
    for (from_s, to_s) in ends.chain([(length_s, length_s)]) {
        if from_s - before_s > GAP_S {
            gaps.push([before_s, from_s]);
        }
        before_s = before_s.max(to_s);
    }
    gaps
}

/// Returns the positions and texts of the mark numbers; close marks share one label, such as 1-3.
fn labels(places: &[f64]) -> Vec<(f64, String)> {
    // First and last index, then first and last position.
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
pub(super) fn forces(session: &SessionFigures, arm: &ArmFigures) -> Markup {
    let largest_n = arm.traces.iter().map(SignalTrace::largest).fold(0.1, f64::max);
    let names = [("measured", COLOURS[4]), ("delayed", COLOURS[3]), ("rendered", COLOURS[0])];
    let step_n = step(largest_n, 4.0);
    let decimals = (-step_n.log10().floor()).max(0.0) as usize;
    let ends = 3.0 * PLOT - 6.0;
    let body = html! {
        @for (i, (trace, (name, colour))) in arm.traces.iter().zip(names).enumerate() {
            @let top = PLOT * i as f64 + 20.0;
            @let bottom = PLOT * (i + 1) as f64 - 6.0;
            @let up = |force_n: f64| bottom - force_n / (1.05 * largest_n) * (bottom - top);
            @for tick in 0..=(1.05 * largest_n / step_n) as usize {
                @let force_n = tick as f64 * step_n;
                path d=(format_args!("M{LEFT} {:.1}H{}", up(force_n), WIDTH - RIGHT)) stroke="#dddddd" {}
                text x=(LEFT - 6.0) y=(format_args!("{:.1}", up(force_n) + 4.0)) text-anchor="end" { (format_args!("{force_n:.decimals$}")) }
            }
            text x=(LEFT) y=(top - 6.0) font-weight="bold" { (name) " (N)" }
            path d=(path(trace, session.length_s, up)) stroke=(colour) stroke-width="1.7" fill="none" {}
        }
        (time_axis(session.length_s, ends, ends))
    };
    drawing([WIDTH, 3.0 * PLOT + 20.0], &format!("Forces of the {} arm over time", arm.side), &body)
}

/// Returns a vertical line for each bucket of a trace, from its minimum to its maximum force.
fn path(trace: &SignalTrace, length_s: f64, up: impl Fn(f64) -> f64) -> String {
    let line = |(bucket, range): (usize, &Option<[f64; 2]>)| {
        let [min_n, max_n] = (*range)?;
        let x = across((bucket as f64 + 0.5) * trace.step_s, length_s);
        Some(format!("M{x:.1} {:.1}V{:.1}", up(max_n) - 0.6, up(min_n) + 0.6))
    };
    trace.buckets.iter().enumerate().filter_map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_marks_that_are_close_together_do_not_cover_each_other() {
        let report = labels(&[100.0, 104.0, 108.0, 300.0, 940.0, 944.0]);
        let texts: Vec<&str> = report.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["1-3", "4", "5-6"]);
        assert!(report.windows(2).all(|pair| pair[1].0 - pair[0].0 >= APART), "{report:?}");
    }

    #[test]
    fn what_was_not_recorded_is_no_state() {
        let span = |from_s, to_s, state| StateSpan { from_s, to_s, state };
        assert_eq!(gaps(10.0, &[span(0.0, 4.0, 3), span(4.7, 10.0, 6)]), [[4.0, 4.7]]);
        assert!(gaps(10.0, &[span(0.0, 4.0, 3), span(4.001, 10.0, 6)]).is_empty(), "the next tick");
        assert_eq!(gaps(10.0, &[span(2.0, 4.0, 3)]), [[0.0, 2.0], [4.0, 10.0]], "before and after");
    }
}
