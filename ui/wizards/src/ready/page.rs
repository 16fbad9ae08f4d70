//! The page of the ready check: the current instruction, the list, and the buttons for its result.

use egui::{Label, RichText, TextEdit, Ui, vec2};
use nima_machine::{
    ready::{PersonRequest, ReadyEntry, ReadyState},
    rig::Roster,
};
use nima_screen::{
    theme,
    widgets::{Sign, card, next_button, sign_ui, small},
};
use nima_words::{
    report_text::{ask_text, cause_text, check_name, figure_text, lacks_text},
    text,
};

use super::ReadyRun;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadyRequest {
    /// Repeat the failed checks.
    Again,
    /// Repeat the whole list.
    Whole,
    Close,
}

/// Draws the page; `saved` is the text about the record.
pub fn ready_ui(
    ui: &mut Ui,
    run: Option<&ReadyRun>,
    by: &mut String,
    saved: Option<&str>,
    roster: &Roster,
) -> Option<ReadyRequest> {
    ui.label(RichText::new(text::ready::TITLE).font(theme::strong(22.0)));
    ui.label(small(text::ready::MEANING));
    ui.add_space(theme::GAP);
    ui.horizontal(|ui| {
        let label = ui.label(text::ready::BY).on_hover_text(text::ready::BY_HOVER);
        ui.add(TextEdit::singleline(by).desired_width(280.0).char_limit(120)).labelled_by(label.id);
    });
    ui.add_space(theme::GAP);
    let Some(run) = run else {
        ui.label(text::ready::WAITS);
        return None;
    };
    let session = &run.session;
    let mut wish = None;
    card(ui, text::ready::NOW, text::ready::MEANING, |ui| {
        if session.is_finished() {
            wish = end_ui(ui, run, saved);
        } else {
            let words = ask_text(&session.ask());
            let words =
                if session.ask() == PersonRequest::Nothing { text::ready::BY_ITSELF.get().to_owned() } else { words };
            ui.add(Label::new(RichText::new(words).font(theme::strong(18.0))).wrap());
            ui.label(small(text::ready::took(session.took_s())));
        }
    });
    ui.add_space(theme::GAP);
    for entry in session.list() {
        entry_ui(ui, entry, roster);
    }
    wish
}

fn end_ui(ui: &mut Ui, run: &ReadyRun, saved: Option<&str>) -> Option<ReadyRequest> {
    let passed = run.session.has_passed();
    let words = if passed { text::ready::PASSED.get() } else { text::ready::FAILED.get() };
    ui.horizontal(|ui| {
        let (what, colour) =
            if passed { (Sign::Disc, theme::now().engaged) } else { (Sign::Triangle, theme::now().alarm_medium) };
        sign_ui(ui, what, 7.0, colour);
        ui.label(RichText::new(words).font(theme::strong(18.0)));
    });
    ui.label(small(text::ready::took(run.session.took_s())));
    if let Some(saved) = saved {
        ui.add(Label::new(small(saved)).wrap());
    }
    let mut wish = None;
    ui.horizontal(|ui| {
        let mut offer = |name: &str, meaning: &str, wanted: ReadyRequest| {
            let button = next_button(name, wanted != ReadyRequest::Whole).min_size(vec2(200.0, 34.0));
            if ui.add(button).on_hover_text(meaning).clicked() {
                wish = Some(wanted);
            }
        };
        if passed {
            offer(text::ready::CLOSE.get(), text::ready::CLOSE_HOVER.get(), ReadyRequest::Close);
        } else {
            offer(text::ready::AGAIN.get(), text::ready::AGAIN_HOVER.get(), ReadyRequest::Again);
        }
        offer(text::ready::WHOLE.get(), text::ready::WHOLE_HOVER.get(), ReadyRequest::Whole);
    });
    wish
}

fn entry_ui(ui: &mut Ui, entry: &ReadyEntry, roster: &Roster) {
    let (what, colour) = match entry.state {
        ReadyState::Asking(_) => (Sign::Ring, theme::now().engaged),
        ReadyState::Passed(_) => (Sign::Disc, theme::now().engaged),
        ReadyState::Failed(_) => (Sign::Triangle, theme::now().alarm_medium),
        ReadyState::Waiting | ReadyState::LeftOut(_) => (Sign::Ring, theme::now().text_weak),
    };
    let name = check_name(entry.check);
    ui.horizontal_wrapped(|ui| {
        sign_ui(ui, what, 6.0, colour);
        match &entry.state {
            ReadyState::Waiting => drop(ui.label(RichText::new(name).color(theme::now().text_weak))),
            ReadyState::Asking(_) => drop(ui.label(RichText::new(name).font(theme::strong(14.0)))),
            ReadyState::Passed(figure) => drop(ui.label(text::ready::line(&name, &figure_text(figure)))),
            ReadyState::Failed(cause) => {
                let [cause, cure] = cause_text(cause, roster);
                ui.vertical(|ui| {
                    ui.add(Label::new(text::ready::line(&name, &cause)).wrap());
                    ui.add(Label::new(small(cure)).wrap());
                });
            }
            ReadyState::LeftOut(lacks) => {
                let words = text::ready::left_out(&name, lacks_text(*lacks));
                ui.label(RichText::new(words).color(theme::now().text_weak));
            }
        }
    });
}
