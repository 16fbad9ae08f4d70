//! Plot of error over cost, both on logarithmic axes, with the Pareto front as a line.

use egui::{Color32, Ui};
use egui_plot::{
    AxisHints, GridInput, GridMark, HoverPosition, Line, MarkerShape, Plot, PlotPoint, PlotPoints, Points,
};
use nima_core::impedance::Mode;
use nima_screen::{theme, widgets::still};
use nima_study::tradeoff::{SourceFigures, SweepPoint};
use nima_words::report_text::{mode_name, three_digits};

use super::tradeoff::words;
use crate::extras::lab::text;

const HEIGHT: f32 = 230.0;
/// A point is selected if the pointer is closer to it than this fraction of the plot.
const NEAR: f64 = 0.06;

/// Draws the plot; returns the point that was clicked.
pub(super) fn plot_ui(ui: &mut Ui, figures: &SourceFigures, selected: Option<usize>) -> Option<usize> {
    let points = &figures.points;
    let shown = shown(points);
    let range = range(points, &shown)?;
    let near = |at: PlotPoint| nearest(points, &shown, &range, at);
    let plot = still(Plot::new("trade-off"))
        .height(HEIGHT)
        .custom_x_axes(vec![AxisHints::new_x().label(text::TIME_AXIS).formatter(|mark, _| plain(mark.value))])
        .custom_y_axes(vec![
            AxisHints::new_y()
                .label(text::error_axis(&figures.unit))
                .min_thickness(48.0)
                .formatter(|mark, _| plain(mark.value)),
        ])
        .x_grid_spacer(|grid| marks(&grid))
        .y_grid_spacer(|grid| marks(&grid))
        .label_formatter(|hover| {
            let (HoverPosition::NearDataPoint { position, .. } | HoverPosition::Elsewhere { position }) = hover;
            near(*position).map(|index| words(&points[index]))
        });
    let response = plot.show(ui, |plot| {
        plot.set_plot_bounds(egui_plot::PlotBounds::from_min_max(range.0, range.1));
        let mut front: Vec<[f64; 2]> =
            shown.iter().filter(|&&i| points[i].pareto).map(|&i| place(&points[i])).collect();
        front.sort_by(|a, b| a[0].total_cmp(&b[0]));
        plot.line(
            Line::new("front", PlotPoints::from(front)).color(theme::now().text_weak).width(1.2).allow_hover(false),
        );
        for mode in Mode::ALL {
            let (shape, colour, radius) = look(mode);
            let of_mode = |i: &&usize| points[**i].choice.method.mode() == Some(mode);
            let places: Vec<[f64; 2]> = shown.iter().filter(of_mode).map(|&i| place(&points[i])).collect();
            let marks = Points::new(mode_name(mode), PlotPoints::from(places));
            plot.points(marks.shape(shape).color(colour).radius(radius).allow_hover(false));
        }
        if let Some(index) = selected.filter(|index| shown.contains(index)) {
            let ring = Points::new("selected", PlotPoints::from(vec![place(&points[index])]));
            plot.points(
                ring.shape(MarkerShape::Circle).filled(false).color(theme::now().text).radius(8.0).allow_hover(false),
            );
        }
    });
    let described = text::plot(shown.len());
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, described.clone()));
    let clicked = response.response.clicked().then(|| response.response.interact_pointer_pos()).flatten()?;
    near(response.transform.value_from_position(clicked))
}

/// Returns shape, colour and size of a mode's markers.
fn look(mode: Mode) -> (MarkerShape, Color32, f32) {
    let now = theme::now();
    let looks = [
        (Mode::Anchored, MarkerShape::Circle, now.rendered, 4.0),
        (Mode::Matched, MarkerShape::Diamond, now.rendered, 4.5),
        (Mode::Best, MarkerShape::Up, now.rendered, 4.5),
        (Mode::Dfr, MarkerShape::Square, now.measured, 5.0),
        (Mode::Linear, MarkerShape::Up, now.reference, 4.5),
        (Mode::Nima, MarkerShape::Circle, now.reference, 4.0),
        (Mode::Literal, MarkerShape::Diamond, now.reference, 4.5),
    ];
    let look = looks.into_iter().find(|(known, ..)| *known == mode);
    look.map_or((MarkerShape::Cross, now.reference, 4.5), |(_, shape, colour, radius)| (shape, colour, radius))
}

