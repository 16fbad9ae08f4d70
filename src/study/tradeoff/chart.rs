//! A small chart as SVG: points and lines over two axes, the upright one logarithmic. Numbers that cannot be drawn are left out.

use std::fmt::Write as _;

/// Colours that stay apart for colour-blind eyes (Okabe and Ito 2008), on white.
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#7a5c00", "#000000"];
const SIZE: [f64; 2] = [760.0, 440.0];
/// Room left, top, right (for the legend) and below.
const MARGIN: [f64; 4] = [76.0, 40.0, 210.0, 56.0];

/// One name in the legend.
#[derive(Clone, Debug, Default)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) places: Vec<[f64; 2]>,
    /// Joined by a line.
    pub(super) joined: bool,
    /// With marks.
    pub(super) marked: bool,
}

/// The chart.
#[derive(Clone, Debug)]
pub(super) struct Chart {
    pub(super) title: String,
    pub(super) labels: [&'static str; 2],
    pub(super) x_logarithmic: bool,
    /// A level to compare with.
    pub(super) level: Option<f64>,
    pub(super) series: Vec<Series>,
}

/// One axis: what is shown, where.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    logarithmic: bool,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>, logarithmic: bool, (from, to): (f64, f64)) -> Self {
        let scaled = values.map(|value| if logarithmic { value.log10() } else { value });
        let (low, high) = scaled.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let room = 0.06 * (high - low).max(if logarithmic { 0.3 } else { 1.0 });
        Self { low: low - room, high: high + room, from, to, logarithmic }
    }

    fn place(&self, value: f64) -> f64 {
        let scaled = if self.logarithmic { value.log10() } else { value };
        self.from + (self.to - self.from) * (scaled - self.low) / (self.high - self.low)
    }

    /// Round values to mark.
    fn marks(&self) -> Vec<f64> {
        if !self.logarithmic {
            return (self.low.ceil() as i64..=self.high.floor() as i64).take(24).map(|value| value as f64).collect();
        }
        let decades = self.high - self.low;
        let steps: &[f64] = if decades < 2.6 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let every = (decades / 8.0).ceil().max(1.0) as i32;
        let inside = |value: &f64| (self.low..=self.high).contains(&value.log10());
        (self.low.floor() as i32..=self.high.ceil() as i32)
            .filter(|decade| decade % every == 0)
            .flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)))
            .filter(inside)
            .collect()
    }
}

