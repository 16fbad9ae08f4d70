//! The console while the set-up page is open.

use std::time::{Duration, Instant};

use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Ui};
use nima_panels::{CalibrationPage, CalibrationWish, calibrations_ui, tiles::PanelId};
use nima_recording::store::ReadyRecord;
use nima_screen::{theme, widgets::card};
use nima_wizards::overview::{ArmOverview, SetupStep, overview, overview_ui};
use nima_words::{language::Text, text};

use super::ConsoleApp;

/// Update interval of the page: a calibration may be saved, or a sensor may connect.
const AGAIN_EVERY: Duration = Duration::from_secs(2);

/// The set-up page.
#[derive(Debug, Default)]
pub(super) struct Listing {
    /// Its content while it is open.
    open: Option<Setup>,
    /// A wizard or the check was started on this page, and returns to it.
    returns: bool,
}

/// Content of the page, as last read.
#[derive(Debug)]
struct Setup {
    arms: Vec<ArmOverview>,
    /// The last ready check of the rig.
    check: Option<ReadyRecord>,
    at: Instant,
}

impl Listing {
    pub(super) const fn is_open(&self) -> bool {
        self.open.is_some()
    }

    pub(super) fn close(&mut self) {
        self.open = None;
    }

    /// Leaves the page, or the wizard that was started on it; returns whether to return to the page.
    pub(super) fn leave(&mut self) -> bool {
        let was_open = self.open.take().is_some();
        std::mem::take(&mut self.returns) && !was_open
    }

    /// Returns the name of the way back from a wizard or the check.
    pub(super) const fn way_back(&self) -> Text {
        if self.returns { text::overview::BACK } else { text::calibrations::CLOSE_WIZARD }
    }
}

impl ConsoleApp {
    /// Reads the content and opens the page; the loop continues.
    pub(super) fn open_listing(&mut self) {
        self.close_check();
        self.wizards.open = None;
        self.listing.returns = false;
        let arms = overview(&self.active, &self.live.rig, &self.running.rig);
        let check = self.active.store().and_then(|store| store.last_check(&self.live.rig.name));
        self.listing.open = Some(Setup { arms, check, at: Instant::now() });
    }

    /// Lays out the page next to the active calibrations.
    pub(super) fn listing_layout(&mut self, ui: &mut Ui) {
        if self.listing.open.as_ref().is_some_and(|setup| setup.at.elapsed() > AGAIN_EVERY) {
            self.open_listing();
        }
        let side = Frame::new().fill(theme::now().panel).inner_margin(Margin::same(8));
        let mut wish = None;
        Panel::left("calibrations").exact_size(316.0).resizable(false).frame(side).show(ui, |ui| {
            let panel = PanelId::Calibrations;
            wish = card(ui, panel.title(), panel.meaning(), |ui| {
                let back = text::calibrations::CLOSE_WIZARD;
                calibrations_ui(ui, &self.live, &self.active, Some(CalibrationPage::All), back)
            });
        });
        let closed = |side| text::calibrations::closed(self.live.state_for(side));
        let mut step = None;
        CentralPanel::default().frame(Frame::new().inner_margin(Margin::symmetric(18, 14))).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                let setup = self.listing.open.as_ref();
                step = setup.and_then(|setup| overview_ui(ui, &setup.arms, &self.live, setup.check.as_ref(), &closed));
            });
        });
        match step {
            Some(step) => self.begin_step(step),
            None => self.obey_calibrations(wish),
        }
    }

    fn begin_step(&mut self, step: SetupStep) {
        match step {
            SetupStep::Devices => {
                self.obey_calibrations(Some(CalibrationWish::Close));
                self.settings.now.layout.show(PanelId::Devices);
                return;
            }
            SetupStep::Calibrate(wanted) => self.open_wanted(wanted),
            SetupStep::Check => self.obey_calibrations(Some(CalibrationWish::Check)),
        }
        self.listing.returns = !self.listing.is_open();
    }
}
