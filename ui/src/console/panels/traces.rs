//! Measured and rendered force over time, x, y and z, on a common time axis.
//!
//! The view is a time interval counted back from now (or from the start of the pause). Drag to move it, turn the wheel to
//! zoom, double-click to reset, even while data arrive.

use egui::{Align2, Button, Rect, RichText, Sense, TextStyle, Ui, pos2, vec2};
use egui_plot::{
    AxisHints, HoverPosition, Line, LineStyle, Plot, PlotBounds, PlotPoint, PlotPoints, PlotResponse, Text, VLine,
};
use nima_machine::rig::Side;

use super::{
    axis::{marks, near_end, plain, signed_n},
    traces_state::{MIN_RANGE_N, TracesState},
};
use crate::console::{
    history::SignalHistory,
    live::LiveState,
    readings::ShaftTwist,
    scene3d::side_name,
    text, theme,
    widgets::{at_the_right, describe, force_sign, small, still, width_of},
};
use crate::report_text::{newtons_read, side_word};

const AXES: [&str; 3] = ["x", "y", "z"];
/// Height of the time axis in rows of text: its numbers, and its title with the gap that `egui_plot` leaves under it.
const TIME_AXIS_ROWS: f32 = 2.25;

/// Width from which the header shows a heading.
const HEADING_FROM: f32 = 800.0;

/// Draws the panel, with plots of these axes (0 is x) below one another.
pub fn force_traces_ui(ui: &mut Ui, live: &mut LiveState, state: &mut TracesState, axes: &[usize]) {
    header_ui(ui, live, state);
    twist_ui(ui, live, state.side);
    ui.add_space(2.0);
    let now_s = state.now_s(state.history(live));
    let from_s = now_s + state.view_s.0;
    let to_s = now_s + state.view_s.1;
    let max = (ui.available_width() * 0.8) as usize;
    let history = &live.history[state.side.index()];
    for (channel, line) in state.lines.iter_mut().enumerate() {
        history.trace(channel, (from_s, to_s), now_s, max, line);
    }
    ui.spacing_mut().item_spacing.y = 4.0;
    let time_axis = time_axis_height(ui);
    let height = ((ui.available_height() - time_axis - 4.0 * (axes.len() - 1) as f32) / axes.len() as f32).max(48.0);
    let cursor_s = state.cursor_s.take();
    let history = &live.history[state.side.index()];
    for &axis in axes {
        let last = axes.last() == Some(&axis);
        state.ranges_n[axis] = range_n(history.extent(&[axis, axis + 3], (from_s, to_s)), state.ranges_n[axis]);
        let height = if last { height + time_axis } else { height };
        let response = plot_ui(ui, live, state, (axis, last, axes.len() == 1), height, cursor_s);
        describe(ui, &response.response, &text::traces::plot(AXES[axis], side_word(state.side)), || {
            summary(history, axis, (from_s, to_s))
        });
        if last {
            let point_s = response.transform.dvalue_dpos()[0] / f64::from(ui.pixels_per_point());
            state.step_s = if point_s.is_finite() { point_s.max(live.min_step_s()) } else { 0.0 };
        }
        interact(ui, state, &response);
        // The plot under the pointer shows the values at the pointer itself.
        if let Some(at_s) = cursor_s.filter(|_| !response.response.hovered()) {
            read_at(ui, history, axis, (now_s, at_s), response.response.rect);
        }
    }
    // The cursor is drawn in all plots; those above the pointer get it in the next frame.
    if state.cursor_s != cursor_s {
        ui.ctx().request_repaint();
    }
}

fn time_axis_height(ui: &Ui) -> f32 {
    TIME_AXIS_ROWS * ui.text_style_height(&egui::TextStyle::Body)
}

