//! Content of each step.

use egui::{Button, DragValue, Id, RichText, TextEdit, Ui};
use nima_camera::{LensReport, PlaceLack, ViewRequest};
use nima_core::calibration::Verdict;
use nima_endoscope::board::SQUARE_M;
use nima_screen::{
    steady_button::{PATIENT_S, SteadyButton},
    theme,
    widgets::{card, figure, small},
};
use nima_wizards::{
    checks::{check_line, switch_ui},
    drawings::progress,
    report::verdict_line,
};
use nima_words::{language::Text, text};

use super::{
    CameraWizard,
    image::{MAP_WIDTH, coverage_ui, image_ui},
};
use crate::extras::camera::{report_text, text as texts};

/// Maximum image width, points: with the map next to it and the instruction above it, it fits a window of 1280 x 720.
const IMAGE: f32 = 500.0;

impl CameraWizard {
    pub(super) fn check_ui(&mut self, ui: &mut Ui) {
        card(ui, texts::CHECKS_TITLE, texts::CHECKS_HOVER, |ui| {
            ui.label(texts::TASK);
            ui.add_space(6.0);
            check_line(ui, texts::CHECK_ENDOSCOPE.get(), self.endoscope.is_some(), texts::NO_ENDOSCOPE.get());
            check_line(ui, texts::CHECK_IMAGE.get(), self.shown.has_come(), texts::NO_IMAGE.get());
        });
        let free = self.views() == 0 && self.touches.is_empty();
        card(ui, texts::BOARD_TITLE, texts::BOARD_HOVER, |ui| {
            ui.horizontal(|ui| {
                let label = ui.label(texts::CORNERS);
                let edit = TextEdit::singleline(&mut self.corners).desired_width(60.0).char_limit(7);
                let edit = ui.add_enabled(free, edit).labelled_by(label.id).on_hover_text(texts::CORNERS_HOVER);
                edit.on_disabled_hover_text(text::wizards::SWITCH_DISABLED_HOVER);
                ui.add_space(16.0);
                let label = ui.label(texts::SQUARE);
                let [min_mm, max_mm] = [SQUARE_M.start(), SQUARE_M.end()].map(|side_m| side_m * 1e3);
                let drag = DragValue::new(&mut self.square_mm).range(min_mm..=max_mm).speed(0.1).suffix(" mm");
                let drag = ui.add_enabled(free, drag).labelled_by(label.id).on_hover_text(texts::SQUARE_HOVER);
                drag.on_disabled_hover_text(text::wizards::SWITCH_DISABLED_HOVER);
            });
            match self.board() {
                Ok(_) => ui.label(small(texts::PRINT)),
                Err(error) => ui.label(texts::no_board(&nima_words::report_text::quoted(&error))),
            };
            let keeps = switch_ui(
                ui,
                free && self.rig_lens().is_some(),
                self.keeps_lens,
                texts::KEEP.get(),
                texts::KEEP_HOVER.get(),
            );
            self.keeps_lens = keeps.unwrap_or(self.keeps_lens);
        });
        self.live_ui(ui, None);
    }

    pub(super) fn views_ui(&mut self, ui: &mut Ui) {
        if self.keeps_lens {
            ui.label(texts::LENS_IS_KEPT);
            return;
        }
        let Some(session) = &self.session else {
            ui.label(texts::NO_IMAGE);
            return;
        };
        let asked = session.asks();
        let fraction = session.fraction();
        let views = session.views().len();
        let coverage = session.coverage();
        let size_px = session.size_px();
        card(ui, texts::VIEWS_TITLE, texts::VIEWS_HOVER, |ui| {
            ui.label(RichText::new(report_text::ask(asked)).font(theme::strong(19.0)));
            let report = self.report();
            progress(ui, texts::PROGRESS.get(), fraction, &texts::views(views, &report));
            ui.add_space(4.0);
            ui.horizontal_top(|ui| {
                self.live_ui(ui, None);
                ui.vertical(|ui| coverage_ui(ui, &coverage, size_px));
            });
            ui.add_space(4.0);
            let remove = ui.add_enabled(views > 0, Button::new(texts::REMOVE_LAST));
            if remove.on_disabled_hover_text(text::wizards::NOTHING_RECORDED).clicked() {
                self.session.iter_mut().for_each(nima_camera::CameraSession::undo);
                self.report = None;
            }
            if asked != ViewRequest::Complete {
                ui.label(small(texts::VIEWS_NOTE));
            }
        });
    }

    pub(super) fn lens_ui(&self, ui: &mut Ui) {
        if self.keeps_lens {
            ui.label(texts::LENS_IS_KEPT);
            return;
        }
        let Some(report) = &self.report else {
            ui.label(texts::CALCULATING);
            return;
        };
        card(ui, texts::LENS_TITLE, texts::LENS_HOVER, |ui| lens_figures(ui, report));
    }

