//! The page of all calibrations.

use egui::{Button, Grid, Id, Label, RichText, Ui, WidgetInfo, vec2};

use nima_machine::rig::Side;

use super::{ArmOverview, OverviewLine, following, made_text, verdict_text};
use crate::console::{
    scene3d::side_name,
    steady_button::{PATIENT_S, SteadyButton},
    text, theme,
    widgets::{Sign, next_button, sign_ui, small},
    wizards::{CalibrationTarget, GoOn},
};
use crate::report_text::within;

/// Widths of the text columns.
const WIDTHS: [f32; 3] = [150.0, 260.0, 260.0];

/// Draws the page; returns the calibration to start. `closed`: the reason why none of this arm can be started.
pub(crate) fn overview_ui(
    ui: &mut Ui,
    arms: &[ArmOverview],
    closed: &dyn Fn(Side) -> Option<&'static str>,
) -> Option<CalibrationTarget> {
    ui.label(RichText::new(text::overview::TITLE.get()).font(theme::strong(22.0)));
    ui.label(small(text::overview::MEANING.get()));
    ui.add_space(theme::GAP);
    if arms.is_empty() {
        ui.label(text::calibrations::NOT_NEEDED.get());
    }
    let mut wish = following_ui(ui, arms, closed);
    for arm in arms {
        let name = side_name(arm.side);
        let head = arm.wrist.as_ref().map_or_else(
            || text::overview::of_unknown(name, text::calibrations::SENSOR_NOT_CONNECTED.get()),
            |wrist| text::overview::of_arm(name, &wrist.serial_number, &wrist.tool),
        );
        ui.label(RichText::new(head).font(theme::strong(15.0)));
        if arm.lines.is_empty() {
            continue;
        }
        Grid::new(("overview", name)).num_columns(6).spacing(vec2(14.0, 6.0)).show(ui, |ui| {
            ui.label("");
            let [calibration, made, verdict, since] = [
                text::overview::CALIBRATION.get(),
                text::overview::MADE.get(),
                text::overview::VERDICT.get(),
                text::overview::SINCE.get(),
            ];
            for words in [calibration, made, verdict, since] {
                ui.label(small(words));
            }
            ui.end_row();
            for line in &arm.lines {
                if line_ui(ui, line, name, closed(arm.side)) {
                    wish = Some(line.wanted);
                }
                ui.end_row();
            }
        });
        ui.add_space(theme::GAP);
    }
    wish
}

/// Draws the button that opens the next calibration.
fn following_ui(
    ui: &mut Ui,
    arms: &[ArmOverview],
    closed: &dyn Fn(Side) -> Option<&'static str>,
) -> Option<CalibrationTarget> {
    let wanted = following(arms, None)?;
    let closed = closed(wanted.side);
    let label = GoOn::Calibrate(wanted).words();
    let may = closed.map_or(Ok(()), Err);
    let button = SteadyButton { id: Id::unique("following"), label: &label, meaning: "", may, waits_s: PATIENT_S };
    let wants = button.ui(ui, |name, enabled| {
        next_button(RichText::new(name).font(theme::strong(15.0)), enabled).min_size(vec2(300.0, 34.0))
    });
    ui.label(small(closed.unwrap_or(text::calibrations::SETS_IDLE.get())));
    ui.add_space(theme::GAP);
    wants.then_some(wanted)
}

/// Draws one line; returns whether to recalibrate.
fn line_ui(ui: &mut Ui, line: &OverviewLine, arm: &str, closed: Option<&str>) -> bool {
    let (what, colour) = if line.is_in_order() {
        (Sign::Disc, theme::now().engaged)
    } else {
        (Sign::Triangle, theme::now().alarm_medium)
    };
    sign_ui(ui, what, 5.0, colour);
    ui.label(line.wanted.name());
    let words = match &line.kept {
        Ok(Some(kept)) => [made_text(kept), verdict_text(kept), line.since.clone()],
        Ok(None) => [text::overview::NEVER.get().to_owned(), String::new(), String::new()],
        Err(why) => [String::new(), why.clone(), String::new()],
    };
    for (words, width) in words.into_iter().zip(WIDTHS) {
        ui.scope(|ui| {
            ui.set_max_width(width);
            ui.add(Label::new(words).wrap());
        });
    }
    let verb = if line.kept == Ok(None) { text::overview::MAKE.get() } else { text::overview::REDO.get() };
    let name = text::overview::button(verb, arm, &within(line.wanted.name()));
    let may = closed.map_or(Ok(()), Err);
    let id = Id::unique(("calibrate", &name));
    let button = SteadyButton { id, label: verb, meaning: "", may, waits_s: PATIENT_S };
    let (button, wants) = button.show(ui, |verb, _| Button::new(verb).min_size(vec2(84.0, 24.0)));
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, button.enabled(), name.clone()));
    wants
}
