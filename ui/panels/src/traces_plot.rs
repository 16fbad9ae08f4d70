//! One plot of the traces: its lines, axes, marks and cursors.

use egui::{Align2, Button, Color32, Rect, RichText, Sense, Ui, UiBuilder, pos2, vec2};
use egui_plot::{
    AxisHints, FilledArea, HoverPosition, Line, LineStyle, Plot, PlotBounds, PlotPoint, PlotPoints, PlotResponse,
    PlotUi, Text, VLine,
};
use nima_screen::{
    history::SignalHistory,
    live::LiveState,
    signals::{TraceInk, TracePlot},
    theme,
    units::{DisplayUnit, PlotUnits},
    widgets::{small, still},
};
use nima_words::{
    language::word,
    report_text::{UNKNOWN, sentence},
    text,
};

use super::{
    axis::{marks, near_end, plain, signed},
    traces::{columns, time_axis_height},
    traces_menu::menu_ui,
    traces_state::TracesState,
};

/// Opacity of the band between the lowest and the highest sample of a column.
const BAND: f32 = 0.3;

const fn colour(ink: TraceInk) -> fn() -> Color32 {
    match ink {
        TraceInk::Measured => || theme::now().measured,
        TraceInk::Rendered => || theme::now().rendered,
        TraceInk::Other => || theme::now().reference,
        TraceInk::Third => || theme::now().engaged,
    }
}

/// Returns a value with sign and unit, or the sign for an unknown one.
pub(super) fn with_unit(value: Option<f64>, DisplayUnit { name, factor, decimals }: DisplayUnit) -> String {
    let words = |value| format!("{} {name}", signed(factor * value, decimals)).trim_end().to_owned();
    value.map_or_else(|| UNKNOWN.to_owned(), words)
}

/// Returns the values of all lines at the end of this interval, and their maxima in it.
pub(super) fn summary(
    history: &SignalHistory,
    plot: TracePlot,
    unit: DisplayUnit,
    (from_s, to_s): (f64, f64),
) -> String {
    let lines = plot.lines().iter().rev().map(|line| {
        let now = history.value_at(line.channel, to_s.min(history.latest_s()));
        let max = history.extent(&[line.channel], (from_s, to_s)).map(|(low, high)| high.max(-low));
        let read = |value: Option<f64>| {
            let unknown = || word("unknown", "unbekannt").to_owned();
            value.map_or_else(unknown, |_| with_unit(value, unit))
        };
        text::traces::summary(line.name.get(), [now, max].map(read), to_s - from_s)
    });
    sentence(&lines.collect::<Vec<_>>().join("; "))
}

/// Draws the values at the cursor of another plot, in the corner of this one.
pub(super) fn read_at(ui: &Ui, history: &SignalHistory, plot: TracePlot, at_s: f64, rect: Rect) {
    let unit = PlotUnits::of(ui.ctx()).of_plot(plot);
    let values: Vec<_> = plot.lines().iter().map(|line| (line, history.value_at(line.channel, at_s))).collect();
    if values.iter().all(|(_, value)| value.is_none()) {
        return;
    }
    let corner = rect.right_top() + vec2(-8.0, 4.0);
    let words = values.iter().rev().map(|(line, value)| format!("{} {}", line.name.get(), with_unit(*value, unit)));
    let report = text::traces::at_cursor(plot.symbol(), &words.collect::<Vec<_>>().join(", "));
    label(
        ui,
        ("cursor", plot.index()),
        Rect::from_min_max(corner - vec2(160.0, 0.0), corner + vec2(0.0, 16.0)),
        &report,
    );
    let mut right = corner.x;
    for (line, value) in values {
        let place = pos2(right, corner.y);
        let words = with_unit(value, unit);
        let drawn = ui.painter().text(place, Align2::RIGHT_TOP, words, theme::strong(13.0), colour(line.ink)());
        right = drawn.left() - 10.0;
    }
}

/// Names painted text for screen readers.
fn label(ui: &Ui, id: impl std::hash::Hash + std::fmt::Debug, place: Rect, words: &str) {
    ui.interact(place, ui.scope_id().with(id), Sense::hover())
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, words));
}

