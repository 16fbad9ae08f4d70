//! What is below the top bar: a page that is open, the past, or the views of the machine.

use egui::Ui;

use super::ConsoleApp;
use crate::console::roles::{Wishes, role_ui};

impl ConsoleApp {
    pub(super) fn page_layout(&mut self, ui: &mut Ui) {
        if self.in_trial() {
            self.trial_layout(ui);
        } else if self.past.is_some() {
            self.past_layout(ui);
        } else if self.list.is_open {
            self.list_layout(ui);
        } else if self.checking.is_open() {
            self.check_layout(ui);
        } else if self.listing.is_open() {
            self.listing_layout(ui);
        } else if self.wizards.open.is_some() {
            self.wizard_layout(ui);
        } else if self.start.is_open {
            self.start_layout(ui);
        } else if self.studies.is_shown {
            self.studies_layout(ui);
        } else {
            self.monitor_layout(ui);
        }
    }

    fn monitor_layout(&mut self, ui: &mut Ui) {
        self.panels.devices.is_seen = false;
        self.panels.devices.is_starting = self.starting.is_some();
        let Wishes { restart, calibration, devices } =
            role_ui(ui, &mut self.settings.now, &mut self.live, &mut self.panels, &self.in_force, &mut self.outbox);
        // At the end of the frame, after everything was drawn with the old loop. A stop requested in the same frame
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
