//! The study next to its participants: public facts, the report, unblinding.

use std::path::PathBuf;

use egui::{Button, Label, RichText, Ui, vec2};
use nima_recording::store::utc_now;
use nima_screen::{
    background::BackgroundQuery,
    opener, theme,
    widgets::{card, small},
};
use nima_user_study::UserStudy;

use super::{
    field_ui,
    list::{blindness, finished},
};
use crate::extras::user_studies::{report, text};

/// Folder of the report within that of the study.
const REPORT: &str = "report";

#[derive(Debug, Default)]
pub(super) struct SidePanel {
    name: String,
    why: String,
    message: Option<String>,
    report: BackgroundQuery<Result<PathBuf, String>>,
    /// Whether a program opened the page.
    opened: BackgroundQuery<bool>,
}

impl SidePanel {
    pub(super) fn ui(&mut self, ui: &mut Ui, study: &mut UserStudy) {
        about_ui(ui, study);
        self.report_ui(ui, study);
        self.unblinding_ui(ui, study);
    }

    /// A separate thread writes the report from the folder: the statistics take some seconds.
    fn report_ui(&mut self, ui: &mut Ui, study: &UserStudy) {
        card(ui, text::studies::REPORT, text::studies::REPORT_HOVER, |ui| {
            let running = self.report.is_running();
            let words = if running { text::studies::REPORT_WRITING.get() } else { text::studies::REPORT_WRITE.get() };
            let button = Button::new(words).min_size(vec2(ui.available_width(), 32.0));
            if ui.add_enabled(!running, button).clicked() {
                let folder = study.folder().to_owned();
                let ctx = ui.ctx().clone();
                self.report.forget();
                self.opened.forget();
                self.report.begin(&ctx, move || {
                    let study = UserStudy::read(&folder).map_err(|error| error.to_string())?;
                    report::write(&study, &folder.join(REPORT), false).map_err(|error| format!("{error:#}"))
                });
            }
            let message = self.report.found().map(|found| match found {
                Ok(page) => text::studies::report_written(page),
                Err(why) => text::studies::report_failed(why),
            });
            ui.add(Label::new(small(message.unwrap_or_default())).wrap());
            let page = self.report.found().and_then(|found| found.as_ref().ok()).cloned();
            if let Some(page) = page.or_else(|| written_before(study).filter(|_| !running)) {
                self.open_ui(ui, page);
            }
        });
    }

    /// Opens the page in the user's program for it.
    fn open_ui(&mut self, ui: &mut Ui, page: PathBuf) {
        let running = self.opened.is_running();
        let button = Button::new(text::studies::REPORT_OPEN).min_size(vec2(ui.available_width(), 28.0));
        if ui.add_enabled(!running, button).on_hover_text(page.display().to_string()).clicked() {
            self.opened.forget();
            self.opened.begin(ui.ctx(), move || opener::open(&page));
        }
        if self.opened.found() == Some(&false) {
            ui.add(Label::new(small(text::studies::REPORT_NOT_OPENED)).wrap());
        }
    }

    fn unblinding_ui(&mut self, ui: &mut Ui, study: &mut UserStudy) {
        let mut pressed = false;
        card(ui, text::studies::UNBLINDING, text::studies::UNBLINDING_HOVER, |ui| {
            if let Some(opened) = study.opened() {
                let message = study.state().unblinding.as_ref();
                let message = message.map(|by| text::studies::unblinded(&by.who, &by.at, &by.why));
                let message = message.unwrap_or_else(|| text::studies::NOT_BLIND.get().to_owned());
                ui.add(Label::new(small(message)).wrap());
                for (label, name) in opened.labels() {
                    ui.add(
                        Label::new(RichText::new(text::studies::stands_for(label, name)).font(theme::strong(14.0)))
                            .wrap(),
                    );
                }
                return;
            }
            field_ui(ui, text::studies::UNBLIND_NAME.get(), &mut self.name);
            field_ui(ui, text::studies::UNBLIND_WHY.get(), &mut self.why);
            if finished(study) < study.plan().participants.len() {
                ui.add(Label::new(small(text::studies::UNBLIND_EARLY)).wrap());
            }
            let complete = !self.name.trim().is_empty() && !self.why.trim().is_empty();
            let button = Button::new(text::studies::UNBLIND).min_size(vec2(ui.available_width(), 32.0));
            pressed = ui.add_enabled(complete, button).clicked();
            if let Some(message) = &self.message {
                ui.add(Label::new(message).wrap());
            }
        });
        if pressed {
            self.message = study.unblind(&self.name, &self.why, &utc_now()).err().map(|error| error.to_string());
        }
    }
}

/// Returns the last written report.
fn written_before(study: &UserStudy) -> Option<PathBuf> {
    let page = study.folder().join(REPORT).join(report::PAGE);
    page.is_file().then_some(page)
}

fn about_ui(ui: &mut Ui, study: &UserStudy) {
    let plan = study.plan();
    let state = study.state();
    card(ui, text::studies::ABOUT, text::studies::ABOUT_HOVER, |ui| {
        ui.add(Label::new(RichText::new(&plan.name).font(theme::strong(15.0))).wrap());
        let count = plan.participants.len();
        let blind = blindness(study);
        let facts = text::studies::facts(&plan.rig, finished(study), count, state.results(), blind);
        ui.add(Label::new(facts).wrap());
        if state.is_simulated() {
            ui.add(Label::new(small(text::studies::SIMULATED)).wrap());
        }
        ui.add(Label::new(small(study.folder().display().to_string())).wrap());
        ui.add_space(4.0);
        ui.label(small(text::studies::COMMITMENT)).on_hover_text(text::studies::COMMITMENT_HOVER);
        ui.add(Label::new(RichText::new(&plan.commitment).monospace().size(11.0)).wrap())
            .on_hover_text(text::studies::COMMITMENT_HOVER);
        let copy = Button::new(text::studies::COPY).min_size(vec2(ui.available_width(), 28.0));
        if ui.add(copy).on_hover_text(text::studies::COMMITMENT_HOVER).clicked() {
            ui.ctx().copy_text(plan.commitment.clone());
        }
    });
}