/// Draws a plot; `[first, last]`: whether it is the first or the last one of the panel.
pub(super) fn plot_ui(
    ui: &mut Ui,
    live: &LiveState,
    state: &mut TracesState,
    plot: TracePlot,
    [first, last]: [bool; 2],
    height: f32,
    cursor_s: Option<f64>,
) -> PlotResponse<()> {
    let now_s = state.now_s(state.history(live));
    let history = state.history(live);
    let (low, high) = state.range(plot);
    let unit = PlotUnits::of(ui.ctx()).of_plot(plot);
    let response = frame(ui, plot, unit, last)
        .height(height)
        .label_formatter(move |hover| {
            let (HoverPosition::NearDataPoint { position, .. } | HoverPosition::Elsewhere { position }) = hover;
            readout(history, plot, unit, now_s, position.x)
        })
        .show(ui, |ui| {
            ui.set_plot_bounds(PlotBounds::from_min_max([state.view_s.0, low], [state.view_s.1, high]));
            lines(ui, state, plot);
            for (number, mark_s) in live.marks_s.iter().enumerate() {
                let words = first.then(|| (number + 1).to_string());
                upright(ui, mark_s - now_s, high, words, LineStyle::dashed_loose());
            }
            for (number, at_s) in state.cursors_s.iter().enumerate() {
                let Some(at_s) = at_s else { continue };
                upright(ui, at_s - now_s, high, first.then(|| text::traces::cursor(number + 1)), LineStyle::Solid);
            }
            if let Some(cursor_s) = cursor_s {
                ui.vline(VLine::new("cursor", cursor_s).color(theme::now().text_weak).width(1.0).allow_hover(false));
            }
        });
    let corner = response.response.rect.left_bottom() + vec2(6.0, -18.0);
    difference_ui(ui, live, state, plot, first, corner);
    if !plot.is_of_forces() && plot.lines().len() > 1 {
        legend_ui(ui, state, plot, response.response.rect);
    }
    response
}

/// Returns the empty plot with its axes.
fn frame<'a>(ui: &Ui, plot: TracePlot, DisplayUnit { name, factor, decimals }: DisplayUnit, last: bool) -> Plot<'a> {
    let seconds = AxisHints::new_x()
        .label(if last { text::traces::TIME_AXIS.get() } else { "" })
        // By default the axis is as high as its labels in the last frame, so an axis with new labels would draw its
        // title over the numbers.
        .min_thickness(time_axis_height(ui))
        .formatter(|mark, _| plain(mark.value, 2));
    let title = if name.is_empty() { plot.symbol().to_owned() } else { format!("{} ({name})", plot.symbol()) };
    let values =
        AxisHints::new_y().label(title).min_thickness(56.0).label_spacing(12.0..=20.0).formatter(move |mark, shown| {
            if near_end(mark.value, shown) { String::new() } else { plain(factor * mark.value, decimals) }
        });
    still(Plot::new(("trace", plot.index())))
        .custom_x_axes(if last { vec![seconds] } else { vec![] })
        .custom_y_axes(vec![values])
        .show_background(false)
        .x_grid_spacer(|grid| marks(&grid, 64.0))
        .y_grid_spacer(|grid| marks(&grid, 18.0))
}

/// Draws the visible lines, each over the band of its noise.
fn lines<'a>(ui: &mut PlotUi<'a>, state: &'a TracesState, plot: TracePlot) {
    for line in plot.lines().iter().filter(|line| !state.is_hidden(line.channel)) {
        let colour = colour(line.ink)();
        for (number, run) in state.lines[line.channel].runs().enumerate() {
            let band = FilledArea::new("band", run.x, run.low, run.high).id(("band", line.channel, number));
            ui.add(band.fill_color(colour.gamma_multiply(BAND)).allow_hover(false));
            let middle = Line::new("line", PlotPoints::Borrowed(run.points)).id((line.channel, number));
            ui.line(middle.color(colour).width(1.6).allow_hover(false));
        }
    }
}

