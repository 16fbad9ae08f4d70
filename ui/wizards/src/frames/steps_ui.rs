//! The first two steps: the required sources before the recording, and the recording with its instructions.

use egui::{Button, RichText, Ui};
use nalgebra::UnitQuaternion;
use nima_core::calibration::frames::CalibrationSource;
use nima_machine::rig::Prompt;
use nima_screen::{
    theme,
    widgets::{card, small},
};
use nima_words::{
    report_text::{self, ShortText as _},
    text::{self, frames as texts},
};

use nima_calibrations::{
    Binding,
    frames::{FrameKind, kind::Texts},
};

use super::FrameWizard;
use crate::{
    checks::{check_line, switch_ui},
    drawings::{POSE_HEIGHT, progress},
    frame::Wizard as _,
    guide::{SIZE, beside},
};

impl FrameWizard {
    pub(super) fn check_ui(&mut self, ui: &mut Ui, binding: &Binding) {
        card(ui, texts::CHECKS_TITLE, texts::CHECKS_HOVER, |ui| {
            let Some(job) = &self.job else {
                ui.label(texts::NO_ARM);
                return;
            };
            let drawn = self.drawn();
            let needs = job.needs();
            beside(ui, &drawn, None, |ui| {
                self.needs_ui(ui, &needs);
                if self.kind == FrameKind::View {
                    check_line(ui, texts::CHECK_IMAGE.get(), self.has_image(binding), texts::NO_IMAGE.get());
                }
            });
        });
        let (Some([name, meaning]), Some(subject)) = (self.texts().other_way, self.subject.clone()) else { return };
        card(ui, texts::OPTIONS_TITLE, texts::OPTIONS_HOVER, |ui| {
            let needs = self.kind.other_way_needs(&subject);
            let free = needs.is_ok() && self.taken() == 0;
            if let Some(other_way) = switch_ui(ui, free, self.other_way, name, meaning) {
                self.other_way = other_way;
                self.begin(Some(subject));
            }
            if let Err(reason) = needs {
                ui.label(small(reason));
            }
        });
    }

    /// Draws the instruction before the recording, and the sources that it needs.
    fn needs_ui(&self, ui: &mut Ui, needs: &[CalibrationSource]) {
        ui.label(RichText::new(self.texts().before).font(theme::strong(15.0)));
        ui.add_space(6.0);
        for source in needs {
            let (name, met) = match source {
                CalibrationSource::Flange => (texts::CHECK_ARM.get(), self.seen.base_from_flange.is_some()),
                CalibrationSource::Marker => (texts::CHECK_MARKER.get(), self.seen.c_from_m.is_some()),
                CalibrationSource::Handle => (texts::CHECK_HANDLE.get(), self.seen.leader_from_handle.is_some()),
                CalibrationSource::Wrench => (texts::CHECK_WRENCH.get(), self.seen.wrench.is_some()),
            };
            check_line(ui, name, met, source.words());
        }
    }

    /// Returns the instruction whose drawing is shown, even while the recording is paused or has not begun.
    fn drawn(&self) -> Prompt {
        self.kind.prompt(self.other_way, self.taken(), || self.target())
    }

    /// Returns the tool's current orientation, as far as the rig file is correct.
    fn held(&self) -> Option<UnitQuaternion<f64>> {
        let arm = self.subject.as_ref()?.arm;
        let base_from_flange = self.seen.base_from_flange?;
        Some(arm.world_from_base.rotation * base_from_flange.rotation * arm.flange_from_s1.rotation)
    }

    pub(super) fn record_ui(&mut self, ui: &mut Ui) {
        let Texts { task, units, .. } = self.texts();
        let Some(coverage) = self.job.as_ref().map(|job| job.coverage()) else { return };
        let complete = coverage.fraction >= 1.0;
        card(ui, texts::RECORD_TITLE, texts::RECORD_HOVER, |ui| {
            let asked = if complete {
                texts::ALL_RECORDED.get().to_owned()
            } else {
                FrameKind::asks(&self.prompt(), self.target().name)
            };
            let drawn = if complete { Prompt::Rest } else { self.drawn() };
            let top = ui.cursor().top();
            beside(ui, &drawn, self.held().as_ref(), |ui| {
                ui.label(RichText::new(asked).font(theme::strong(19.0)));
                if !complete {
                    ui.label(task);
                    ui.add_space(6.0);
                    let paused = (0.0, texts::PAUSED.get().to_owned());
                    let (fraction, phase) = if self.paused { paused } else { report_text::phase(&self.phase) };
                    progress(ui, texts::PROGRESS.get(), fraction, &phase);
                    ui.add_space(4.0);
                }
            });
            if complete {
                // Keep the space of the drawing, so that the buttons below do not move.
                let height = if self.kind == FrameKind::Mount { POSE_HEIGHT } else { SIZE.y };
                ui.add_space((height + top - ui.cursor().top()).max(0.0));
            }
            let words = texts::coverage(self.taken(), units, coverage.missing.map(report_text::ShortText::words));
            progress(ui, texts::COVERAGE.get(), coverage.fraction, &words);
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                let pause = if self.paused { texts::GO_ON.get() } else { texts::PAUSE.get() };
                let pause = ui.add_enabled(!complete, Button::new(pause)).on_hover_text(texts::PAUSE_HOVER);
                if pause.on_disabled_hover_text(texts::ALL_RECORDED).clicked() {
                    self.paused = !self.paused;
                }
                let remove = ui.add_enabled(self.taken() > 0, Button::new(texts::REMOVE_LAST));
                if remove.on_disabled_hover_text(text::wizards::NOTHING_RECORDED).clicked() {
                    self.job.iter_mut().for_each(|job| job.undo());
                    self.report = None;
                    self.frame.saved = None;
                }
            });
        });
    }
}
