//! The panels in separate windows: the same panels as in the main window, each with the state of the machine and Stop.

use egui::{Align, Button, Context, Frame, Layout, Margin, Panel, Ui, vec2};
use nima_machine::messages::Command;
use nima_panels::{
    panel::PanelContext,
    roles::{Role, Wishes},
    tiles::{PanelId, content_ui, window_ui},
};
use nima_screen::{live::LiveState, theme, widgets::weak};
use nima_words::text;

use super::{ConsoleApp, shown_page::ShownPage};
use crate::console::{
    keys,
    top_bar::{state_ui, stop_button_ui},
};

/// Requests of the head of a window.
#[derive(Clone, Copy, Debug, Default)]
struct WindowHead {
    stops: bool,
    closes: bool,
}

impl ConsoleApp {
    /// Draws the windows, of the machine or of the recorded session on the screen. A participant of a study sees none.
    pub(super) fn windows_layout(&mut self, ctx: &Context) {
        if self.in_trial() {
            return;
        }
        let mut wishes = Wishes::default();
        for panel in self.settings.now.layout.windows().collect::<Vec<_>>() {
            let mut head = WindowHead::default();
            head.closes |= window_ui(ctx, panel, &mut |ui| self.window_layout(ui, panel, &mut head, &mut wishes));
            if head.stops {
                self.outbox.push(Command::Stop);
            }
            if head.closes {
                self.settings.now.layout.toggle_window(panel);
            }
        }
        if matches!(self.shown, ShownPage::Monitor) {
            self.obey_wishes(wishes);
        }
    }

    fn window_layout(&mut self, ui: &mut Ui, panel: PanelId, head: &mut WindowHead, wishes: &mut Wishes) {
        head.stops |= keys::stop_pressed(ui.ctx());
        head_ui(ui, &self.live, head);
        let is_monitor = matches!(self.shown, ShownPage::Monitor);
        let is_locked = !(is_monitor || self.shown.is_past());
        if is_locked {
            ui.label(weak(text::tiles::LOCKED));
        }
        // A view and the window would share one camera.
        if panel == PanelId::Field && is_monitor && self.role() != Role::Technician {
            ui.label(weak(text::tiles::FIELD_IN_VIEW));
            return;
        }
        let (live, panels, active, outbox) = match self.shown.past_mut() {
            Some(past) if past.is_foreign() => {
                ui.label(weak(text::playback::ONLY_SESSIONS));
                return;
            }
            None => (&mut self.live, &mut self.panels, &self.active, &mut self.outbox),
            Some(past) => {
                let Some(live) = &mut past.live else { return };
                (&mut **live, &mut past.panels, &past.active, &mut past.outbox)
            }
        };
        let mut all = std::mem::take(&mut panels.all);
        let mut at = PanelContext { live, panels, active, outbox, wishes, is_locked };
        content_ui(ui, panel, &mut |ui| all.ui(ui, panel, &mut at));
        panels.all = all;
        if let Some(past) = self.shown.past_mut() {
            past.outbox.forget();
        }
    }
}

/// Draws the state of the machine, the way back, and Stop.
fn head_ui(ui: &mut Ui, live: &LiveState, head: &mut WindowHead) {
    let frame = Frame::new().fill(theme::now().panel).inner_margin(Margin::symmetric(14, 0));
    Panel::top("head").exact_size(56.0).resizable(false).frame(frame).show(ui, |ui| {
        ui.horizontal_centered(|ui| {
            state_ui(ui, live, live.state());
            let back = Button::new(text::tiles::CLOSE_WINDOW).min_size(vec2(44.0, 30.0));
            head.closes |= ui.add(back).on_hover_text(text::tiles::CLOSE_WINDOW_HOVER).clicked();
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                head.stops |= stop_button_ui(ui, live.state(), false);
            });
        });
    });
}
