//! Display of a session's report, or of the reason for a missing one.

use egui::{Label, Response, RichText, Sense, Ui, vec2};
use nima_core::calibration::Verdict;
use nima_screen::{
    theme,
    widgets::{Sign, card, sign},
};
use nima_words::{report_text::ShortText as _, text};

/// Result of a session, or the reason for a missing one; `None` with too few data.
pub(super) type WizardReport<R> = Option<Result<R, String>>;

/// Returns the text of a verdict and its reason.
pub(super) fn verdict_text(verdict: Verdict, reason: &str) -> String {
    format!("{}: {reason}", verdict.words())
}

/// Draws the same text as a line of a card.
pub fn verdict_line(ui: &mut Ui, verdict: Verdict, reason: &str) {
    judged_line(ui, verdict == Verdict::Accepted, &verdict_text(verdict, reason));
}

/// Draws a result with a sign and a colour that say whether it is good.
pub(super) fn judged_line(ui: &mut Ui, good: bool, words: &str) -> Response {
    let (what, colour) =
        if good { (Sign::Disc, theme::now().engaged) } else { (Sign::Triangle, theme::now().alarm_medium) };
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(16.0, 18.0), Sense::hover());
        sign(ui.painter(), what, rect.center(), 5.5, colour);
        ui.add(Label::new(RichText::new(words).font(theme::strong(15.0)).color(colour)).wrap())
    })
    .inner
}

/// Draws a card whose heading is the verdict, with a sign and a colour; `meaning` is its hover text.
pub(super) fn verdict_card(ui: &mut Ui, verdict: Verdict, meaning: &str, content: impl FnOnce(&mut Ui)) {
    theme::card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        judged_line(ui, verdict == Verdict::Accepted, verdict.words()).on_hover_text(meaning);
        ui.add_space(2.0);
        content(ui);
    });
    ui.add_space(theme::GAP);
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
            card(ui, text::wizards::NO_RESULT, no_result_hover, |ui| ui.label(error));
        }
        None => {
            ui.label(too_few);
        }
    }
}
