//! Help for new users: a tour of four steps, and a glossary. Both stay below the top bar so that the stop button is
//! never covered, and the loop continues while they are open.

use egui::{Align, Align2, Button, Color32, Context, Label, Rect, RichText, ScrollArea, Ui, Window, vec2};
use nima_screen::theme;
use nima_words::text::{
    commands::{BY_HAND, key_meaning},
    help::{
        BEGIN, FIRST_STEP, GLOSSARY, GLOSSARY_WINDOW, KEYS_HEADING, NEXT_STEP, SKIP_THE_TOUR, STEP_BACK, TOUR,
        TOUR_WINDOW, WORDS_HEADING, step_of,
    },
};

use crate::console::commands::table;

/// Open help windows.
#[derive(Clone, Copy, Debug, Default)]
pub struct Help {
    /// The current step of the tour.
    tour: Option<usize>,
    pub glossary: bool,
}

impl Help {
    pub const fn begin_tour(&mut self) {
        self.tour = Some(0);
    }

    pub(super) const fn is_touring(&self) -> bool {
        self.tour.is_some()
    }

    pub(super) const fn end_tour(&mut self) {
        self.tour = None;
    }

    /// Draws the open windows into `room`, the tour only over the views (`on_view`); returns true in the frame in which it ends.
    pub(super) fn ui(&mut self, ctx: &Context, room: Rect, on_view: bool) -> bool {
        self.glossary_ui(ctx, room);
        let Some(step) = self.tour.filter(|_| on_view) else { return false };
        let (heading, words) = TOUR[step];
        let window = Window::new(TOUR_WINDOW.get()).title_bar(false).resizable(false).movable(false).constrain_to(room);
        let window = window.anchor(Align2::CENTER_TOP, vec2(0.0, 12.0)).fixed_size(vec2(440.0, 0.0));
        window.show(ctx, |ui| {
            // A window with shorter lines would be narrower, and its buttons elsewhere.
            ui.set_min_width(ui.available_width());
            ui.label(RichText::new(heading.get()).font(theme::strong(18.0)));
            let font = theme::regular(15.0);
            // Reserve space for the longest text, so that the buttons stay under the pointer.
            let height = |words: &str| {
                ui.painter().layout(words.to_owned(), font.clone(), Color32::WHITE, ui.available_width()).size().y
            };
            let rest = TOUR.iter().map(|(_, words)| height(words.get())).fold(0.0, f32::max) - height(words.get());
            ui.label(RichText::new(words.get()).font(font));
            ui.add_space(rest + 6.0);
            ui.horizontal(|ui| {
                let size = vec2(96.0, 32.0);
                // Digits differ in width.
                ui.add_sized(
                    vec2(48.0, size.y),
                    Label::new(nima_screen::widgets::small(step_of(step + 1, TOUR.len()))),
                );
                let back = ui.add_enabled(step > 0, Button::new(STEP_BACK).min_size(size));
                if back.on_disabled_hover_text(FIRST_STEP).clicked() {
                    self.tour = Some(step - 1);
                }
                let last = step + 1 == TOUR.len();
                let next = nima_screen::widgets::next_button(if last { BEGIN.get() } else { NEXT_STEP.get() }, true);
                if ui.add(next.min_size(size)).clicked() {
                    self.tour = if last { None } else { Some(step + 1) };
                }
                if !last && ui.add(Button::new(SKIP_THE_TOUR).min_size(size)).clicked() {
                    self.tour = None;
                }
            });
        });
        self.tour.is_none()
    }

    fn glossary_ui(&mut self, ctx: &Context, room: Rect) {
        let window = Window::new(GLOSSARY_WINDOW.get()).open(&mut self.glossary).constrain_to(room).collapsible(false);
        let height = (room.height() - 90.0).min(560.0);
        window.default_pos(room.center_top() + vec2(-230.0, 16.0)).fixed_size(vec2(460.0, height)).show(ctx, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                ui.label(RichText::new(KEYS_HEADING).font(theme::strong(16.0)));
                for entry in table().iter().filter(|entry| !entry.keys.is_empty()) {
                    key_ui(ui, &entry.keys_text(), &key_meaning(&entry.title, entry.does));
                }
                for (key, meaning) in BY_HAND {
                    key_ui(ui, key.get(), meaning.get());
                }
                ui.add_space(8.0);
                ui.label(RichText::new(WORDS_HEADING).font(theme::strong(16.0)));
                for (word, meaning) in terms() {
                    ui.label(RichText::new(word).font(theme::strong(14.0)));
                    ui.label(nima_screen::widgets::weak(meaning));
                    ui.add_space(4.0);
                }
            });
        });
    }
}

/// Returns the glossary in the alphabetical order of the language.
fn terms() -> [(&'static str, &'static str); GLOSSARY.len()] {
    let mut terms = GLOSSARY.map(|(word, meaning)| (word.get(), meaning.get()));
    terms.sort_by_key(|(word, _)| word.to_lowercase());
    terms
}

fn key_ui(ui: &mut Ui, key: &str, meaning: &str) {
    ui.horizontal(|ui| {
        let key = Label::new(RichText::new(key).font(theme::strong(14.0))).halign(Align::Min);
        ui.add_sized(vec2(150.0, 18.0), key);
        ui.add(Label::new(nima_screen::widgets::weak(meaning)).wrap());
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use nima_words::language::{self, Language};

    #[test]
    fn the_glossary_is_in_order_and_every_meaning_is_a_sentence() {
        for language in [Language::English, Language::German] {
            let terms = language::with(language, terms);
            assert!(terms.is_sorted_by_key(|(word, _)| word.to_lowercase()));
            assert!(terms.iter().all(|(word, meaning)| meaning.ends_with('.') && meaning.len() > word.len()));
        }
    }
}
