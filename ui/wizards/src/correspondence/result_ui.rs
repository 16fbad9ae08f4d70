//! The result of the correspondence wizard: verdict, figures, and the agreement of the two sensors.

use egui::{Grid, Ui, vec2};
use nima_core::calibration::correspondence::{CorrespondenceReport, OffsetFrame, PushAgreement};
use nima_screen::widgets::{card, figure, small};
use nima_words::{report_text::three_digits, text};

use crate::report::verdict_card;

pub(super) fn verdict_ui(ui: &mut Ui, report: &CorrespondenceReport) {
    verdict_card(ui, report.verdict, text::correspondence::VERDICT_HOVER.get(), |ui| {
        ui.label(&report.reason);
        ui.add_space(4.0);
        let left_out = report.outliers.len();
        let weak = report.weak.len();
        let pushes = text::correspondence::used(report.pairs, left_out, weak);
        figure(ui, text::correspondence::STEP_PUSHES, pushes, text::correspondence::PUSHES_HOVER);
        let spread = format!("{:.2}, {:.2}", report.excitation.second, report.excitation.third);
        figure(ui, text::correspondence::SPREAD, spread, text::correspondence::SPREAD_HOVER);
        let Some(solution) = &report.solution else { return };
        let [roll, pitch, yaw] = solution.roll_pitch_yaw_deg;
        let name = text::correspondence::rotation(solution.target.name());
        figure(ui, &name, format!("{roll:.2}, {pitch:.2}, {yaw:.2} deg"), text::correspondence::ROTATION_HOVER);
        figure(
            ui,
            text::correspondence::UNCERTAINTY,
            format!("{:.2} deg", solution.uncertainty_deg),
            text::correspondence::UNCERTAINTY_HOVER,
        );
        let check = format!("{:.3} deg", solution.cross_check_deg);
        figure(ui, text::correspondence::CROSS_CHECK, check, text::correspondence::CROSS_CHECK_HOVER);
        if let Some(diagnosis) = &solution.diagnosis {
            let gain = format!("{:.3} ± {:.3}", diagnosis.gain, diagnosis.gain_se);
            figure(ui, text::correspondence::GAIN, gain, text::correspondence::GAIN_HOVER);
            let offset = format!("{:.3} ± {:.3} N", diagnosis.offset_norm_n(), diagnosis.offset_se_n);
            figure(
                ui,
                text::correspondence::OFFSET,
                format!("{offset} ({})", frame_text(diagnosis.offset_frame)),
                text::correspondence::OFFSET_HOVER,
            );
        }
    });
}

fn frame_text(frame: OffsetFrame) -> &'static str {
    match frame {
        OffsetFrame::S1 => text::correspondence::OFFSET_OF_WRIST.get(),
        OffsetFrame::S2 => text::correspondence::OFFSET_OF_TISSUE.get(),
        OffsetFrame::Unknown => text::correspondence::OFFSET_OF_EITHER.get(),
    }
}

/// Draws the paper's Validation I: agreement of the rotated force under the tissue with that at the wrist.
pub(super) fn agreement_ui(ui: &mut Ui, agreement: &PushAgreement) {
    let meaning = text::correspondence::AGREEMENT_HOVER.get();
    card(ui, text::correspondence::AGREEMENT_TITLE, meaning, |ui| {
        Grid::new("agreement").num_columns(7).spacing(vec2(22.0, 6.0)).show(ui, |ui| {
            for head in [
                text::correspondence::AXIS.get(),
                text::correspondence::FITTED_MAE.get(),
                "SD",
                "R2",
                text::correspondence::HELD_OUT_MAE.get(),
                "SD",
                "R2",
            ] {
                ui.label(small(head));
            }
            ui.end_row();
            let sides = [
                (&agreement.residuals.fitted, &agreement.r2_fitted),
                (&agreement.residuals.held_out, &agreement.r2_held_out),
            ];
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                ui.label(name);
                for (stats, r2) in sides {
                    for value in [stats.mae[axis], stats.sd[axis], r2[axis]] {
                        ui.label(three_digits(value));
                    }
                }
                ui.end_row();
            }
        });
        let fitted = agreement.r2_fitted_overall;
        let held_out = agreement.r2_held_out_overall;
        figure(
            ui,
            text::correspondence::R2_OVERALL,
            text::correspondence::agreement(fitted, held_out),
            text::correspondence::R2_OVERALL_HOVER,
        );
    });
}
