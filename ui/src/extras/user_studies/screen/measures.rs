//! The form's parts for task and measurement: scene, task, measures, and exclusion rules.

use egui::{Button, ComboBox, DragValue, Grid, Label, Ui, vec2};
use nima_score::LONGEST_TRIAL_S;
use nima_screen::widgets::{card, small, weak};
use nima_user_study::{Excludes, ExclusionRule, MeasureComparison};

use super::{
    draft::{Draft, MeasureChoice},
    form::{seconds_ui, whole_ui},
};
use crate::extras::user_studies::text;

/// Width of the open lists of measures, points.
const LIST: f32 = 460.0;

pub(super) fn task_ui(ui: &mut Ui, draft: &mut Draft) {
    card(ui, text::study_form::TASK, text::study_form::TASK_HOVER, |ui| {
        let mut chosen = None;
        let rings = draft.place_of_scene().map_or(0, |place| place.rings);
        let place = draft.place_of_scene();
        let [name, about] = place.map_or([&draft.file.scene, ""], |place| [place.name.as_str(), &place.about]);
        let label = ui.label(weak(text::study_form::SCENE));
        let combo = ComboBox::from_id_salt("scene").width(220.0).selected_text(name).show_ui(ui, |ui| {
            for (at, place) in draft.scenes.iter().enumerate() {
                if ui.selectable_label(place.of == draft.file.scene, &place.name).on_hover_text(&place.about).clicked()
                {
                    chosen = Some(at);
                }
            }
        });
        combo.response.labelled_by(label.id);
        ui.add(Label::new(small(about)).wrap());
        Grid::new("task").num_columns(2).spacing(vec2(12.0, 4.0)).show(ui, |ui| {
            if let Some(task) = &draft.task {
                let mut limit_s = task.time_limit_s;
                seconds_ui(ui, text::study_form::LIMIT.get(), &mut limit_s, 0.0..=LONGEST_TRIAL_S);
                if (limit_s - task.time_limit_s).abs() > 0.0 {
                    draft.limit(limit_s);
                }
            }
            if rings > 0 {
                ui.checkbox(&mut draft.takes_few, text::study_form::FEW_RINGS);
                ui.end_row();
                if draft.takes_few {
                    whole_ui(ui, text::study_form::RINGS.get(), &mut draft.rings, 0..=rings);
                }
            }
        });
        if let Some(at) = chosen {
            draft.choose(at);
        }
    });
}

/// Draws the primary measure, and the others of the report.
pub(super) fn measures_ui(ui: &mut Ui, draft: &mut Draft) {
    let Draft { file, measures, .. } = draft;
    card(ui, text::study_form::MEASURES, text::study_form::MEASURES_HOVER, |ui| {
        let label = ui.label(weak(text::study_form::PRIMARY));
        let mut chosen = None;
        measure_ui(ui, ("primary", 0), &file.primary, measures, &mut chosen).labelled_by(label.id);
        if let Some(key) = chosen.take() {
            file.primary = key;
        }
        ui.label(small(meaning(measures, &file.primary)));
        ui.add_space(4.0);
        ui.label(weak(text::study_form::SECONDARY));
        let mut gone = None;
        ui.horizontal_wrapped(|ui| {
            // A wider row above must not push these out of the window.
            ui.set_max_width(ui.available_width().min(SECONDARY_WIDTH));
            for (at, key) in file.secondary.iter().enumerate() {
                let button = ui.add(Button::new(text::study_form::leave_off(key)));
                if button.on_hover_text(text::study_form::leave_off_hover(&meaning(measures, key))).clicked() {
                    gone = Some(at);
                }
            }
        });
        if let Some(gone) = gone {
            file.secondary.remove(gone);
        }
        let more = text::study_form::ADD_MEASURE.get();
        let combo = measure_ui(ui, ("more", 0), more, measures, &mut chosen);
        combo.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, more));
        file.secondary.extend(chosen);
    });
}

/// Width within which the secondary measures wrap, points: a third of the smallest window.
const SECONDARY_WIDTH: f32 = 300.0;

