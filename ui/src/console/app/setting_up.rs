//! The console while the set-up page is open.

use std::time::{Duration, Instant};

use egui::{CentralPanel, Frame, Margin, Panel, ScrollArea, Ui};
use nima_panels::{CalibrationPage, CalibrationWish, calibrations_ui, tiles::PanelId};
use nima_recording::store::ReadyRecord;
use nima_screen::{theme, widgets::card};
use nima_wizards::overview::{ArmOverview, SetupStep, overview, overview_ui};
use nima_words::text;

use super::{
    ConsoleApp,
    shown_page::{ShownPage, WayBack},
};

/// Update interval of the page: a calibration may be saved, or a sensor may connect.
const AGAIN_EVERY: Duration = Duration::from_secs(2);

/// The set-up page: its content, as last read.
#[derive(Debug)]
pub(super) struct SetupPage {
    arms: Vec<ArmOverview>,
    /// The last ready check of the rig.
    check: Option<ReadyRecord>,
    at: Instant,
}

/// Keeps the last known calibrations of an arm whose sensor is not connected: a sensor that is lost for a moment must not move
/// the tiles under the pointer. The tile of the devices shows the loss.
fn with_known(mut arms: Vec<ArmOverview>, before: &[ArmOverview]) -> Vec<ArmOverview> {
    for arm in arms.iter_mut().filter(|arm| arm.wrist.is_none()) {
        if let Some(known) = before.iter().find(|known| known.side == arm.side) {
            arm.clone_from(known);
        }
    }
    arms
}

impl ConsoleApp {
    /// Reads the content and opens the page; the loop continues.
    pub(super) fn open_setup(&mut self) {
        self.way_back = WayBack::Monitor;
        let arms = overview(&self.active, &self.live.rig, &self.running.rig);
        let arms = match &self.shown {
            ShownPage::Setup(before) => with_known(arms, &before.arms),
            _ => arms,
        };
        let check = self.active.store().and_then(|store| store.last_check(&self.live.rig.name));
        self.shown = ShownPage::Setup(Box::new(SetupPage { arms, check, at: Instant::now() }));
    }

    /// Lays out the page next to the active calibrations.
    pub(super) fn setup_layout(&mut self, ui: &mut Ui) {
        if matches!(&self.shown, ShownPage::Setup(setup) if setup.at.elapsed() > AGAIN_EVERY) {
            self.open_setup();
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
                if let ShownPage::Setup(setup) = &self.shown {
                    step = overview_ui(ui, &setup.arms, &self.live, setup.check.as_ref(), &closed);
                }
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
        if !matches!(self.shown, ShownPage::Setup(_)) {
            self.way_back = WayBack::Setup;
        }
    }
}

#[cfg(test)]
mod tests {
    use nima_machine::rig::Side;
    use nima_recording::store::WristId;

    use super::*;

    #[test]
    fn an_arm_whose_sensor_is_lost_keeps_what_was_known() {
        let wrist =
            |serial_number: &str| Some(WristId { serial_number: serial_number.to_owned(), tool: "grasper".to_owned() });
        let arm = |side, wrist| ArmOverview { side, wrist, lines: Vec::new() };
        let before = [arm(Side::Right, wrist("SN1")), arm(Side::Left, wrist("SN2"))];
        let lost = vec![arm(Side::Right, None), arm(Side::Left, wrist("SN3"))];
        let now = with_known(lost, &before);
        assert_eq!([&now[0].wrist, &now[1].wrist], [&wrist("SN1"), &wrist("SN3")], "another sensor is another arm");
    }
}
