//! The console while a wizard is open: switches the scene, saves calibrations, and switches back.

use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Ui};
use nima_machine::{
    config::RigConfig,
    messages::{Command, LoopState},
    rig::{Prompt, Roster, Side},
};
use nima_panels::{CalibrationPage, CalibrationWish, calibrations_ui, tiles::PanelId};
use nima_screen::{theme, widgets::card};
use nima_simulation::{scene::Scene, screen::Screen};
use nima_wizards::{
    Binding, CalibrationTarget, GoOn, SaveRequest, WizardKind, WizardPageRequest, Wizards,
    overview::{following, overview},
};
use nima_words::{language::Text, text};

use super::{
    ConsoleApp,
    shown_page::{ShownPage, WayBack},
};
use crate::console::reader::task_of;

/// Minimum width of a wizard next to the endoscope image, and the range of the image's width.
const WIZARD_MIN: f32 = 560.0;
const IMAGE: (f32, f32) = (340.0, 760.0);

impl ConsoleApp {
    /// Opens a wizard. A simulated rig changes to the wizard's scene, in which a simulated person guides the arm; the arm of
    /// a rig with devices has a technician.
    pub(super) fn open_wizard(&mut self, which: WizardKind) {
        let side = self.active.side();
        let Some(scene) = which.scene().filter(|_| self.live.rig.devices.is_none()) else {
            // A simulated rig has no arm with joints: the wizard reports it.
            let rests = matches!(self.live.state_for(side), LoopState::Idle | LoopState::Disconnected)
                || self.live.rig.devices.is_none();
            let rig = self.live.rig.clone();
            let scene = self.live.scene.clone();
            match if rests { Ok(()) } else { self.restart(rig, scene) } {
                Ok(()) => self.shown = ShownPage::Wizard(which),
                Err(reason) => self.active.notify(text::calibrations::not_opened(&reason)),
            }
            return;
        };
        let here = which.suits(&self.live.scene) && self.live.scene.has(&self.live.rig, side);
        let opened = if here && self.shown.wizard().is_none() {
            Ok(())
        } else {
            let scene = Scene::load(scene).map_err(|error| nima_words::report_text::quoted(&error));
            let scene = scene.map(|scene| if side == Side::Left { scene.with_left_hand() } else { scene });
            scene.and_then(|scene| self.restart_in(scene))
        };
        match opened {
            Ok(()) => self.shown = ShownPage::Wizard(which),
            Err(reason) => self.active.notify(text::calibrations::not_opened(&reason)),
        }
    }

    /// Restarts the same rig in another scene; the previous scene is stored for the return.
    pub(super) fn restart_in(&mut self, scene: Scene) -> Result<(), String> {
        let watched = self.live.scene.clone();
        self.restart(self.live.rig.clone(), scene)?;
        self.watched.get_or_insert(watched);
        Ok(())
    }

    /// Returns to the set-up page if the wizard was started there, and to the previous scene; the wizards keep their data.
    pub(super) fn close_wizard(&mut self) {
        let from = std::mem::take(&mut self.way_back);
        let returns = from == WayBack::Setup && !matches!(self.shown, ShownPage::Setup(_));
        self.leave_page();
        self.leave_scene();
        if returns {
            self.open_setup();
        }
    }

    /// Returns the name of the way back from a wizard or the check.
    pub(super) const fn way_back(&self) -> Text {
        match self.way_back {
            WayBack::Monitor => text::calibrations::CLOSE_WIZARD,
            WayBack::Setup => text::overview::BACK,
        }
    }

    /// Ends what a wizard asks of the person at the arm, and returns to the scene before it.
    fn leave_scene(&mut self) {
        let Some(scene) = self.watched.take() else {
            self.outbox.push(Command::Prompt(self.active.side(), Prompt::Rest));
            return;
        };
        if let Err(reason) = self.restart(self.live.rig.clone(), scene.clone()) {
            self.watched = Some(scene);
            self.active.notify(text::calibrations::still_in_the_experiment(&reason));
        }
    }

    /// Selects the wrist sensor of the other arm: data of one sensor must not be mixed with another's.
    fn choose_arm(&mut self, side: Side) {
        self.outbox.push(Command::Prompt(self.active.side(), Prompt::Rest));
        self.active.choose(side);
        self.forget_what_was_taken();
        if let Some(which) = self.shown.wizard() {
            self.leave_page();
            self.open_wizard(which);
        }
    }

    /// Resets the wizards, because their data are from another sensor.
    pub(super) fn forget_what_was_taken(&mut self) {
        self.wizards = Wizards::default();
    }

    /// Saves the calibration of this wizard and activates it.
    fn save(&mut self, which: WizardKind, saving: SaveRequest) {
        let saved = self.saved(saving);
        // Read this before the restart, because afterwards the sensor must first be opened.
        let following = saved.as_ref().ok().and_then(|(rig, _)| self.following(which, rig));
        let report = match saved {
            Ok((rig, words)) => match self.restart(rig, self.live.scene.clone()) {
                Ok(()) => Ok(words),
                Err(reason) => Ok(text::calibrations::active_after_restart(&words, &reason)),
            },
            Err(reason) => Err(text::calibrations::not_saved(&reason)),
        };
        self.wizards.report_saved(which, report, following);
    }

