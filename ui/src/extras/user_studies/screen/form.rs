//! The form of a new study.

use std::{ops::RangeInclusive, path::Path};

use egui::{Button, ComboBox, DragValue, Grid, Label, RichText, ScrollArea, TextEdit, Ui, vec2};
use nima_core::{
    impedance::Mode,
    limits::{DELAY_S, GAIN},
};
use nima_score::LONGEST_TRIAL_S;
use nima_screen::{
    theme,
    widgets::{card, next_button, small, weak},
};
use nima_user_study::{
    ATTEMPTS_MAX, BREAK_AFTER_MAX, BREAK_MAX_S, Condition, InterruptionPolicy, NotReached, PARTICIPANTS_MAX,
    PRACTICE_MAX, Questionnaire, TRIALS_MAX, UserStudy, order,
};
use nima_words::report_text::{mode_meaning, mode_name};

use super::{
    column,
    draft::{Draft, with_mode, without_force},
    field_ui,
    measures::{exclusion_ui, measures_ui, task_ui},
};
use crate::extras::user_studies::{
    study::{self, READY},
    text,
};

/// Height of the footer with buttons and errors.
const FOOT: f32 = 84.0;
/// Fraction of the width for the left column.
const LEFT: f32 = 0.42;

#[derive(Debug)]
pub(super) struct StudyForm {
    draft: Draft,
    report: Vec<String>,
}

/// The chosen action.
pub(super) enum FormChoice {
    Back,
    Made(Box<UserStudy>),
}

impl StudyForm {
    pub(super) fn new() -> Option<Self> {
        Some(Self { draft: Draft::of(READY[0])?, report: Vec::new() })
    }

    pub(super) fn ui(&mut self, ui: &mut Ui, data: Option<&Path>) -> Option<FormChoice> {
        let room = ui.available_size() - vec2(0.0, FOOT);
        let draft = &mut self.draft;
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = theme::GAP;
            column(ui, "what", vec2(LEFT * room.x - theme::GAP, room.y), |ui| {
                ready_ui(ui, draft);
                what_ui(ui, draft);
                task_ui(ui, draft);
                practice_ui(ui, draft);
            });
            column(ui, "conditions", vec2((1.0 - LEFT) * room.x, room.y), |ui| {
                conditions_ui(ui, draft);
                measures_ui(ui, draft);
                exclusion_ui(ui, draft);
                breaks_ui(ui, draft);
                questionnaires_ui(ui, draft);
            });
        });
        ui.add_space(6.0);
        self.foot_ui(ui, data)
    }

    fn foot_ui(&mut self, ui: &mut Ui, data: Option<&Path>) -> Option<FormChoice> {
        let mut done = None;
        ui.horizontal(|ui| {
            let name = RichText::new(text::study_form::MAKE).font(theme::strong(17.0));
            let make =
                ui.add_enabled(data.is_some(), next_button(name, true).min_size(vec2(160.0, theme::STOP_SIZE.y)));
            let make = make.on_hover_text(text::study_form::MAKE_HOVER);
            if make.on_disabled_hover_text(text::studies::NO_FOLDER).clicked()
                && let Some(data) = data
            {
                done = self.make(data);
            }
            if ui.add(Button::new(text::studies::BACK).min_size(theme::STOP_SIZE)).clicked() {
                done = Some(FormChoice::Back);
            }
            ScrollArea::vertical().id_salt("mistakes").max_height(FOOT - 12.0).auto_shrink(false).show(ui, |ui| {
                ui.vertical(|ui| {
                    let place = data.map(|data| text::study_form::place(&self.draft.place(data)));
                    if self.report.is_empty() {
                        ui.add(Label::new(small(place.unwrap_or_default())).wrap());
                    }
                    for mistake in &self.report {
                        ui.add(Label::new(mistake).wrap());
                    }
                });
            });
        });
        done
    }

    /// All errors are shown at once.
    fn make(&mut self, data: &Path) -> Option<FormChoice> {
        let file = self.draft.file();
        self.report = study::mistakes(&file);
        if !self.report.is_empty() {
            return None;
        }
        match study::create(&self.draft.place(data), &file) {
            Ok(study) => Some(FormChoice::Made(Box::new(study))),
            Err(error) => {
                self.report = vec![format!("{error:#}")];
                None
            }
        }
    }
}

fn ready_ui(ui: &mut Ui, draft: &mut Draft) {
    card(ui, text::study_form::READY, text::study_form::READY_HOVER, |ui| {
        for ready in READY {
            let [name, about] = text::study_form::ready(ready);
            let button = Button::selectable(draft.ready == ready, name).frame_when_inactive(true);
            let clicked = ui.add(button.min_size(vec2(ui.available_width(), 30.0))).clicked();
            ui.add(Label::new(small(about)).wrap());
            if let Some(other) = clicked.then(|| Draft::of(ready)).flatten() {
                *draft = other;
            }
        }
    });
}

