//! Two sessions side by side on one clock: the field and the traces of each.

use egui::{CentralPanel, Frame, Label, Margin, Panel, RichText, Ui, UiBuilder, vec2};
use nima_panels::force_traces_ui;
use nima_screen::{
    scene3d::{CameraLook, scene_ui},
    theme,
    widgets::weak,
};
use nima_words::text;

use super::{Playback, signals_ui};

/// Fraction of the height for the traces.
const TRACES: f32 = 0.46;

/// Draws both, each in its half.
pub fn both_ui(ui: &mut Ui, past: &mut Playback, smooth: bool) {
    let room = ui.available_rect_before_wrap();
    let Some(mut beside) = past.beside.take() else { return };
    let (left, right) = room.split_left_right_at_fraction(0.5);
    for (name, rect, one) in [("one", left, &mut *past), ("other", right, &mut *beside)] {
        let half = UiBuilder::new().max_rect(rect.shrink2(vec2(theme::GAP / 2.0, 0.0))).id_salt(name);
        ui.scope_builder(half, |ui| half_ui(ui, one, smooth));
    }
    past.beside = Some(beside);
}

fn half_ui(ui: &mut Ui, past: &mut Playback, smooth: bool) {
    let head = Frame::new().inner_margin(Margin::symmetric(8, 4));
    let id = |of: &str| ui.scope_id().with(of);
    let whose = id("whose");
    let below = id("traces");
    Panel::top(whose).resizable(false).frame(head).show(ui, |ui| {
        let name = past.path.file_name().unwrap_or_default().to_string_lossy();
        let at = past.about.map(|about| text::playback::position(past.shown_s(), about.end_s)).unwrap_or_default();
        let words = text::playback::half(&name, &at);
        ui.add(Label::new(RichText::new(&words).font(theme::strong(14.0))).truncate()).on_hover_text(words);
    });
    let Some(live) = &mut past.live else {
        let words = past.report.refused.as_deref().unwrap_or(text::playback::OPENING.get());
        ui.centered_and_justified(|ui| ui.label(weak(words)));
        return;
    };
    if past.signals.is_some() {
        return signals_ui(ui, past);
    }
    past.panels.scene.look = CameraLook::Free;
    past.panels.scene.figures = true;
    past.panels.scene.smooth = smooth;
    let traces = Frame::new().inner_margin(Margin { left: 8, right: 18, top: 6, bottom: 6 });
    let height = TRACES * ui.available_height();
    Panel::bottom(below).exact_size(height).resizable(false).frame(traces).show(ui, |ui| {
        force_traces_ui(ui, live, &mut past.panels.forces, None);
    });
    CentralPanel::no_frame().show(ui, |ui| scene_ui(ui, live, &mut past.panels.scene, &mut past.outbox));
    past.outbox.forget();
}
