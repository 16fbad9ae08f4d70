//! Checks that must pass before a wizard starts, and switches that describe the rig.

use egui::{Checkbox, Ui};
use nima_core::calibration::gravity::{CheckState, PrecheckResult};
use nima_screen::{
    theme,
    widgets::{Sign, sign_ui},
};
use nima_words::{report_text::sentence, text};

/// Draws one check with its measured value, or with cause and remedy.
pub(super) fn check_ui(ui: &mut Ui, check: &PrecheckResult) {
    let (what, colour, words) = match &check.state {
        CheckState::Good if check.measured.is_empty() => {
            (Sign::Disc, theme::now().engaged, text::wizards::FINE.get().to_owned())
        }
        CheckState::Good => (Sign::Disc, theme::now().engaged, text::wizards::met(&check.measured)),
        CheckState::Waiting => (Sign::Ring, theme::now().at_rest, text::wizards::WAITING.get().to_owned()),
        CheckState::Bad { cause, cure } => (Sign::Triangle, theme::now().text, format!("{cause}; {cure}")),
    };
    line_ui(ui, what, colour, &format!("{}: {words}", sentence(check.name)));
}

/// Draws a passed check, or the instruction.
pub fn check_line(ui: &mut Ui, name: &str, met: bool, otherwise: &str) {
    let (what, colour, words) = if met {
        (Sign::Disc, theme::now().engaged, text::wizards::FINE.get())
    } else {
        (Sign::Triangle, theme::now().text, otherwise)
    };
    line_ui(ui, what, colour, &format!("{name}: {words}"));
}

/// Draws a check that waits for an earlier one.
pub(super) fn waiting_line(ui: &mut Ui, name: &str) {
    line_ui(ui, Sign::Ring, theme::now().at_rest, &format!("{name}: {}", text::wizards::WAITING.get()));
}

fn line_ui(ui: &mut Ui, what: Sign, colour: egui::Color32, words: &str) {
    ui.horizontal_wrapped(|ui| {
        sign_ui(ui, what, 6.0, colour);
        ui.label(words);
    });
}

/// Draws a switch that describes the rig; returns its new state when pressed.
pub fn switch_ui(ui: &mut Ui, free: bool, on: bool, name: &str, meaning: &str) -> Option<bool> {
    let mut wanted = on;
    let switch = ui.add_enabled(free, Checkbox::new(&mut wanted, name));
    let switch = switch.on_hover_text(meaning).on_disabled_hover_text(text::wizards::SWITCH_DISABLED_HOVER);
    switch.changed().then_some(wanted)
}