fn what_ui(ui: &mut Ui, draft: &mut Draft) {
    let file = &mut draft.file;
    card(ui, text::study_form::WHAT, text::study_form::WHAT_HOVER, |ui| {
        field_ui(ui, text::study_form::NAME.get(), &mut file.name);
        field_ui(ui, text::study_form::RIG.get(), &mut file.rig);
        Grid::new("figures").num_columns(2).spacing(vec2(12.0, 4.0)).show(ui, |ui| {
            whole_ui(ui, text::study_form::PARTICIPANTS.get(), &mut file.participants, 0..=PARTICIPANTS_MAX);
            whole_ui(ui, text::study_form::TRIALS.get(), &mut file.trials, 0..=TRIALS_MAX);
            whole_ui(ui, text::study_form::ATTEMPTS.get(), &mut file.attempts, 0..=ATTEMPTS_MAX);
        });
        let rows = order::williams(file.conditions.len()).len();
        ui.label(small(text::study_form::balance(file.participants as usize, rows)));
        ui.horizontal_wrapped(|ui| {
            ui.label(text::study_form::INTERRUPTED);
            either_ui(
                ui,
                &mut file.interrupted,
                [
                    (InterruptionPolicy::Repeat, text::study_form::REPEATED.get()),
                    (InterruptionPolicy::Resume, text::study_form::SKIPPED.get()),
                ],
            );
        });
        ui.checkbox(&mut file.blind, text::study_form::BLIND);
        ui.checkbox(&mut file.record, text::study_form::RECORD);
    });
}

fn practice_ui(ui: &mut Ui, draft: &mut Draft) {
    let names: Vec<String> = draft.file.conditions.iter().map(|condition| condition.name.clone()).collect();
    card(ui, text::study_form::PRACTICE, text::study_form::PRACTICE_HOVER, |ui| {
        ui.checkbox(&mut draft.practises, text::study_form::PRACTISES);
        let criterion = &mut draft.practice.criterion;
        ui.add_enabled_ui(draft.practises, |ui| {
            Grid::new("practice").num_columns(2).spacing(vec2(12.0, 4.0)).show(ui, |ui| {
                seconds_ui(ui, text::study_form::TIME.get(), &mut criterion.time_s, 0.0..=LONGEST_TRIAL_S);
                whole_ui(ui, text::study_form::DROPS.get(), &mut criterion.drops_out_of_view, 0..=20);
                whole_ui(ui, text::study_form::IN_A_ROW.get(), &mut criterion.consecutive, 0..=50);
                whole_ui(ui, text::study_form::MORE.get(), &mut criterion.additional, 0..=50);
                whole_ui(ui, text::study_form::MAX.get(), &mut criterion.max_trials, 0..=PRACTICE_MAX);
                choice_ui(ui, text::study_form::UNDER.get(), &mut draft.under, &names, text::study_form::IN_TURN.get());
            });
            ui.horizontal_wrapped(|ui| {
                ui.label(text::study_form::NOT_REACHED);
                either_ui(
                    ui,
                    &mut draft.practice.not_reached,
                    [
                        (NotReached::GoOn, text::study_form::GOES_ON.get()),
                        (NotReached::Exclude, text::study_form::EXCLUDED.get()),
                    ],
                );
            });
        });
    });
}

fn conditions_ui(ui: &mut Ui, draft: &mut Draft) {
    let mut gone = None;
    card(ui, text::study_form::CONDITIONS, text::study_form::CONDITIONS_HOVER, |ui| {
        let few = draft.file.conditions.len() <= 2;
        Grid::new("conditions-table").num_columns(5).spacing(vec2(8.0, 4.0)).show(ui, |ui| {
            for head in [
                text::study_form::NAME.get(),
                text::study_form::FEEDBACK.get(),
                text::study_form::GAIN.get(),
                text::study_form::DELAY.get(),
            ] {
                ui.label(small(head));
            }
            ui.end_row();
            for (condition, number) in draft.file.conditions.iter_mut().zip(1..) {
                condition_ui(ui, condition, number);
                let remove = ui.add_enabled(!few, Button::new(text::study_form::REMOVE));
                let name = text::study_form::of_condition(text::study_form::REMOVE.get(), number);
                remove.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, !few, &name));
                if remove.clicked() {
                    gone = Some(number - 1);
                }
                ui.end_row();
            }
        });
        let names: Vec<String> = draft.file.conditions.iter().map(|condition| condition.name.clone()).collect();
        ui.horizontal(|ui| {
            if ui.add(Button::new(text::study_form::ADD).min_size(vec2(140.0, 28.0))).clicked() {
                draft.add();
            }
            choice_ui(
                ui,
                text::study_form::REFERENCE.get(),
                &mut draft.reference,
                &names,
                text::study_form::FIRST_LABEL.get(),
            );
        });
    });
    if let Some(gone) = gone {
        draft.remove(gone);
    }
}

