//! The step that shows a result: verdict with reason and remedy, errors, and changes to the rig file.

use egui::{Grid, Ui, vec2};
use nalgebra::UnitQuaternion;
use nima_core::calibration::frames::SignedAxes;
use nima_screen::widgets::{card, figure, small};
use nima_words::{
    report_text::{self, sentence},
    text::frames as texts,
};

use nima_calibrations::frames::{
    FrameSubject,
    job::{Outcome, Quality},
    numbers::{self, FrameNumber, NumberUnit},
    sizes_text,
};

use super::effect::effect_image;
use crate::report::verdict_card;

/// Draws the result; `units` is the name of the recorded items.
pub(super) fn outcome_ui(
    ui: &mut Ui,
    outcome: &Outcome,
    subject: &FrameSubject,
    seen_view: Option<UnitQuaternion<f64>>,
    units: &str,
) {
    let quality = outcome.quality();
    verdict_card(ui, quality.verdict, texts::VERDICT_HOVER.get(), |ui| {
        ui.label(sentence(&report_text::cause(&quality.cause)));
        ui.add_space(4.0);
        figures_ui(ui, &quality, outcome.outliers(), units);
        if let Outcome::Mount(report) = outcome
            && let Some(found) = &report.found
        {
            ui.label(texts::mount_found(found.from_active_deg, found.agrees()));
            if let Some(axes) = found.axes.filter(|axes| *axes != SignedAxes::SAME) {
                ui.label(texts::mount_axes(&report_text::axes_text(axes)));
            }
            figure(ui, texts::TOOL_MASS, format!("{:.3} kg", found.mass_kg), texts::TOOL_MASS_HOVER);
        }
    });
    let Some((numbers, effect)) = numbers::of(outcome, subject, seen_view) else { return };
    card(ui, texts::CHANGE_TITLE, texts::CHANGE_HOVER, |ui| {
        effect_image(ui, &effect);
        ui.add_space(6.0);
        if numbers.is_empty() {
            ui.label(texts::NO_CHANGE);
        } else {
            numbers_ui(ui, &numbers);
        }
        let were_given = !numbers.is_empty() && numbers.iter().all(|number| number.before.is_some());
        if were_given && effect.is_within(quality.uncertainty) {
            ui.add_space(4.0);
            ui.label(texts::WITHIN_UNCERTAINTY);
        }
    });
}

fn figures_ui(ui: &mut Ui, quality: &Quality, outliers: &[usize], units: &str) {
    figure(ui, sentence(units), quality.poses.to_string(), texts::RECORDED_HOVER);
    if !outliers.is_empty() {
        let list = outliers.iter().map(|i| (i + 1).to_string()).collect::<Vec<_>>().join(", ");
        figure(ui, texts::LEFT_OUT, list, texts::LEFT_OUT_HOVER);
    }
    let rows = [
        (texts::HELD_OUT.get(), quality.held_out, texts::HELD_OUT_HOVER.get()),
        (texts::HELD_OUT_MAX.get(), quality.held_out_max, texts::HELD_OUT_MAX_HOVER.get()),
        (texts::FITTED.get(), quality.fitted, texts::FITTED_HOVER.get()),
        (texts::UNCERTAINTY.get(), quality.uncertainty, texts::UNCERTAINTY_HOVER.get()),
    ];
    for (name, sizes, meaning) in rows {
        if let Some(words) = sizes_text(sizes) {
            figure(ui, name, words, meaning);
        }
    }
}

fn numbers_ui(ui: &mut Ui, numbers: &[FrameNumber]) {
    Grid::new("rig_numbers").num_columns(4).spacing(vec2(22.0, 6.0)).show(ui, |ui| {
        for head in [texts::KEY.get(), texts::BEFORE.get(), texts::AFTER.get(), texts::CHANGE.get()] {
            ui.label(small(head));
        }
        ui.end_row();
        for number in numbers {
            ui.label(&number.key);
            ui.label(
                number.before.as_ref().map_or(texts::NOT_GIVEN.get().to_owned(), |before| shown(before, number.unit)),
            );
            ui.label(shown(&number.after, number.unit));
            ui.label(number.before.as_ref().map_or(String::new(), |before| changed(before, number)));
            ui.end_row();
        }
    });
}

fn shown(values: &[f64], unit: NumberUnit) -> String {
    let (scale, digits, name) = of_unit(unit);
    let numbers: Vec<_> = values.iter().map(|x| format!("{:.digits$}", rounded(x * scale, digits))).collect();
    format!("{}{name}", numbers.join(", "))
}

fn changed(before: &[f64], number: &FrameNumber) -> String {
    let (scale, digits, name) = of_unit(number.unit);
    let by = before.iter().zip(&number.after).map(|(a, b)| rounded((b - a) * scale, digits));
    let by: Vec<_> = by.map(|x| format!("{x:+.digits$}")).collect();
    format!("{}{name}", by.join(", "))
}

/// Rounds to this many digits and avoids `-0`.
fn rounded(x: f64, digits: usize) -> f64 {
    let scale = (0..digits).fold(1.0, |scale, _| scale * 10.0);
    (x * scale).round() / scale + 0.0
}

/// Returns scale, digits and name of a unit on the screen.
const fn of_unit(unit: NumberUnit) -> (f64, usize, &'static str) {
    match unit {
        NumberUnit::Metres => (1e3, 2, " mm"),
        NumberUnit::Degrees => (1.0, 2, " deg"),
        NumberUnit::One => (1.0, 3, ""),
    }
}
