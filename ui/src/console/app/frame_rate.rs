//! Decides when the next frame is drawn, and measures the cost of the frames.

use std::{
    path::Path,
    time::{Duration, Instant},
};

use nima_files::write_atomically;
use nima_machine::messages::LoopState;
use nima_panels::roles::Role;
use nima_playback::Playback;
use nima_screen::{frames::FrameMeasurement, loop_connection::LoopConnection, run_log::WithScreen, stderr::print_line};

use super::ConsoleApp;
use crate::console::ConsoleOptions;

/// Interval between frames while data arrive: about thirty per second.
const FRAME: Duration = Duration::from_millis(31);
/// Minimum pause between two frames, in which input is handled however slow drawing is.
const MIN_REST: Duration = Duration::from_millis(1);
/// Interval between frames while nothing is engaged, for the clocks; changes, mouse and keyboard still cause a frame at
/// once.
const BEAT_AT_REST: Duration = Duration::from_secs(2);
/// Time in which traces and figures settle after the last engagement.
const SETTLED: Duration = Duration::from_secs(2);
/// Time of the screenshot if no end was given: the demo is running by then.
const SCREENSHOT_AT: Duration = Duration::from_secs(3);
/// Time to take the screenshot before the window closes.
const SCREENSHOT_BEFORE_EXIT: Duration = Duration::from_millis(700);

impl ConsoleApp {
    /// Requests the next frame: soon if something moves, otherwise at the next scheduled change. Data from the loop wake the
    /// window in between.
    pub(super) fn rest(&mut self, ctx: &egui::Context) {
        let moves = !(self.live.state().is_latched() || self.live.state() == LoopState::Idle);
        let asks = self.shown.guides_a_person();
        let plays = self.shown.past().is_some_and(Playback::moves) || self.panels.demo.moves();
        let devices = &self.panels.devices;
        if moves || plays || devices.is_testing() || asks || self.live.first_tick().is_none() {
            self.moved = Instant::now();
        }
        self.calm = self.moved.elapsed() > SETTLED;
        if let Some(door) = &self.door {
            door.show_devices(devices.is_seen);
            door.rest(self.calm);
        }
        let next = if self.calm {
            self.until_change()
        } else {
            // Measured from the start of this frame, so that its own duration counts. Endoscope images wake the window
            // themselves; an extra frame just before each of them would be wasted.
            let frame =
                if self.role() == Role::Surgeon && self.panels.eyes.wakes() { FRAME + FRAME / 2 } else { FRAME };
            frame.saturating_sub(self.framed.elapsed()).max(MIN_REST)
        };
        ctx.request_repaint_after(next);
    }

    /// Returns whether this frame of an idle window is only for a flashing alarm: then nothing else is updated.
    pub(super) fn only_flashes(&mut self, ctx: &egui::Context) -> bool {
        let Some(door) = self.door.as_ref().filter(|_| self.calm) else { return false };
        let wanted = door.has_woken() || ctx.input(|input| !input.events.is_empty() || input.pointer.any_down());
        if wanted || self.taken.elapsed() + MIN_REST >= BEAT_AT_REST {
            return false;
        }
        self.live.received(door.last_came());
        true
    }

    /// Returns the time until the next change in an idle window: the clocks, or a request of the command line. A
    /// flashing alarm requests its own frames.
    fn until_change(&self) -> Duration {
        let open = self.opened.elapsed();
        let ConsoleOptions { exit_after, screenshot, .. } = &self.options;
        let wanted = [screenshot.as_ref().filter(|_| !self.is_photographed).map(|_| self.image_at()), *exit_after];
        let wanted = wanted.into_iter().flatten().map(|at| at.saturating_sub(open));
        wanted.fold(BEAT_AT_REST.saturating_sub(self.taken.elapsed()), Duration::min).max(MIN_REST)
    }

    /// Returns the time of the requested screenshot.
    pub(super) fn image_at(&self) -> Duration {
        self.options.exit_after.map_or(SCREENSHOT_AT, |exit| exit.saturating_sub(SCREENSHOT_BEFORE_EXIT))
    }

    /// Records the duration of the previous frame.
    pub(super) fn measure(&mut self, ctx: &egui::Context, frame: &eframe::Frame) {
        let before = std::mem::replace(&mut self.framed, Instant::now());
        let work_s = frame.info().cpu_usage.map(f64::from);
        let period = (!self.calm).then(|| self.framed.duration_since(before));
        if let Some(period) = period {
            self.live.frame(period.as_secs_f64(), work_s);
        }
        let Some(meter) = &mut self.meter else { return };
        if meter.begin(&FrameMeasurement { period, work_s, live: self.live.first_tick().is_some() }) {
            ctx.request_repaint();
        }
    }

    /// Writes the results of the loop and of the window to files, if requested.
    pub(super) fn write_figures(&mut self) {
        if let (Some(path), Some(meter)) = (&self.options.frames, &self.meter) {
            write_json(path, &meter.figures(&self.renderer));
        }
        let summary = self.door.take().and_then(LoopConnection::stop_and_join);
        self.sessions.end();
        if let (Some(path), Some(summary)) = (&self.options.summary, summary) {
            self.diary.marks = self.live.marks_s.len();
            self.diary.paused = self.panels.forces.is_paused();
            write_json(path, &WithScreen { summary: &summary, screen: &self.diary });
        }
    }
}

/// Writes a value as JSON; errors can be reported only on the terminal.
fn write_json(path: &Path, value: &impl serde::Serialize) {
    let written = serde_json::to_vec_pretty(value)
        .map_err(std::io::Error::from)
        .and_then(|text| write_atomically(path, |file| file.write_all(&text)));
    if let Err(error) = written {
        print_line(format_args!("cannot write {}: {error}", path.display()));
    }
}