fn condition_ui(ui: &mut Ui, condition: &mut Condition, number: usize) {
    let named = |what: &str| text::study_form::of_condition(what, number);
    let name = ui.add_sized(vec2(150.0, 22.0), TextEdit::singleline(&mut condition.name).char_limit(60));
    name.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, named(text::study_form::NAME.get())));
    let shown = condition.mode.map_or(text::study_form::NO_FORCE.get(), mode_name);
    let combo = ComboBox::from_id_salt(("force", number)).width(128.0).selected_text(shown).show_ui(ui, |ui| {
        for mode in Mode::ALL {
            let chosen = condition.mode == Some(mode);
            if ui.selectable_label(chosen, mode_name(mode)).on_hover_text(mode_meaning(mode)).clicked() {
                with_mode(condition, mode);
            }
        }
        if ui.selectable_label(condition.no_force, text::study_form::NO_FORCE).clicked() {
            without_force(condition);
        }
    });
    let of = named(text::study_form::FEEDBACK.get());
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &of));
    if condition.no_force {
        ui.label(weak(text::study_form::NO_GAIN));
    } else {
        let mut gain = condition.gain.unwrap_or(1.0);
        let drag = ui.add(DragValue::new(&mut gain).range(0.01..=GAIN.max).speed(0.01).fixed_decimals(2));
        if drag.changed() {
            condition.gain = Some(gain);
        }
        drag.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::SpinButton, true, named(text::study_form::GAIN.get()))
        });
    }
    let mut delay_ms = condition.delay_ms.unwrap_or(0.0);
    let delays_ms = DELAY_S.per(1e-3, "ms");
    let drag = ui.add(DragValue::new(&mut delay_ms).range(delays_ms.min..=delays_ms.max).speed(1.0).suffix(" ms"));
    if drag.changed() {
        condition.delay_ms = Some(delay_ms);
    }
    drag.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, named(text::study_form::DELAY.get())));
}

fn breaks_ui(ui: &mut Ui, draft: &mut Draft) {
    card(ui, text::study_form::BREAKS, text::study_form::BREAKS_HOVER, |ui| {
        ui.checkbox(&mut draft.rests, text::study_form::RESTS);
        ui.add_enabled_ui(draft.rests, |ui| {
            Grid::new("breaks").num_columns(2).spacing(vec2(12.0, 4.0)).show(ui, |ui| {
                whole_ui(ui, text::study_form::EVERY.get(), &mut draft.breaks.after_trials, 0..=BREAK_AFTER_MAX);
                seconds_ui(ui, text::study_form::MIN.get(), &mut draft.breaks.min_s, 0.0..=BREAK_MAX_S);
            });
        });
    });
}

fn questionnaires_ui(ui: &mut Ui, draft: &mut Draft) {
    let asked = &mut draft.file.questionnaires;
    card(ui, text::study_form::QUESTIONNAIRES, text::study_form::QUESTIONNAIRES_HOVER, |ui| {
        Grid::new("questionnaires").num_columns(3).spacing(vec2(16.0, 4.0)).show(ui, |ui| {
            ui.label("");
            ui.label(small(text::study_form::AFTER_EACH));
            ui.label(small(text::study_form::AT_END));
            ui.end_row();
            for which in Questionnaire::ALL {
                let name = text::questionnaires::questionnaire(which);
                ui.label(name);
                for (all, when) in [
                    (&mut asked.after_condition, text::study_form::AFTER_EACH.get()),
                    (&mut asked.at_end, text::study_form::AT_END.get()),
                ] {
                    let mut on = all.contains(&which);
                    let response = ui.checkbox(&mut on, "");
                    if response.changed() {
                        all.retain(|one| *one != which);
                        all.extend(on.then_some(which));
                        all.sort();
                    }
                    let words = format!("{name}: {when}");
                    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, &words));
                }
                ui.end_row();
            }
        });
    });
}

pub(super) fn whole_ui(ui: &mut Ui, name: &str, value: &mut u32, range: RangeInclusive<u32>) {
    let label = ui.label(weak(name));
    ui.add(DragValue::new(value).range(range).speed(0.1)).labelled_by(label.id);
    ui.end_row();
}

pub(super) fn seconds_ui(ui: &mut Ui, name: &str, value_s: &mut f64, range_s: RangeInclusive<f64>) {
    let label = ui.label(weak(name));
    ui.add(DragValue::new(value_s).range(range_s).speed(1.0).max_decimals(1).suffix(" s")).labelled_by(label.id);
    ui.end_row();
}

/// Draws a choice of one of these conditions, or none.
fn choice_ui(ui: &mut Ui, name: &str, chosen: &mut Option<usize>, names: &[String], none: &str) {
    let label = ui.label(weak(name));
    let shown = chosen.and_then(|at| names.get(at)).map_or(none, String::as_str);
    let combo = ComboBox::from_id_salt(name).width(128.0).selected_text(shown).show_ui(ui, |ui| {
        ui.selectable_value(chosen, None, none);
        for (at, name) in names.iter().enumerate() {
            ui.selectable_value(chosen, Some(at), name);
        }
    });
    combo.response.labelled_by(label.id);
    ui.end_row();
}

fn either_ui<T: PartialEq + Copy>(ui: &mut Ui, value: &mut T, choices: [(T, &str); 2]) {
    for (choice, name) in choices {
        let button = Button::selectable(*value == choice, name).frame_when_inactive(true);
        if ui.add(button).clicked() {
            *value = choice;
        }
    }
}
