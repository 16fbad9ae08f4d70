//! Signals over time on a common time axis: the forces, and the other values of a tick that the operator chooses.
//!
//! The view is a time interval counted back from now (or from the start of the pause). Drag to move it, turn the wheel to
//! zoom, double-click to reset, even while data arrive.

use egui::{
    Button, Frame, Label, Margin, RichText, ScrollArea, Sense, TextStyle, Ui, containers::menu::MenuButton,
    scroll_area::ScrollSource, vec2,
};
use nima_machine::rig::Side;
use nima_screen::{
    exports,
    live::LiveState,
    readings::ShaftTwist,
    scene3d::side_name,
    signals::TracePlot,
    theme,
    units::PlotUnits,
    widgets::{at_the_right, describe, force_sign, small, weak, width_of},
};
use nima_words::{language::Text, report_text::side_word, text};

use crate::panel::{Panel, PanelContext, PanelSize};

use super::{
    traces_menu::signals_ui,
    traces_plot::{interact, plot_ui, range, read_at, summary},
    traces_state::TracesState,
};

/// Height of the time axis in rows of text: its numbers, and its title with the gap that `egui_plot` leaves under it.
const TIME_AXIS_ROWS: f32 = 2.25;
/// Smallest height of a plot; if more are chosen than fit, they are scrolled.
const MIN_PLOT: f32 = 39.0;
/// Smallest height if a plot of another signal is shown: its axis has a longer title.
const MIN_OTHER: f32 = 72.0;
const GAP: f32 = 4.0;

/// Width from which the header shows a heading.
const HEADING_FROM: f32 = 800.0;
/// Channels of the measured and of the rendered force: x, y, z and magnitude.
const OF_FORCES: [[usize; 4]; 2] = [[0, 1, 2, 6], [3, 4, 5, 7]];

#[derive(Debug, Default)]
pub struct TracesPanel;

impl Panel for TracesPanel {
    const NAME: Text = text::traces::NAME;
    const MEANING: Text = text::traces::MEANING;
    const SIZE: PanelSize = PanelSize::filling([220.0, 200.0]);

    fn ui(&mut self, ui: &mut Ui, at: &mut PanelContext<'_>) {
        // Space for the last number of the time axis, half of which is outside the plot.
        Frame::new().inner_margin(Margin { left: 8, right: 18, top: 6, bottom: 6 }).show(ui, |ui| {
            force_traces_ui(ui, at.live, &mut at.panels.forces, None);
        });
    }
}

/// Draws the panel with the chosen plots below one another, or with this one only.
pub fn force_traces_ui(ui: &mut Ui, live: &mut LiveState, state: &mut TracesState, only: Option<TracePlot>) {
    let whole = ui.available_rect_before_wrap();
    state.take_png(ui.ctx(), whole);
    header_ui(ui, live, state, only.is_none());
    twist_ui(ui, live, state.side);
    exports::report_ui(ui);
    ui.add_space(2.0);
    let plots: Vec<TracePlot> = only.map_or_else(|| state.plots.plots().collect(), |one| vec![one]);
    if plots.is_empty() {
        ui.add(Label::new(weak(text::traces::NO_PLOT)).wrap());
        return;
    }
    ui.spacing_mut().item_spacing.y = GAP;
    let count = plots.len() as f32;
    let room = ui.available_height() - time_axis_height(ui) - GAP * (count - 1.0);
    let others = plots.iter().any(|plot| !TracePlot::FORCES.contains(plot));
    let least = if others { MIN_OTHER } else { MIN_PLOT };
    if room >= least * count || only.is_some() {
        plots_ui(ui, live, state, &plots, (room / count).max(least));
        return;
    }
    // The wheel zooms the plots, so only the bar scrolls them.
    ScrollArea::vertical().scroll_source(ScrollSource::SCROLL_BAR).auto_shrink(false).show(ui, |ui| {
        plots_ui(ui, live, state, &plots, least);
    });
}

fn plots_ui(ui: &mut Ui, live: &LiveState, state: &mut TracesState, plots: &[TracePlot], height: f32) {
    let now_s = state.now_s(state.history(live));
    let shown_s = (now_s + state.view_s.0, now_s + state.view_s.1);
    let max = columns(ui);
    let history = &live.history[state.side.index()];
    for line in plots.iter().flat_map(|plot| plot.lines()) {
        history.trace(line.channel, shown_s, now_s, max, &mut state.lines[line.channel]);
    }
    let cursor_s = state.cursor_s.take();
    for &plot in plots {
        let is_first = plots.first() == Some(&plot);
        let is_last = plots.last() == Some(&plot);
        let extent = history.extent(&state.visible(plot), shown_s);
        state.ranges[plot.index()] = range(plot, extent, state.ranges[plot.index()]);
        let height = if is_last { height + time_axis_height(ui) } else { height };
        let response = plot_ui(ui, live, state, plot, [is_first, is_last], height, cursor_s);
        let name = text::traces::plot(plot.name().get(), side_word(state.side));
        let unit = PlotUnits::of(ui.ctx()).of_plot(plot);
        describe(ui, &response.response, &name, || summary(history, plot, unit, shown_s));
        if is_last {
            let point_s = response.transform.dvalue_dpos()[0] / f64::from(ui.pixels_per_point());
            state.step_s = if point_s.is_finite() { point_s.max(live.min_step_s()) } else { 0.0 };
        }
        interact(ui, live, state, plots, plot, &response);
        // The plot under the pointer shows the values at the pointer itself.
        if let Some(at_s) = cursor_s.filter(|_| !response.response.hovered()) {
            read_at(ui, history, plot, now_s + at_s, response.response.rect);
        }
    }
    // The cursor is drawn in all plots; those above the pointer get it in the next frame.
    if state.cursor_s != cursor_s {
        ui.ctx().request_repaint();
    }
}

