//! The console while it changes to another rig or scene: ends the loop, starts the emulators if needed, and restarts the loop
//! idle.

use std::{
    path::PathBuf,
    sync::mpsc::{Receiver, TryRecvError, channel},
    thread,
};

use egui::{Key, Modifiers, Ui};
use nima_machine::config::RigConfig;
use nima_panels::{rig_choice::RigChoice, roles::Role};
use nima_simulation::scene::Scene;
use nima_words::{
    report_text::chain,
    text::{self, of_files::of_file},
};

use super::{ConsoleApp, shown_page::ShownPage};
use crate::{
    console::{
        reader::ScreenReader,
        start::{StartInputs, StartRequest, WelcomeChoice, drawn_anew},
    },
    emulators::Emulators,
};

/// A rig that is being started.
#[derive(Debug)]
pub(super) struct StartingRig {
    choice: RigChoice,
    rig: RigConfig,
    scene: Scene,
    emulators: Receiver<Result<Option<Emulators>, String>>,
    /// The previous rig and scene, to return to if the start fails.
    before: Option<RigChoice>,
    /// Reason for the restart, if the rig stays the same.
    because: Option<String>,
    /// File to write back if the start fails.
    undo: Option<Undo>,
}

/// A rig file before a change.
#[derive(Debug)]
pub(super) struct Undo {
    pub(super) path: PathBuf,
    /// Text; `None` if it did not exist.
    pub(super) text: Option<String>,
}

impl Undo {
    /// Restores the file. If that fails, the next start reports the problem.
    pub(super) fn take_back(&self) {
        match &self.text {
            Some(text) => nima_files::write_atomically(&self.path, |file| file.write_all(text.as_bytes())).ok(),
            None => std::fs::remove_file(&self.path).ok(),
        };
    }
}

impl ConsoleApp {
    /// This rig and scene are running, with these emulators for an emulated rig.
    #[must_use]
    pub(crate) fn with_choice(mut self, running: RigChoice, emulators: Option<Emulators>) -> Self {
        self.running = running;
        self.serve(emulators);
        self
    }

    /// Shows the wizards' instructions to this reader, for tests whose emulators run in the same process.
    #[must_use]
    pub fn with_reader(mut self, reader: ScreenReader) -> Self {
        self.reader = Some(reader);
        self
    }

    /// The rig of this name or path is running.
    #[must_use]
    pub fn with_rig_name(mut self, rig: impl Into<String>) -> Self {
        self.running.rig = rig.into();
        self
    }

    /// From now on, these emulators serve the loop, and their technician follows the screen.
    fn serve(&mut self, emulators: Option<Emulators>) {
        self.reader = emulators.as_ref().map(Emulators::technician);
        self.read = None;
        self.emulators = emulators;
    }

    /// Returns the running rig and scene.
    pub const fn running(&self) -> &RigChoice {
        &self.running
    }

    /// Shows a window over a view in which a new user can choose the running rig, the demonstration, or their own rig.
    pub(super) fn welcome(&mut self, ctx: &egui::Context, room: egui::Rect) {
        if !matches!(self.shown, ShownPage::Monitor) {
            return;
        }
        // A user who asks for a view knows the program.
        if self.options.role.is_some() {
            self.start.welcome.close();
        }
        // Shown once; the tour stays in the View menu.
        self.settings.now.toured |= self.start.welcome.is_open();
        match self.start.welcome.ui(ctx, room) {
            None => {}
            Some(WelcomeChoice::Simulated) => self.help.begin_tour(),
            Some(WelcomeChoice::Demo) => self.settings.now.role = Role::Demo,
            Some(WelcomeChoice::Own) => self.open_start(),
        }
    }