/// Returns the forces along an axis at the end of this interval, and their maximum in it.
fn summary(history: &SignalHistory, axis: usize, (from_s, to_s): (f64, f64)) -> String {
    let both = [axis, axis + 3].map(|channel| {
        let now_n = history.value_at(channel, to_s.min(history.latest_s()));
        let max_n = history.extent(&[channel], (from_s, to_s)).map(|(low, high)| high.max(-low));
        [signed_n(now_n), newtons_read(max_n, 1)]
    });
    text::traces::summary(both, to_s - from_s)
}

/// Values at the cursor of another plot, in the corner of this one.
fn read_at(ui: &Ui, history: &SignalHistory, axis: usize, (now_s, at_s): (f64, f64), rect: Rect) {
    let both_n = [axis, axis + 3].map(|channel| history.value_at(channel, now_s + at_s));
    if both_n == [None; 2] {
        return;
    }
    let [measured, rendered] = both_n.map(signed_n);
    let corner = rect.right_top() + vec2(-8.0, 4.0);
    let report = text::traces::at_cursor(AXES[axis], &measured, &rendered);
    let place = Rect::from_min_max(corner - vec2(160.0, 0.0), corner + vec2(0.0, 16.0));
    ui.interact(place, ui.scope_id().with(("cursor", axis)), Sense::hover())
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &report));
    let mut right = corner.x;
    for (words, colour) in [(rendered, theme::now().rendered), (measured, theme::now().measured)] {
        let place = ui.painter().text(pos2(right, corner.y), Align2::RIGHT_TOP, words, theme::strong(13.0), colour);
        right = place.left() - 10.0;
    }
}

/// Draws the torque about the shaft, if known: it is not rendered, so it is not among the traces.
fn twist_ui(ui: &mut Ui, live: &LiveState, side: Side) {
    let ShaftTwist { jaws_nm, wrist_nm } = live.figures.twist[side.index()];
    if jaws_nm.is_some() || wrist_nm.is_some() {
        let words = text::traces::twist([jaws_nm, wrist_nm].map(|nm| nm.map(|nm| 1e3 * nm)));
        ui.label(small(&words)).on_hover_text(text::traces::TWIST_HOVER.get());
    }
}

fn header_ui(ui: &mut Ui, live: &mut LiveState, state: &mut TracesState) {
    ui.horizontal(|ui| {
        let needed = needed_width(ui, live, state);
        let heading = text::traces::HEADING.get();
        let style = TextStyle::Heading.resolve(ui.style());
        let with_heading = needed + width_of(ui.painter(), heading, style) + 36.0;
        if ui.available_width() > with_heading.max(HEADING_FROM) {
            ui.label(RichText::new(heading).text_style(egui::TextStyle::Heading))
                .on_hover_text(text::traces::HOVER.get());
            ui.add_space(12.0);
        }
        if ui.available_width() < needed {
            let spacing = ui.spacing_mut();
            (spacing.item_spacing.x, spacing.button_padding.x) =
                (0.25 * spacing.item_spacing.x, 0.35 * spacing.button_padding.x);
        }
        for (name, rendered) in [(text::traces::MEASURED.get(), false), (text::traces::RENDERED.get(), true)] {
            let (rect, _) = ui.allocate_exact_size(vec2(30.0, 14.0), Sense::hover());
            force_sign(ui.painter(), theme::now(), rect, rendered);
            ui.label(small(name)).on_hover_text(text::traces::HOVER.get());
            ui.add_space(6.0);
        }
        at_the_right(ui, |ui| switches_ui(ui, live, state));
    });
}

/// Returns the width of the row without its heading, in the language of the window.
fn needed_width(ui: &Ui, live: &LiveState, state: &TracesState) -> f32 {
    let of = |words: &str, style: TextStyle| width_of(ui.painter(), words, style.resolve(ui.style()));
    let signs = [text::traces::MEASURED.get(), text::traces::RENDERED.get()];
    let pause = if state.is_paused() { text::traces::GO_ON.get() } else { text::traces::PAUSE.get() };
    let mut buttons = vec![text::traces::LAST_TEN_SECONDS.get(), text::traces::MARK.get(), pause];
    if live.is_bimanual() {
        buttons.extend(Side::ALL.map(side_name));
    }
    let gaps = ui.spacing().item_spacing.x + 2.0 * ui.spacing().button_padding.x;
    let signs: f32 = signs.iter().map(|words| of(words, TextStyle::Small) + 36.0 + 3.0 * gaps).sum();
    let buttons: f32 = buttons.iter().map(|words| of(words, TextStyle::Button).max(44.0) + gaps).sum();
    signs + buttons
}

