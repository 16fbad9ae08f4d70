//! Plots as SVG, shared by evaluations, reports and studies: points and lines on linear or logarithmic axes, with a
//! legend.
//!
//! Not a plotting library, because the result must be one text file that uses the reader's own sans-serif font. Values
//! that are not finite (or not positive on a logarithmic axis) are left out; values beyond the axis are drawn at its
//! edge.

use std::fmt::Write as _;

const WIDTH: f64 = 620.0;
const HEIGHT: f64 = 460.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 56.0;
const LEGEND_LINE: f64 = 18.0;
/// Colours that most colour-blind readers can distinguish (Okabe and Ito); the markers differ too.
pub const COLOURS: [&str; 7] = ["#d55e00", "#e69f00", "#cc79a7", "#009e73", "#0072b2", "#56b4e9", "#000000"];

#[derive(Clone, Debug)]
pub struct Axis {
    pub title: String,
    pub range: [f64; 2],
    /// A logarithmic scale requires a positive range.
    pub logarithmic: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeriesStyle {
    Points,
    Line,
    Dashed,
}

#[derive(Clone, Debug)]
pub struct Series {
    /// Text in the legend; empty for no entry.
    pub name: String,
    /// Index into [`COLOURS`]; also selects the marker's shape.
    pub colour: usize,
    pub style: SeriesStyle,
    /// `(x, y)`.
    pub points: Vec<[f64; 2]>,
}

#[derive(Clone, Debug)]
pub struct Chart {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    /// Drawn in this order, later series on top.
    pub series: Vec<Series>,
}

impl Axis {
    pub fn log(title: &str, from: f64, to: f64) -> Self {
        Self { title: title.into(), range: [from, to], logarithmic: true }
    }

    pub fn linear(title: &str, from: f64, to: f64) -> Self {
        Self { title: title.into(), range: [from, to], logarithmic: false }
    }

    /// Returns an axis that covers all drawable `values`, with a small margin.
    pub fn around(title: &str, values: impl Iterator<Item = f64>, logarithmic: bool) -> Self {
        let map = |value: f64| if logarithmic { value.log10() } else { value };
        let mapped = values.map(map).filter(|value| value.is_finite());
        let (low, high) = mapped.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let room = 0.06 * (high - low).max(if logarithmic { 0.3 } else { 1.0 });
        let back = |value: f64| if logarithmic { 10.0_f64.powf(value) } else { value };
        Self { title: title.into(), range: [back(low - room), back(high + room)], logarithmic }
    }

    /// Returns the position of `value` on the axis, 0 to 1; `None` if it cannot be drawn.
    fn place(&self, value: f64) -> Option<f64> {
        let map = |value: f64| if self.logarithmic { value.log10() } else { value };
        let [from, to] = self.range.map(map);
        let place = (map(value) - from) / (to - from);
        // The logarithm of zero is minus infinity, which is drawn at the lower edge; NaN cannot be drawn.
        (!place.is_nan() && (place.is_finite() || value == 0.0)).then(|| place.clamp(0.0, 1.0))
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        let [from, to] = self.range;
        if self.logarithmic {
            let first = from.log10().ceil() as i32;
            let last = to.log10().floor() as i32;
            let step = ((last - first) / 8 + 1).max(1);
            let between: &[i32] = if to / from < 400.0 { &[1, 2, 5] } else { &[1] };
            return (first - 1..=last)
                .filter(|power| (power - first) % step == 0)
                .flat_map(|power| between.iter().map(move |&first_digit| (first_digit, power)))
                .map(|(digit, power)| (f64::from(digit) * 10.0_f64.powi(power), digit_and_power(digit, power)))
                .filter(|(value, _)| (from..=to).contains(value))
                .collect();
        }
        let rough = ((to - from) / 6.0).abs().max(f64::MIN_POSITIVE);
        let power = 10.0_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= rough).unwrap_or(rough);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        (0..=12)
            .map(|i| (from / step).ceil() * step + f64::from(i) * step)
            .filter(|value| *value <= to + 1e-9 * step)
            .map(|value| (value, format!("{:.decimals$}", if value.abs() < 1e-9 * step { 0.0 } else { value })))
            .collect()
    }
}