/// Returns the number of columns in which a line is drawn.
pub(super) fn columns(ui: &Ui) -> usize {
    (ui.available_width() * 0.8) as usize
}

pub(super) fn time_axis_height(ui: &Ui) -> f32 {
    TIME_AXIS_ROWS * ui.text_style_height(&TextStyle::Body)
}

/// Draws the torque about the shaft: it is not rendered, so it is not among the forces. The line of a rig that can measure it
/// stays while the torque is unknown, so that the plots do not move.
fn twist_ui(ui: &mut Ui, live: &LiveState, side: Side) {
    let ShaftTwist { jaws_nm, wrist_nm } = live.figures.twist[side.index()];
    if jaws_nm.is_some() || wrist_nm.is_some() || live.rig.devices.is_some() {
        let words = text::traces::twist([jaws_nm, wrist_nm].map(|nm| nm.map(|nm| 1e3 * nm)));
        ui.add(Label::new(small(&words)).truncate()).on_hover_text(text::traces::TWIST_HOVER);
    }
}

fn header_ui(ui: &mut Ui, live: &mut LiveState, state: &mut TracesState, chooses: bool) {
    let needed = needed_width(ui, live, state, chooses);
    if ui.available_width() < 0.8 * needed {
        ui.horizontal_wrapped(|ui| {
            legend_ui(ui, state);
            switches_ui(ui, live, state, chooses);
        });
        return;
    }
    ui.horizontal(|ui| {
        let heading = text::traces::HEADING.get();
        let style = TextStyle::Heading.resolve(ui.style());
        let with_heading = needed + width_of(ui.painter(), heading, style) + 36.0;
        if ui.available_width() > with_heading.max(HEADING_FROM) {
            ui.label(RichText::new(heading).text_style(TextStyle::Heading)).on_hover_text(text::traces::HOVER);
            ui.add_space(12.0);
        }
        if ui.available_width() < needed {
            let spacing = ui.spacing_mut();
            (spacing.item_spacing.x, spacing.button_padding.x) =
                (0.25 * spacing.item_spacing.x, 0.35 * spacing.button_padding.x);
        }
        legend_ui(ui, state);
        at_the_right(ui, |ui| switches_ui(ui, live, state, chooses));
    });
}

/// Draws the signs of both forces; a click on a name hides or shows its lines.
fn legend_ui(ui: &mut Ui, state: &mut TracesState) {
    for ((name, rendered), channels) in
        [(&text::traces::MEASURED, false), (&text::traces::RENDERED, true)].into_iter().zip(OF_FORCES)
    {
        let is_hidden = state.is_hidden(channels[0]);
        let (rect, _) = ui.allocate_exact_size(vec2(30.0, 14.0), Sense::hover());
        if !is_hidden {
            force_sign(ui.painter(), theme::now(), rect, rendered);
        }
        let words = if is_hidden { small(name.get()).strikethrough() } else { small(name.get()) };
        let button = ui.add(Button::new(words).frame_when_inactive(false));
        button.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, !is_hidden, name.get()));
        if button
            .on_hover_text(format!("{}\n{}", text::traces::LEGEND_HOVER.get(), text::traces::HOVER.get()))
            .clicked()
        {
            state.toggle(&channels);
        }
    }
}

/// Returns the width of the row without its heading, in the language of the window.
fn needed_width(ui: &Ui, live: &LiveState, state: &TracesState, chooses: bool) -> f32 {
    let of = |words: &str, style: TextStyle| width_of(ui.painter(), words, style.resolve(ui.style()));
    let signs = [text::traces::MEASURED.get(), text::traces::RENDERED.get()];
    let pause = if state.is_paused() { text::traces::GO_ON.get() } else { text::traces::PAUSE.get() };
    let mut buttons = vec![text::traces::LAST_TEN_SECONDS.get(), text::traces::MARK.get(), pause];
    if chooses {
        buttons.push(text::traces::SIGNALS.get());
    }
    if live.is_bimanual() {
        buttons.extend(Side::ALL.map(side_name));
    }
    let gaps = ui.spacing().item_spacing.x + 2.0 * ui.spacing().button_padding.x;
    let signs: f32 = signs.iter().map(|words| of(words, TextStyle::Small) + 36.0 + 3.0 * gaps).sum();
    let buttons: f32 = buttons.iter().map(|words| of(words, TextStyle::Button).max(44.0) + gaps).sum();
    signs + buttons
}

/// Switches of the traces.
fn switches_ui(ui: &mut Ui, live: &mut LiveState, state: &mut TracesState, chooses: bool) {
    let size = vec2(60.0, 26.0);
    if chooses {
        let button = Button::new(text::traces::SIGNALS).min_size(size);
        let close =
            egui::containers::menu::MenuConfig::new().close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
        let (signals, _) = MenuButton::from_button(button).config(close).ui(ui, |ui| signals_ui(ui, state));
        signals.on_hover_text(text::traces::SIGNALS_HOVER);
    }
    let reset = ui.add(Button::new(text::traces::LAST_TEN_SECONDS).min_size(size));
    if reset.on_hover_text(text::traces::LAST_TEN_SECONDS_HOVER).clicked() {
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
    let mark = ui.add_enabled(!live.is_shown_only(), Button::new(text::traces::MARK).min_size(size));
    if mark.on_hover_text(text::traces::MARK_HOVER).on_disabled_hover_text(live.of.blocked()).clicked() {
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
