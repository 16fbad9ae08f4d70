//! The page of the ready check: the current instruction, the list, and the buttons for its result.

use egui::{Label, RichText, TextEdit, Ui, vec2};
use nima_machine::{
    ready::{Ask, Entry, State},
    rig::Roster,
};

use super::Run;
use crate::{
    console::{
        text, theme,
        widgets::{Sign, card, next_button, sign_ui, small},
    },
    words::{ask_words, cause_words, check_name, figure_words, lacks_words},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wish {
    /// Repeat the failed points.
    Again,
    /// Repeat the whole list.
    Whole,
    Close,
}

/// Draws the page; `saved` is the text about the record.
pub(crate) fn ready_ui(
    ui: &mut Ui,
    run: Option<&Run>,
    by: &mut String,
    saved: Option<&str>,
    roster: &Roster,
) -> Option<Wish> {
    ui.label(RichText::new(text::ready::TITLE.get()).font(theme::strong(22.0)));
    ui.label(small(text::ready::MEANING.get()));
    ui.add_space(theme::GAP);
    ui.horizontal(|ui| {
        let label = ui.label(text::ready::BY.get()).on_hover_text(text::ready::BY_HOVER.get());
        ui.add(TextEdit::singleline(by).desired_width(280.0).char_limit(120)).labelled_by(label.id);
    });
    ui.add_space(theme::GAP);
    let Some(run) = run else {
        ui.label(text::ready::WAITS.get());
        return None;
    };
    let session = &run.session;
    let mut wish = None;
    card(ui, text::ready::NOW.get(), text::ready::MEANING.get(), |ui| {
        if session.is_finished() {
            wish = end_ui(ui, run, saved);
        } else {
            let words = ask_words(&session.ask());
            let words = if session.ask() == Ask::Nothing { text::ready::BY_ITSELF.get().to_owned() } else { words };
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

fn end_ui(ui: &mut Ui, run: &Run, saved: Option<&str>) -> Option<Wish> {
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
        let mut offer = |name: &str, meaning: &str, wanted: Wish| {
            let button = next_button(name, wanted != Wish::Whole).min_size(vec2(200.0, 34.0));
            if ui.add(button).on_hover_text(meaning).clicked() {
                wish = Some(wanted);
            }
        };
        if passed {
            offer(text::ready::CLOSE.get(), text::ready::CLOSE_HOVER.get(), Wish::Close);
        } else {
            offer(text::ready::AGAIN.get(), text::ready::AGAIN_HOVER.get(), Wish::Again);
        }
        offer(text::ready::WHOLE.get(), text::ready::WHOLE_HOVER.get(), Wish::Whole);
    });
    wish
}

fn entry_ui(ui: &mut Ui, entry: &Entry, roster: &Roster) {
    let (what, colour) = match entry.state {
        State::Asking(_) => (Sign::Ring, theme::now().engaged),
        State::Passed(_) => (Sign::Disc, theme::now().engaged),
        State::Failed(_) => (Sign::Triangle, theme::now().alarm_medium),
        State::Waiting | State::LeftOut(_) => (Sign::Ring, theme::now().text_weak),
    };
    let name = check_name(entry.check);
    ui.horizontal_wrapped(|ui| {
        sign_ui(ui, what, 6.0, colour);
        match &entry.state {
            State::Waiting => drop(ui.label(RichText::new(name).color(theme::now().text_weak))),
            State::Asking(_) => drop(ui.label(RichText::new(name).font(theme::strong(14.0)))),
            State::Passed(figure) => drop(ui.label(text::ready::line(&name, &figure_words(figure)))),
            State::Failed(cause) => {
                let [cause, cure] = cause_words(cause, roster);
                ui.vertical(|ui| {
                    ui.add(Label::new(text::ready::line(&name, &cause)).wrap());
                    ui.add(Label::new(small(cure)).wrap());
                });
            }
            State::LeftOut(lacks) => {
                let words = text::ready::left_out(&name, lacks_words(*lacks));
                ui.label(RichText::new(words).color(theme::now().text_weak));
            }
        }
    });
}