impl Chart {
    /// The SVG document. Writing into a String cannot fail: its results are dropped.
    pub(super) fn svg(&self) -> String {
        let [width, height] = SIZE;
        let [left, top, right, below] = MARGIN;
        let drawn: Vec<Series> = self.series.iter().map(|series| self.drawable(series)).collect();
        let places = || drawn.iter().flat_map(|series| &series.places);
        let x = Axis::new(places().map(|place| place[0]), self.x_logarithmic, (left, width - right));
        let y = Axis::new(places().map(|place| place[1]).chain(self.level), true, (height - below, top));
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n<title>{title}</title>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n\
             <text x=\"{left}\" y=\"22\" font-size=\"15\" font-weight=\"bold\">{title}</text>\n",
            title = escaped(&self.title)
        );
        self.frame(&x, &y, &mut svg);
        for (i, series) in drawn.iter().enumerate() {
            series.draw(i, &x, &y, &mut svg);
            let at = [width - right + 22.0, top + 14.0 + 19.0 * i as f64];
            let colour = COLOURS[i % COLOURS.len()];
            if series.joined {
                let (from, to) = (at[0] - 10.0, at[0] + 10.0);
                writeln!(svg, "<path d=\"M{from} {y}H{to}\" stroke=\"{colour}\" stroke-width=\"1.6\"/>", y = at[1])
                    .ok();
            }
            if series.marked {
                svg.push_str(&mark(i, at));
            }
            writeln!(svg, "<text x=\"{}\" y=\"{}\">{}</text>", at[0] + 16.0, at[1] + 4.0, escaped(&series.name)).ok();
        }
        svg.push_str("</svg>\n");
        svg
    }

    fn drawable(&self, series: &Series) -> Series {
        let fits = |[x, y]: &[f64; 2]| x.is_finite() && y.is_finite() && *y > 0.0 && (*x > 0.0 || !self.x_logarithmic);
        Series { places: series.places.iter().copied().filter(fits).collect(), ..series.clone() }
    }

    fn frame(&self, x: &Axis, y: &Axis, svg: &mut String) {
        for value in x.marks() {
            let at = x.place(value);
            writeln!(svg, "<path d=\"M{at:.1} {}V{}\" stroke=\"#ddd\"/>", y.from, y.to).ok();
            writeln!(svg, "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>", y.from + 18.0, plain(value))
                .ok();
        }
        for value in y.marks() {
            let at = y.place(value);
            writeln!(svg, "<path d=\"M{} {at:.1}H{}\" stroke=\"#ddd\"/>", x.from, x.to).ok();
            let right = x.from - 7.0;
            writeln!(svg, "<text x=\"{right}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>", at + 4.0, plain(value)).ok();
        }
        if let Some(level) = self.level {
            let at = y.place(level);
            writeln!(svg, "<path d=\"M{} {at:.1}H{}\" stroke=\"#222\" stroke-dasharray=\"6 4\"/>", x.from, x.to).ok();
        }
        let (middle, centre) = (0.5 * (x.from + x.to), 0.5 * (y.from + y.to));
        let [across, up] = self.labels.map(escaped);
        writeln!(
            svg,
            "<path d=\"M{} {}H{}V{}H{}Z\" fill=\"none\" stroke=\"#888\"/>",
            x.from, y.from, x.to, y.to, x.from
        )
        .ok();
        writeln!(svg, "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">{across}</text>", y.from + 42.0).ok();
        let turn = format!("rotate(-90 18 {centre})");
        writeln!(svg, "<text x=\"18\" y=\"{centre}\" text-anchor=\"middle\" transform=\"{turn}\">{up}</text>").ok();
    }
}

impl Series {
    fn draw(&self, index: usize, x: &Axis, y: &Axis, svg: &mut String) {
        let colour = COLOURS[index % COLOURS.len()];
        let places: Vec<[f64; 2]> = self.places.iter().map(|[across, up]| [x.place(*across), y.place(*up)]).collect();
        if self.joined && places.len() > 1 {
            let corners: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
            let points = corners.join(" ");
            writeln!(svg, "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>")
                .ok();
        }
        if self.marked {
            for place in &places {
                svg.push_str(&mark(index, *place));
            }
        }
    }
}

/// A mark; shapes differ as well as colours.
fn mark(index: usize, [x, y]: [f64; 2]) -> String {
    let colour = COLOURS[index % COLOURS.len()];
    match index % 4 {
        0 => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{colour}\"/>\n"),
        1 => format!("<path d=\"M{x:.1} {y:.1}m0 -5l5 5l-5 5l-5 -5z\" fill=\"{colour}\"/>\n"),
        2 => format!("<path d=\"M{x:.1} {y:.1}m0 -5l5 9h-10z\" fill=\"{colour}\"/>\n"),
        _ => format!("<path d=\"M{x:.1} {y:.1}m-4 -4h8v8h-8z\" fill=\"{colour}\"/>\n"),
    }
}

fn plain(value: f64) -> String {
    if value == 0.0 || (0.001..1e5).contains(&value.abs()) {
        let text = format!("{value:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.0e}")
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        let places = vec![[1.0, 0.5], [2.0, f64::NAN], [3.0, f64::INFINITY], [0.0, 1.0], [4.0, -1.0], [5.0, 50.0]];
        let series = vec![Series { name: "a < b & c".to_owned(), places, joined: true, marked: true }];
        let chart = Chart { title: "t".to_owned(), labels: ["x", "y"], x_logarithmic: true, level: Some(1.0), series };
        let svg = chart.svg();
        assert!(svg.contains("a &lt; b &amp; c") && svg.ends_with("</svg>\n"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 3, "two places and the legend");
        let empty = Chart { series: Vec::new(), level: None, ..chart }.svg();
        assert!(!empty.contains("NaN") && !empty.contains("inf"));
    }
}
