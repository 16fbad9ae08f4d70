//! Inputs of a console when it is opened: options, settings, calibrations.

use std::path::Path;

use nima_panels::settings::SettingsStore;
use nima_screen::{
    exports,
    frames::FrameMeter,
    link::{LineConnection, Reopen},
    screenshot,
    stderr::print_line,
};
use nima_simulation::ObjectFeed;
use nima_wizards::{WizardKind, Wizards, active_calibrations::ActiveCalibrations};
use nima_words::language;

use super::{ConsoleApp, WARM_UP, shown_page::ShownPage};
use crate::console::{ConsoleOptions, screenshots::ScreenshotRun, sessions::ConsoleSessions};

impl ConsoleApp {
    /// Applies the options of the command line.
    #[must_use]
    pub fn with_options(mut self, options: ConsoleOptions) -> Self {
        self.options = options;
        self.meter = self.options.frames.as_ref().map(|_| FrameMeter::new(self.options.exit_after));
        if let Some(seconds) = self.options.traces_s {
            self.panels.forces.show_last(seconds);
        }
        self.photographer = self.options.images.clone().map(ScreenshotRun::new);
        self.settings.now.role = self.options.role.unwrap_or(self.settings.now.role);
        self.settings.now.language = self.options.language.unwrap_or(self.settings.now.language);
        self.use_language();
        if let Some(which) = self.options.wizard {
            self.open_wizard(which);
        }
        match (self.options.session.clone(), self.options.signals.take()) {
            (Some(recording), Some(signals)) => self.open_signals(&recording, &signals),
            (Some(session), None) => self.open_past(&session),
            (None, _) => {}
        }
        self.leave_when_asked();
        self
    }

    /// The window's thread uses the language of the settings; messages outside the window stay English.
    pub(super) fn use_language(&self) {
        language::set(self.settings.now.language);
    }

    /// When the end of the process is requested, the loop ends at once, even if the window is blocked, and then the window.
    pub(super) fn leave_when_asked(&self) {
        let Some(door) = &self.door else { return };
        let ender = door.handle().ender();
        let ctx = self.ctx.clone();
        self.options.leave.at_once(move || {
            ender.end();
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            ctx.request_repaint();
        });
    }

    /// Uses these settings; changes are saved.
    #[must_use]
    pub fn with_settings(mut self, settings: SettingsStore) -> Self {
        if let Some(report) = settings.report() {
            self.active.notify(format!("{report}."));
        }
        if settings.is_first_run() {
            // The tour is about the simulated rig; a user who names a rig with devices does not need it.
            if self.live.rig.devices.is_none() {
                self.start.welcome.open();
            } else {
                self.help.begin_tour();
            }
        }
        self.start.set_folder(settings.folder());
        exports::set_folder(&self.ctx, settings.folder());
        settings.now.units.choose(&self.ctx);
        self.settings = settings;
        self.running.remember(&mut self.settings.now.recent);
        self
    }

    /// Continues the recording of the running loop, and records later loops.
    #[must_use]
    pub(crate) fn with_sessions(mut self, sessions: ConsoleSessions) -> Self {
        self.sessions = sessions;
        self
    }

    /// Adds the source of the simulated rig's objects.
    #[must_use]
    pub fn with_objects(mut self, objects: Option<ObjectFeed>) -> Self {
        self.objects = objects;
        self
    }

    /// The arm is at another machine: shows the state of the link, and reopens it for every loop that restarts.
    #[must_use]
    pub(crate) fn with_line(mut self, far: Option<(Box<dyn LineConnection>, Reopen)>) -> Self {
        if let Some((door, reopen)) = far {
            self.live.line = Some(door);
            self.reopen = Some(reopen);
        }
        self
    }

    /// Uses this store of calibrations from now on, with the calibrations that it contains for the rig's sensors and
    /// tools.
    #[must_use]
    pub fn with_store(mut self, folder: &Path) -> Self {
        self.active = ActiveCalibrations::load(Some(folder), &self.live.rig, &self.live.scene);
        self
    }

    /// Runs every loop that a wizard or a setting needs in simulated time, at most `speed` times as fast as real time.
    #[must_use]
    pub const fn with_simulated_time(mut self, speed: f64) -> Self {
        self.simulated_speed = Some(speed);
        self
    }

    /// Starts emulators by this program.
    #[must_use]
    pub fn with_program(mut self, program: &Path) -> Self {
        self.program = Some(program.to_path_buf());
        self
    }

    /// Shows this wizard, with the data of these wizards.
    #[must_use]
    pub fn with_wizards(mut self, which: WizardKind, wizards: Wizards) -> Self {
        self.wizards = wizards;
        self.shown = ShownPage::Wizard(which);
        self
    }

    /// Runs the timed options of the command line: screenshots, a stall, the end.
    pub(super) fn obey_options(&mut self, ctx: &egui::Context) {
        let open = self.opened.elapsed();
        let ConsoleOptions { exit_after, screenshot, .. } = self.options.clone();
        if let Some(path) = screenshot.filter(|_| !self.is_photographed && open >= self.image_at()) {
            self.is_photographed = true;
            ctx.request_screenshot(move |image| {
                // By now, errors can be reported only on the terminal.
                if let Err(error) = screenshot::save(&path, &image) {
                    print_line(format_args!("{error:#}"));
                }
            });
        }
        let finished =
            self.photographer.as_mut().is_some_and(|taker| taker.step(ctx, &self.live, &mut self.settings.now));
        if let Some(stall) = self.options.stall.take_if(|_| open >= WARM_UP) {
            std::thread::sleep(stall);
        }
        if finished || exit_after.is_some_and(|exit| open >= exit) {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }
}