/// Draws a vertical line with its name at the top.
fn upright(ui: &mut PlotUi<'_>, at_s: f64, top: f64, words: Option<String>, style: LineStyle) {
    let colour = theme::now().text;
    ui.vline(VLine::new("mark", at_s).color(colour).width(1.2).style(style).allow_hover(false));
    if let Some(words) = words {
        let words = RichText::new(words).font(theme::strong(13.0));
        let place = PlotPoint::new(at_s, top);
        ui.text(Text::new("marks", place, words).color(colour).anchor(Align2::LEFT_TOP).allow_hover(false));
    }
}

/// Draws the difference between the two cursors.
fn difference_ui(ui: &Ui, live: &LiveState, state: &TracesState, plot: TracePlot, first: bool, corner: egui::Pos2) {
    let [Some(one_s), Some(two_s)] = state.cursors_s else { return };
    let history = state.history(live);
    let unit = PlotUnits::of(ui.ctx()).of_plot(plot);
    let mut words = if first { vec![text::traces::between(two_s - one_s)] } else { Vec::new() };
    for line in plot.lines().iter().rev().filter(|line| !state.is_hidden(line.channel)) {
        let [one, two] = [one_s, two_s].map(|at_s| history.value_at(line.channel, at_s));
        let difference = one.zip(two).map(|(one, two)| two - one);
        words.push(format!("{} {}", line.name.get(), with_unit(difference, unit)));
    }
    let words = words.join("   ");
    let font = theme::strong(12.5);
    let galley = ui.painter().layout_no_wrap(words.clone(), font, theme::now().text);
    let place = Rect::from_min_size(corner, galley.size());
    ui.painter().rect_filled(place.expand(2.0), 2.0, theme::now().card);
    ui.painter().galley(corner, galley, theme::now().text);
    label(ui, ("difference", plot.index()), place, &text::traces::difference(plot.symbol(), &words));
}

/// Draws the names of the lines in the corner; a click hides or shows a line.
fn legend_ui(ui: &mut Ui, state: &mut TracesState, plot: TracePlot, rect: Rect) {
    let mut left = rect.left() + 6.0;
    for line in plot.lines().iter().rev() {
        let is_hidden = state.is_hidden(line.channel);
        let words = RichText::new(line.name.get()).font(theme::strong(12.0)).color(colour(line.ink)());
        let button = Button::new(if is_hidden { small(line.name.get()).strikethrough() } else { words });
        let place = Rect::from_min_size(pos2(left, rect.top() + 2.0), vec2(rect.width(), 18.0));
        let mut corner = ui.new_child(UiBuilder::new().max_rect(place).id_salt(("legend", line.channel)));
        let response = corner.add(button.frame_when_inactive(false).small().wrap_mode(egui::TextWrapMode::Extend));
        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, !is_hidden, line.name.get()));
        left = response.rect.right() + 4.0;
        if response.on_hover_text(text::traces::LEGEND_HOVER).clicked() {
            state.toggle(&[line.channel]);
        }
    }
}

fn readout(history: &SignalHistory, plot: TracePlot, unit: DisplayUnit, now_s: f64, at_s: f64) -> Option<String> {
    let values = plot.lines().iter().rev().map(|line| (line, history.value_at(line.channel, now_s + at_s)));
    let values: Vec<_> = values.collect();
    let is_known = values.iter().any(|(_, value)| value.is_some());
    let axis = if TracePlot::FORCES.contains(&plot) { format!(" {}", plot.symbol()) } else { String::new() };
    let lines = values.iter().map(|(line, value)| format!("{}{axis} {}", line.name.get(), with_unit(*value, unit)));
    is_known.then(|| text::traces::before_now(-at_s, &lines.collect::<Vec<_>>().join("\n")))
}