/// Shows the rules that exclude trials and participants.
pub(super) fn exclusion_ui(ui: &mut Ui, draft: &mut Draft) {
    let mut gone = None;
    card(ui, text::study_form::EXCLUSION, text::study_form::EXCLUSION_HOVER, |ui| {
        let Draft { file, measures, .. } = draft;
        if file.exclusion.is_empty() {
            ui.label(small(text::study_form::NO_RULES));
        }
        Grid::new("exclusion").num_columns(6).spacing(vec2(8.0, 4.0)).show(ui, |ui| {
            for (rule, number) in file.exclusion.iter_mut().zip(1..) {
                rule_ui(ui, rule, number, measures);
                let name = text::study_form::of_rule(text::study_form::REMOVE.get(), number);
                let remove = ui.add(Button::new(text::study_form::REMOVE));
                remove.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                if remove.clicked() {
                    gone = Some(number - 1);
                }
                ui.end_row();
            }
        });
        if ui.add(Button::new(text::study_form::ADD_RULE).min_size(vec2(140.0, 28.0))).clicked() {
            draft.add_rule();
        }
    });
    if let Some(gone) = gone {
        draft.file.exclusion.remove(gone);
    }
}

fn rule_ui(ui: &mut Ui, rule: &mut ExclusionRule, number: usize, measures: &[MeasureChoice]) {
    let named = |what: &str| text::study_form::of_rule(what, number);
    let mut chosen = None;
    let combo = measure_ui(ui, ("rule", number), &rule.measure, measures, &mut chosen);
    combo.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, named(text::study_form::MEASURE.get())));
    if let Some(key) = chosen {
        rule.measure = key;
    }
    let is =
        choose_ui(ui, ("is", number), &mut rule.is, &COMPARISONS.map(|one| (one, text::study_form::comparison(one))));
    is.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, named(text::study_form::IS.get())));
    if rule.is == MeasureComparison::Missing {
        rule.limit = None;
        ui.label("");
    } else {
        let unit = measures.iter().find(|known| known.key == rule.measure).map_or("", |known| known.unit);
        let unit = if unit == "1" || unit == "count" { String::new() } else { format!(" {unit}") };
        let mut limit = rule.limit.unwrap_or(0.0);
        let drag = DragValue::new(&mut limit).speed(0.1).max_decimals(3).suffix(unit);
        let drag = ui.add(if rule.limit.is_some() { drag } else { drag.custom_formatter(|_, _| NO_LIMIT.to_owned()) });
        if drag.changed() || drag.lost_focus() {
            rule.limit = Some(limit);
        }
        drag.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::SpinButton, true, named(text::study_form::LIMIT_OF.get()))
        });
    }
    let excludes = [Excludes::Trial, Excludes::Participant].map(|one| (one, text::study_form::excludes(one)));
    let what = choose_ui(ui, ("excludes", number), &mut rule.exclude, &excludes);
    what.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, named(text::study_form::LEFT_OUT.get())));
    if rule.exclude == Excludes::Participant {
        let drag =
            ui.add(DragValue::new(&mut rule.times).range(0..=1000).speed(0.1).suffix(text::study_form::TIMES.get()));
        drag.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::SpinButton, true, named(text::study_form::FROM.get()))
        });
    } else {
        rule.times = 1;
        ui.label("");
    }
}

/// Text for an unset limit.
const NO_LIMIT: &str = "...";
const COMPARISONS: [MeasureComparison; 3] =
    [MeasureComparison::Above, MeasureComparison::Below, MeasureComparison::Missing];

/// Draws a list of values, by their texts.
fn choose_ui<T: PartialEq + Copy>(
    ui: &mut Ui,
    id: (&str, usize),
    value: &mut T,
    choices: &[(T, &'static str)],
) -> egui::Response {
    let shown = choices.iter().find(|(one, _)| one == value).map_or("", |(_, words)| words);
    let combo = ComboBox::from_id_salt(id).width(104.0).selected_text(shown).show_ui(ui, |ui| {
        for (one, words) in choices {
            ui.selectable_value(value, *one, *words);
        }
    });
    combo.response
}

/// Draws a list of the measures, which shows this one.
fn measure_ui(
    ui: &mut Ui,
    id: (&str, usize),
    shown: &str,
    measures: &[MeasureChoice],
    chosen: &mut Option<String>,
) -> egui::Response {
    let combo = ComboBox::from_id_salt(id).width(190.0).selected_text(shown).show_ui(ui, |ui| {
        ui.set_min_width(LIST);
        for known in measures {
            let words = text::study_form::measure(&known.key, known.words);
            if ui.selectable_label(known.key == shown, words).clicked() {
                *chosen = Some(known.key.clone());
            }
        }
    });
    combo.response
}

fn meaning(measures: &[MeasureChoice], key: &str) -> String {
    measures.iter().find(|known| known.key == *key).map_or_else(String::new, |known| known.words.to_owned())
}
