//! Drawings of a session over time, as SVG.

use std::fmt::Write as _;

use nima_session::report::{ArmFigures, Figures, STATES, Trace};
use nima_study::picture::COLOURS;

use super::html::escape;

const WIDTH: f64 = 960.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 14.0;
const BAND: f64 = 26.0;
const PLOT: f64 = 130.0;
/// Most marks in a band: more would hide it.
const MARKS: usize = 200;

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
fn step(range: f64, parts: f64) -> f64 {
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
        // Writing into a String cannot fail, here and below.
        writeln!(out, "<path d=\"M{x:.1} {top}V{bottom}\" stroke=\"#cccccc\"/>").ok();
        writeln!(out, "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{t_s:.decimals$}</text>", bottom + 15.0).ok();
        t_s += step_s;
    }
    writeln!(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">time (s)</text>", LEFT - 8.0, bottom + 15.0).ok();
}

/// The states of an arm as a band, with a triangle at each warning and each error, and a numbered line at each mark of the operator.
pub(super) fn states(session: &Figures, arm: &ArmFigures) -> String {
    let (top, bottom) = (16.0, 16.0 + BAND);
    let mut out = begin(bottom + 22.0, &format!("States of the {} arm over time", arm.side));
    writeln!(out, "<defs>{HATCH}</defs>").ok();
    time_axis(&mut out, session.length_s, top, bottom);
    for span in &arm.states {
        let (name, colour, hatched) = STATE[usize::from(span.state).min(STATES - 1)];
        let x = across(span.from_s, session.length_s);
        let width = (across(span.to_s, session.length_s) - x).max(0.8);
        for fill in [Some(colour), hatched.then_some("url(#hatch)")].into_iter().flatten() {
            writeln!(out, "<rect x=\"{x:.1}\" y=\"{top}\" width=\"{width:.1}\" height=\"{BAND}\" fill=\"{fill}\"><title>{name}</title></rect>")
                .ok();
        }
    }
    let mut number = 0;
    for mark in session.marks.iter().filter(|mark| mark.level != "info").take(MARKS) {
        let x = across(mark.t_s, session.length_s);
        if mark.level == "mark" {
            number += 1;
            // At the right edge the number stands on the other side.
            let (at, anchor) = if x < WIDTH - 40.0 { (x + 3.0, "start") } else { (x - 3.0, "end") };
            writeln!(
                out,
                "<g><path d=\"M{x:.1} {}V{bottom}\" stroke=\"#000000\" stroke-width=\"2\"/>\
                 <text x=\"{at:.1}\" y=\"{}\" text-anchor=\"{anchor}\" font-weight=\"bold\">{number}</text><title>{}</title></g>",
                top - 12.0,
                top - 3.0,
                escape(&mark.words)
            )
            .ok();
            continue;
        }
        let fill = if mark.level == "error" { "#000000" } else { "#ffffff" };
        writeln!(
            out,
            "<path d=\"M{x:.1} {top}l-5 -11h10z\" fill=\"{fill}\" stroke=\"#000000\"><title>{}</title></path>",
            escape(&mark.words)
        )
        .ok();
    }
    out.push_str("</svg>\n");
    out
}

/// The lengths of the three forces, one above the other on the same scale.
pub(super) fn forces(session: &Figures, arm: &ArmFigures) -> String {
    let largest_n = arm.traces.iter().map(Trace::largest).fold(0.1, f64::max);
    let names = [("measured", COLOURS[4]), ("delayed", COLOURS[3]), ("rendered", COLOURS[0])];
    let mut out = begin(3.0 * PLOT + 20.0, &format!("Forces of the {} arm over time", arm.side));
    for (i, (trace, (name, colour))) in arm.traces.iter().zip(names).enumerate() {
        let (top, bottom) = (PLOT * i as f64 + 20.0, PLOT * (i + 1) as f64 - 6.0);
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
            let (high, low) = (up(*most_n), up(*least_n));
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
