//! The studies of the user's data folder, and others that were opened here before.

use std::path::{Path, PathBuf};

use egui::{Button, Label, RichText, Ui, vec2};
use nima_recording::store::utc_now;
use nima_screen::{
    theme,
    widgets::{card, next_button, small, weak},
};
use nima_user_study::{StudyStep, UserStudy};

use super::{column, field_ui};
use crate::extras::user_studies::text;

/// Folder of studies within the user's data.
const FOLDER: &str = "studies";
const PLAN: &str = "study.toml";
const BUTTON: egui::Vec2 = vec2(150.0, 36.0);

#[derive(Debug, Default)]
pub(super) struct StudyList {
    rows: Vec<StudyListRow>,
    /// The folder typed by the user.
    other: String,
    report: Option<String>,
}

#[derive(Debug)]
struct StudyListRow {
    folder: PathBuf,
    name: String,
    about: Result<String, String>,
}

/// The chosen action.
pub(super) enum StudyListChoice {
    Back,
    New,
    Open(Box<UserStudy>),
}

pub(super) fn folder_of(data: &Path) -> PathBuf {
    data.join(FOLDER)
}

/// Returns whether the list finds this folder automatically.
pub(super) fn is_in(data: Option<&Path>, folder: &Path) -> bool {
    data.is_some_and(|data| folder.parent() == Some(&folder_of(data)))
}

impl StudyList {
    /// Reads the list again.
    pub(super) fn read(&mut self, data: Option<&Path>, known: &[PathBuf]) {
        let entries = data.map(folder_of).and_then(|folder| std::fs::read_dir(folder).ok());
        let mut folders: Vec<PathBuf> = entries.into_iter().flatten().flatten().map(|entry| entry.path()).collect();
        folders.retain(|folder| folder.join(PLAN).is_file());
        folders.sort();
        folders.extend(known.iter().cloned());
        self.rows = folders.into_iter().map(StudyListRow::of).collect();
        self.report = data.is_none().then(|| text::studies::NO_FOLDER.get().to_owned());
    }

    fn open(&mut self, folder: &Path) -> Option<StudyListChoice> {
        match UserStudy::open(folder, &utc_now()) {
            Ok(study) => Some(StudyListChoice::Open(Box::new(study))),
            Err(error) => {
                self.report = Some(error.to_string());
                None
            }
        }
    }

    pub(super) fn ui(&mut self, ui: &mut Ui) -> Option<StudyListChoice> {
        let mut done = None;
        let mut wanted = None;
        ui.horizontal(|ui| {
            if ui.add(Button::new(text::studies::BACK).min_size(BUTTON)).clicked() {
                done = Some(StudyListChoice::Back);
            }
            ui.label(RichText::new(text::studies::OPEN).font(theme::strong(19.0)));
        });
        // A separate line, so that the content below never moves.
        ui.add(Label::new(weak(self.report.clone().unwrap_or_default())).wrap());
        ui.add_space(4.0);
        let room = ui.available_size();
        let gap = theme::GAP;
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = gap;
            column(ui, "studies", vec2(0.62 * room.x - gap, room.y), |ui| {
                card(ui, text::studies::YOURS, text::studies::YOURS_HOVER, |ui| {
                    if self.rows.is_empty() {
                        ui.label(weak(text::studies::NONE));
                    }
                    for row in &self.rows {
                        if row.ui(ui) {
                            wanted = Some(row.folder.clone());
                        }
                    }
                });
            });
            column(ui, "new", vec2(0.38 * room.x, room.y), |ui| {
                let name = RichText::new(text::studies::NEW).font(theme::strong(17.0));
                let button = next_button(name, self.rows.is_empty()).min_size(vec2(ui.available_width(), 44.0));
                if ui.add(button).on_hover_text(text::study_form::READY_HOVER).clicked() {
                    done = Some(StudyListChoice::New);
                }
                ui.add_space(theme::GAP);
                card(ui, text::studies::OTHER, text::studies::YOURS_HOVER, |ui| {
                    field_ui(ui, text::studies::OTHER_FOLDER.get(), &mut self.other);
                    let written = !self.other.trim().is_empty();
                    let button = Button::new(text::studies::OTHER_OPEN).min_size(vec2(ui.available_width(), 32.0));
                    if ui.add_enabled(written, button).clicked() {
                        wanted = Some(PathBuf::from(self.other.trim()));
                    }
                });
            });
        });
        done.or_else(|| self.open(&wanted?))
    }
}

impl StudyListRow {
    fn of(folder: PathBuf) -> Self {
        match UserStudy::read(&folder) {
            Ok(study) => Self { name: study.plan().name.clone(), about: Ok(standing(&study)), folder },
            Err(error) => Self { name: folder.display().to_string(), about: Err(error.to_string()), folder },
        }
    }

    /// Returns true when it is to be opened.
    fn ui(&self, ui: &mut Ui) -> bool {
        ui.add_space(2.0);
        ui.add(Label::new(RichText::new(&self.name).font(theme::strong(15.0))).wrap());
        let mut clicked = false;
        ui.horizontal(|ui| {
            let button = Button::new(text::studies::OPEN_THIS).min_size(vec2(74.0, 28.0));
            let response = ui.add_enabled(self.about.is_ok(), button);
            let name = text::studies::open_named(&self.name);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, self.about.is_ok(), &name));
            clicked = response.clicked();
            let about = self.about.as_ref().unwrap_or_else(|why| why);
            ui.vertical(|ui| {
                ui.add(Label::new(about).wrap());
                ui.add(Label::new(small(self.folder.display().to_string())).wrap());
            });
        });
        ui.add_space(6.0);
        clicked
    }
}

/// Returns the number of finished or excluded participants.
pub(super) fn finished(study: &UserStudy) -> usize {
    let plan = study.plan();
    let state = study.state();
    plan.participants.iter().filter(|one| matches!(state.next(plan, one), StudyStep::Done { .. })).count()
}

pub(super) fn blindness(study: &UserStudy) -> &'static str {
    text::studies::blindness(study.plan().blind, study.state().unblinding.is_some())
}

fn standing(study: &UserStudy) -> String {
    let participants = study.plan().participants.len();
    text::studies::standing(finished(study), participants, study.state().results(), blindness(study))
}
