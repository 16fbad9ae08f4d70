//! The result of the gravity wizard: verdict, figures, and the errors of the models.

use egui::{Grid, RichText, Ui, vec2};
use nima_core::calibration::gravity::{GravityReport, ModelFit};
use nima_screen::{
    theme,
    widgets::{card, figure, small},
};
use nima_words::{report_text::three_digits, text};

use crate::report::{verdict_card, verdict_line};

pub(super) fn report_figures(ui: &mut Ui, report: &GravityReport) {
    verdict_line(ui, report.verdict, &report.reason);
    figure(ui, text::gravity::COVERAGE, format!("{:.2}", report.coverage), text::gravity::COVERAGE_HOVER);
    if let Some(mass_kg) = report.mass_kg {
        figure(ui, text::gravity::MASS, format!("{mass_kg:.3} kg"), text::gravity::MASS_HOVER);
    }
}

pub(super) fn verdict_ui(ui: &mut Ui, report: &GravityReport) {
    verdict_card(ui, report.verdict, text::gravity::VERDICT_HOVER.get(), |ui| {
        ui.label(&report.reason);
        ui.add_space(4.0);
        figure(ui, text::gravity::STEP_POSES, report.poses.to_string(), text::gravity::POSES_USED_HOVER);
        figure(ui, text::gravity::COVERAGE, format!("{:.2}", report.coverage), text::gravity::COVERAGE_HOVER);
        let condition = report.condition.map_or(text::gravity::UNDETERMINED.get().to_owned(), three_digits);
        figure(ui, text::gravity::CONDITION, condition, text::gravity::CONDITION_HOVER);
        if let (Some(mass_kg), Some(com_m)) = (report.mass_kg, report.com_m) {
            figure(ui, text::gravity::MASS, format!("{mass_kg:.3} kg"), text::gravity::MASS_HOVER);
            let [x, y, z] = com_m.map(|m| m * 1e3);
            figure(
                ui,
                text::gravity::CENTRE_OF_MASS,
                format!("{x:.1}, {y:.1}, {z:.1} mm"),
                text::gravity::CENTRE_OF_MASS_HOVER,
            );
        }
        if !report.outliers.is_empty() {
            let list = report.outliers.iter().map(|i| (i + 1).to_string()).collect::<Vec<_>>().join(", ");
            figure(ui, text::gravity::LEFT_OUT, text::gravity::left_out(&list), text::gravity::LEFT_OUT_HOVER);
        }
    });
}

/// Draws the table of the models' errors on the poses of the fit and on held-out ones.
pub(super) fn models_ui(ui: &mut Ui, report: &GravityReport) {
    card(ui, text::gravity::MODELS_TITLE, text::gravity::MODELS_HOVER, |ui| {
        Grid::new("gravity_models").num_columns(5).spacing(vec2(22.0, 6.0)).show(ui, |ui| {
            for head in [
                text::gravity::MODEL.get(),
                text::gravity::FITTED_MEAN.get(),
                text::gravity::LARGEST.get(),
                text::gravity::HELD_OUT_MEAN.get(),
                text::gravity::LARGEST.get(),
            ] {
                ui.label(small(head));
            }
            ui.end_row();
            for fit in &report.fits {
                model_row(ui, fit, report.chosen == Some(fit.kind));
            }
        });
    });
}

fn model_row(ui: &mut Ui, fit: &ModelFit, chosen: bool) {
    let name = nima_words::report_text::sentence(fit.kind.name());
    ui.label(if chosen {
        RichText::new(text::gravity::chosen(&name)).font(theme::strong(14.0))
    } else {
        RichText::new(name)
    });
    for stats in [&fit.force_n.fitted, &fit.force_n.held_out] {
        ui.label(format!("{:.3}", stats.mean_mae()));
        ui.label(format!("{:.3}", stats.largest()));
    }
    ui.end_row();
}