    pub(super) fn touch_ui(&mut self, ui: &mut Ui) {
        let marked = self.next_corner();
        let still = self.tip.still_m().is_some();
        card(ui, texts::TOUCH_TITLE, texts::TOUCH_HOVER, |ui| {
            let asked = match (&self.base, marked) {
                (None, _) => texts::LAY_DOWN.get().to_owned(),
                (Some(_), Some(corner)) => texts::touch(corner),
                (Some(_), None) => texts::ALL_TOUCHED.get().to_owned(),
            };
            ui.label(RichText::new(asked).font(theme::strong(19.0)));
            if self.moved {
                ui.label(texts::MOVED);
            }
            ui.horizontal(|ui| {
                let can = self.base.is_some() && marked.is_some() && still && !self.moved;
                let may = if can { Ok(()) } else { Err(texts::TOUCHED_DISABLED.get()) };
                let [label, meaning] = [texts::TOUCHED, texts::TOUCHED_HOVER].map(Text::get);
                let take = SteadyButton { id: Id::unique("touched"), label, meaning, may, waits_s: PATIENT_S };
                if take.ui(ui, |label, _| Button::new(label).min_size(egui::vec2(150.0, 34.0))) {
                    self.take_touch();
                }
                let remove = ui.add_enabled(!self.touches.is_empty(), Button::new(texts::REMOVE_TOUCH));
                if remove.on_disabled_hover_text(text::wizards::NOTHING_RECORDED).clicked() {
                    self.touches.pop();
                    self.find_place();
                }
                if ui.button(texts::LAY_ANEW).on_hover_text(texts::LAY_ANEW_HOVER).clicked() {
                    self.lay_anew();
                }
            });
            let tip = if still { texts::TIP_STILL.get() } else { texts::TIP_MOVES.get() };
            ui.label(small(texts::touched(self.touches.len(), tip)));
            ui.add_space(4.0);
            ui.horizontal_top(|ui| {
                self.live_ui(ui, marked);
                ui.vertical(|ui| self.place_figures(ui));
            });
        });
    }

    fn place_figures(&self, ui: &mut Ui) {
        ui.set_max_width(MAP_WIDTH);
        match &self.placed {
            None => {
                ui.label(small(texts::PLACE_OPTIONAL));
            }
            Some(Err(error)) => {
                ui.label(report_text::place_error(*error));
            }
            Some(Ok(placed)) => {
                let reason = placed.lack.as_ref().map_or_else(
                    || texts::PLACE_GOOD.get().to_owned(),
                    |lack: &PlaceLack| report_text::place_lack(lack),
                );
                verdict_line(ui, placed.verdict(), &reason);
                figure(ui, texts::HELD_OUT, format!("{:.1} px", placed.held_out_px), texts::PLACE_HELD_OUT_HOVER);
                figure(
                    ui,
                    texts::HELD_OUT_MAX,
                    format!("{:.1} px", placed.held_out_max_px),
                    texts::PLACE_HELD_OUT_HOVER,
                );
                figure(ui, texts::RIGID, format!("{:.2} mm", placed.fitted_m * 1e3), texts::RIGID_HOVER);
            }
        }
    }

    /// Draws the image with the detected corners.
    pub(super) fn live_ui(&self, ui: &mut Ui, marked: Option<usize>) {
        let width = (ui.available_width() - MAP_WIDTH - 16.0).clamp(160.0, IMAGE);
        // While the board is at rest, its corners keep their positions, whatever hides them.
        let sight = if marked.is_some() { self.base.as_ref() } else { self.sight.as_ref() };
        let board = self.board().ok();
        let words = texts::image(&self.report());
        image_ui(ui, width, &self.shown, sight.zip(board.as_ref()), marked, &words);
    }
}

fn lens_figures(ui: &mut Ui, report: &LensReport) {
    let reason = report.cause.as_ref().map_or_else(|| texts::LENS_GOOD.get().to_owned(), report_text::camera_cause);
    verdict_line(ui, report.verdict(), &reason);
    ui.add_space(4.0);
    figure(ui, texts::VIEWS_USED, report.used.len().to_string(), texts::VIEWS_USED_HOVER);
    for (at, why) in &report.left_out {
        ui.label(small(texts::left_out(at + 1, report_text::left_out(*why))));
    }
    figure(ui, texts::COVERAGE, format!("{:.0} %", 100.0 * report.coverage.fraction()), texts::COVERAGE_HOVER);
    let Some(found) = &report.lens else { return };
    let lens = &found.lens;
    let sd = &found.deviations;
    let with = |value: f64, sd: f64| texts::with_deviation(value, sd);
    figure(ui, texts::HELD_OUT, format!("{:.3} px", found.held_out_px), texts::HELD_OUT_HOVER);
    figure(ui, texts::HELD_OUT_MAX, format!("{:.2} px", found.held_out_max_px), texts::HELD_OUT_HOVER);
    figure(ui, texts::FITTED, format!("{:.3} px", found.fitted_px), texts::FITTED_HOVER);
    figure(ui, texts::TILT, format!("{:.0} deg", found.tilt_deg), texts::TILT_HOVER);
    figure(ui, texts::FOCAL, with(lens.focal_px.x, sd.focal_px.x), texts::FOCAL_HOVER);
    if found.terms.aspect {
        figure(ui, texts::FOCAL_DOWN, with(lens.focal_px.y, sd.focal_px.y), texts::FOCAL_HOVER);
    }
    let centre = format!("{}, {}", with(lens.centre_px.x, sd.centre_px.x), with(lens.centre_px.y, sd.centre_px.y));
    figure(ui, texts::CENTRE, centre, texts::CENTRE_HOVER);
    figure(ui, texts::BEND, texts::bend(&lens.bend, &sd.bend), texts::BEND_HOVER);
}

/// Returns whether a lens can be used.
pub(super) fn is_good(report: &LensReport) -> bool {
    report.verdict() == Verdict::Accepted
}
