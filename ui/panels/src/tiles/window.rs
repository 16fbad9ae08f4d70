//! A panel in its own window, for a second monitor.

use egui::{Context, Ui, Vec2, ViewportBuilder, ViewportId, vec2};
use nima_screen::theme;
use nima_words::text;

use super::PanelId;

/// Size of the window of a panel that fills it, and of a list.
const FILLING: Vec2 = vec2(1280.0, 760.0);
const LIST: Vec2 = vec2(640.0, 760.0);

/// Draws the window of this panel with this content. Returns true if the operator closes it.
pub fn window_ui(ctx: &Context, panel: PanelId, content: &mut dyn FnMut(&mut Ui)) -> bool {
    let builder = ViewportBuilder::default()
        .with_title(text::tiles::window_title(panel.title()))
        .with_app_id("nima-console")
        .with_inner_size(if panel.fills() { FILLING } else { LIST })
        .with_min_inner_size([360.0, 280.0]);
    ctx.show_viewport_immediate(ViewportId::from_hash_of(("panel", panel)), builder, |ui, _| {
        // eframe clears another window to transparent black.
        ui.painter().rect_filled(ui.ctx().content_rect(), 0.0, theme::now().background);
        content(ui);
        ui.input(|input| input.viewport().close_requested())
    })
}
