//! Display of a session's report, or of the reason for a missing one.

use egui::{RichText, Ui};
use nima_core::calibration::Verdict;

use crate::{
    console::{text, theme, widgets::card},
    report_text::ShortText as _,
};

/// Result of a session, or the reason for a missing one; `None` with too few data.
pub(super) type WizardReport<R> = Option<Result<R, String>>;

/// Returns the text of a verdict and its reason.
pub(super) fn verdict_text(verdict: Verdict, reason: &str) -> String {
    format!("{}: {reason}", verdict.words())
}

/// Draws the same text as a line of a card.
pub(crate) fn verdict_line(ui: &mut Ui, verdict: Verdict, reason: &str) {
    ui.label(RichText::new(verdict_text(verdict, reason)).font(theme::strong(14.0)));
}

/// Draws the step that shows the result: the report, the error, or that there are too few data.
pub(super) fn result_ui<R>(
    ui: &mut Ui,
    report: Option<&Result<R, String>>,
    [no_result_hover, too_few]: [&str; 2],
    show: impl FnOnce(&mut Ui, &R),
) {
    match report {
        Some(Ok(report)) => show(ui, report),
        Some(Err(error)) => {
            card(ui, text::wizards::NO_RESULT.get(), no_result_hover, |ui| ui.label(error));
        }
        None => {
            ui.label(too_few);
        }
    }
}