    /// Closes the welcome or the tour by Escape. If everything is simulated there is nothing to stop, so that key press only
    /// closes; otherwise (a device, a handle on the desk, an arm on another machine) it also stops, as everywhere.
    pub(super) fn close_welcome_by_key(&mut self, ctx: &egui::Context) {
        let is_shown = self.start.welcome.is_open() || self.help.is_touring();
        if !is_shown || !ctx.input(|input| input.key_pressed(Key::Escape)) {
            return;
        }
        self.start.welcome.close();
        self.help.end_tour();
        self.settings.now.toured = true;
        let rig = &self.live.rig;
        if rig.devices.is_none() && rig.desk.is_none() && self.live.line.is_none() {
            ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape));
        }
    }

    pub(super) fn open_start(&mut self) {
        self.shown = ShownPage::Start;
        self.start.open(&self.running, &self.settings.now.recent);
    }

    pub(super) fn start_layout(&mut self, ui: &mut Ui) {
        let now = StartInputs {
            live: &self.live,
            running: &self.running,
            recent: &self.settings.now.recent,
            is_starting: self.starting.is_some(),
            image: self.panels.eyes.report(),
            page: self.page.as_ref().map(|page| page.name()),
        };
        match self.start.ui(ui, &now) {
            Some(StartRequest::Start(choice)) if !self.outbox.holds_stop() => {
                let before = self.running.clone();
                // The welcome describes the rig that ran before.
                self.start.welcome.close();
                self.begin(choice, Some(before), None);
            }
            Some(StartRequest::Start(_)) | None => {}
            Some(StartRequest::Page) => self.open_page(),
            Some(StartRequest::Leave) => self.leave_page(),
        }
    }

    /// Starts a rig whose file was changed; the change is undone if the start fails.
    pub(super) fn begin_changed(&mut self, choice: RigChoice, undo: Undo) {
        if self.reopen.is_some() {
            undo.take_back();
            return self.panels.devices.notify(text::devices::not_changed(text::link::ONE_RIG.get()));
        }
        let before = self.running.clone();
        self.begin(choice, Some(before), None);
        match &mut self.starting {
            Some(starting) => starting.undo = Some(undo),
            None => undo.take_back(),
        }
    }

    /// Ends the loop and starts this choice. A choice that cannot be loaded does not end the loop.
    pub(super) fn begin(&mut self, choice: RigChoice, before: Option<RigChoice>, because: Option<String>) {
        if self.reopen.is_some() {
            return self.start.notify(Some(text::link::ONE_RIG.get().to_owned()));
        }
        let loaded = RigConfig::load(&choice.rig).and_then(|rig| {
            let scene = Scene::load(&choice.scene)?.mounted_at(&rig)?;
            let scene = if rig.devices.is_none() { drawn_anew(scene) } else { scene };
            Ok((rig, scene))
        });
        let (rig, scene) = match loaded {
            Ok(loaded) => loaded,
            Err(error) => {
                return self
                    .start
                    .notify(Some(text::start::not_started(&nima_words::report_text::quoted(&chain(&error)), None)));
            }
        };
        // End the old loop first: a rig must have only one controller, and two sets of emulators cannot use the same
        // addresses.
        drop(self.door.take());
        self.sessions.end();
        self.serve(None);
        self.start.notify(None);
        let (give, emulators) = channel();
        let ctx = self.ctx.clone();
        let devices = rig.devices.clone();
        let names = choice.clone();
        let program = self.program.clone();
        let work = move || {
            let started = match program {
                Some(program) => Emulators::start_by(&program, &names.rig, &names.scene, devices.as_ref()),
                None => Emulators::start(&names.rig, &names.scene, devices.as_ref()),
            };
            give.send(started.map_err(|error| format!("{error:#}"))).ok();
            ctx.request_repaint();
        };
        // If no thread can be created, `give` is dropped, which is reported.
        thread::Builder::new().name("emulators".to_owned()).spawn(work).ok();
        self.starting = Some(StartingRig { choice, rig, scene, emulators, before, because, undo: None });
    }

    /// Continues the start once the emulators serve.
    pub(super) fn go_on_starting(&mut self) {
        let Some(starting) = &self.starting else { return };
        let emulators = match starting.emulators.try_recv() {
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => Err(text::start::NO_THREAD.get().to_owned()),
            Ok(emulators) => emulators,
        };
        let Some(StartingRig { choice, rig, scene, before, because, undo, .. }) = self.starting.take() else { return };
        let started = emulators.and_then(|emulators| {
            self.serve(emulators);
            self.start_loop(rig, scene)
        });
        if let (Err(cause), Some(undo)) = (&started, &undo) {
            undo.take_back();
            self.panels.devices.notify(text::devices::not_changed(cause));
        }
        match (started, before) {
            (Ok(()), _) => {
                if !self.is_held() {
                    choice.remember(&mut self.settings.now.recent);
                }
                self.forget_what_was_taken();
                self.watched = None;
                if because.is_some() {
                    self.shown = ShownPage::Start;
                } else if matches!(self.shown, ShownPage::Start) {
                    self.leave_page();
                }
                self.start
                    .notify(because.map(|cause| text::start::not_started(&cause, Some(of_file(&self.live.rig.name)))));
                self.running = choice;
            }
            (Err(cause), Some(before)) => self.begin(before, None, Some(cause)),
            (Err(cause), None) => {
                self.shown = ShownPage::Start;
                self.start.notify(Some(text::start::not_started(&because.unwrap_or(cause), None)));
            }
        }
    }
}