/// Switches of the traces.
fn switches_ui(ui: &mut Ui, live: &mut LiveState, state: &mut TracesState) {
    let size = vec2(60.0, 26.0);
    let reset = ui.add(Button::new(text::traces::LAST_TEN_SECONDS.get()).min_size(size));
    if reset.on_hover_text(text::traces::LAST_TEN_SECONDS_HOVER.get()).clicked() {
        state.show_last_ten();
    }
    if live.is_bimanual() {
        ui.add_space(6.0);
        for side in Side::LEFT_TO_RIGHT {
            let button = Button::selectable(state.side == side, side_name(side)).frame_when_inactive(true);
            let meaning = text::traces::forces_of(side_word(side));
            if ui.add(button.min_size(vec2(52.0, 26.0))).on_hover_text(meaning).clicked() {
                state.side = side;
            }
        }
    }
    let mark = ui.add_enabled(!live.is_shown_only(), Button::new(text::traces::MARK.get()).min_size(size));
    if mark.on_hover_text(text::traces::MARK_HOVER.get()).clicked() {
        live.mark();
    }
    let paused = state.is_paused();
    let (name, meaning) = if paused {
        (text::traces::GO_ON.get(), text::traces::GO_ON_HOVER.get())
    } else {
        (text::traces::PAUSE.get(), text::traces::PAUSE_HOVER.get())
    };
    if ui.add(Button::new(name).selected(paused).min_size(size)).on_hover_text(meaning).clicked() {
        state.toggle_pause(live);
    }
}

fn plot_ui(
    ui: &mut Ui,
    live: &LiveState,
    state: &TracesState,
    (axis, last, only): (usize, bool, bool),
    height: f32,
    cursor_s: Option<f64>,
) -> PlotResponse<()> {
    let now_s = state.now_s(state.history(live));
    let history = state.history(live);
    let seconds = AxisHints::new_x()
        .label(if last { text::traces::TIME_AXIS.get() } else { "" })
        // By default the axis is as high as its labels in the last frame, so an axis with new labels would draw its
        // title over the numbers.
        .min_thickness(time_axis_height(ui))
        .formatter(|mark, _| plain(mark.value));
    let newtons = AxisHints::new_y()
        .label(format!("{} (N)", AXES[axis]))
        .min_thickness(56.0)
        .label_spacing(12.0..=20.0)
        .formatter(|mark, shown| if near_end(mark.value, shown) { String::new() } else { plain(mark.value) });
    let plot = still(Plot::new(("forces", axis)))
        .height(height)
        .custom_x_axes(if last { vec![seconds] } else { vec![] })
        .custom_y_axes(vec![newtons])
        .show_background(false)
        .x_grid_spacer(|grid| marks(&grid, 64.0))
        .y_grid_spacer(|grid| marks(&grid, 18.0))
        .label_formatter(move |hover| {
            let (HoverPosition::NearDataPoint { position, .. } | HoverPosition::Elsewhere { position }) = hover;
            readout(history, axis, now_s, position.x)
        });
    let lines = [(axis, "measured", theme::now().measured, 2.2), (axis + 3, "rendered", theme::now().rendered, 1.6)];
    let (low_n, high_n) = state.ranges_n[axis];
    plot.show(ui, |plot| {
        plot.set_plot_bounds(PlotBounds::from_min_max([state.view_s.0, low_n], [state.view_s.1, high_n]));
        for (channel, name, colour, width) in lines {
            for (run, points) in state.lines[channel].runs().enumerate() {
                let line = Line::new(name, PlotPoints::Borrowed(points)).id((name, run));
                plot.line(line.color(colour).width(width).allow_hover(false));
            }
        }
        for (number, mark_s) in live.marks_s.iter().enumerate() {
            let name = format!("mark {}", number + 1);
            let at_s = mark_s - now_s;
            let dashed = LineStyle::dashed_loose();
            plot.vline(VLine::new(name, at_s).color(theme::now().text).width(1.2).style(dashed).allow_hover(false));
            if axis == 0 || only {
                let text = RichText::new((number + 1).to_string()).font(theme::strong(13.0));
                let place = PlotPoint::new(at_s, high_n);
                plot.text(
                    Text::new("marks", place, text)
                        .color(theme::now().text)
                        .anchor(Align2::LEFT_TOP)
                        .allow_hover(false),
                );
            }
        }
        if let Some(cursor_s) = cursor_s {
            plot.vline(VLine::new("cursor", cursor_s).color(theme::now().text_weak).width(1.0).allow_hover(false));
        }
    })
}

