//! Questionnaires for a participant. Missing answers are shown, and submitting requires complete answers.

use egui::{Button, Label, Response, RichText, ScrollArea, Slider, TextEdit, Ui, vec2};
use nima_screen::{
    theme,
    widgets::{next_button, small, weak},
};
use nima_user_study::{
    Label as Letter, PAIRS, Questionnaire, QuestionnaireAnswers, REALISM_ITEM, Ratings, SUS_ITEMS, TLX_SCALES, TlxScale,
};
use nima_words::{language::Text, report_text::sentence};

use crate::extras::user_studies::text;

/// Width of a rating line.
const SLIDER: f32 = 420.0;
const STEP: f64 = 5.0;

/// A questionnaire that is being filled in.
#[derive(Debug)]
pub(super) struct QuestionnairePage {
    pub(super) participant: String,
    pub(super) which: Questionnaire,
    pub(super) after: Option<Letter>,
    ratings: [Option<u8>; 6],
    chosen: [Option<TlxScale>; 15],
    items: [Option<u8>; 10],
    realism: Option<u8>,
    text: String,
}

/// The chosen action.
pub(super) enum QuestionChoice {
    Back,
    Submit(QuestionnaireAnswers),
}

/// Returns all values; `None` if one is missing.
fn all<T: Copy + Default, const N: usize>(given: &[Option<T>; N]) -> Option<[T; N]> {
    given.iter().all(Option::is_some).then(|| given.map(Option::unwrap_or_default))
}

fn name_of(scale: TlxScale) -> String {
    let found = TLX_SCALES.iter().find(|(known, ..)| *known == scale);
    found.map_or_else(String::new, |(_, name, _)| sentence(name))
}

impl QuestionnairePage {
    pub(super) fn new(participant: &str, which: Questionnaire, after: Option<Letter>) -> Self {
        Self {
            participant: participant.to_owned(),
            which,
            after,
            ratings: [None; 6],
            chosen: [None; 15],
            items: [None; 10],
            realism: None,
            text: String::new(),
        }
    }

    pub(super) fn is(&self, participant: &str, which: Questionnaire, after: Option<Letter>) -> bool {
        self.participant == participant && self.which == which && self.after == after
    }

    /// Returns the answers, or the missing items.
    fn answers(&self) -> Result<QuestionnaireAnswers, Vec<String>> {
        let missing = |names: &mut dyn Iterator<Item = String>| names.collect::<Vec<_>>();
        let unrated = || {
            missing(
                &mut TLX_SCALES
                    .iter()
                    .zip(self.ratings)
                    .filter(|(_, r)| r.is_none())
                    .map(|((_, n, _), _)| (*n).to_owned()),
            )
        };
        match self.which {
            Questionnaire::NasaTlx => all(&self.ratings)
                .map(|ratings| QuestionnaireAnswers::NasaTlx(Ratings::of(ratings)))
                .ok_or_else(unrated),
            Questionnaire::NasaTlxWeighted => {
                let mut wrong = unrated();
                let pairs = self.chosen.iter().filter(|one| one.is_none()).count();
                wrong.extend((pairs > 0).then(|| text::questionnaires::missing_pairs(pairs)));
                let chosen = self.chosen.map(|one| one.unwrap_or(TlxScale::Mental));
                match all(&self.ratings) {
                    Some(ratings) if wrong.is_empty() => {
                        Ok(QuestionnaireAnswers::NasaTlxWeighted { ratings: Ratings::of(ratings), chosen })
                    }
                    _ => Err(wrong),
                }
            }
            Questionnaire::Sus => all(&self.items).map(QuestionnaireAnswers::Sus).ok_or_else(|| {
                let open = self.items.iter().zip(1..).filter(|(item, _)| item.is_none());
                missing(&mut open.map(|(_, number)| text::questionnaires::statement(number)))
            }),
            Questionnaire::Realism => {
                self.realism.map(QuestionnaireAnswers::Realism).ok_or_else(|| vec![text::questionnaires::statement(1)])
            }
            Questionnaire::FreeText => Ok(QuestionnaireAnswers::FreeText(self.text.trim().to_owned())),
        }
    }

