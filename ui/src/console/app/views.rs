//! Content below the top bar: an open page, a recorded session, or the views of the machine.

use egui::Ui;

use super::{ConsoleApp, reaching::Page};
use crate::console::roles::{Wishes, role_ui};

impl ConsoleApp {
    pub(super) fn page_layout(&mut self, ui: &mut Ui) {
        self.panels.scene.is_seen = false;
        if let Some(past) = &mut self.past {
            past.panels.scene.is_seen = false;
        }
        match self.page() {
            Page::Trial => self.trial_layout(ui),
            Page::Past => self.past_layout(ui),
            Page::List => self.list_layout(ui),
            Page::Check => self.check_layout(ui),
            Page::Listing => self.listing_layout(ui),
            Page::Wizard => self.wizard_layout(ui),
            Page::Start => self.start_layout(ui),
            Page::OfExtra => self.page_of_extra_layout(ui),
            Page::Monitor => self.monitor_layout(ui),
        }
    }

    fn monitor_layout(&mut self, ui: &mut Ui) {
        self.panels.devices.is_seen = false;
        self.panels.devices.is_starting = self.starting.is_some();
        let Wishes { restart, calibration, devices } =
            role_ui(ui, &mut self.settings.now, &mut self.live, &mut self.panels, &self.in_force, &mut self.outbox);
        // At the end of the frame, after everything was drawn with the old loop. A stop requested in the same frame takes
        // precedence.
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
