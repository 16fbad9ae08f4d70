//! The demonstration: a script that shows the modes at a long and a short delay, explains them, and invites the audience to
//! try. Only for simulated and emulated rigs; afterwards mode and delay are restored.

mod chapter_time;
mod letting_go;
mod recovery;
mod script;
mod state;
#[cfg(test)]
mod tests;

use egui::{Button, CentralPanel, Frame, Label, Margin, Panel, RichText, Ui, vec2};
use nima_machine::messages::LoopState;

use self::{
    script::SCRIPT,
    state::{may_play, may_show},
};
use super::Panels;
use crate::console::{
    live::LiveState,
    outbox::Outbox,
    panels::{force_space_ui, force_traces_ui, horizon_ui},
    scene3d::scene_ui,
    text, theme, tiles,
    widgets::{bar, card, small},
};

pub use self::state::DemoState;

/// Below this width the chapters need two rows.
const ONE_ROW: f32 = 1310.0;
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
        let panel = tiles::Panel::Horizon;
        card(ui, panel.title(), panel.meaning(), |ui| horizon_ui(ui, live, outbox));
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
            force_traces_ui(ui, live, &mut panels.forces, &[2]);
        });
        scene_ui(ui, live, &mut panels.scene, outbox);
    });
}

/// Draws the steps, the current text, and the progress.
fn caption_ui(ui: &mut Ui, live: &LiveState, demo: &mut DemoState) {
    let plays = may_play(live);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(6.0, 6.0);
        for (i, step) in SCRIPT.iter().enumerate() {
            let name = format!("{}. {}", i + 1, step.name);
            let button = Button::selectable(demo.step == i, name).frame_when_inactive(true).min_size(vec2(0.0, 30.0));
            if ui.add_enabled(may_show(live, step), button).on_hover_text(step.words.get()).clicked() {
                demo.go_to(i);
            }
        }
        ui.add_space(10.0);
        let (name, meaning) = if demo.held {
            (text::roles::PLAY.get(), text::roles::PLAY_HOVER.get())
        } else {
            (text::roles::HOLD.get(), text::roles::HOLD_HOVER.get())
        };
        if ui.add_enabled(plays, Button::new(name).min_size(vec2(64.0, 30.0))).on_hover_text(meaning).clicked() {
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
        ui.label(small(text::roles::NOTE_CHOOSE_SIMULATED.get()));
    }
}
