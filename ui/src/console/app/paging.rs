//! The console while a page of an extra is open: its rig runs idle between the runs, and each run has its own loop.
//!
//! The console's own recorder is paused during this time, because a session contains the mode. The page saves its own
//! data.

use egui::Ui;
use nima_machine::{config::RigConfig, messages::LoopState};
use nima_simulation::scene::Scene;
use nima_words::{report_text::chain, text};

use super::{ConsoleApp, shown_page::ShownPage};
use crate::console::{
    page::{LeftPage, PageContext, PageRequest, PageRun, PreparedRun, Room, RunBreak},
    start::is_real,
};

impl ConsoleApp {
    /// Returns whether a run of a page is in progress: then the window shows nothing else.
    pub fn in_trial(&self) -> bool {
        self.run().is_some()
    }

    pub(super) fn run(&self) -> Option<&dyn PageRun> {
        self.page.as_ref().and_then(|page| page.run())
    }

    pub(super) fn is_held(&self) -> bool {
        self.page.as_ref().is_some_and(|page| page.holds_machine())
    }

    pub(super) fn toggle_page(&mut self) {
        if matches!(self.shown, ShownPage::OfExtra) { self.leave_page() } else { self.open_page() }
    }

    /// Shows the page. First ends everything that the screen does to the machine automatically: a demonstration, or mouse
    /// control.
    pub(super) fn open_page(&mut self) {
        let Some(page) = &mut self.page else { return };
        self.panels.demo.leave(&mut self.outbox);
        self.panels.scene.let_go(&mut self.outbox);
        page.read(self.settings.folder(), &self.settings.now.studies);
        self.shown = ShownPage::OfExtra;
    }

    pub(super) fn page_of_extra_layout(&mut self, ui: &mut Ui) {
        let held = self.live.state() == LoopState::Engaged && is_real(&self.live.rig);
        let closed = match text::calibrations::closed(self.live.state()) {
            None if held => Some(text::start::ENGAGED.get()),
            closed => closed,
        };
        let folder = self.settings.folder().map(std::path::Path::to_path_buf);
        let room = Room {
            folder: folder.as_deref(),
            known: &mut self.settings.now.studies,
            closed,
            is_over_a_line: self.reopen.is_some(),
            is_starting: self.starting.is_some(),
        };
        let left = self.page.as_mut().and_then(|page| page.ui(ui, room));
        self.sessions.rest(self.is_held());
        match left {
            None | Some(LeftPage::Machine(None)) => {}
            Some(LeftPage::Page) => self.leave_page(),
            // The previous rig runs again.
            Some(LeftPage::Machine(Some(before))) => {
                let now = self.running.clone();
                self.begin(before, Some(now), None);
            }
        }
    }

    /// Continues the page's requests to the loop. A latched stop or fault keeps its loop until it is released.
    pub(super) fn go_on_with_page(&mut self) {
        let Some(page) = &mut self.page else { return };
        let has_ended = self.door.as_ref().is_some_and(|door| !door.handle().is_running());
        let why = if self.options.leave.is_asked() { RunBreak::Closed } else { RunBreak::LoopEnded };
        let now = PageContext {
            running: &self.running,
            ended: has_ended.then_some(why),
            is_latched: self.live.state().is_latched(),
            is_starting: self.starting.is_some(),
        };
        match page.go_on(&now) {
            None => {}
            Some(PageRequest::End { again }) => self.end_run(again),
            Some(PageRequest::Run) => {
                if let Err(why) = self.begin_run() {
                    self.report_on_page(Some(why));
                }
            }
            Some(PageRequest::Start(choice)) => {
                let before = self.running.clone();
                self.begin(choice, Some(before), None);
                if self.starting.is_none() {
                    // The start page shows the cause when it is opened.
                    self.report_on_page(self.start.report().map(str::to_owned));
                }
            }
        }
    }

    fn report_on_page(&mut self, why: Option<String>) {
        if let Some(page) = &mut self.page {
            page.notify(why);
        }
    }

    /// Restarts the loop for the run; only the loop receives its conditions.
    fn begin_run(&mut self) -> Result<(), String> {
        self.take_in();
        if let Some(why) = text::calibrations::closed(self.live.state()) {
            return Err(why.to_owned());
        }
        let Some(page) = &mut self.page else { return Ok(()) };
        let PreparedRun { rig, scene, is_by_mouse } = page.prepare()?;
        self.panels.scene.be_of_participant(true, is_by_mouse);
        self.shown = ShownPage::OfExtra;
        self.clear_for_trial();
        // End the old loop first: a rig must have only one controller.
        drop(self.door.take());
        self.sessions.end();
        let started = rig.and_then(|rig| self.start_loop(rig, scene).ok());
        if started.is_none() {
            self.break_off(RunBreak::NotStarted);
            self.end_run(true);
        }
        Ok(())
    }

    fn break_off(&mut self, why: RunBreak) {
        if let Some(run) = self.page.as_mut().and_then(|page| page.run_mut()) {
            run.break_off(why);
        }
    }

    /// Ends the loop of the run, lets the page record the result, and restarts its rig idle, with the settings of its file.
    fn end_run(&mut self, again: bool) {
        self.panels.scene.let_go(&mut self.outbox);
        self.panels.scene.be_of_participant(false, false);
        drop(self.door.take());
        self.objects = None;
        let Some(page) = &mut self.page else { return };
        page.finish_run();
        if !again {
            return;
        }
        let loaded = RigConfig::load(&self.running.rig).and_then(|rig| {
            let scene = Scene::load(&self.running.scene)?.mounted_at(&rig)?;
            Ok((rig, scene))
        });
        let started = loaded.map_err(|error| chain(&error)).and_then(|(rig, scene)| self.start_loop(rig, scene));
        if let Err(why) = started {
            self.report_on_page(Some(text::start::not_started(&why, None)));
        }
    }

    /// When the window closes, an unfinished run is recorded as aborted.
    pub(super) fn break_off_run(&mut self) {
        if self.in_trial() {
            self.break_off(RunBreak::Closed);
            self.end_run(false);
        }
    }

    /// Lays out the participant's screen, below the top bar.
    pub(super) fn trial_layout(&mut self, ui: &mut Ui) {
        if let Some(run) = self.page.as_mut().and_then(|page| page.run_mut()) {
            run.ui(ui, &self.live, &mut self.panels.scene, &mut self.outbox);
        }
    }
}