fn readout(history: &SignalHistory, axis: usize, now_s: f64, at_s: f64) -> Option<String> {
    let both_n = [axis, axis + 3].map(|channel| history.value_at(channel, now_s + at_s));
    let [measured, rendered] = both_n.map(signed_n);
    (both_n != [None; 2]).then(|| text::traces::before_now(-at_s, AXES[axis], &measured, &rendered))
}

fn interact(ui: &Ui, state: &mut TracesState, plot: &PlotResponse<()>) {
    let response = &plot.response;
    let s_per_point = plot.transform.dvalue_dpos()[0];
    if response.dragged() {
        state.pan(-f64::from(response.drag_delta().x) * s_per_point);
    }
    if response.double_clicked() {
        state.show_last_ten();
    }
    if let Some(pointer) = response.hover_pos() {
        let at_s = plot.transform.value_from_position(pointer).x;
        state.cursor_s = Some(at_s);
        let wheel = ui.input(|input| input.smooth_scroll_delta().y + 100.0 * (input.zoom_delta() - 1.0));
        if wheel.abs() > 0.0 {
            state.zoom(f64::from(wheel * 0.004).exp(), at_s);
        }
    }
}

/// Returns the range of a plot: a round number that includes all values, and does not shrink at once when a peak
/// leaves.
fn range_n(extent_n: Option<(f64, f64)>, (low_n, high_n): (f64, f64)) -> (f64, f64) {
    let (min, max) = extent_n.unwrap_or((0.0, 0.0));
    let wanted = (-round_up(-min), round_up(max));
    // Shrink only when less than half is used, because an axis that changes with every peak cannot be read.
    let keep = |old: f64, wanted: f64| if wanted > old || wanted < 0.45 * old { wanted } else { old };
    (-keep(-low_n, -wanted.0), keep(high_n, wanted.1))
}

/// Returns the next of 0.25, 0.5, 1, 1.5, 2, 3, 4, 6, 8, 12, ... with a margin of one tenth.
fn round_up(value_n: f64) -> f64 {
    let needed = value_n * 1.1;
    let mut step = MIN_RANGE_N;
    while step < needed && step < 1e6 {
        step *= 2.0;
        if step >= 2.0 && step * 0.75 >= needed {
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
        assert_eq!(range_n(Some((-0.1, 1.7)), (-0.25, 0.25)), (-0.25, 2.0));
        assert_eq!(range_n(Some((-0.1, 1.3)), (-0.25, 2.0)), (-0.25, 2.0), "a smaller peak keeps the range");
        assert_eq!(range_n(Some((-0.1, 0.3)), (-0.25, 2.0)), (-0.25, 0.5));
        assert_eq!(range_n(None, (-1.0, 4.0)), (-0.25, 0.25));
        assert_eq!(range_n(Some((-2.6, 0.0)), (-0.25, 0.25)), (-3.0, 0.25));
        assert!(range_n(Some((0.0, f64::INFINITY)), (-0.25, 0.25)).1.is_finite());
    }
}