/// Moves and zooms the view by the mouse, sets cursors, and opens the menu.
pub(super) fn interact(
    ui: &Ui,
    live: &LiveState,
    state: &mut TracesState,
    plots: &[TracePlot],
    plot: TracePlot,
    shown: &PlotResponse<()>,
) {
    let response = &shown.response;
    let [s_per_point, per_point] = shown.transform.dvalue_dpos();
    let now_s = state.now_s(state.history(live));
    if response.dragged() {
        state.pan(-f64::from(response.drag_delta().x) * s_per_point);
        state.pan_vertically(plot, -f64::from(response.drag_delta().y) * per_point);
    }
    if let Some(pointer) = response.hover_pos() {
        let at = shown.transform.value_from_position(pointer);
        state.cursor_s = Some(at.x);
        let (wheel, shift) = ui.input(|input| {
            // With Shift, the wheel scrolls sideways.
            let turned = input.smooth_scroll_delta();
            (turned.y + turned.x + 100.0 * (input.zoom_delta() - 1.0), input.modifiers.shift)
        });
        let factor = f64::from(wheel * 0.004).exp();
        if wheel.abs() > 0.0 && shift {
            state.zoom_vertically(plot, factor, at.y);
        } else if wheel.abs() > 0.0 {
            state.zoom(factor, at.x);
        }
        if response.clicked() {
            state.cursors_s[usize::from(shift)] = Some(now_s + at.x);
        }
        if response.secondary_clicked() {
            state.menu_s = now_s + at.x;
        }
    }
    if response.double_clicked() {
        state.reset();
    }
    let max = columns(ui);
    response.context_menu(|ui| menu_ui(ui, live, state, plots, max));
}

/// Returns the range of a plot: a round number that includes all values, and does not shrink at once when a peak leaves.
/// Forces and speeds include zero; a position does not.
pub(super) fn range(plot: TracePlot, extent: Option<(f64, f64)>, (low, high): (f64, f64)) -> (f64, f64) {
    let least = plot.min_range();
    match plot {
        TracePlot::Degree => (-0.3, least + 0.3),
        TracePlot::Position => {
            let (min, max) = extent.unwrap_or((0.0, 0.0));
            let height = round_up(max - min, least);
            let keeps = low <= min && max <= high && high - low <= 2.5 * height;
            let middle = f64::midpoint(min, max);
            if keeps { (low, high) } else { (middle - 0.6 * height, middle + 0.6 * height) }
        }
        _ => {
            let (min, max) = extent.unwrap_or((0.0, 0.0));
            let below = if plot.has_direction() { round_up(-min, least) } else { 0.04 * round_up(max, least) };
            let wanted = (-below, round_up(max, least));
            // Shrink only when less than half is used, because an axis that changes with every peak cannot be read.
            let keep = |old: f64, wanted: f64| if wanted > old || wanted < 0.45 * old { wanted } else { old };
            (-keep(-low, -wanted.0), keep(high, wanted.1))
        }
    }
}

/// Returns the next of 0.25, 0.5, 1, 1.5, 2, 3, 4, 6, 8, 12, ... times the smallest range, with a margin of one tenth.
fn round_up(value: f64, least: f64) -> f64 {
    let needed = value * 1.1;
    let mut step = least;
    while step < needed && step < 1e6 {
        step *= 2.0;
        if step >= 8.0 * least && step * 0.75 >= needed {
            return step * 0.75;
        }
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_holds_what_there_is_and_does_not_jump() {
        let range_n = |extent, old| range(TracePlot::ForceZ, extent, old);
        assert_eq!(range_n(Some((-0.1, 1.7)), (-0.25, 0.25)), (-0.25, 2.0));
        assert_eq!(range_n(Some((-0.1, 1.3)), (-0.25, 2.0)), (-0.25, 2.0), "a smaller peak keeps the range");
        assert_eq!(range_n(Some((-0.1, 0.3)), (-0.25, 2.0)), (-0.25, 0.5));
        assert_eq!(range_n(None, (-1.0, 4.0)), (-0.25, 0.25));
        assert_eq!(range_n(Some((-2.6, 0.0)), (-0.25, 0.25)), (-3.0, 0.25));
        assert!(range_n(Some((0.0, f64::INFINITY)), (-0.25, 0.25)).1.is_finite());
    }

    #[test]
    fn a_position_fills_its_axis_wherever_it_is() {
        let (low, high) = range(TracePlot::Position, Some((-312.0, -308.0)), (0.0, 0.0));
        assert!(low < -312.0 && high > -308.0 && high - low < 12.0, "{low} {high}");
        assert_eq!(range(TracePlot::Position, Some((-311.0, -308.5)), (low, high)), (low, high));
    }
}
