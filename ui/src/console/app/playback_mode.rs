//! The console during playback: the list of sessions, and an open one.
//!
//! The machine keeps running, its alarms are shown and its stop works; no other control reaches it.

use std::{path::Path, sync::Arc};

use egui::{CentralPanel, Frame, Margin, Stroke, StrokeKind, Ui};
use nima_panels::roles::role_ui;
use nima_playback::{FRAME, Playback, bar_ui, both_ui, head_ui, list::SessionListChoice, signals_ui};
use nima_recording::csv::Signals;
use nima_screen::{loop_connection::LoopConnection, theme, widgets::weak};
use nima_words::text;

use super::{ConsoleApp, shown_page::ShownPage};

impl ConsoleApp {
    /// Shows this session; the machine keeps running.
    #[must_use]
    pub fn with_session(mut self, session: &Path) -> Self {
        self.open_past(session);
        self
    }

    /// Shows the signals of another program's recording; the machine keeps running.
    #[must_use]
    pub fn with_signals(mut self, recording: &Path, signals: &Arc<Signals>) -> Self {
        self.open_signals(recording, signals);
        self
    }

    /// Returns the session on the screen, and its time, s.
    pub fn past(&self) -> Option<(&Path, f64)> {
        self.shown.past().map(|past| (past.path.as_path(), past.shown_s()))
    }

    /// Returns the session that it is compared with, and its time, s.
    pub fn past_beside(&self) -> Option<(&Path, f64)> {
        let beside = self.shown.past()?.beside.as_ref().filter(|beside| beside.live.is_some())?;
        Some((beside.path.as_path(), beside.shown_s()))
    }

    /// Returns the recorded ticks on the screen, once all figures are replayed.
    pub fn past_ticks(&self) -> Option<&[Option<nima_machine::messages::Tick>]> {
        let past = self.shown.past().filter(|past| past.is_whole())?;
        past.live.as_ref().map(|live| live.ticks.as_slice())
    }

    /// Returns the recorded objects on the screen.
    pub fn past_objects(&self) -> Option<&nima_session::objects::ObjectStates> {
        self.shown.past()?.live.as_ref()?.objects.as_ref()
    }

    pub fn show_past(&mut self, t_s: f64) {
        if let Some(past) = self.shown.past_mut() {
            past.show(t_s);
        }
    }

    pub(super) fn open_past(&mut self, session: &Path) {
        self.leave_machine();
        let past = Playback::open(session, &self.ctx, self.panels.scene.twin());
        self.shown = ShownPage::Past(Box::new(past));
    }

    pub(super) fn open_signals(&mut self, recording: &Path, signals: &Arc<Signals>) {
        self.leave_machine();
        self.shown = ShownPage::Past(Box::new(Playback::open_signals(recording, signals, &self.ctx)));
    }

    /// Ends everything that the screen does to the machine automatically: a demonstration, or mouse control.
    fn leave_machine(&mut self) {
        self.panels.demo.leave(&mut self.outbox);
        self.panels.scene.let_go(&mut self.outbox);
        self.outbox.flush(self.door.as_ref().map(LoopConnection::handle));
    }

    /// Advances playback by this time.
    pub(super) fn go_on_in_past(&mut self, dt_s: f64) {
        if let Some(past) = self.shown.past_mut() {
            past.step(dt_s, self.live.state().permits().drives);
        }
    }

    pub(super) fn toggle_list(&mut self) {
        if matches!(self.shown, ShownPage::Sessions) {
            self.leave_page();
        } else {
            self.list.open(&self.ctx, self.settings.folder());
            self.shown = ShownPage::Sessions;
        }
    }

    pub(super) fn list_layout(&mut self, ui: &mut Ui) {
        let recorded = self.sessions.shown();
        match self.list.ui(ui, recorded.as_ref()) {
            Some(SessionListChoice::Open(session)) => self.open_past(&session),
            Some(SessionListChoice::Back) => self.leave_page(),
            None => {}
        }
    }

    /// Draws the same views as for the machine, in a frame with its own colour.
    pub(super) fn past_layout(&mut self, ui: &mut Ui) {
        let Some(past) = self.shown.past_mut() else { return };
        let room = ui.available_rect_before_wrap();
        let live_again = head_ui(ui, past);
        bar_ui(ui, past);
        let wants_beside = std::mem::take(&mut past.wants_beside);
        let smooth = self.panels.scene.smooth;
        CentralPanel::no_frame().show(ui, |ui| {
            if past.is_choosing {
                let recorded = self.sessions.shown();
                let choice = self.list.ui(ui, recorded.as_ref());
                past.is_choosing = choice.is_none();
                if let Some(SessionListChoice::Open(session)) = choice {
                    past.set_beside(Playback::open(&session, &self.ctx, self.panels.scene.twin()));
                }
                return;
            }
            if past.beside.is_some() {
                return both_ui(ui, past, smooth);
            }
            if past.is_foreign() && past.live.is_some() {
                return signals_ui(ui, past);
            }
            let Some(live) = &mut past.live else {
                let words = past.refused().unwrap_or(text::playback::OPENING.get());
                let frame = Frame::new().inner_margin(Margin::symmetric(24, 0));
                frame.show(ui, |ui| ui.centered_and_justified(|ui| ui.label(weak(words))));
                return;
            };
            live.rough_edges = self.live.rough_edges;
            past.panels.scene.smooth = smooth;
            past.panels.eyes.show_as(self.settings.now.image);
            // Discard commands that the views send to the machine.
            role_ui(ui, &mut self.settings.now, live, &mut past.panels, &past.active, &mut past.outbox);
            past.outbox.forget();
        });
        let stroke = Stroke::new(FRAME, theme::now().past);
        ui.painter().rect_stroke(room, 0.0, stroke, StrokeKind::Inside);
        if wants_beside {
            past.is_choosing = true;
            self.list.open(&self.ctx, self.settings.folder());
            self.list.for_beside = true;
        }
        if live_again {
            self.leave_page();
        }
    }
}