    /// Returns the step after this calibration on this rig; a simulated rig needs no ready check.
    fn following(&self, which: WizardKind, rig: &RigConfig) -> Option<GoOn> {
        let arms = overview(&self.active, rig, &self.running.rig);
        let wanted = following(&arms, Some(self.wizards.wanted(which, self.active.side())));
        wanted.map(GoOn::Calibrate).or(rig.devices.as_ref().map(|_| GoOn::Check))
    }

    /// Opens the wizard of this calibration, for its arm.
    pub(super) fn open_wanted(&mut self, wanted: CalibrationTarget) {
        if wanted.side != self.active.side() {
            self.obey_calibrations(Some(CalibrationWish::Choose(wanted.side)));
        }
        self.wizards.choose_part(wanted);
        self.obey_calibrations(Some(CalibrationWish::Open(wanted.which)));
    }

    /// Saves; returns the new rig and a text for the screen.
    fn saved(&mut self, saving: SaveRequest) -> Result<(RigConfig, String), String> {
        let (rig, path, words) = match saving {
            SaveRequest::Frame(saving) => self.active.save_frame(*saving, &self.running.rig, self.settings.folder())?,
            SaveRequest::Camera(changes) => {
                let (path, rig) = self.active.change_rig(&changes, &self.running.rig, self.settings.folder())?;
                let words = text::wizards::written(&path);
                (rig, path, words)
            }
            SaveRequest::Undo(changes) => {
                let (path, rig) = self.active.change_rig(&changes, &self.running.rig, self.settings.folder())?;
                (rig, path, text::frames::UNDONE.get().to_owned())
            }
            saving => return Ok((self.live.rig.clone(), self.active.save(saving)?)),
        };
        self.running.rig = path.display().to_string();
        self.running.remember(&mut self.settings.now.recent);
        Ok((rig, words))
    }

    /// Sends the open wizard's instruction for the person at the arm, and shows it to the technician of an emulated rig.
    pub(super) fn ask(&mut self) {
        if matches!(self.shown, ShownPage::Check(_)) {
            return;
        }
        let open = self.shown.wizard();
        let wanted = open.map_or(Prompt::Rest, |which| self.wizards.prompt(which));
        let side = self.active.side();
        if let Some(reader) = &self.reader {
            reader.show(Screen { side, task: task_of(open), prompt: wanted }, &mut self.read);
        }
        let tick = self.live.tick_of(side);
        let asked = tick.is_some_and(|tick| tick.state == LoopState::Idle && tick.guidance.prompt != wanted);
        if open.is_some() && asked {
            self.outbox.push(Command::Prompt(side, wanted));
        }
    }

    /// Returns sensor, tool and arm for a new calibration.
    fn binding(&self) -> Binding {
        let none = Roster::new();
        let roster = self.door.as_ref().map_or(&none, |door| door.handle().roster());
        self.active.binding_of(&self.running.rig, &self.live.rig, roster)
    }

    /// Lays out the Technician view with one wizard, the active calibrations, and the button to return.
    pub(super) fn wizard_layout(&mut self, ui: &mut Ui, which: WizardKind) {
        let side = Frame::new().fill(theme::now().panel).inner_margin(Margin::same(8));
        let mut wish = None;
        Panel::left("calibrations").exact_size(316.0).resizable(false).frame(side).show(ui, |ui| {
            let panel = PanelId::Calibrations;
            wish = card(ui, panel.title(), panel.meaning(), |ui| {
                let open = Some(CalibrationPage::Wizard(which));
                calibrations_ui(ui, &self.live, &self.active, open, self.way_back())
            });
        });
        if self.wizards.looks_at_image(which) && self.panels.eyes.is_on() {
            let width = (ui.available_width() - WIZARD_MIN).clamp(IMAGE.0, IMAGE.1);
            Panel::right("image").exact_size(width).resizable(false).frame(side).show(ui, |ui| {
                self.panels.eyes.ui(ui, &self.live);
            });
        }
        let binding = self.binding();
        self.wizards.see(which, || self.panels.eyes.newest(), ui.ctx());
        let mut asked = None;
        CentralPanel::default().frame(Frame::new().inner_margin(Margin::symmetric(18, 14))).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                ui.set_max_width(ui.available_width().min(760.0));
                asked = self.wizards.ui(which, ui, &binding);
            });
        });
        match asked {
            Some(WizardPageRequest::Save(saving)) => self.save(which, saving),
            Some(WizardPageRequest::GoOn(GoOn::Calibrate(wanted))) => self.open_wanted(wanted),
            Some(WizardPageRequest::GoOn(GoOn::Check)) => self.obey_calibrations(Some(CalibrationWish::Check)),
            None => {}
        }
        self.obey_calibrations(wish);
    }

    pub(super) fn obey_calibrations(&mut self, wish: Option<CalibrationWish>) {
        match wish {
            Some(CalibrationWish::Open(which)) => self.open_wizard(which),
            Some(CalibrationWish::Check) => self.open_check(),
            Some(CalibrationWish::List) => self.open_setup(),
            Some(CalibrationWish::Choose(side)) => self.choose_arm(side),
            Some(CalibrationWish::Close) => self.close_wizard(),
            None => {}
        }
    }
}
