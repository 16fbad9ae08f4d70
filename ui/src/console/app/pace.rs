//! When the next picture is drawn, and what the pictures cost.

use std::{
    path::Path,
    time::{Duration, Instant},
};

use nima_files::write_atomically;
use nima_machine::messages::LoopState;

use super::ConsoleApp;
use crate::{
    console::{Options, diary::WithScreen, door::Door, frames::Picture},
    telling::tell,
};

/// Thirty pictures a second while data flow.
const FRAME: Duration = Duration::from_millis(31);
/// Input is looked at between two pictures, however slow they are.
const LEAST_REST: Duration = Duration::from_millis(1);
/// While nothing is engaged the clocks go on by this; a change, the mouse and the keyboard are answered at once all the same.
const BEAT_AT_REST: Duration = Duration::from_secs(2);
/// Once nothing is engaged, traces and figures come to rest in this time.
const SETTLED: Duration = Duration::from_secs(2);
/// When a picture was asked for but no end: the demo is in full swing by then.
const SCREENSHOT_AT: Duration = Duration::from_secs(3);
/// Room for the picture to be taken before the window closes.
const SCREENSHOT_BEFORE_EXIT: Duration = Duration::from_millis(700);

impl ConsoleApp {
    /// Asks for the next picture: soon while something moves, otherwise when something can change by itself. What comes from the loop
    /// meanwhile wakes the window.
    pub(super) fn rest(&mut self, ctx: &egui::Context) {
        let moves = !(self.live.state().is_latched() || self.live.state() == LoopState::Idle);
        if moves || self.wizards.open.is_some() || self.live.first_tick().is_none() {
            self.moved = Instant::now();
        }
        self.calm = self.moved.elapsed() > SETTLED;
        if let Some(door) = &self.door {
            door.rest(self.calm);
        }
        let next = if self.calm {
            self.until_change()
        } else {
            // Counted from the beginning of this picture: what it took is no reason to wait longer.
            FRAME.saturating_sub(self.framed.elapsed()).max(LEAST_REST)
        };
        ctx.request_repaint_after(next);
    }

    /// This picture of a window at rest is for a flashing alarm alone: nothing else moves on, so that nothing else is drawn.
    pub(super) fn only_flashes(&mut self, ctx: &egui::Context) -> bool {
        let Some(door) = self.door.as_ref().filter(|_| self.calm) else { return false };
        let wanted = door.has_woken() || ctx.input(|input| !input.events.is_empty() || input.pointer.any_down());
        if wanted || self.taken.elapsed() + LEAST_REST >= BEAT_AT_REST {
            return false;
        }
        self.live.heard(door.last_came());
        true
    }

    /// Time until something changes on a window at rest: the clocks, what was asked for from outside. A flashing alarm asks for itself.
    fn until_change(&self) -> Duration {
        let open = self.opened.elapsed();
        let Options { exit_after, screenshot, .. } = &self.options;
        let wanted = [screenshot.as_ref().filter(|_| !self.pictured).map(|_| self.picture_at()), *exit_after];
        let wanted = wanted.into_iter().flatten().map(|at| at.saturating_sub(open));
        wanted.fold(BEAT_AT_REST.saturating_sub(self.taken.elapsed()), Duration::min).max(LEAST_REST)
    }

    /// When the picture that was asked for is taken.
    pub(super) fn picture_at(&self) -> Duration {
        self.options.exit_after.map_or(SCREENSHOT_AT, |exit| exit.saturating_sub(SCREENSHOT_BEFORE_EXIT))
    }

    /// Takes in how long the picture before this one took.
    pub(super) fn measure(&mut self, ctx: &egui::Context, frame: &eframe::Frame) {
        let before = std::mem::replace(&mut self.framed, Instant::now());
        let work_s = frame.info().cpu_usage.map(f64::from);
        let period = (!self.calm).then(|| self.framed.duration_since(before));
        if let Some(period) = period {
            self.live.frame(period.as_secs_f64(), work_s);
        }
        let Some(meter) = &mut self.meter else { return };
        let drawn_share = self.surface.as_ref().map_or(1.0, |surface| surface.drawn_share());
        if meter.begin(&Picture { period, work_s, drawn_share, live: self.live.first_tick().is_some() }) {
            ctx.request_repaint();
        }
    }

    /// Writes the figures of the loop and of the screen where they are wanted.
    pub(super) fn write_figures(&mut self) {
        if let (Some(path), Some(meter)) = (&self.options.frames, &self.meter) {
            write_json(path, &meter.figures(&self.renderer));
        }
        let summary = self.door.take().and_then(Door::stop_and_join);
        if let (Some(path), Some(summary)) = (&self.options.summary, summary) {
            self.diary.marks = self.live.marks_s.len();
            self.diary.paused = self.panels.forces.is_paused();
            write_json(path, &WithScreen { summary: &summary, screen: &self.diary });
        }
    }
}

/// Writes a value as JSON; the window has no one to tell of a failure but the terminal it was started from.
fn write_json(path: &Path, value: &impl serde::Serialize) {
    let written = serde_json::to_vec_pretty(value)
        .map_err(std::io::Error::from)
        .and_then(|text| write_atomically(path, |file| file.write_all(&text)));
    if let Err(error) = written {
        tell(format_args!("cannot write {}: {error}", path.display()));
    }
}
