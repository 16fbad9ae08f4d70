//! The console while the past is shown: the list of sessions, and one that is open.
//!
//! The machine runs on, its alarms are told and its stop works; nothing else on the screen reaches it.

use std::path::Path;

use egui::{CentralPanel, Stroke, StrokeKind, Ui};

use super::ConsoleApp;
use crate::console::{
    door::Door,
    past::{FRAME, Past, bar_ui, both_ui, head_ui},
    roles::role_ui,
    text, theme,
    widgets::weak,
};

impl ConsoleApp {
    /// Shows this session; the machine runs on.
    #[must_use]
    pub fn with_session(mut self, session: &Path) -> Self {
        self.open_past(session);
        self
    }

    /// The session on the screen, and the time of it, s.
    pub fn past(&self) -> Option<(&Path, f64)> {
        self.past.as_ref().map(|past| (past.path.as_path(), past.shown_s()))
    }

    /// The session beside it, and the time of that one, s.
    pub fn past_beside(&self) -> Option<(&Path, f64)> {
        let beside = self.past.as_ref()?.beside.as_ref().filter(|beside| beside.live.is_some())?;
        Some((beside.path.as_path(), beside.shown_s()))
    }

    /// The ticks of the past on the screen, once every figure is as it was.
    pub fn past_ticks(&self) -> Option<&[Option<nima_machine::messages::Tick>]> {
        let past = self.past.as_ref().filter(|past| past.is_whole())?;
        past.live.as_ref().map(|live| live.ticks.as_slice())
    }

    /// The objects of the past on the screen.
    pub fn past_objects(&self) -> Option<&nima_session::objects::Objects> {
        self.past.as_ref()?.live.as_ref()?.objects.as_ref()
    }

    /// Shows this time of the session on the screen, s.
    pub fn show_past(&mut self, t_s: f64) {
        if let Some(past) = &mut self.past {
            past.show(t_s);
        }
    }

    /// Opens a session. What the screen does to the machine by itself, a demonstration or leading by mouse, ends before.
    pub(super) fn open_past(&mut self, session: &Path) {
        self.panels.demo.leave(&mut self.outbox);
        self.panels.scene.let_go(&mut self.outbox);
        self.outbox.flush(self.door.as_ref().map(Door::handle));
        self.start.is_open = false;
        self.list.is_open = false;
        self.past = Some(Past::open(session, &self.ctx, self.panels.scene.twin()));
    }

    /// The screen shows the machine again.
    pub(super) fn close_past(&mut self) {
        self.past = None;
        self.list.is_open = false;
    }

    /// The past is played on by this time.
    pub(super) fn go_on_in_past(&mut self, dt_s: f64) {
        if let Some(past) = &mut self.past {
            past.step(dt_s, self.live.state().permits().drives);
        }
    }

    pub(super) fn toggle_list(&mut self) {
        if self.list.is_open {
            self.list.is_open = false;
        } else {
            self.start.is_open = false;
            self.list.open(&self.ctx, self.settings.folder());
        }
    }

    pub(super) fn list_layout(&mut self, ui: &mut Ui) {
        if let Some(session) = self.list.ui(ui) {
            self.open_past(&session);
        }
    }

    /// The same views as of the machine, in a frame of their own colour.
    pub(super) fn past_layout(&mut self, ui: &mut Ui) {
        let Some(past) = &mut self.past else { return };
        let room = ui.available_rect_before_wrap();
        let live_again = head_ui(ui, past);
        bar_ui(ui, past);
        let wants_beside = std::mem::take(&mut past.wants_beside);
        let smooth = self.panels.scene.smooth;
        CentralPanel::no_frame().show(ui, |ui| {
            if self.list.is_open {
                if let Some(session) = self.list.ui(ui) {
                    past.set_beside(Past::open(&session, &self.ctx, self.panels.scene.twin()));
                }
                return;
            }
            if past.beside.is_some() {
                return both_ui(ui, past, smooth);
            }
            let Some(live) = &mut past.live else {
                let words = past.refused().unwrap_or(text::past::OPENING.get());
                ui.centered_and_justified(|ui| ui.label(weak(words)));
                return;
            };
            live.rough_edges = self.live.rough_edges;
            past.panels.scene.smooth = smooth;
            past.panels.eyes.show_as(self.settings.now.picture);
            // What the views wish for the machine is left undone.
            role_ui(ui, &mut self.settings.now, live, &mut past.panels, &past.in_force, &mut past.outbox);
            past.outbox.forget();
        });
        let stroke = Stroke::new(FRAME, theme::now().past);
        ui.painter().rect_stroke(room, 0.0, stroke, StrokeKind::Inside);
        if wants_beside {
            self.list.open(&self.ctx, self.settings.folder());
            self.list.for_beside = true;
        }
        if live_again {
            self.close_past();
        }
    }
}