/// Returns the points at the source's own rate and with the default differentiator that can be drawn.
fn shown(points: &[SweepPoint]) -> Vec<usize> {
    let usual = points.first().map(|point| point.choice.differentiator);
    (0..points.len())
        .filter(|&i| {
            let point = &points[i];
            let [x, y] = place(point);
            point.choice.every == 1 && Some(point.choice.differentiator) == usual && x.is_finite() && y.is_finite()
        })
        .collect()
}

/// Returns the position of a point: decades of time and of error.
fn place(point: &SweepPoint) -> [f64; 2] {
    [point.cost_us.p50.log10(), point.error.log10()]
}

type PlotRange = ([f64; 2], [f64; 2]);

fn range(points: &[SweepPoint], shown: &[usize]) -> Option<PlotRange> {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for &i in shown {
        for (axis, value) in place(&points[i]).into_iter().enumerate() {
            low[axis] = low[axis].min(value);
            high[axis] = high[axis].max(value);
        }
    }
    let room = |axis: usize| 0.08 * (high[axis] - low[axis]).max(0.3);
    let grown = ([low[0] - room(0), low[1] - room(1)], [high[0] + room(0), high[1] + room(1)]);
    (!shown.is_empty()).then_some(grown)
}

fn nearest(points: &[SweepPoint], shown: &[usize], (low, high): &PlotRange, at: PlotPoint) -> Option<usize> {
    let distance = |i: usize| {
        let [x, y] = place(&points[i]);
        ((x - at.x) / (high[0] - low[0])).hypot((y - at.y) / (high[1] - low[1]))
    };
    shown.iter().copied().min_by(|&a, &b| distance(a).total_cmp(&distance(b))).filter(|&i| distance(i) < NEAR)
}

/// Returns the marks at 1, 2 and 5 of every decade, or only at decades if there are many.
fn marks(grid: &GridInput) -> Vec<GridMark> {
    let (low, high) = grid.bounds;
    if !(low.is_finite() && high.is_finite()) || high - low > 60.0 {
        return Vec::new();
    }
    let decades = high - low;
    let steps: &[f64] = if decades < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let every = (decades / 6.0).ceil().max(1.0) as i32;
    (low.floor() as i32..=high.ceil() as i32)
        .filter(|decade| decade % every == 0)
        .flat_map(|decade| steps.iter().map(move |step| f64::from(decade) + step.log10()))
        .filter(|value| (low..=high).contains(value))
        .map(|value| GridMark { value, step_size: 1.0 })
        .collect()
}

/// Returns the number at a mark, whose position is in decades.
fn plain(decade: f64) -> String {
    let value = 10f64.powf(decade);
    if (0.01..1e4).contains(&value) {
        let text = format!("{value:.2}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        three_digits(value).replace(".0e", "e")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_few_and_round() {
        for (low, high) in [(0.0, 0.4), (-2.0, 1.0), (-1.5, 7.0), (-3.0, 20.0)] {
            let marks = marks(&GridInput { bounds: (low, high), base_step_size: 0.1 });
            assert!((1..=8).contains(&marks.len()), "{low} to {high}: {}", marks.len());
        }
        assert!(marks(&GridInput { bounds: (0.0, f64::NAN), base_step_size: 0.1 }).is_empty());
        assert_eq!([0.0, std::f64::consts::LOG10_2, -1.0, 3.0].map(plain), ["1", "2", "0.1", "1000"]);
    }
}
