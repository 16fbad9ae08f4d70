//! Content below the top bar: an open page, a recorded session, or the views of the machine.

use egui::Ui;
use nima_panels::roles::{Wishes, role_ui};

use super::{ConsoleApp, shown_page::ShownPage};

impl ConsoleApp {
    pub(super) fn page_layout(&mut self, ui: &mut Ui) {
        self.panels.scene.is_seen = false;
        if let Some(past) = self.shown.past_mut() {
            past.panels.scene.is_seen = false;
        }
        match self.shown {
            ShownPage::Past(_) => self.past_layout(ui),
            ShownPage::Sessions => self.list_layout(ui),
            ShownPage::Check(_) => self.check_layout(ui),
            ShownPage::Setup(_) => self.setup_layout(ui),
            ShownPage::Wizard(which) => self.wizard_layout(ui, which),
            ShownPage::Start => self.start_layout(ui),
            ShownPage::OfExtra if self.in_trial() => self.trial_layout(ui),
            ShownPage::OfExtra => self.page_of_extra_layout(ui),
            ShownPage::Monitor => self.monitor_layout(ui),
        }
    }

    /// Ends mouse control while no view shows the field: the person would not see the instrument, and could not end it.
    pub(super) fn end_hidden_drive(&mut self) {
        let scene = &mut self.panels.scene;
        if scene.is_led() && !scene.is_seen {
            scene.let_go(&mut self.outbox);
        }
    }

    /// Makes the loop compute what a panel shows, once the work without it is measured.
    pub(super) fn compute_shown(&mut self) {
        let is_seen = std::mem::take(&mut self.panels.degrees.is_seen);
        // During playback, or with a stop, the command would be dropped.
        if !self.shown.is_past() && !self.outbox.holds_stop() {
            let runs = self.live.state().permits().drives;
            let shows = is_seen && runs && self.live.compare_cost.has_waited();
            self.outbox.show_all_modes(shows, &self.live);
        }
    }

    fn monitor_layout(&mut self, ui: &mut Ui) {
        self.panels.devices.is_seen = false;
        self.panels.devices.is_starting = self.starting.is_some();
        self.panels.devices.sample(&self.live);
        let wishes =
            role_ui(ui, &mut self.settings.now, &mut self.live, &mut self.panels, &self.active, &mut self.outbox);
        self.obey_wishes(wishes);
    }

    pub(super) fn obey_wishes(&mut self, Wishes { restart, calibration, devices }: Wishes) {
        // At the end of the frame, when everything has been drawn with the old loop. A stop requested in the same frame
        // takes precedence.
        if self.outbox.holds_stop() {
            return;
        }
        if let Some(rig) = restart {
            self.apply_tradeoff(rig);
        }
        if let Some(change) = devices {
            self.connect(&change);
        }
        self.obey_calibrations(calibration);
    }
}
