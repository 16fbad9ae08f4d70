//! The demonstration: a script that shows the modes at a long and a short delay, explains them, and invites the audience to
//! try. Only for simulated and emulated rigs; afterwards mode and delay are restored.

mod chapter_time;
mod letting_go;
mod recovery;
mod script;
mod state;
#[cfg(test)]
mod tests;

use egui::{Align2, Button, CentralPanel, Frame, Label, Margin, Panel, Rect, RichText, Sense, Ui, WidgetInfo, vec2};
use nima_machine::messages::LoopState;
use nima_screen::{
    degree_record::DegreeRule,
    live::LiveState,
    outbox::Outbox,
    rolling::DegreeFractions,
    scene3d::scene_ui,
    signals::TracePlot,
    theme,
    widgets::{bar, card, figure, small},
};
use nima_words::text;

use self::{
    script::SCRIPT,
    state::{may_play, why_not_shown},
};
use super::Panels;
use crate::{force_space_ui, force_traces_ui, horizon_ui, tiles};

pub use self::state::DemoState;

/// Below this width the chapters need two rows.
const ONE_ROW: f32 = 1310.0;
/// Height of the bars of the degrees.
const DEGREES_HEIGHT: f32 = 20.0;
/// Below this height the force-space plot is left out.
const MIN_SPACE: f32 = 190.0;

pub(super) fn demo_ui(ui: &mut Ui, live: &mut LiveState, panels: &mut Panels, outbox: &mut Outbox) {
    if may_play(live) && !live.is_shown_only() {
        panels.demo.play(live, panels.scene.is_led(), outbox);
    }
    let side = Frame::new().fill(theme::now().panel).inner_margin(Margin::same(8));
    let height = if ui.available_width() < ONE_ROW { 176.0 } else { 140.0 };
    // The script is not shown for a recorded session.
    if !live.is_shown_only() {
        let frame = side.inner_margin(Margin::symmetric(18, 12));
        let caption = Panel::bottom("caption").exact_size(height).resizable(false).frame(frame);
        caption.show(ui, |ui| caption_ui(ui, live, &mut panels.demo));
    }
    Panel::right("figures").exact_size(348.0).resizable(false).frame(side).show(ui, |ui| {
        theme::card().show(ui, |ui| figures_ui(ui, live));
        ui.add_space(theme::GAP);
        let panel = tiles::PanelId::Horizon;
        card(ui, panel.title(), panel.meaning(), |ui| horizon_ui(ui, live, outbox, true));
        let Panels { forces, space, .. } = panels;
        let room = vec2(ui.available_width(), ui.available_height().min(380.0));
        if room.y < MIN_SPACE {
            return;
        }
        ui.allocate_ui(room, |ui| force_space_ui(ui, live, forces.side(), space, forces.cursor_at_s(live)));
    });
    CentralPanel::no_frame().show(ui, |ui| {
        let frame = Frame::new().inner_margin(Margin::symmetric(12, 8));
        Panel::bottom("trace").exact_size(200.0).resizable(false).frame(frame).show(ui, |ui| {
            force_traces_ui(ui, live, &mut panels.forces, Some(TracePlot::ForceZ));
        });
        panels.scene.release = Some(panels.demo.trail()).filter(|_| !live.is_shown_only());
        scene_ui(ui, live, &mut panels.scene, outbox);
        panels.scene.release = None;
    });
}

/// Draws the gain, and how often each degree was identified.
fn figures_ui(ui: &mut Ui, live: &LiveState) {
    ui.set_width(ui.available_width());
    ui.spacing_mut().item_spacing.y = 4.0;
    let of_degrees = live.degrees.fractions(DegreeRule::Console, false);
    let fractions = of_degrees.map(DegreeFractions::fractions).unwrap_or_default();
    let is_known = of_degrees.is_some();
    let identified =
        live.first_tick().filter(|_| is_known).map(|tick| tick.identification.degrees.anchored.to_string());
    let degree = identified.unwrap_or_else(|| "–".to_owned());
    let name = text::roles::gain_and_degree(live.gain());
    figure(ui, &name, degree, text::roles::FIGURES_HOVER);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), DEGREES_HEIGHT), Sense::hover());
    let percents: Vec<String> = fractions.iter().skip(1).map(|fraction| format!("{:.0} %", 100.0 * fraction)).collect();
    let words = text::roles::degrees(&percents.join(", "));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &words));
    response.on_hover_text(&words);
    let width = rect.width() / percents.len().max(1) as f32;
    for (i, fraction) in fractions.iter().skip(1).enumerate() {
        let column = Rect::from_min_size(rect.min + vec2(i as f32 * width, 0.0), vec2(width - 4.0, rect.height()));
        bar(ui.painter(), column, *fraction, theme::now().selected);
        let degree = (i + 1).to_string();
        ui.painter().text(column.center(), Align2::CENTER_CENTER, degree, theme::regular(13.0), theme::now().text);
    }
}

/// Draws the steps, the current text, and the progress.
fn caption_ui(ui: &mut Ui, live: &LiveState, demo: &mut DemoState) {
    let plays = may_play(live);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(6.0, 6.0);
        for (i, step) in SCRIPT.iter().enumerate() {
            let name = format!("{}. {}", i + 1, step.name);
            let button = Button::selectable(demo.step == i, name).frame_when_inactive(true).min_size(vec2(0.0, 30.0));
            let why = why_not_shown(live, step);
            let button = ui.add_enabled(why.is_none(), button).on_hover_text(step.words.get());
            if button.on_disabled_hover_text(why.unwrap_or_default()).clicked() {
                demo.go_to(i);
            }
        }
        ui.add_space(10.0);
        let (name, meaning) = if demo.held {
            (text::roles::PLAY.get(), text::roles::PLAY_HOVER.get())
        } else {
            (text::roles::HOLD.get(), text::roles::HOLD_HOVER.get())
        };
        let hold = ui.add_enabled(plays, Button::new(name).min_size(vec2(64.0, 30.0))).on_hover_text(meaning);
        if hold.on_disabled_hover_text(text::roles::NOTE_REAL_RIG).clicked() {
            demo.held = !demo.held;
        }
    });
    ui.add_space(4.0);
    let words = demo.caption(live);
    ui.add(Label::new(RichText::new(words).font(theme::regular(18.0))).wrap());
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 4.0), egui::Sense::hover());
    if plays && live.state() == LoopState::Engaged {
        bar(ui.painter(), rect, demo.progress(), theme::now().reference);
    }
    if !plays {
        ui.label(small(text::roles::NOTE_CHOOSE_SIMULATED));
    }
}