fn digit_and_power(digit: i32, power: i32) -> String {
    match (digit, power) {
        (1, _) => power_of_ten(power),
        (_, 0..=4) => format!("{}", i64::from(digit) * 10_i64.pow(power.unsigned_abs())),
        (_, -3..=-1) => format!("{:.*}", power.unsigned_abs() as usize, f64::from(digit) * 10.0_f64.powi(power)),
        _ => format!("{digit}\u{b7}{}", power_of_ten(power)),
    }
}

fn power_of_ten(power: i32) -> String {
    match power {
        -2..=3 => format!("{}", 10.0_f64.powi(power)),
        _ => format!("10<tspan dy=\"-6\" font-size=\"9\">{}</tspan>", power.to_string().replace('-', "\u{2212}")),
    }
}

/// Returns all charts side by side as one SVG document.
pub fn svg(charts: &[Chart]) -> String {
    let legend = charts.iter().map(legend_lines).max().unwrap_or(0) as f64 * LEGEND_LINE;
    let width = WIDTH * charts.len().max(1) as f64;
    let height = HEIGHT + legend;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    for (i, chart) in charts.iter().enumerate() {
        // Writing into a String cannot fail, here and below.
        writeln!(out, "<g transform=\"translate({} 0)\">", WIDTH * i as f64).ok();
        frame(&mut out, chart);
        chart.series.iter().for_each(|series| draw(&mut out, chart, series));
        legend_of(&mut out, chart);
        out.push_str("</g>\n");
    }
    out.push_str("</svg>\n");
    out
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn across(place: f64) -> f64 {
    LEFT + place * (WIDTH - LEFT - RIGHT)
}

fn down(place: f64) -> f64 {
    HEIGHT - BOTTOM - place * (HEIGHT - TOP - BOTTOM)
}

fn frame(out: &mut String, chart: &Chart) {
    let left = across(0.0);
    let right = across(1.0);
    let top = down(1.0);
    let bottom = down(0.0);
    writeln!(out, "<text x=\"{left}\" y=\"22\" font-size=\"14\" font-weight=\"bold\">{}</text>", escape(&chart.title))
        .ok();
    for (value, label) in chart.x.ticks() {
        let Some(x) = chart.x.place(value).map(across) else { continue };
        writeln!(out, "<path d=\"M{x:.1} {top:.1}V{bottom:.1}\" stroke=\"#dddddd\"/>").ok();
        writeln!(out, "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>", bottom + 18.0).ok();
    }
    for (value, label) in chart.y.ticks() {
        let Some(y) = chart.y.place(value).map(down) else { continue };
        writeln!(out, "<path d=\"M{left:.1} {y:.1}H{right:.1}\" stroke=\"#dddddd\"/>").ok();
        writeln!(out, "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>", left - 6.0, y + 4.0).ok();
    }
    writeln!(
        out,
        "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#444444\"/>",
        right - left,
        bottom - top
    )
    .ok();
    let middle = f64::midpoint(left, right);
    let centre = f64::midpoint(top, bottom);
    let x_title = escape(&chart.x.title);
    let y_title = escape(&chart.y.title);
    writeln!(out, "<text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x_title}</text>", bottom + 40.0).ok();
    writeln!(out, "<text transform=\"translate(16 {centre:.1}) rotate(-90)\" text-anchor=\"middle\">{y_title}</text>")
        .ok();
}

fn colour(series: &Series) -> &'static str {
    COLOURS[series.colour % COLOURS.len()]
}

fn draw(out: &mut String, chart: &Chart, series: &Series) {
    let place = |[x, y]: [f64; 2]| Some([across(chart.x.place(x)?), down(chart.y.place(y)?)]);
    let points: Vec<[f64; 2]> = series.points.iter().filter_map(|point| place(*point)).collect();
    if series.style != SeriesStyle::Points && !points.is_empty() {
        let dashes = if series.style == SeriesStyle::Dashed { " stroke-dasharray=\"5 4\"" } else { "" };
        write!(out, "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{dashes} points=\"", colour(series))
            .ok();
        for [x, y] in &points {
            write!(out, "{x:.1},{y:.1} ").ok();
        }
        out.push_str("\"/>\n");
    }
    if series.style != SeriesStyle::Dashed {
        for [x, y] in points {
            marker(out, series, x, y);
        }
    }
}

