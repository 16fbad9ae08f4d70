//! The console while the page of all calibrations is open.

use std::time::{Duration, Instant};

use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Ui};

use super::ConsoleApp;
use crate::console::{
    overview::{ArmOverview, overview, overview_ui},
    panels::{CalibrationPage, calibrations_ui},
    text, theme,
    tiles::Panel as Tile,
    widgets::card,
};

/// Update interval of the list: a calibration may be saved, or a sensor may connect.
const AGAIN_EVERY: Duration = Duration::from_secs(2);

/// The list while its page is open, and its update time.
#[derive(Debug, Default)]
pub(super) struct Listing(Option<(Vec<ArmOverview>, Instant)>);

impl Listing {
    pub(super) const fn is_open(&self) -> bool {
        self.0.is_some()
    }

    pub(super) fn close(&mut self) {
        self.0 = None;
    }
}

impl ConsoleApp {
    /// Builds the list and opens its page; the loop continues.
    pub(super) fn open_listing(&mut self) {
        self.close_check();
        self.wizards.open = None;
        let arms = overview(&self.active, &self.live.rig, &self.running.rig);
        self.listing.0 = Some((arms, Instant::now()));
    }

    /// Lays out the page next to the active calibrations.
    pub(super) fn listing_layout(&mut self, ui: &mut Ui) {
        if self.listing.0.as_ref().is_some_and(|(_, at)| at.elapsed() > AGAIN_EVERY) {
            self.open_listing();
        }
        let side = Frame::new().fill(theme::now().panel).inner_margin(Margin::same(8));
        let mut wish = None;
        Panel::left("calibrations").exact_size(316.0).resizable(false).frame(side).show(ui, |ui| {
            let panel = Tile::Calibrations;
            wish = card(ui, panel.title(), panel.meaning(), |ui| {
                calibrations_ui(ui, &self.live, &self.active, Some(CalibrationPage::All))
            });
        });
        let closed = |side| text::calibrations::closed(self.live.state_for(side));
        let mut wanted = None;
        CentralPanel::default().frame(Frame::new().inner_margin(Margin::symmetric(18, 14))).show(ui, |ui| {
            ScrollArea::both().auto_shrink(false).show(ui, |ui| {
                wanted = self.listing.0.as_ref().and_then(|(arms, _)| overview_ui(ui, arms, &closed));
            });
        });
        match wanted {
            Some(wanted) => self.open_wanted(wanted),
            None => self.obey_calibrations(wish),
        }
    }
}