    pub(super) fn ui(&mut self, ui: &mut Ui) -> Option<QuestionChoice> {
        let mut done = None;
        let title = text::questionnaires::asked(self.which, &self.participant, self.after);
        ui.label(RichText::new(title).font(theme::strong(19.0)));
        ui.add_space(6.0);
        let height = ui.available_height() - 66.0;
        ScrollArea::vertical().id_salt("questions").auto_shrink(false).max_height(height).show(ui, |ui| {
            ui.set_max_width(ui.available_width().min(980.0));
            match self.which {
                Questionnaire::NasaTlx => self.ratings_ui(ui),
                Questionnaire::NasaTlxWeighted => {
                    self.ratings_ui(ui);
                    self.pairs_ui(ui);
                }
                Questionnaire::Sus => self.sus_ui(ui),
                Questionnaire::Realism => scale_ui(ui, REALISM_ITEM, &mut self.realism, 7),
                Questionnaire::FreeText => self.text_ui(ui),
            }
        });
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            let answers = self.answers();
            let name = RichText::new(text::questionnaires::SUBMIT).font(theme::strong(17.0));
            let button = next_button(name, answers.is_ok()).min_size(theme::STOP_SIZE);
            let clicked = ui.add_enabled(answers.is_ok(), button).clicked();
            if ui.add(Button::new(text::studies::BACK).min_size(theme::STOP_SIZE)).clicked() {
                done = Some(QuestionChoice::Back);
            }
            match answers {
                Ok(answers) if clicked => done = Some(QuestionChoice::Submit(answers)),
                Ok(_) => {}
                Err(what) => {
                    ui.add(Label::new(weak(text::questionnaires::missing(&what))).wrap());
                }
            }
        });
        done
    }

    fn ratings_ui(&mut self, ui: &mut Ui) {
        ui.label(small(text::questionnaires::RATE));
        for ((_, name, question), rating) in TLX_SCALES.iter().zip(&mut self.ratings) {
            ui.add_space(4.0);
            let label = ui.add(Label::new(RichText::new(sentence(name)).font(theme::strong(15.0))));
            ui.add(Label::new(*question).wrap());
            ui.horizontal(|ui| {
                ui.spacing_mut().slider_width = SLIDER;
                let mut value = rating.map_or(50.0, f64::from);
                let slider = Slider::new(&mut value, 0.0..=100.0).step_by(STEP).show_value(false);
                // A scale that has not been rated must not look like a rating in the middle.
                let opacity = if rating.is_some() { 1.0 } else { 0.4 };
                let slider = slider.trailing_fill(rating.is_some());
                let response = ui.scope(|ui| {
                    ui.set_opacity(opacity);
                    ui.add(slider)
                });
                let response = response.inner.labelled_by(label.id);
                // Pressing the middle changes nothing, but counts as an answer.
                if let Some(tapped) = tapped(&response) {
                    value = tapped;
                } else if !(response.changed() || response.drag_started()) {
                    value = f64::NAN;
                }
                if value.is_finite() {
                    *rating = Some((STEP * (value / STEP).round()) as u8);
                }
                let shown = rating
                    .map_or_else(|| text::questionnaires::NOT_ANSWERED.get().to_owned(), |rating| rating.to_string());
                ui.label(weak(shown));
            });
        }
    }

    fn pairs_ui(&mut self, ui: &mut Ui) {
        ui.add_space(10.0);
        ui.label(RichText::new(text::questionnaires::PAIRS).font(theme::strong(15.0)));
        ui.columns(2, |columns| {
            for (at, ((one, other), chosen)) in PAIRS.iter().zip(&mut self.chosen).enumerate() {
                columns[at / PAIRS.len().div_ceil(2)].horizontal(|ui| {
                    ui.add_sized(vec2(22.0, 30.0), Label::new(small((at + 1).to_string())));
                    for scale in [one, other] {
                        let name = name_of(*scale);
                        let button = Button::selectable(*chosen == Some(*scale), &name).frame_when_inactive(true);
                        let response = ui.add(button.min_size(vec2(130.0, 30.0)));
                        let named = format!("{}: {name}", at + 1);
                        let on = *chosen == Some(*scale);
                        response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, on, &named));
                        if response.clicked() {
                            *chosen = Some(*scale);
                        }
                    }
                });
            }
        });
    }

    fn sus_ui(&mut self, ui: &mut Ui) {
        for ((statement, item), number) in SUS_ITEMS.iter().zip(&mut self.items).zip(1..) {
            numbered_ui(
                ui,
                &format!("{number}. {statement}"),
                item,
                5,
                number,
                text::questionnaires::AGREE.map(Text::get),
            );
        }
    }

    fn text_ui(&mut self, ui: &mut Ui) {
        let label = ui.label(RichText::new(text::questionnaires::FREE_TEXT).font(theme::strong(15.0)));
        ui.label(small(text::questionnaires::FREE_TEXT_HINT));
        let field = TextEdit::multiline(&mut self.text).desired_rows(8).desired_width(f32::INFINITY).char_limit(4000);
        ui.add(field).labelled_by(label.id);
    }
}

/// Returns the position (0 to 100) of a tap whose press and release arrived in one frame, which a slider misses.
fn tapped(slider: &Response) -> Option<f64> {
    let (is_tap, at) = slider.ctx.input(|input| {
        let pointer = &input.pointer;
        (pointer.primary_pressed() && pointer.primary_released(), pointer.interact_pos())
    });
    let at = at.filter(|_| is_tap && slider.contains_pointer())?;
    // Keep the middle of the handle within the line.
    let line = slider.rect.x_range().shrink(slider.rect.height() / 2.5);
    Some(f64::from(100.0 * ((at.x - line.min) / line.span()).clamp(0.0, 1.0)))
}

/// Draws a question that is answered by a number from 1 on.
fn scale_ui(ui: &mut Ui, question: &str, answer: &mut Option<u8>, max: u8) {
    numbered_ui(ui, question, answer, max, 1, ["", ""]);
}

/// Like [`scale_ui`], with the meanings of the first and last number.
fn numbered_ui(ui: &mut Ui, question: &str, answer: &mut Option<u8>, max: u8, number: usize, [first, last]: [&str; 2]) {
    ui.add_space(4.0);
    ui.add(Label::new(question).wrap());
    ui.horizontal(|ui| {
        ui.label(small(first));
        for value in 1..=max {
            let on = *answer == Some(value);
            let button = Button::selectable(on, value.to_string()).frame_when_inactive(true);
            let response = ui.add(button.min_size(vec2(48.0, 30.0)));
            let named = format!("{number}: {value}");
            response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, on, &named));
            if response.clicked() {
                *answer = Some(value);
            }
        }
        ui.label(small(last));
    });
}