/// Draws a circle, square, triangle, diamond or cross, depending on the series' colour index.
fn marker(out: &mut String, series: &Series, x: f64, y: f64) {
    let path = match series.colour % 5 {
        0 => "m-3 -3l6 6m0 -6l-6 6",
        1 => "m-3 -3h6v6h-6z",
        2 => "m0 -4l4 7h-8z",
        3 => "m0 -4l4 4l-4 4l-4 -4z",
        _ => "m-3 0a3 3 0 1 0 6 0a3 3 0 1 0 -6 0z",
    };
    let colour = colour(series);
    writeln!(
        out,
        "<path d=\"M{x:.1} {y:.1}{path}\" fill=\"{colour}\" fill-opacity=\"0.5\" stroke=\"{colour}\" stroke-width=\"1.3\"/>"
    )
    .ok();
}

fn named(chart: &Chart) -> impl Iterator<Item = &Series> {
    chart.series.iter().filter(|series| !series.name.is_empty())
}

fn legend_lines(chart: &Chart) -> usize {
    named(chart).count().div_ceil(2)
}

/// Draws the legend in two columns below the plot.
fn legend_of(out: &mut String, chart: &Chart) {
    for (i, series) in named(chart).enumerate() {
        let x = LEFT + (i % 2) as f64 * (WIDTH - LEFT - RIGHT) / 2.0;
        let y = HEIGHT + (i / 2) as f64 * LEGEND_LINE;
        if series.style == SeriesStyle::Points {
            marker(out, series, x + 10.0, y);
        } else {
            let dashes = if series.style == SeriesStyle::Dashed { " stroke-dasharray=\"5 4\"" } else { "" };
            let colour = colour(series);
            writeln!(out, "<path d=\"M{x:.1} {y:.1}h20\" stroke=\"{colour}\" stroke-width=\"1.5\"{dashes}/>").ok();
            if series.style == SeriesStyle::Line {
                marker(out, series, x + 10.0, y);
            }
        }
        writeln!(out, "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>", x + 26.0, y + 4.0, escape(&series.name)).ok();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_has_its_place_or_none() {
        let axis = Axis::log("x", 1.0, 1e4);
        assert_eq!(axis.place(100.0), Some(0.5));
        assert_eq!(axis.place(0.0), Some(0.0));
        assert_eq!(axis.place(1e9), Some(1.0));
        assert_eq!([axis.place(-1.0), axis.place(f64::NAN), axis.place(f64::INFINITY)], [None; 3]);
        assert_eq!(Axis::linear("x", -1.0, 1.0).place(0.0), Some(0.5));
        let labels: Vec<_> = Axis::linear("x", 0.0, 1.0).ticks().into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(Axis::log("x", 1e-17, 1e4).ticks().len(), 8);
        let labels: Vec<_> = Axis::log("x", 0.15, 12.0).ticks().into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["0.2", "0.5", "1", "2", "5", "10"]);
        let around = Axis::around("x", [f64::NAN, 3.0, 0.0, 30.0].into_iter(), true);
        assert!(around.range[0] > 1.0 && around.range[0] < 3.0 && around.range[1] > 30.0);
        assert!(Axis::around("x", std::iter::empty(), true).ticks().len() > 1);
    }

    #[test]
    fn a_document_with_everything_in_it() {
        let points = vec![[1.0, 2.0], [f64::NAN, 1.0], [3.0, 4.0]];
        let series = [SeriesStyle::Points, SeriesStyle::Line, SeriesStyle::Dashed].map(|style| Series {
            name: "a < b".into(),
            colour: 1,
            style,
            points: points.clone(),
        });
        let chart = Chart {
            title: "T & U".into(),
            x: Axis::linear("delay (ms)", 0.0, 5.0),
            y: Axis::log("error (N)", 0.1, 10.0),
            series: series.to_vec(),
        };
        let text = svg(&[chart.clone(), chart]);
        assert!(text.starts_with("<svg") && text.ends_with("</svg>\n"));
        assert_eq!(text.matches("<polyline").count(), 4);
        assert!(text.contains("T &amp; U") && text.contains("a &lt; b") && !text.contains("NaN"));
    }
}
